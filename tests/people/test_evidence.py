"""Foreground against boxes: where a person is, what somebody nearer leaves of them, two who touch."""

from __future__ import annotations

import numpy as np
import pytest

from made_people import ASPECT, HEIGHT, OFFSET, SLOPE, WIDTH, Walker, empty_scene, mask_of
from muybridge.errors import InputError
from muybridge.people.box import states_from_boxes
from muybridge.people.detect import Places, find_standing
from muybridge.people.evidence import Evidence, ForegroundConfig, Together
from muybridge.people.ground import GroundScale
from muybridge.people.scene import describe
from muybridge.people.silhouette import Silhouette

EMPTY = empty_scene()
GROUND = GroundScale(OFFSET, SLOPE, ASPECT)
PASSING = [Walker((10, feet), (310, feet), 60 * k, 60 * k + 59) for k, feet in enumerate((120, 150, 180))]


@pytest.fixture(scope="module")
def silhouette() -> Silhouette:
    return describe(EMPTY, [mask_of(PASSING, frame) for frame in range(0, 180, 2)]).silhouette


def standing(*feet: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """(mask, states (N, 6)) of people who stand there."""
    walkers = [Walker(place, place, 0, 0) for place in feet]
    boxes = np.array([walker.box(0) for walker in walkers])
    return mask_of(walkers, 0), states_from_boxes(boxes)


def test_in_closed_form() -> None:
    """One cell: f pixels of foreground and e of background give looks / area x (f log p/q + e log (1-p)/(1-q))."""
    mask = np.zeros((20, 20), bool)
    mask[5:10, 4:8] = True
    evidence = Evidence(mask, Silhouette.flat(0.6), ForegroundConfig(outside=0.1, looks=12.0))
    state = states_from_boxes(np.array([[3, 5, 6, 5]]))
    f, e = 20, 10
    expected = 12.0 / 30 * (f * np.log(0.6 / 0.1) + e * np.log(0.4 / 0.9))
    np.testing.assert_allclose(evidence.observe(30.0).log_prob(state), [expected])
    assert evidence.seen(state[0]) == (1.0, 20 / 30)


def test_an_outline_is_of_all_that_is_near_but_scraps() -> None:
    """A box of 10 x 20 about (20, 20), looked at 12 x 24: rows 8 to 31, columns 14 to 25."""
    state = states_from_boxes(np.array([[15, 10, 10, 20]]))[0]
    mask = np.zeros((60, 60), bool)
    mask[12:22, 17:23] = mask[25:31, 18:20] = True  # 60 pixels, and legs of 12: more than 0.15 of that
    mask[9, 14] = True  # a scrap
    mask[40:50, 40:50] = True  # somebody else
    outline = Evidence(mask, Silhouette.flat()).outline(state)
    np.testing.assert_array_equal(outline, [(17 + 22) / 2, (12 + 30) / 2, 6, 19])


@pytest.mark.parametrize("place", [(slice(0, 0), slice(0, 0)), (slice(0, 20), slice(17, 23))])
def test_nothing_and_what_leaves_the_picture_have_no_outline(place: tuple[slice, slice]) -> None:
    mask = np.zeros((60, 60), bool)
    mask[place] = True
    assert Evidence(mask, Silhouette.flat()).outline(states_from_boxes(np.array([[15, 2, 10, 20]]))[0]) is None


def test_the_best_place_is_where_the_person_is(silhouette: Silhouette) -> None:
    """Cells are fifths of the width, 4 pixels: within two pixels across, and two of the feet."""
    mask, (state,) = standing((150.0, 170.0))
    likelihood = Evidence(mask, silhouette).observe(float(state[2] * state[3]))
    x, feet = np.meshgrid(np.arange(120, 181), np.arange(140, 201))
    boxes = GROUND.standing(x.ravel().astype(float), feet.ravel() - 0.5)
    best = boxes[np.argmax(likelihood.log_prob(boxes))]
    assert abs(best[0] - state[0]) <= 2 and abs(best[1] + best[3] / 2 - state[1] - state[3] / 2) <= 3


def test_nobody_there_is_worse_than_nothing_known(silhouette: Silhouette) -> None:
    mask, _ = standing((150.0, 170.0))
    evidence = Evidence(mask, silhouette)
    away = GROUND.standing(np.array([60.0]), np.array([170.0]))
    assert evidence.observe(1000.0).log_prob(away)[0] < 0
    evidence.explain(away[0], share=1.0)
    assert evidence.observe(1000.0).log_prob(away)[0] == 0
    assert evidence.seen(away[0])[0] == 0


def test_what_somebody_nearer_covers_says_nothing(silhouette: Silhouette) -> None:
    """The one behind is half hidden: with the other explained, the best place is theirs, not the other's."""
    mask, (near, far) = standing((150.0, 190.0), (163.0, 178.0))
    evidence = Evidence(mask, silhouette)
    x = np.arange(130, 190).astype(float)
    boxes = GROUND.standing(x, np.full(len(x), 178.0))
    assert abs(x[np.argmax(evidence.observe(1000.0).log_prob(boxes))] - far[0]) > 4  # the nearer one draws it away
    evidence.explain(near)
    assert abs(x[np.argmax(evidence.observe(1000.0).log_prob(boxes))] - far[0]) <= 4


def test_occluders_say_nothing() -> None:
    mask, hidden = np.zeros((10, 10), bool), np.zeros((10, 10), bool)
    hidden[:, :5] = True
    evidence = Evidence(mask, Silhouette.flat(), hidden=hidden)
    assert evidence.observe(25.0).log_prob(states_from_boxes(np.array([[0, 2, 5, 5]])))[0] == 0
    with pytest.raises(InputError, match="occluders"):
        Evidence(mask, Silhouette.flat(), hidden=hidden[:5])


def test_people_who_touch_are_found_one_by_one(silhouette: Silhouette) -> None:
    """Three abreast without a valley between them, and one alone."""
    mask, states = standing((100.0, 180.0), (121.0, 182.0), (142.0, 180.0), (250.0, 140.0))
    found = find_standing(Evidence(mask, silhouette), Places.on(GROUND, (WIDTH, HEIGHT), 30.0), 0.45)
    assert len(found) == 4
    for state in states:
        away = [abs(box[0] - state[0]) + abs(box[1] - state[1]) for box in found]
        assert min(away) < 6
    assert not find_standing(Evidence(mask & False, silhouette), Places.on(GROUND, (WIDTH, HEIGHT), 30.0), 0.45)


def test_nobody_is_looked_for_where_people_are_too_small(silhouette: Silhouette) -> None:
    mask, _ = standing((250.0, 100.0))
    assert OFFSET + SLOPE * 100 < 48
    assert not find_standing(Evidence(mask, silhouette), Places.on(GROUND, (WIDTH, HEIGHT), 60.0), 0.45)


def test_cues_add_up() -> None:
    class Two:
        def log_prob(self, states: np.ndarray) -> np.ndarray:
            return np.full(len(states), 2.0)

    assert Together((Two(), Two(), Two())).log_prob(np.zeros((4, 6))).tolist() == [6.0] * 4


def test_bad_settings_are_one_line() -> None:
    with pytest.raises(InputError, match="foreground"):
        ForegroundConfig(outside=0.0)
