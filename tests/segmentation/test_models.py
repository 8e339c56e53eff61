"""Every background model by name: one conformance test over the registry, then what each promises by itself."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.segmentation import (
    BACKGROUND_MODELS,
    BackgroundModel,
    GaussianBackground,
    GaussianConfig,
    PlateBackground,
    PlateConfig,
    build_background,
    settings_at,
)

HEIGHT, WIDTH = 40, 60
BLUE, SKIN = (200, 40, 20), (120, 150, 210)  # BGR
NOISE = 2.0


def empty_pictures(rng, count=30, colour=BLUE):
    values = np.asarray(colour) + rng.normal(0, NOISE, (count, HEIGHT, WIDTH, 3))
    return list(np.clip(np.rint(values), 0, 255).astype(np.uint8))


def with_person(picture, colour=SKIN):
    out, truth = picture.copy(), np.zeros(picture.shape[:2], bool)
    truth[10:30, 20:40] = True
    out[truth] = colour
    return out, truth


@pytest.mark.parametrize("name", BACKGROUND_MODELS)
def test_each_model_finds_a_plain_person_on_a_blue_screen(name):
    rng = np.random.default_rng(1)
    *training, last = empty_pictures(rng)
    model = build_background(name, training)
    assert isinstance(model, BackgroundModel)
    picture, truth = with_person(last)
    mask = model.apply(picture)
    assert mask.shape == (HEIGHT, WIDTH) and mask.dtype == bool
    # 4 sd of the noise and more separate the two everywhere: nothing of the person may be lost, next to nothing added
    assert mask[truth].all()
    assert mask[~truth].mean() < 0.01


@pytest.mark.parametrize("name", [name for name, entry in BACKGROUND_MODELS.items() if entry.needs_pictures])
def test_models_work_on_grey_pictures(name):
    rng = np.random.default_rng(2)
    grey = [picture[..., 0] for picture in empty_pictures(rng)]
    picture, truth = grey[-1].copy(), np.zeros((HEIGHT, WIDTH), bool)
    truth[10:30, 20:40] = True
    picture[truth] = 90
    mask = build_background(name, grey[:-1]).apply(picture)
    assert mask[truth].all() and mask[~truth].mean() < 0.01


@pytest.mark.parametrize("name", [name for name, entry in BACKGROUND_MODELS.items() if entry.needs_pictures])
def test_another_size_is_refused(name):
    model = build_background(name, empty_pictures(np.random.default_rng(3)))
    with pytest.raises(InputError, match="60 x 40, 3 channels, got 30 x 20, 3 channels"):
        model.apply(np.zeros((20, 30, 3), np.uint8))


def test_unknown_names_and_settings_say_what_there_is():
    with pytest.raises(InputError, match="plate or gaussian or hue_key"):
        build_background("watershed")
    with pytest.raises(InputError, match="threshold"):
        build_background("plate", [np.zeros((4, 4, 3), np.uint8)], treshold=3)
    with pytest.raises(InputError, match="pictures of the empty scene"):
        build_background("plate")


def test_what_counts_pictures_follows_the_rate() -> None:
    """Defaults are for 30 Hz: 50 and 3600 pictures there, a third at 10 Hz; models that count none have none."""
    assert settings_at("spatial", 30.0) == {"rest": 50, "patience": 3600}
    assert settings_at("auto", 10.0) == {"rest": 17, "patience": 1200}
    assert settings_at("mixture", 10.0) == {}
    assert settings_at("kde", 0.001)["rest"] == 1  # 0 would mean never


@pytest.mark.parametrize("name, settings", [
    ("plate", {"space": "xyz"}), ("plate", {"threshold": 0}), ("gaussian", {"threshold": -1}),
    ("gaussian", {"update_rate": 2}), ("hue_key", {"tolerance": 0}), ("hue_key", {"minimum_saturation": 3}),
])  # fmt: skip
def test_senseless_settings_are_refused(name, settings):
    with pytest.raises(InputError):
        build_background(name, [np.zeros((4, 4, 3), np.uint8)] * 9, **settings)


def test_gaussian_learns_mean_and_variance_of_each_pixel():
    rng = np.random.default_rng(4)
    pictures = np.stack(empty_pictures(rng, 200)).astype(float)
    model = GaussianBackground.train(list(pictures.astype(np.uint8)))
    np.testing.assert_allclose(model.mean, pictures.mean(0), atol=1e-4)
    np.testing.assert_allclose(model.variance, pictures.var(0, ddof=1), rtol=1e-4, atol=1e-4)


def test_gaussian_false_alarms_are_as_rare_as_the_normal_law_says():
    """Largest of 3 channels beyond 3 sd: 1 - 0.9973^3 = 0.81 %. Standard error over 24,000 pixels 0.06 %; the sd is
    estimated from 400 pictures and pictures are rounded, which moves the rate by less than a tenth of itself."""
    rng = np.random.default_rng(5)

    def draw(count):
        return list(np.clip(np.rint(120 + rng.normal(0, 6, (count, HEIGHT, WIDTH, 3))), 0, 255).astype(np.uint8))

    model = GaussianBackground.train(draw(400), GaussianConfig(threshold=3, sd_floor=0.1))
    rate = np.mean([model.apply(picture).mean() for picture in draw(10)])
    assert abs(rate - 0.0081) < 0.1 * 0.0081 + 3 * 0.0006
    loose = GaussianBackground(model.mean, model.variance, GaussianConfig(threshold=2, sd_floor=0.1))
    assert np.mean([loose.apply(picture).mean() for picture in draw(3)]) > 0.1  # negative control: 13 % at 2 sd


def test_on_line_update_follows_light_but_does_not_learn_the_person():
    rng = np.random.default_rng(6)
    training = empty_pictures(rng, colour=(120, 120, 120))
    learning = GaussianBackground.train(training, GaussianConfig(update_rate=0.2))
    fixed = GaussianBackground.train(training)
    for step in range(40):
        plain = empty_pictures(rng, 1, colour=(120 + step,) * 3)[0]
        picture, truth = with_person(plain, colour=(30, 30, 240))
        mask, stuck = learning.apply(picture), fixed.apply(picture)
    assert mask[truth].all() and mask[~truth].mean() < 0.02
    assert stuck[~truth].mean() > 0.9  # negative control: a model that cannot learn sees 40 grey values more everywhere


def test_too_few_pictures_for_a_spread():
    with pytest.raises(InputError, match="5 or more"):
        GaussianBackground.train(empty_pictures(np.random.default_rng(7), 4))


@pytest.mark.parametrize("space", ["rgb", "lab"])
def test_plate_difference_is_nought_on_the_plate_and_thresholded_strictly(space):
    plate = empty_pictures(np.random.default_rng(8), 1)[0]
    model = PlateBackground(plate, PlateConfig(space=space))
    assert model.difference(plate).max() == 0
    assert not model.apply(plate).any()


def test_plate_rgb_difference_is_euclidean():
    plate = np.full((4, 4, 3), 100, np.uint8)
    model = PlateBackground(plate, PlateConfig("rgb", threshold=12.9))
    picture = plate + np.array([3, 4, 12], np.uint8)
    np.testing.assert_allclose(model.difference(picture), 13)
    assert model.apply(picture).all()


def test_half_weight_lab_minds_light_less_than_colour():
    plate = np.full((4, 4, 3), 120, np.uint8)
    model = PlateBackground(plate, PlateConfig("lab"))
    full = PlateBackground(plate, PlateConfig("lab", lightness_weight=1.0))
    brighter = np.full((4, 4, 3), 140, np.uint8)
    # a grey that gets brighter moves along L alone; float32 conversion leaves a and b within 0.01
    np.testing.assert_allclose(model.difference(brighter), full.difference(brighter) / 2, atol=0.01)


def test_a_plate_of_several_pictures_is_their_median():
    pictures = [np.full((4, 4, 3), value, np.uint8) for value in (10, 20, 200)]
    assert build_background("plate", pictures).background[0, 0, 0] == 20


def test_hue_key_wraps_round_and_refuses_grey():
    red = np.full((4, 4, 3), (20, 10, 220), np.uint8)
    model = build_background("hue_key", hue=355.0, tolerance=20.0)
    assert not model.apply(red).any()
    assert model.apply(np.full((4, 4, 3), BLUE, np.uint8)).all()
    with pytest.raises(InputError, match="three channels"):
        model.apply(red[..., 0])
