"""Somebody who goes down: followed with a box of their own size, and nobody else is.

They walk in for three seconds, lie for four, and walk on, at 10 frames a second, with the truth's own masks.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from made_people import HEIGHT, WIDTH, Walker, picture_of
from muybridge.evaluation.boxes import overlaps
from muybridge.people.box import BoxMotion, states_from_boxes
from muybridge.people.down import Down, is_alone, is_whole, lead, lowness
from muybridge.people.evidence import Evidence, Region
from muybridge.people.person import Person
from muybridge.people.scene import Scene
from muybridge.people.tracker import PeopleTracker, TrackerConfig
from people.made import EMPTY, SMALL, known, tracked

UPRIGHT = replace(SMALL, down=False)
FALLS, RISES, END = 30, 70, 90
PLACE = (150.0, 170.0)
COMES = Walker((40, 170), PLACE, 0, FALLS - 1)
STAYS = Walker(PLACE, PLACE, FALLS, RISES - 1)
GOES = Walker(PLACE, (260, 170), RISES, END)
STAYS_STATE = states_from_boxes(np.array([STAYS.box(FALLS)]))[0]
PASSES = Walker((60, 200), (260, 200), FALLS + 2, RISES - 2, 1)


def laid(picture: np.ndarray, mask: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The only person of a picture, turned by a right angle about their feet, and their box (4,) left, top, ..."""
    y, x = np.nonzero(mask)
    rows, columns = slice(y.min(), y.max() + 1), slice(x.min(), x.max() + 1)
    own, pixels = np.rot90(mask[rows, columns]), np.rot90(picture[rows, columns])
    height, width = own.shape
    place = slice(rows.stop - height, rows.stop), slice(columns.start, columns.start + width)
    picture, mask = EMPTY.copy(), np.zeros_like(mask)
    mask[place] = own
    picture[place][own] = pixels[own]
    return picture, mask, np.array([columns.start, rows.stop - height, width, height], float)


