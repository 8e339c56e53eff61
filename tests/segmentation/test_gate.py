"""What a model may learn of a picture."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.segmentation.gate import FLOOD, LASTING, SETTLE, Gate
from muybridge.segmentation.kde import KdeConfig
from muybridge.segmentation.stillness import MOVED, STIRRING

SHAPE = (40, 50)
PICTURE = np.full((*SHAPE, 3), 90, np.uint8)


def box(rows: slice, columns: slice) -> np.ndarray:
    mask = np.zeros(SHAPE, bool)
    mask[rows, columns] = True
    return mask


PERSON = box(slice(10, 30), slice(10, 20))


def test_background_is_learnt_and_foreground_is_not() -> None:
    np.testing.assert_array_equal(Gate(SHAPE, 100).learnt(PERSON, PICTURE), ~PERSON)


def test_without_patience_everything_is_learnt() -> None:
    assert Gate(SHAPE, 0).learnt(PERSON, PICTURE).all()


def test_what_has_been_foreground_for_long_is_learnt() -> None:
    gate = Gate(SHAPE, 3)
    learnt = [gate.learnt(PERSON, PICTURE).all() for _ in range(5)]
    assert learnt == [False, False, False, True, True]


def test_a_thing_that_rests_is_learnt_and_one_who_stirs_is_not() -> None:
    """Of 200 pixels STIRRING = 2 % are 4: five that change are a person, three are noise."""
    assert STIRRING * PERSON.sum() == 4

    def learnt(changing: int) -> bool:
        gate = Gate(SHAPE, 100, rest=10)
        for frame in range(15):
            picture = PICTURE.copy()
            picture[10, 10 : 10 + changing] += np.uint8((MOVED + 1) * (frame % 2))
            found = gate.learnt(PERSON, picture)
        return bool(found[PERSON].all())

    assert learnt(0) and learnt(3)
    assert not learnt(5)


def test_components_rest_apart() -> None:
    gate, other = Gate(SHAPE, 100, rest=10), box(slice(10, 30), slice(30, 40))
    for frame in range(15):
        picture = PICTURE.copy()
        picture[other] += np.uint8(100 * (frame % 2))
        found = gate.learnt(PERSON | other, picture)
    assert found[PERSON].all() and not found[other].any()


def test_when_the_light_changes_everything_is_learnt_until_it_has_settled() -> None:
    gate = Gate(SHAPE, 100)
    rows = int(np.ceil(FLOOD * SHAPE[0])) + 1
    assert gate.learnt(box(slice(0, rows), slice(None)), PICTURE).all()
    after = [gate.learnt(PERSON, PICTURE).all() for _ in range(SETTLE + 2)]
    assert after == [True] * (SETTLE - 1) + [False] * 3
    assert not gate.learnt(box(slice(0, rows - 2), slice(None)), PICTURE).all()  # not more than FLOOD


def test_who_was_there_before_the_light_changed_is_not_learnt_with_it() -> None:
    gate, everything = Gate(SHAPE, 100), np.ones(SHAPE, bool)
    for _ in range(LASTING):
        gate.learnt(PERSON, PICTURE)
    learnt = gate.learnt(everything, PICTURE)
    assert not learnt[PERSON].any() and learnt[:, 30:].all()


def test_grey_pictures() -> None:
    assert Gate(SHAPE, 100, rest=5).learnt(PERSON, PICTURE[..., :1]).sum() == (~PERSON).sum()


@pytest.mark.parametrize("name", ["patience", "rest"])
def test_bad_settings(name: str) -> None:
    with pytest.raises(InputError, match=name):
        KdeConfig(**{name: -1})
