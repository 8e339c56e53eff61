"""Feet on the floor: slip is taken back where a foot bears, and only there."""

from __future__ import annotations

import numpy as np
import pytest

from motion_measures import lowest, soles
from muybridge.synthetic.contacts import bearing_spells, correction, floor_level, grip_velocity, settle
from muybridge.synthetic.motion import Motion, perform
from muybridge.synthetic.skinning import load_figure

FIGURE = load_figure("man")
RATE = 120.0


def sliding(speed: float, height: float = 0.01) -> np.ndarray:
    """(T, 3, 3) metres: a sole that slides along for a second, is carried on for half a second, and slides again."""
    times = np.arange(300) / RATE
    swing = np.clip((times - 1.0) / 0.5, 0, 1)
    x = speed * times + 0.8 * swing**2 * (3 - 2 * swing)
    z = height + 0.2 * 16 * (swing * (1 - swing)) ** 2
    heel = np.stack([x, 0 * x, z], axis=1)
    return heel[:, None] + np.array([[0, 0, 0], [0.15, 0, 0], [0.2, 0, 0]])


class TestCorrection:
    def test_slip_and_height_are_taken_back(self):
        """0.1 m/s of slip, 1 cm above the floor: well inside a spell nothing is left of either."""
        fixed = sliding(0.1) + correction(sliding(0.1), RATE)[:, None]
        for inside in (slice(10, 105), slice(195, 290)):
            assert np.linalg.norm(grip_velocity(fixed, RATE)[inside], axis=1).max() < 1e-6
            np.testing.assert_allclose(fixed[inside, :, 2], 0.0, atol=1e-9)

    def test_a_swing_is_no_slip(self):
        """The foot still lands 0.8 m ahead, give or take what it slipped in the two spells."""
        fixed = sliding(0.1) + correction(sliding(0.1), RATE)[:, None]
        assert fixed[250, 0, 0] - fixed[50, 0, 0] == pytest.approx(0.8 + 0.1 * 1.5, abs=0.03)
        assert fixed[:, 0, 2].max() == pytest.approx(0.2, abs=0.01)

    def test_fast_feet_are_left_alone(self):
        """The control: what slides at 2 m/s does not bear."""
        assert not correction(sliding(2.0), RATE)[:, :2].any()

    def test_never_below_the_floor(self):
        """Smoothing by s = 8 ms leaves s^2 / 2 of a foot's upward acceleration (26 m/s^2 here): 0.8 mm."""
        low = sliding(2.0, height=-0.03)
        assert (low + correction(low, RATE)[:, None])[..., 2].min() > -0.001


class TestSpells:
    def test_low_and_slow(self):
        lowest, speed = np.full(200, 0.2), np.full(200, 0.1)
        lowest[50:90], lowest[120:125], lowest[150:180] = 0.01, 0.01, 0.01
        speed[150:180] = 1.5
        assert bearing_spells(lowest, speed, RATE) == [(50, 90)]

    def test_to_the_ends(self):
        assert bearing_spells(np.zeros(50), np.zeros(50), RATE) == [(0, 50)]


class TestFloor:
    def test_leaps_do_not_lift_it(self):
        low = np.abs(np.sin(np.arange(600) / RATE * 6)) * 0.3
        np.testing.assert_allclose(floor_level(low, RATE), 0.0, atol=0.02)

    def test_it_follows_a_slope_so_far(self):
        slope = np.linspace(0, 0.05, 600)
        assert np.abs(floor_level(slope, RATE) - slope)[60:-60].max() < 0.015
        assert floor_level(np.linspace(0, 1, 600), RATE).max() < 0.2


class TestSettle:
    @pytest.mark.parametrize("kind", ["walk", "crouch", "jump"])
    def test_a_lifted_and_slipping_body(self, kind):
        """A motion that stands well, raised by 4 cm and carried along at 0.2 m/s, stands well again."""
        track = perform(FIGURE, Motion(kind, rate=RATE, duration=2.0))
        track.places[...] += np.arange(240)[:, None, None] / RATE * (0.2, 0, 0) + (0, 0, 0.04)
        before = lowest(FIGURE, track, every=4)
        settle(FIGURE, track.rotations, track.places, RATE)
        after = lowest(FIGURE, track, every=4)
        assert before.min() > 0.02
        assert -0.01 < after.min() and np.median(np.abs(after)) < (0.06 if kind == "jump" else 0.01)
        turns = track.rotations
        np.testing.assert_allclose(
            turns @ np.swapaxes(turns, -1, -2), np.broadcast_to(np.eye(3), turns.shape), atol=1e-9
        )

    def test_bearing_feet_stop(self):
        track = perform(FIGURE, Motion("crouch", rate=RATE, duration=2.0))
        track.places[...] += np.arange(240)[:, None, None] / RATE * (0.2, 0, 0)
        slip = []
        for _ in range(2):
            feet = soles(FIGURE, track)
            slip.append(np.median([np.linalg.norm(grip_velocity(feet[:, k], RATE), axis=1) for k in (0, 1)]))
            settle(FIGURE, track.rotations, track.places, RATE)
        assert slip[0] > 0.15 and slip[1] < 0.02
