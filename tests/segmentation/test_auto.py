"""The rule between the Gaussian and the spatial model, pixel by pixel."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.segmentation import AutoBackground, AutoConfig, SpatialBackground
from reference.mixture import TAIL, fallen

H, W, NOISE = 24, 32, 2.0
LOOKS = (60, 140)
CONFIG = AutoConfig(light=False, closing=1, opening=1)


def shown(rng: np.random.Generator, look: int | np.ndarray) -> np.ndarray:
    values = np.broadcast_to(np.asarray(look)[..., None], (H, W, 3)) + rng.normal(0, NOISE, (H, W, 3))
    return np.rint(values).astype(np.uint8)


def changing() -> AutoBackground:
    """Ten pictures of one look, ten of the other, and again: all pixels change together."""
    rng = np.random.default_rng(1)
    return AutoBackground.train([shown(rng, LOOKS[number // 10 % 2]) for number in range(80)], CONFIG)


def test_where_it_is_calm_the_score_is_between_the_largest_deviation_and_that_of_pairs() -> None:
    """All deviations learnt are below the floor of 4, of noise of 2: means are those of 40 pictures."""
    rng = np.random.default_rng(2)
    model = AutoBackground.train([shown(rng, 100) for _ in range(40)], CONFIG)
    assert model.calm.all()
    picture = shown(rng, 100)
    picture[5, 7] = (100, 140, 90)
    largest = np.abs(picture - model.background).max(axis=2) / CONFIG.deviation_floor
    pairs = model._as_deviation(SpatialBackground._judged(model, picture)[0])
    np.testing.assert_allclose(model.score(picture), np.sqrt(largest * pairs), rtol=1e-3, atol=1e-3)
    assert model.apply(picture)[5, 7] and model.score(shown(rng, 100)).max() < CONFIG.threshold


@pytest.mark.parametrize("deviation", [0.0, 1.0, 2.3, 2.31, 12.0])
def test_a_score_for_the_deviation_at_which_all_densities_have_fallen_alike(deviation: float) -> None:
    """Of three channels and two partners, whose own densities are usual: 16 = 3 d^2 is where tails begin, at 2.309."""
    model = AutoBackground((H, W, 3), CONFIG)
    highest = 3 * np.log(256 / np.sqrt(2 * np.pi) / CONFIG.sd_floor)
    score = 3 * fallen(np.array(3 * deviation**2), TAIL) / 2 - (1 + 2 * 2) * highest
    np.testing.assert_allclose(model._as_deviation(np.full((H, W), score)), deviation, rtol=1e-5, atol=1e-3)


def test_both_looks_are_background_when_all_pixels_show_one() -> None:
    model = changing()
    assert not model.calm.any()
    for look in LOOKS:
        assert not model.apply(shown(np.random.default_rng(3), look)).any()


def test_a_look_that_does_not_go_with_the_neighbours_lies_further() -> None:
    """Alone in the one look while the partners show the other: each of two raises the square by 2 * 4 nats, to 4 sd. By
    pairs it lies further, for it was never seen with them.

    Elsewhere half of all pictures showed that look: log 2 less for each of three densities, 2 log 2 / 3 of a channel's
    squared deviation beside the noise's one: 1.21.
    """
    model, here = changing(), (12, 16)
    looks = np.full((H, W), LOOKS[0])
    looks[here] = LOOKS[1]
    score = model.score(shown(np.random.default_rng(4), looks))
    assert score[here] >= np.sqrt(2 * 2 * CONFIG.surprise_limit)
    assert np.median(score) < 1.21
