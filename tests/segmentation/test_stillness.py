"""What has not moved: things, and not people."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.segmentation.stillness import MOVED, STIRRING, Stillness, differs

SHAPE = (40, 50)
PICTURE = np.full((*SHAPE, 3), 90, np.uint8)
THING = np.zeros(SHAPE, bool)
THING[10:30, 10:20] = True


def found(changing: int, *, pictures: int = 15, rest: int = 10, smallest: int = 1) -> bool:
    """Whether a region of 200 pixels is a thing, of which so many change from picture to picture."""
    stillness = Stillness(SHAPE, rest, smallest)
    for frame in range(pictures):
        picture = PICTURE.copy()
        picture[10, 10 : 10 + changing] += np.uint8((MOVED + 1) * (frame % 2))
        stillness.watch(picture)
    things = stillness.things(THING)
    assert not things[~THING].any()
    return bool(things[THING].all())


def test_who_stirs_is_no_thing() -> None:
    """STIRRING = 2 % of 200 pixels are 4: five that change are a person, three are noise."""
    assert STIRRING * THING.sum() == 4
    assert found(0) and found(3) and not found(5)


@pytest.mark.parametrize(
    "settings", [{"pictures": 9}, {"rest": 0}, {"smallest": 201}], ids=["too short", "never", "too small"]
)
def test_what_is_none(settings: dict) -> None:
    assert found(0) and not found(0, **settings)


def test_a_pixel_differs_by_any_channel() -> None:
    other = PICTURE.copy()
    other[0, 0, 2] += MOVED
    other[0, 1, 1] += MOVED + 1
    assert not differs(PICTURE, other)[0, 0] and differs(PICTURE, other).sum() == 1 and differs(PICTURE, other)[0, 1]
