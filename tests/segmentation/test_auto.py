"""The Gaussian where it is calm, the spatial model everywhere, and what either learns."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.segmentation import AutoBackground, AutoConfig, GaussianBackground, SpatialBackground, SpatialConfig
from reference.mixture import TAIL, fallen

H, W, NOISE = 24, 32, 2.0
LOOKS = (60, 140)
CONFIG = AutoConfig(light=False, closing=1, opening=1)
PLACE = (slice(8, 14), slice(10, 16))


def shown(rng: np.random.Generator, look: int | np.ndarray) -> np.ndarray:
    values = np.broadcast_to(np.asarray(look)[..., None], (H, W, 3)) + rng.normal(0, NOISE, (H, W, 3))
    return np.rint(values).astype(np.uint8)


def calm(config: AutoConfig = CONFIG) -> AutoBackground:
    rng = np.random.default_rng(2)
    return AutoBackground.train([shown(rng, 100) for _ in range(40)], config)


def changing() -> AutoBackground:
    """Ten pictures of one look, ten of the other, and again: all pixels change together."""
    rng = np.random.default_rng(1)
    return AutoBackground.train([shown(rng, LOOKS[number // 10 % 2]) for number in range(80)], CONFIG)


def with_a_thing(rng: np.random.Generator, colour: tuple[int, int, int]) -> np.ndarray:
    picture = shown(rng, 100)
    picture[PLACE] = colour
    return picture


def test_where_it_is_calm_the_larger_deviation_counts() -> None:
    """The Gaussian's is that of the `gaussian` model of the same pictures, whose means agree to float32's rounding; all
    deviations learnt are below the floor of 4, of noise of 2."""
    rng = np.random.default_rng(2)
    pictures = [shown(rng, 100) for _ in range(40)]
    model, gaussian = AutoBackground.train(pictures, CONFIG), GaussianBackground.train(pictures)
    picture = shown(rng, 100)
    picture[5, 7] = (100, 140, 90)
    pairs = model._as_deviation(SpatialBackground._judged(model, picture)[0])
    wanted = np.maximum(1.25 * gaussian.score(picture), pairs)
    np.testing.assert_allclose(model.score(picture), wanted, rtol=1e-3, atol=1e-3)
    assert model.apply(picture)[5, 7] and model.score(shown(rng, 100)).max() < CONFIG.threshold


@pytest.mark.parametrize("deviation", [0.0, 1.0, 2.3, 2.31, 12.0])
def test_a_score_for_the_deviation_at_which_all_densities_have_fallen_alike(deviation: float) -> None:
    """Of three channels and two partners, whose own densities are usual: 16 = 3 d^2 is where tails begin, at 2.309."""
    model = AutoBackground((H, W, 3), CONFIG)
    highest = 3 * np.log(256 / np.sqrt(2 * np.pi) / CONFIG.sd_floor)
    score = 3 * fallen(np.array(3 * deviation**2), TAIL) / 2 - (1 + 2 * 2) * highest
    np.testing.assert_allclose(model._as_deviation(np.full((H, W), score)), deviation, rtol=1e-5, atol=1e-3)


class TestChanging:
    def test_both_looks_are_background_when_all_pixels_show_one(self) -> None:
        model = changing()
        for look in LOOKS:
            assert not model.apply(shown(np.random.default_rng(3), look)).any()

    def test_with_a_gaussian_everywhere_one_of_them_is_foreground(self) -> None:
        model = changing()
        model.config = replace(CONFIG, calm=0.0)
        first, second = (model.score(shown(np.random.default_rng(3), look)) > CONFIG.threshold for look in LOOKS)
        assert (first ^ second).all()

    def test_a_look_that_does_not_go_with_the_neighbours_is_foreground(self) -> None:
        """Alone in the one look while the partners show the other, with which it was never seen."""
        model, here = changing(), (12, 16)
        looks = np.full((H, W), LOOKS[0])
        looks[here] = LOOKS[1]
        mask = model.apply(shown(np.random.default_rng(4), looks))
        assert mask[here] and mask.sum() <= 1 + 8  # those who have it for a partner may be blamed


class TestLearnt:
    def test_a_thing_that_rests_is_background_to_both(self) -> None:
        """As soon as it is to the spatial model, though most of what the pixels showed was another look."""
        model, rng = calm(replace(CONFIG, rest=10, closing=3, opening=5)), np.random.default_rng(6)
        masks = [model.apply(with_a_thing(rng, (100, 160, 100)))[PLACE] for _ in range(17)]
        assert masks[5].all() and not masks[-1].any()
        assert model.mixtures.weights.max(axis=1)[PLACE].min() > CONFIG.calm

    def test_when_it_goes_away_the_gaussian_judges_again(self) -> None:
        model, rng = calm(replace(CONFIG, rest=10, closing=3, opening=5)), np.random.default_rng(6)
        pictures = [with_a_thing(rng, (100, 160, 100)) for _ in range(17)]
        for picture in (*pictures, shown(rng, 100)):
            model.apply(picture)
        without = replace(model.config, gaussian_weight=0.0)
        picture = with_a_thing(rng, (100, 111, 100))  # 2.75 deviations of 4, less five of a mean of 40: 0.4
        score = model.score(picture)[PLACE]
        model.config = without
        assert score.min() > 1.25 * 2.35
        assert (score > model.score(picture)[PLACE]).all()

    def test_it_learns_what_the_spatial_model_learns(self) -> None:
        """Whatever the Gaussian and the threshold say."""
        auto = calm(replace(CONFIG, gaussian_weight=9.0, threshold=3.0))
        plain = SpatialConfig(**{name: getattr(CONFIG, name) for name in SpatialConfig.__dataclass_fields__
                                 if name != "threshold"})  # fmt: skip
        rng = np.random.default_rng(2)
        spatial = SpatialBackground.train([shown(rng, 100) for _ in range(40)], plain)
        for number in range(10):
            picture = with_a_thing(rng, (100, 108 + 8 * number, 100))
            auto.apply(picture)
            spatial.apply(picture)
        np.testing.assert_array_equal(auto.mixtures.means, spatial.mixtures.means)
        np.testing.assert_array_equal(auto.counts, spatial.counts)


WRONG = [{"calm": 1.5}, {"gaussian_weight": -1.0}, {"deviation_floor": 0.0}, {"learnt_threshold": np.nan}]


@pytest.mark.parametrize("setting", WRONG)
def test_settings_that_mean_nothing(setting: dict[str, float]) -> None:
    (name,) = setting
    with pytest.raises(InputError, match=name):
        AutoConfig(**setting)
