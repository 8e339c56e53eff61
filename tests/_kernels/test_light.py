"""A picture in another light, against its meaning."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge._kernels.light import relight
from reference import mixture as literal


@pytest.mark.parametrize("shape", [(30, 41, 3), (17, 8, 1)])
def test_relit_pictures_are_those_of_the_reference(shape: tuple[int, int, int]) -> None:
    """Rounded: half a grey value apart at most, and 1e-6 for products of a row's gains in another order."""
    rng = np.random.default_rng(1)
    image, field = rng.integers(0, 256, shape, dtype=np.uint8), rng.normal(0, 0.2, (6, shape[2]))
    found = np.empty_like(image)
    relight(image, field, found)
    wanted = np.minimum(image / literal.light(field, shape[:2]), 255)
    assert np.abs(found - wanted).max() <= 0.5 + 1e-6
    assert (wanted == 255).any() and (wanted < 255).any()
