"""The colour that lasts, against visiting every pixel: comparisons of whole numbers, so that all agree."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge._kernels.lasting import over_rows_lasting
from reference.lasting import lasting


@pytest.mark.parametrize("ended", [True, False])
def test_against_visiting_every_pixel(ended: bool) -> None:
    """Colours of few values, so that many are near each other, and scores differ by more than rounding."""
    rng = np.random.default_rng(3)
    pixels = (10 * rng.integers(0, 4, (6, 7, 24, 3))).astype(np.uint8)
    out = np.zeros(pixels.shape[:3], bool)
    over_rows_lasting(pixels, 2, 10, 3, 0.5, 0.5, ended, out)
    expected = [[lasting(pixels[y, x], 2, 10, 3, 0.5, 0.5, ended) for x in range(7)] for y in range(6)]
    np.testing.assert_array_equal(out, expected)
    assert 0 < out.mean() < 1
