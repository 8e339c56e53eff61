"""Flight and path in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.synthetic.stepping import GRAVITY, Steps, bounce, path_at

HOP = Steps(rate=2.0, begin=0.3, shifts=(0.0, 0.0), bears=(0.45, 0.45), flight=True, rises=1)
JOG = Steps(rate=1.4, begin=0.1, bears=(0.36, 0.36), flight=True, rises=2)


@pytest.mark.parametrize("steps", [HOP, JOG])
class TestBounce:
    times = np.arange(0, 3, 1e-4)

    def test_periodic_and_zero_as_a_foot_comes_down(self, steps):
        period = 1.0 / (steps.rate * steps.rises)
        contact = np.arange(1, 5) * period - steps.begin / steps.rate
        np.testing.assert_allclose(bounce(steps, contact), 0.0, atol=1e-9)
        np.testing.assert_allclose(bounce(steps, self.times), bounce(steps, self.times + period), atol=1e-9)

    def test_height_of_flight(self, steps):
        """g T^2 / 8 for a flight of T seconds."""
        flight = (1.0 / steps.rises - steps.bears[0]) / steps.rate
        assert bounce(steps, self.times).max() == pytest.approx(GRAVITY * flight**2 / 8, rel=1e-5)

    def test_forces(self, steps):
        """The floor pushes and never pulls: acceleration is -g or above it, and its mean over a period is 0."""
        fall = np.diff(bounce(steps, self.times), 2) / 1e-8
        assert fall.min() > -GRAVITY - 1e-4
        period = 1.0 / (steps.rate * steps.rises)
        assert abs(fall[: round(4 * period / 1e-4)].mean()) < 0.02 * GRAVITY
        jumps = np.abs(np.diff(fall)).max()
        assert jumps < 0.1  # a corner in speed would be a jump of 1e4 times the change


class TestPath:
    times = np.linspace(-1, 1, 201)

    def test_straight(self):
        path = path_at(Steps(1.0, 0.0, speed=2.0, direction=0.5), self.times, 0.2)
        np.testing.assert_allclose(path, 2.0 * self.times[:, None] * (np.cos(0.7), np.sin(0.7)), atol=1e-12)

    def test_arc(self):
        """Even speed, a turn at the rate, through the origin; the radius is speed over rate."""
        path = path_at(Steps(1.0, 0.0, speed=1.5, turn_rate=0.8), self.times, 0.2)
        centre = 1.5 / 0.8 * np.array([-np.sin(0.2), np.cos(0.2)])
        np.testing.assert_allclose(np.linalg.norm(path - centre, axis=1), 1.5 / 0.8)
        np.testing.assert_allclose(path[100], 0.0, atol=1e-12)
        steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
        np.testing.assert_allclose(steps, steps[0])

    def test_no_flight_no_bounce(self):
        assert not bounce(Steps(1.0, 0.0), self.times).any()
