"""Walks from point to point: people arrive where they are to stand, when their legs can, and turn as they go."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from motion_measures import lowest
from muybridge.errors import InputError
from muybridge.synthetic.clip import LOWERED
from muybridge.synthetic.motion import Motion, perform
from muybridge.synthetic.planting import sole
from muybridge.synthetic.route import ACCELERATION, plan, stride_length
from muybridge.synthetic.skinning import load_figure

WAY = ((-2.0, 0.0, 1.0), (0.0, 0.0, 2.0), (0.0, 1.5, 0.0))
RATE, SPEED = 25.0, 1.25


@pytest.fixture(scope="module")
def made():
    figure, motion = load_figure("woman"), Motion(duration=8.0, rate=RATE, way=WAY)
    return figure, motion, perform(figure, motion)


class TestPlan:
    def test_waits_goes_waits_and_stays(self):
        """A leg of length L takes L / v + v / a seconds: speeding up and slowing down each cost half of v / a."""
        path = plan(Motion(duration=8.0, rate=RATE, way=WAY), SPEED)
        leg = 2.0 / SPEED + SPEED / ACCELERATION
        times = np.arange(200) / RATE
        at_first, at_second = times < 1.0, (times > 1.0 + leg) & (times < 3.0 + leg)
        assert np.allclose(path.places[at_first], WAY[0][:2], atol=1e-6)
        assert np.allclose(path.places[at_second], WAY[1][:2], atol=1e-6) and (path.pace[at_second] == 0).all()
        assert np.allclose(path.places[-1], WAY[2][:2], atol=1e-6)

    def test_never_faster_than_the_legs(self):
        path = plan(Motion(duration=8.0, rate=RATE, way=WAY), SPEED)
        steps = np.linalg.norm(np.diff(path.places, axis=0), axis=1)
        assert steps.max() <= SPEED / RATE + 1e-6 and np.diff(path.walked).min() >= 0

    def test_faces_where_it_goes(self):
        path = plan(Motion(duration=8.0, rate=RATE, way=WAY), SPEED)
        walking = path.pace > 0.9
        course = np.diff(path.places, axis=0)[walking[:-1]]
        angle = np.arctan2(course[:, 1], course[:, 0]) - path.headings[:-1][walking[:-1]]
        assert np.abs(np.angle(np.exp(1j * angle))).max() < np.radians(10)

    def test_a_corner_is_rounded_but_its_ends_are_not(self):
        """The line stays within reach of the corner: a Gaussian of 0.25 m pulls a right angle in by 0.25 / sqrt(pi)."""
        path = plan(Motion(duration=9.0, rate=RATE, way=((0, 0, 0), (3, 0, 0), (3, 3, 0))), SPEED)
        nearest = np.linalg.norm(path.places - (3, 0), axis=1).min()
        assert nearest == pytest.approx(0.25 / np.sqrt(np.pi), abs=0.02)
        assert np.allclose(path.places[[0, -1]], [(0, 0), (3, 3)], atol=1e-6)


class TestPerformed:
    def test_the_pelvis_follows_the_plan(self, made):
        figure, motion, track = made
        path = plan(motion, stride_length(figure, motion) * motion.cadence)
        assert np.allclose(track.places[:, 0, :2], path.places, atol=1e-9)

    def test_soles_are_on_the_floor(self, made):
        """The height is smoothed over half a frame, so a sole may be off by what it moves in that time."""
        figure, _, track = made
        lowest = np.minimum(
            *(sole(figure, track.rotations, track.places, side)[..., 2].min(axis=1) for side in ("left", "right"))
        )
        assert np.abs(lowest).max() < 0.03

    def test_the_bearing_foot_slips_little(self, made):
        """Strides follow from the distance: while walking, the slower foot goes at less than a third of the body."""
        figure, motion, track = made
        path = plan(motion, stride_length(figure, motion) * motion.cadence)
        feet = np.stack([sole(figure, track.rotations, track.places, side)[:, 1, :2] for side in ("left", "right")])
        speed = np.linalg.norm(np.diff(feet, axis=1), axis=-1) * RATE
        assert np.median(speed.min(axis=0)[path.pace[1:] == 1]) < SPEED / 3


@pytest.fixture(scope="module", params=LOWERED)
def lowered(request):
    way = ((-1.5, 0.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 6.0), (2.0, 1.0, 0.0))
    figure, motion = load_figure("woman"), Motion(request.param, duration=14.0, rate=RATE, way=way)
    return figure, motion, perform(figure, motion)


class TestLowered:
    def test_goes_down_at_the_longest_stop_alone(self, lowered):
        figure, motion, track = lowered
        walk = perform(figure, replace(motion, kind="walk"))
        highest, usual = (one.joints[..., 2].max(axis=1) for one in (track, walk))
        begin, seconds = plan(motion, stride_length(figure, motion) * motion.cadence).stops[-1]
        at_stop = (motion.times >= begin) & (motion.times <= begin + seconds)
        assert highest[at_stop].min() < {"crouch": 0.85, "bend": 0.55, "lie": 0.25}[motion.kind] * usual.max()
        assert highest[~at_stop].min() > 0.95 * usual.min()

    def test_the_feet_stay(self, lowered):
        """Their middle, from the first moment of the stop to the last: it is what is held."""
        figure, motion, track = lowered
        begin, seconds = plan(motion, stride_length(figure, motion) * motion.cadence).stops[-1]
        at_stop = (motion.times > begin) & (motion.times < begin + seconds)
        soles = [sole(figure, track.rotations, track.places, side)[at_stop] for side in ("left", "right")]
        middle = np.concatenate(soles, axis=1)[..., :2].mean(axis=1)
        assert np.abs(middle - middle[0]).max() < 0.01
        assert np.abs(np.diff(track.places[:, 0, :2], axis=0)).max() < 1.5 / RATE + 0.02

    def test_nothing_is_below_the_floor(self, lowered):
        """As of every motion: the lowest vertex is within 1.5 cm of the floor."""
        figure, _, track = lowered
        assert np.abs(lowest(figure, track, every=10)).max() < 0.015


class TestErrors:
    @pytest.mark.parametrize("kind", ["wave", "jog"])
    def test_only_walks_have_a_way(self, kind):
        with pytest.raises(InputError, match="of walk, crouch, bend, lie"):
            Motion(kind, way=WAY)

    @pytest.mark.parametrize("way", [((0, 0, 0),), ((0, 0, 0), (1, np.nan, 0)), ((0, 0, -1), (1, 1, 0))])
    def test_a_way_that_cannot_be(self, way):
        with pytest.raises(InputError, match="way"):
            Motion(way=way)
