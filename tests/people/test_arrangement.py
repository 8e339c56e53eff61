"""One state for three parts: what is not plausible is never proposed; a part without colours goes with the others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from made_people import part_boxes, pole
from muybridge.filters.dynamics import Belief
from muybridge.people.arrangement import (
    DIMENSIONS,
    Arrangement,
    ArrangementLikelihood,
    ArrangementWalk,
    usual_arrangements,
)
from muybridge.people.box import states_from_boxes
from muybridge.people.contrast_likelihood import ContrastConfig
from muybridge.people.evidence import Evidence
from muybridge.people.filtered import Frame
from muybridge.people.part_filters import boxes_of
from muybridge.people.silhouette import Silhouette
from people.made import EMPTY
from people.test_repair import RULES, WALKER, body_of, frame_of

COLOURS = replace(RULES, colour=ContrastConfig(bands=2))
WALK = ArrangementWalk.usual_walk()
SHARES = np.array([[0.0, -0.42, 0.3, 0.12], [0.0, -0.15, 0.6, 0.3], [0.0, 0.14, 0.6, 0.2]])
"""Of a standing adult: middles of sections of .17, .35 and the upper half of .48 of the height."""


def started(seed: int = 0) -> Arrangement:
    parts = Arrangement.start(np.random.default_rng(seed), body_of(0), frame_of(0), COLOURS)
    assert parts is not None
    return parts


def off(parts: Arrangement, number: int) -> np.ndarray:
    """(3, 2) pixels from the true parts' centres."""
    difference: np.ndarray = parts.boxes[:, :2] - states_from_boxes(part_boxes(WALKER, number))[:, :2]
    return difference


def at_the_edge(count: int) -> np.ndarray:
    directions = np.random.default_rng(1).standard_normal((count, DIMENSIONS))
    return WALK.reach * (directions / np.linalg.norm(directions, axis=1)[:, None]) @ WALK.root.T


def test_what_is_not_plausible_is_never_proposed() -> None:
    """From the edge of what is plausible, with usual noise and with ten times that; drawn once, many would be beyond.

    With ten times the noise, z = 0.65 z_0 + 7.6 n: within 4.1 of six components by chance in some 1 % of draws, so that
    twenty of them leave most to be pulled in.
    """
    edge = at_the_edge(2000)
    np.testing.assert_allclose(WALK.distance(edge), WALK.reach)
    for scale in (1.0, 10.0):
        moved = WALK.sample(np.random.default_rng(2), edge, scale=scale)
        assert (WALK.distance(moved) <= WALK.reach * (1 + 1e-9)).all()
        drawn = WALK._drawn(np.random.default_rng(2), edge, scale)
        assert (WALK.distance(drawn) > WALK.reach).mean() > 0.05


def test_heads_are_above_torsos_and_those_above_hip_legs() -> None:
    """All over the ellipsoid's surface, on a body of usual shares."""
    body = np.array([100.0, 100.0, 40.0, 100.0])
    boxes = ArrangementLikelihood((None,) * 3, boxes_of(SHARES, body), 100.0).boxes(at_the_edge(5000))
    assert (np.diff(boxes[..., 1], axis=1) > 0).all()


def test_moments_are_those_of_a_kalman_filter() -> None:
    """From 0, where next to nothing is drawn again: |n| > 4.1 / 0.76 of six components has a probability of 6e-5.

    Of N = 20 000 whitened draws the means have a standard deviation of 0.007, variances of 0.01, covariances of 0.007:
    five of each. Another `keep` of 0.5 would have variances of 1.30 in these units.
    """
    count = 20_000
    belief = WALK.carry(Belief.at_rest(np.zeros(DIMENSIONS), np.zeros(DIMENSIONS)))
    root = np.linalg.cholesky(belief.covariance)
    moved = np.linalg.solve(root, WALK.sample(np.random.default_rng(3), np.zeros((count, DIMENSIONS))).T)
    np.testing.assert_allclose(moved.mean(axis=1), belief.mean, atol=5 / np.sqrt(count))
    np.testing.assert_allclose(np.cov(moved), np.eye(DIMENSIONS), atol=5 * np.sqrt(2 / count))
    away = Belief.at_rest(at_the_edge(1)[0], np.zeros(DIMENSIONS))
    np.testing.assert_allclose(
        WALK.carry(away).mean, WALK.sample(np.random.default_rng(0), away.mean[None], scale=0)[0]
    )


def test_usual_arrangements_are_a_covariance() -> None:
    covariance = usual_arrangements()
    np.testing.assert_array_equal(covariance, covariance.T)
    assert (np.linalg.eigvalsh(covariance) > 0).all()


@pytest.mark.parametrize("scene", ["seen", "hidden"])
def test_a_part_that_can_be_seen_stays_though_the_body_is_not_trusted(scene: str) -> None:
    """The body's box is 5 px off, a fifth of its width, as beside somebody who crosses.

    By colours that know what is hidden head and torso are nearer to the truth than to where the body has them (drawn
    legs stride, and look like the wall between them where they were one when cut); with everything hidden, all three go
    with the body, and what they look like stays to the bit.
    """
    hidden = np.ones(EMPTY.shape[:2], bool) if scene == "hidden" else None
    parts = started()
    looks = [target.histogram.copy() for target in parts.targets]
    for number in range(1, 8):
        frame = frame_of(number)
        frame = replace(frame, evidence=Evidence(frame.evidence.mask, Silhouette.flat(), hidden=hidden))
        parts.step(body_of(number) + (5, 0, 0, 0, 0, 0), frame, trusted=False)
    away = off(parts, 7)[:, 0]
    assert (away > 2.5).all() if hidden is not None else (np.abs(away[:2]) < 2.5).all()
    for target, look in zip(parts.targets, looks):
        np.testing.assert_array_equal(target.histogram, look)


def faceless(number: int) -> Frame:
    """As `frame_of`, with the wall where the head is."""
    frame = frame_of(number)
    left, top, width, height = part_boxes(WALKER, number)[0].astype(int)
    place = slice(top - 2, top + height + 2), slice(left - 2, left + width + 3)
    picture = frame.picture.copy()
    picture[place] = frame.background[place]
    return replace(frame, picture=picture)


def test_a_head_without_colours_goes_with_the_others() -> None:
    """The body's box is 5 px off to one side; torso and hip-leg can be seen, of the head nothing.

    A head that went with the body would be off by 5 px there, with the torso by less than half of that.
    """
    for seed in range(3):
        parts = started(seed)
        for number in range(1, 10):
            parts.step(body_of(number) + (5, 0, 0, 0, 0, 0), faceless(number), trusted=False)
        assert np.abs(off(parts, 9)[0, 0]) < 2.5


def test_parts_behind_a_pole_learn_nothing_and_go_with_the_person() -> None:
    parts = started()
    for number in range(5):
        parts.step(body_of(number), frame_of(number), trusted=True)
    looks = [target.histogram.copy() for target in parts.targets]
    for number in range(5, 9):
        found = parts.step(body_of(number), frame_of(number, pole(60, 140)), trusted=False)
    for target, look in zip(parts.targets, looks):
        np.testing.assert_array_equal(target.histogram, look)
    assert found.shape == (3, 5) and (np.abs(off(parts, 8)) < 6).all()  # a tenth of the height, 70 px


def test_nobody_is_cut_where_there_is_no_foreground() -> None:
    frame = frame_of(0)
    nothing = replace(frame, evidence=Evidence(np.zeros_like(frame.evidence.mask), Silhouette.flat()))
    assert Arrangement.start(np.random.default_rng(0), body_of(0), nothing, COLOURS) is None
