"""Light that changes over the whole picture: found beside people, and not found where there is none."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.segmentation import build_background
from muybridge.segmentation.light import GAIN, LATTICE, Light
from reference import mixture as literal

H, W, NOISE, MATCH = 60, 80, 3.0, 2.5
ROOM = np.random.default_rng(5).uniform(60, 180, (H // 5, W // 5, 3)).repeat(5, 0).repeat(5, 1)
DIM = np.array([[-0.5] * 3, [0.1, 0.1, 0.08], [-0.05] * 3, [0.06] * 3, [0.0] * 3, [-0.04] * 3])
"""A lamp off: 0.6 of the light, a tenth more on the right."""
DARK = np.outer([-0.5, 0, 0, 0, 0, 0], [1, 1, 1])
PERSON = np.zeros((H, W), bool)
PERSON[10:55, 30:50] = True  # 19 % of the picture


def picture(seed: int, field: np.ndarray | None = None, person: np.ndarray | None = None) -> np.ndarray:
    values = ROOM if person is None else np.where(person[..., None], (30, 200, 90), ROOM)
    if field is not None:
        values = values * literal.light(field, (H, W))
    values = values + np.random.default_rng(seed).normal(0, NOISE, values.shape)
    return np.clip(np.rint(values), 0, 255).astype(np.uint8)


def measured(light: Light, shown: np.ndarray) -> np.ndarray:
    mean = ROOM[light.lattice]
    return light.measure(shown, mean, np.full_like(mean, NOISE))


@pytest.mark.parametrize("person", [None, PERSON])
def test_a_field_is_found_beside_people(person: np.ndarray | None) -> None:
    """A gain's error is noise over brightness, 3 / 70, over the root of some 1000 pixels for each of 6 terms: 0.33 %
    where all six are at their largest; four times that is allowed."""
    light = Light((H, W, 3), MATCH)
    found = literal.light(measured(light, picture(1, DIM, person)), (H, W)) / literal.light(DIM, (H, W))
    assert np.abs(found - 1).max() < 4 * 3 / 70 * np.sqrt(6 / 1000)


def test_no_light_is_seen_where_nothing_or_too_little_changed() -> None:
    light = Light((H, W, 3), MATCH)
    assert not measured(light, picture(2)).any()
    assert not measured(light, picture(3, person=PERSON)).any()


def test_a_change_that_explains_less_than_half_of_the_picture_is_no_light() -> None:
    """The left part darkens, as if somebody large came: 0.4 of the pixels would go with one gain, 0.6 with none."""
    shown = picture(4)
    shown[:, : int(0.4 * W)] = picture(4, DARK)[:, : int(0.4 * W)]
    assert not measured(Light((H, W, 3), MATCH), shown).any()
    assert GAIN < 0.4


def test_pictures_too_small_or_dark_to_say() -> None:
    assert not measured_small(np.zeros((1, 1, 3), np.uint8)).any()
    assert not measured(Light((H, W, 3), MATCH), np.zeros((H, W, 3), np.uint8)).any()


def measured_small(shown: np.ndarray) -> np.ndarray:
    light = Light(shown.shape, MATCH)
    mean = np.full((1, 1, shown.shape[2]), 90.0)
    return light.measure(shown, mean, np.full_like(mean, NOISE))


def test_the_lattice_is_about_as_large_as_it_says() -> None:
    rows, columns = Light((480, 640, 3), MATCH).lattice
    assert 0.7 * LATTICE < len(range(480)[rows]) * len(range(640)[columns]) < 1.4 * LATTICE


@pytest.mark.parametrize("name", ["spatial", "auto"])
def test_people_are_found_in_the_first_picture_after_a_lamp_goes_off(name: str) -> None:
    """With `light` nothing but the person, as before; without, everything, as the negative control."""
    masks = {}
    for light in (True, False):
        model = build_background(name, [picture(seed) for seed in range(20)], light=light)
        masks[light] = model.apply(picture(30, DIM, PERSON))
    np.testing.assert_array_equal(masks[True], PERSON)
    assert masks[False][~PERSON].mean() > 0.9
