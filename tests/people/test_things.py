"""Things beside the empty scene: a door that is shut, whom it does not hide."""

from __future__ import annotations

import numpy as np

from muybridge.people.masks import MaskConfig, Masks

FLOOR, DOOR, COAT = (120, 130, 140), (40, 60, 130), (150, 30, 30)
WHERE = (slice(20, 80), slice(60, 85))


def scene(door: bool, coat_at: int | None = None) -> np.ndarray:
    """A wall that is seen through a doorway, or a leaf before it; and a coat that begins in some column."""
    picture = np.full((120, 160, 3), FLOOR, np.uint8)
    if door:
        picture[WHERE] = DOOR
    if coat_at is not None:
        picture[40:70, coat_at : coat_at + 15] = COAT
    return picture


def test_a_shut_door_is_nobody_after_a_while() -> None:
    masks = Masks.train([scene(False)], MaskConfig(rest=10))
    shown = [masks.apply(scene(True))[WHERE].mean() for _ in range(12)]
    assert min(shown[:9]) > 0.9 and shown[-1] == 0
    assert not masks.apply(scene(False)).any()  # it opens: both looks are known
    someone = masks.apply(scene(True, coat_at=65))
    assert someone[42:68, 67:78].all() and someone.sum() <= 30 * 15


def test_a_thing_stays_known_when_the_scene_is_learnt_anew() -> None:
    masks, anew = (Masks.train([scene(False)], MaskConfig(rest=10)) for _ in range(2))
    for _ in range(12):
        masks.apply(scene(True))
    assert anew.things is not None and masks.things is not None
    anew.things.go_on_from(masks.things)
    assert not anew.apply(scene(True)).any()


def test_who_is_in_the_picture_is_not_learnt() -> None:
    masks = Masks.train([scene(False)])
    picture = scene(False, coat_at=65)
    learnt = masks.without_people(picture, masks.apply(picture))
    np.testing.assert_array_equal(learnt, scene(False))


def test_it_stays_where_nothing_may_be_a_thing() -> None:
    masks = Masks.train([scene(False)], MaskConfig(rest=0))
    shown = [masks.apply(scene(True))[WHERE].mean() for _ in range(12)]
    assert min(shown) > 0.9  # negative control


def test_feet_that_stand_still_are_no_things() -> None:
    """8 x 12 pixels, 96 of the 200 that a thing has at least."""
    masks = Masks.train([scene(False)], MaskConfig(rest=10))
    for _ in range(15):
        picture = scene(False)
        picture[90:98, 60:72] = COAT
        mask = masks.apply(picture)
    assert mask[91:97, 61:71].all()
