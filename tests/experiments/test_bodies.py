from __future__ import annotations

import numpy as np
import pytest

from muybridge.body import named_body
from muybridge.experiments.bodies import TRUNK, rounded, wrong_body
from muybridge.tracking.body_input import own_lengths

BODY = named_body("person")


@pytest.mark.parametrize("share", [0.05, 0.10])
def test_every_length_is_wrong_by_that_share_with_both_signs(share: float) -> None:
    before, after = own_lengths(BODY), own_lengths(wrong_body(BODY, share, 3))
    ratios = np.array([after[name] / before[name] for name in before])
    np.testing.assert_allclose(np.abs(ratios - 1.0), share, rtol=1e-9)
    assert ratios.min() < 1 < ratios.max()


def test_the_seed_decides_which() -> None:
    first, again, other = (own_lengths(wrong_body(BODY, 0.1, seed)) for seed in (3, 3, 4))
    assert first == again and first != other


def test_a_round_trunk_has_the_area_of_the_elliptical_one() -> None:
    flat = {s.name: s.shape for s in BODY.segments}
    for segment in rounded(BODY).segments:
        shape, was = segment.shape, flat[segment.name]
        if segment.name in TRUNK:
            assert shape is not None and was is not None
            assert shape.scale[0] == shape.scale[1] != was.scale[0]
            assert np.prod(shape.scale) == pytest.approx(np.prod(was.scale))
        else:
            assert shape == was
