"""A part placed from the other two; parts that nobody can see coast and learn nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from made_people import Walker, part_boxes, picture_of, pole
from muybridge.people.alone import PartsAlone
from muybridge.people.box import BoxMotion, CountConfig, states_from_boxes
from muybridge.people.colour_likelihood import ColourConfig
from muybridge.people.evidence import Evidence
from muybridge.people.failure import FailureDetector
from muybridge.people.filtered import Frame
from muybridge.people.histograms import to_luma_chroma
from muybridge.people.part_filters import PartRules, Parts
from muybridge.people.parts import PartConfig
from muybridge.people.repair import (
    AROUND,
    HEAD,
    HIP_LEG,
    MOST_OF,
    TORSO,
    in_section,
    in_sight,
    mended,
    section,
    torso_between,
)
from muybridge.people.silhouette import Silhouette
from people.made import EMPTY
from people.test_failure import machine

WALKER = Walker((60, 200), (260, 200), 0, 49)
RULES = PartRules(BoxMotion.within((320, 240)), CountConfig(), ColourConfig(), PartConfig(), 10.0)


def frame_of(number: int, hidden: np.ndarray | None = None) -> Frame:
    picture, mask = picture_of([WALKER], number, EMPTY, hidden)
    evidence = Evidence(mask, Silhouette.flat(), hidden=hidden)
    return Frame(number, to_luma_chroma(picture), to_luma_chroma(EMPTY), evidence)


def body_of(number: int) -> np.ndarray:
    box = WALKER.box(number)
    assert box is not None
    return states_from_boxes(box)[0]


def started(rules: PartRules = RULES) -> Parts:
    parts = Parts.start(np.random.default_rng(0), body_of(0), frame_of(0), rules)
    assert parts is not None
    return parts


def test_a_torso_between_head_and_hip_leg() -> None:
    """(5.8), all four numbers."""
    head, hip_leg = np.array([10.0, 20, 8, 10, 1, 1]), np.array([14.0, 60, 20, 30, 0, 0])
    np.testing.assert_allclose(torso_between(head, hip_leg), [12, 40, 14, 20])


def test_sections_lie_above_and_below_as_bodies_are_cut() -> None:
    """The torso's middle is half its section, .175, from both cuts; the head's section is .17 high, hip-leg's .24."""
    torso, body = np.array([50.0, 100, 20, 25, 0, 0]), np.array([50.0, 110, 30, 100, 0, 0])
    np.testing.assert_allclose(section(HEAD, torso, body, PartConfig()), [50, 100 - 17.5 - 8.5, 30, 17])
    np.testing.assert_allclose(section(HIP_LEG, torso, body, PartConfig()), [50, 100 + 17.5 + 12, 30, 24])


def test_a_part_in_a_section_is_where_its_foreground_is() -> None:
    frame = frame_of(0)
    frame.evidence.mask[:] = False
    frame.evidence.mask[100:112, 60:68] = True  # 96 of 400 pixels
    place, before = np.array([64.0, 105, 20, 20]), np.array([0.0, 0, 7, 9])
    found = in_section(place, before, frame, PartConfig(shrink=1.2))
    sides = 2 * 1.2 * np.sqrt((np.array([8, 12]) ** 2 - 1) / 12)  # (5.3), (5.4) of full rows and columns
    np.testing.assert_allclose(found, [63.5, 105.5, *sides])
    frame.evidence.mask[:] = False
    np.testing.assert_allclose(in_section(place, before, frame, PartConfig()), [64, 105, 7, 9])
    outside = np.array([-90.0, 105, 20, 20])
    np.testing.assert_allclose(in_section(outside, before, frame, PartConfig())[2:], [7, 9])


@pytest.mark.parametrize("index", [HEAD, TORSO, HIP_LEG])
def test_a_part_that_was_thrown_away_is_found_again(index: int) -> None:
    """Its centre lies on the part again: within half of the true part's box."""
    parts, frame = started(), frame_of(0)
    others = [part.state for k, part in enumerate(parts.filters) if k != index]
    parts.filters[index].state = replace(parts.filters[index].state, estimate=np.array([5.0, 5, 4, 4, 0, 0]))
    found = mended(parts.filters, index, body_of(0), frame, RULES.cut, RULES.colour)
    true = part_boxes(WALKER, 0)[index]
    assert (np.abs(found.box[:2] - states_from_boxes(true)[0, :2]) <= true[2:] / 2).all()
    assert len(found.state.particles) == sum(len(state.particles) for state in others)  # N_1 + N_2
    np.testing.assert_allclose(found.state.particles[:, 4:], np.concatenate([s.particles[:, 4:] for s in others]))
    assert np.ptp(found.state.particles[:, :4], axis=0).max() == 0