def shown(frame: int, others: list[Walker]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Picture, foreground and the true box of who goes down; others walk before them."""
    if frame < FALLS or frame >= RISES:
        who = COMES if frame < FALLS else GOES
        return (*picture_of([who, *others], frame, EMPTY), who.box(frame))
    picture, mask, box = laid(*picture_of([STAYS], FALLS, EMPTY))  # still: with another number the legs move
    before, theirs = picture_of(others, frame, EMPTY)
    picture[theirs] = before[theirs]
    return picture, mask | theirs, box


def followed(others: list[Walker], config: TrackerConfig = SMALL) -> tuple[PeopleTracker, np.ndarray, list[int]]:
    """The tracker, and of every frame the best overlap with who goes down, and whose box that is."""
    tracker = PeopleTracker(Scene(EMPTY, known().ground, known().silhouette), config, frame_rate=10.0)
    true = []
    for frame in range(END):
        picture, mask, box = shown(frame, others)
        tracker.step(frame, picture, mask)
        true.append(box)
    boxes, best, whose = tracker.tracks().boxes, [], []
    for frame in range(END):
        now = boxes.where(boxes.frames == frame)
        shared = overlaps(true[frame][None], now.boxes)[0]
        best.append(shared.max())
        whose.append(int(now.ids[shared.argmax()]))
    return tracker, np.array(best), whose


class TestFollowed:
    @pytest.mark.parametrize("others", [[], [PASSES]], ids=["alone", "somebody passes"])
    def test_who_lies_keeps_their_identity_and_has_a_box_of_their_own(self, others):
        """It takes a frame until it is seen (0.12 s at 10 a second); then the box is the region's, but for its noise.

        A box of 22 x 62 pixels that is off by 2 in each of its sides still overlaps by 0.75.
        """
        _, best, whose = followed(others)
        assert len(set(whose)) == 1
        assert np.median(best[FALLS + 2 : RISES]) > 0.75 and best[FALLS + 2 : RISES].min() > 0.5
        assert best[RISES + 3 :].min() > 0.6

    def test_with_the_size_of_a_standing_person_they_are_not(self):
        """The control: 22 x 62 across 62 x 22 is at best 22 x 22 of 2244 pixels, 0.22."""
        _, best, _ = followed([], UPRIGHT)
        assert best[FALLS + 2 : RISES].max() < 0.5

    def test_nothing_is_learnt_of_them_meanwhile(self, monkeypatch):
        learnt = []
        remember = Person.remember

        def noted(person, frame):
            learnt.append(frame.number)
            remember(person, frame)

        monkeypatch.setattr(Person, "remember", noted)
        followed([])
        assert not {*range(FALLS + 1, RISES)} & {*learnt}
        assert {*range(FALLS - 10, FALLS)} <= {*learnt} and max(learnt) > RISES + 3  # the control

    @pytest.mark.parametrize("hides", ["pole", "wall"])
    def test_who_is_hidden_in_part_is_not_down(self, hides, monkeypatch):
        """Behind a pole as wide as they are; behind a wall up to the hips."""
        went = []
        monkeypatch.setattr("muybridge.people.down._become", lambda *arguments: went.append(arguments))
        mask = np.zeros((HEIGHT, WIDTH), bool)
        mask[{"pole": (slice(None), slice(150, 170)), "wall": (slice(140, 175), slice(130, 320))}[hides]] = True
        tracked([Walker((30, 170), (290, 170), 0, 69)], 70, mask)
        assert not went

    def test_nor_who_is_seen_for_too_short_to_know_how_tall_they_are(self, monkeypatch):
        """The first 1.5 s of somebody who is 0.6 of the usual height."""
        went = []
        monkeypatch.setattr("muybridge.people.down._become", lambda *arguments: went.append(arguments))
        tracked([Walker((30, 170), (290, 170), 0, 69, stature=0.6)], 15)
        assert not went


class TestLead:
    ground, silhouette = known().ground, known().silhouette

    @pytest.fixture
    def lying(self) -> tuple[Region, Evidence]:
        _, mask, box = laid(*picture_of([STAYS], FALLS, EMPTY))
        evidence = Evidence(mask, self.silhouette)
        region = evidence.region(STAYS_STATE)
        assert region is not None
        np.testing.assert_allclose(region.box, states_from_boxes(box[None])[0, :4])
        assert region.filled == mask.sum() / (box[2] * box[3]) and region.pixels == mask.sum() and region.open == 1
        return region, evidence

    def test_who_lies_is_explained_by_lying(self, lying):
        region, evidence = lying
        assert lead(region, evidence, self.ground)[0] > 8 and lowness(region, self.ground) < 0.5
        assert is_whole(region, evidence, self.ground)

    def test_and_who_stands_by_standing_where_they_do(self):
        _, mask = picture_of([STAYS], FALLS, EMPTY)
        evidence = Evidence(mask, self.silhouette)
        region = evidence.region(STAYS_STATE)
        assert region is not None
        ahead, standing = lead(region, evidence, self.ground)
        assert ahead < 0 and lowness(region, self.ground) == pytest.approx(1, abs=0.1)
        # Of seven rows over a tenth of the height, and columns about the middle: off by at most half a step.
        np.testing.assert_allclose(standing[:2], STAYS_STATE[:2], atol=0.1 * STAYS_STATE[3])

    def test_a_scrap_is_not_all_of_a_person(self, lying):
        region, evidence = lying
        assert not is_whole(replace(region, filled=0.2 * region.filled), evidence, self.ground)

    def test_alone(self, lying):
        region, _ = lying
        x, y, width, height = region.box
        assert is_alone(region, [np.array([x + width + 1, y, width, height])])
        assert not is_alone(region, [np.array([x + width - 1, y, width, height])])


class TestDown:
    down = Down(np.array([60.0, 20.0]), 0.5)

    def test_sizes_in_closed_form(self):
        """Five times 0.06 off in width and none in height: -25 / 2."""
        states = np.array([[0.0, 0, 60, 20], [0, 0, 78, 20]])
        np.testing.assert_allclose(self.down.log_prob(states), [0, -12.5])

    def test_moves_in_place_as_anybody_and_in_size_by_as_much_as_it_is_spread(self):
        usual = BoxMotion.within((WIDTH, HEIGHT))
        noise = self.down.motion(usual).noise_sd
        np.testing.assert_allclose(noise[2:4], [3.6, 1.2])
        np.testing.assert_array_equal(noise[[0, 1, 4, 5]], usual.noise_sd[[0, 1, 4, 5]])

    def test_fills_its_box_evenly_within_limits(self):
        box = np.array([0.0, 0, 9, 9])
        assert [Down.of(Region(box, share)).filled for share in (0.05, 0.6, 1.0)] == [0.2, 0.6, 0.8]
