"""The rule between the Gaussian and the spatial model, pixel by pixel."""

from __future__ import annotations

import numpy as np

from muybridge.segmentation import AutoBackground, AutoConfig

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


def test_where_it_is_calm_the_score_is_the_largest_deviation_over_the_channels() -> None:
    """All deviations learnt are below the floor of 4, of noise of 2: means are those of 40 pictures."""
    rng = np.random.default_rng(2)
    model = AutoBackground.train([shown(rng, 100) for _ in range(40)], CONFIG)
    assert model.calm.all()
    picture = shown(rng, 100)
    picture[5, 7] = (100, 140, 90)
    wanted = np.abs(picture - model.background).max(axis=2) / CONFIG.deviation_floor
    np.testing.assert_allclose(model.score(picture), wanted, rtol=1e-4, atol=1e-4)
    assert model.apply(picture)[5, 7]


def test_both_looks_are_background_when_all_pixels_show_one() -> None:
    model = changing()
    assert not model.calm.any()
    for look in LOOKS:
        assert not model.apply(shown(np.random.default_rng(3), look)).any()


def test_a_look_that_does_not_go_with_the_neighbours_lies_further() -> None:
    """Alone in the one look while the partners show the other: each of two raises the square by 2 * 4 nats, to 4 sd."""
    model, here = changing(), (12, 16)
    looks = np.full((H, W), LOOKS[0])
    looks[here] = LOOKS[1]
    score = model.score(shown(np.random.default_rng(4), looks))
    assert score[here] >= np.sqrt(2 * 2 * CONFIG.partner_limit)
    assert np.median(score) < 1