def test_who_is_in_sight() -> None:
    """A full block of 20 x 60: found from anywhere within AROUND, and not where most of it is hidden or further off."""
    frame = frame_of(0)
    frame.evidence.mask[:] = False
    frame.evidence.mask[100:160, 90:110] = True
    truth = np.array([99.5, 129.5, 20, 60])
    near, far = truth + (0.4 * 60, -0.4 * 60, 0, 0), truth + (2 * AROUND * 60 + 20, 0, 0, 0)
    for body in (truth, near):
        np.testing.assert_allclose(in_sight(body, frame), truth)
    assert in_sight(far, frame) is None
    frame.evidence.mask[100:160, 120:140] = True  # somebody else, 30 px to the right: whoever is nearer
    np.testing.assert_allclose(in_sight(truth + (14, 0, 0, 0), frame), truth)
    np.testing.assert_allclose(in_sight(truth + (16, 0, 0, 0), frame), truth + (30, 0, 0, 0))
    frame.evidence.mask[:, 120:] = False
    fills = frame.evidence.silhouette.mean
    for shown, expected in ((1.2 * MOST_OF * fills, True), (0.8 * MOST_OF * fills, False)):  # of the block's columns
        hidden = np.zeros(EMPTY.shape[:2], bool)
        hidden[:, 90 + round(shown * 20) :] = True
        behind = Frame(0, frame.picture, frame.background,
                       Evidence(frame.evidence.mask, Silhouette.flat(), hidden=hidden))  # fmt: skip
        assert (in_sight(truth, behind) is not None) == expected


@pytest.mark.parametrize("repaired", [True, False])
def test_parts_that_all_went_astray_are_found_by_the_foreground(repaired: bool) -> None:
    """All moved by 24 px, 0.4 of the height, as one: their arrangement, which machines judge, is as it was.

    Nothing lies there that looks like them; without repair none is on its part, which are 9 to 22 px wide.
    """
    never = machine(0, 1e3)
    rules = replace(RULES, detector=FailureDetector((never,) * 3, never) if repaired else None)
    one = PartsAlone.start(np.random.default_rng(0), body_of(0), frame_of(0), rules)
    assert one is not None
    for part in one.parts.filters:
        astray = part.state.particles + (-24, 0, 0, 0, 0, 0)
        part.state = replace(part.state, particles=astray, estimate=part.state.estimate - (24, 0, 0, 0, 0, 0))
    one.body = one.body - (24, 0, 0, 0, 0, 0)
    one.step(frame_of(1))
    off = np.abs(one.states[:, 0] - states_from_boxes(part_boxes(WALKER, 1))[:, 0])
    assert (off < 5).all() if repaired else (off > 5).all()
    assert one.parts.repairs == int(repaired)


def test_what_the_detector_says_is_done() -> None:
    """One that always calls the head lost, and one that calls everything lost; the same parts without either."""
    always, never = machine(0, -1.0), machine(0, 1e3)
    always = replace(always, offset=-10.0)
    one = FailureDetector((always, never, never), never)
    everything = FailureDetector((always, never, never), replace(never, offset=-10.0))
    for detector, expected in ((None, 0), (one, 2), (everything, 2)):
        parts = started(replace(RULES, detector=detector))
        for number in range(12):
            found = parts.step(body_of(number), frame_of(number), trusted=True)
        assert parts.repairs == expected  # after half a second, and half a second after that
        assert found.shape == (3, 5) and np.isfinite(found).all()


def test_parts_that_nobody_sees_coast_and_learn_nothing() -> None:
    """Behind a pole: what they look like stays to the bit, nothing is repaired, and they go on with the person.

    4 px a frame for 4 frames: 16 px; they keep the speed they had, known to 1.4 px a frame and so to 6 px.
    """
    always = replace(machine(0, -1.0), offset=-10.0)
    parts = started(replace(RULES, detector=FailureDetector((always,) * 3, always)))
    for number in range(5):
        parts.step(body_of(number), frame_of(number), trusted=True)
    before, looks = parts.states, [part.target.histogram.copy() for part in parts.filters]
    hidden = pole(60, 140)
    for number in range(5, 9):
        parts.step(body_of(number), frame_of(number, hidden), trusted=False)
    assert parts.repairs == 0
    for part, look in zip(parts.filters, looks):
        np.testing.assert_array_equal(part.target.histogram, look)
    moved = parts.states[:, 0] - before[:, 0]
    assert (moved > 4).all() and (moved < 28).all()
