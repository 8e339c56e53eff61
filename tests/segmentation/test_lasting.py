"""The empty scene of a clip in which somebody stands for most of the time."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.segmentation.lasting import lasting_picture
from muybridge.segmentation.pictures import median_picture

FLOOR, COAT = 120, 40
NOISE = 3.0


def clip(*stays: tuple[int, int], moments: int = 60) -> list[np.ndarray]:
    """Pictures of a floor, with somebody in their middle from one moment to another."""
    pictures = []
    for moment in range(moments):
        noise = np.random.default_rng(moment).normal(0, NOISE, (24, 32, 3))
        picture = np.full((24, 32, 3), FLOOR) + noise
        if any(first <= moment < last for first, last in stays):
            picture[6:20, 10:18] = COAT + noise[6:20, 10:18]
        pictures.append(np.clip(picture, 0, 255).astype(np.uint8))
    return pictures


def off(picture: np.ndarray) -> float:
    """How far the picture is from the floor, where somebody stood."""
    return float(np.abs(picture[6:20, 10:18].astype(float) - FLOOR).mean())


def test_who_came_and_went_is_not_learnt() -> None:
    """The median over the 15 moments that show the floor is off by 1.25 * 3 / sqrt(15) = 1.0 grey values on average."""
    pictures = clip((5, 50))
    assert off(lasting_picture(pictures)) < 2
    assert off(median_picture(pictures)) > 70  # negative control: the coat is seen in three moments of four


def test_clothes_that_pass_early_and_late_are_not_learnt() -> None:
    assert off(lasting_picture(clip((2, 5), (55, 58)))) < 2


def test_what_changed_for_good_is_as_it_was_longer() -> None:
    assert off(lasting_picture(clip((40, 60)))) < 2 and off(lasting_picture(clip((20, 60)))) > 70


def test_who_lingers_before_a_door_that_opens_is_not_learnt(monkeypatch: pytest.MonkeyPatch) -> None:
    """Shut for 18 moments, then somebody stands before it for 27, then it is open for 15."""
    pictures = clip((18, 45))
    for picture in pictures[:18]:
        picture[6:20, 10:18] -= 50  # the leaf is darker than what is behind
    assert abs(off(lasting_picture(pictures)) - 50) < 2
    monkeypatch.setattr("muybridge.segmentation.lasting.PASSING", 1.0)
    assert off(lasting_picture(pictures)) > 70  # negative control: the coat


def test_of_a_stream_who_came_and_stands_is_not_learnt() -> None:
    """There since two fifths of the time, and until now: of a clip that has ended it is what is there for longer."""
    pictures = clip((24, 60))
    assert off(lasting_picture(pictures, ended=False)) < 2
    assert off(lasting_picture(pictures)) > 70


def test_of_few_pictures_there_is_a_median() -> None:
    pictures = clip((1, 3), moments=5)
    np.testing.assert_array_equal(lasting_picture(pictures), median_picture(pictures))


def test_several_sizes_are_refused() -> None:
    with pytest.raises(InputError, match="several sizes"):
        lasting_picture([*clip(), np.zeros((5, 5, 3), np.uint8)])
