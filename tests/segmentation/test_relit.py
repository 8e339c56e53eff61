"""A lamp that is switched: the picture in the old light again, and people as dark before the floor as they were."""

from __future__ import annotations

import numpy as np

from made_people import HEIGHT, WIDTH, empty_scene
from muybridge.segmentation.light import relit

EMPTY = empty_scene()
COLUMNS = np.linspace(0, 1, WIDTH)[None, :, None]
DIM = 0.75 - 0.3 * COLUMNS
"""A lamp at the left is left on: brighter there."""


def dimmed(picture: np.ndarray) -> np.ndarray:
    return np.clip(picture * DIM, 0, 255).astype(np.uint8)


def with_people(picture: np.ndarray) -> np.ndarray:
    """Two, each a sixteenth of the picture, who reflect half of what the floor does."""
    shown = picture.astype(float)
    for left in (60, 200):
        shown[60:180, left : left + 40] *= 0.5
    return shown.astype(np.uint8)


def test_the_old_light() -> None:
    """Grey values, means: cut down to whole ones under a gain of at least 0.45, 0.5 / 0.45 = 1.1; rounded again, 0.25;
    a quadratic for log(0.75 - 0.3 x) is 0.07 % off, of 140 0.1. Together 1.5."""
    found = relit(dimmed(EMPTY), EMPTY).astype(float)
    assert np.abs(found - EMPTY).mean() < 1.5
    assert np.abs(dimmed(EMPTY).astype(float) - EMPTY).mean() > 50  # negative control


def test_people_stay_as_dark_before_the_floor() -> None:
    """Cut down from 42 under a gain of 0.6: half a grey value of it, 1.2 %; the field's own misfit and bias, 0.8 %."""
    before, after = with_people(EMPTY), relit(dimmed(with_people(EMPTY)), EMPTY)
    person = np.s_[70:170, 65:95]
    assert abs(float(after[person].mean()) / float(before[person].mean()) - 1) < 0.02


def test_a_picture_in_the_same_light_is_itself() -> None:
    picture = with_people(EMPTY)
    assert relit(picture, EMPTY) is picture and picture.shape == (HEIGHT, WIDTH, 3)
