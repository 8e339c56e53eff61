"""How people are expected to move: the dynamics that settings make, and what they scale with."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from muybridge.body import Body, named_body
from muybridge.errors import InputError
from muybridge.filters import METHODS, ConstantVelocity, NearlyConstantVelocity
from muybridge.tracking.motion import FRAME, SEARCHING, Motion, ProportionalMotion, motion_of

MOTION = Motion(1.0, 2.0, 4.0, 0.75, 0.3, 8.0, 16.0, 32.0, usual_weight=4.0)
STILL = replace(MOTION, root_acceleration=0.0, root_turn_acceleration=0.0, turn_acceleration=0.0)


@pytest.fixture(scope="module")
def body() -> Body:
    return named_body("person")


class TestDynamics:
    def test_accelerations_make_velocities_that_are_estimated(self, body: Body) -> None:
        dynamics = MOTION.dynamics(body, 0.04)
        assert type(dynamics) is NearlyConstantVelocity
        assert (dynamics.gain, dynamics.follow) == (0.75, 0.3)

    def test_turns_in_proportion_to_what_is_usual(self, body: Body) -> None:
        """The mean over joints is the speed that is stated; the heading, which has no usual deviation, has its own."""
        proportional = ProportionalMotion(**vars(STILL)).dynamics(body, 0.04).noise_sd
        wide = body.usual[1]
        known = np.isfinite(wide)
        np.testing.assert_allclose(np.ptp(proportional[known] / wide[known]), 0.0, atol=1e-12)
        assert proportional[known].mean() == pytest.approx(0.04 * STILL.turn_speed)
        np.testing.assert_array_equal(proportional[~known], STILL.dynamics(body, 0.04).noise_sd[~known])
        knee, twist = (body.dof_names.index(f"left_{name}") for name in ("knee_flexion", "hip_rotation"))
        assert proportional[knee] > 3 * proportional[twist]

    def test_turns_alike_where_nothing_is_usual(self) -> None:
        """The figure-like bodies of the catalogue state no usual angles."""
        other = named_body("bodytrack")
        assert np.isinf(other.usual[1]).all()
        own, same = (kind(**vars(STILL)).dynamics(other, 0.04).noise_sd for kind in (ProportionalMotion, Motion))
        np.testing.assert_array_equal(own, same)

    def test_one_acceleration_is_enough(self, body: Body) -> None:
        assert type(replace(STILL, turn_acceleration=1.0).dynamics(body, 0.04)) is NearlyConstantVelocity

    def test_without_any_velocities_are_differences(self, body: Body) -> None:
        dynamics = STILL.dynamics(body, 0.04)
        assert type(dynamics) is ConstantVelocity and dynamics.gain == 0.75

    @pytest.mark.parametrize("interval", [1 / 25, 1 / 100])
    def test_speeds_go_with_time_and_accelerations_with_its_root_besides(self, body: Body, interval: float) -> None:
        """Place, turns of the root, and every other joint have values of their own, stated for frames of FRAME seconds.

        N accelerations of a t^2 in a second, t = 1 / N, change the velocity per second by sqrt(N) a t: alike for every
        t if a is multiplied by sqrt(FRAME / t).
        """
        root = np.array([name.startswith("root_") for name in body.dof_names])
        turns = root & (np.arange(len(root)) >= 3)
        dynamics = MOTION.dynamics(body, interval)
        for values, power, (place, turn, other) in (
            (dynamics.noise_sd, interval, (1.0, 2.0, 4.0)),
            (dynamics.acceleration_sd, interval**2 * np.sqrt(FRAME / interval), (8.0, 16.0, 32.0)),
        ):
            np.testing.assert_allclose(values[:3], place * power)
            np.testing.assert_allclose(values[turns], turn * power)
            np.testing.assert_allclose(values[~root], other * power)
        assert turns.sum() == 3

    def test_limits_are_the_bodys(self, body: Body) -> None:
        dynamics = MOTION.dynamics(body, 0.04)
        np.testing.assert_array_equal(dynamics.lower, body.lower)
        np.testing.assert_array_equal(dynamics.upper, body.upper)

    @pytest.mark.parametrize("motion", [MOTION, STILL], ids=["estimated", "differences"])
    def test_the_weight_of_what_is_usual_multiplies_its_pull(self, body: Body, motion: Motion) -> None:
        """A precision of 4 / sd^2 beside the usual place: half the deviation; of twice the frames each counts half."""
        dynamics = motion.dynamics(body, FRAME)
        often = motion.dynamics(body, FRAME / 2)
        np.testing.assert_allclose(often.usual_sd, np.sqrt(2.0) * dynamics.usual_sd)
        np.testing.assert_array_equal(dynamics.usual, body.usual[0])
        known = np.isfinite(body.usual[1])
        assert known.any() and not known.all()
        np.testing.assert_allclose(dynamics.usual_sd[known], 0.5 * body.usual[1][known])
        assert np.isposinf(dynamics.usual_sd[~known]).all()

    def test_weight_0_knows_nothing_usual(self, body: Body) -> None:
        dynamics = replace(MOTION, usual_weight=0.0).dynamics(body, 0.04)
        assert np.isposinf(dynamics.usual_sd).all()
        assert (dynamics.log_usual(np.ones((2, len(body.dof_names)))) == 0).all()


class TestSettings:
    @pytest.mark.parametrize("setting", Motion.__dataclass_fields__)
    @pytest.mark.parametrize("value", [-1.0, np.nan, np.inf])
    def test_bad_ones_name_themselves(self, setting: str, value: float) -> None:
        with pytest.raises(InputError, match=f"motion '{setting}': expected finite and not negative"):
            Motion(**{setting: value})

    @pytest.mark.parametrize("setting", ["velocity_gain", "velocity_follow"])
    def test_shares_are_at_most_one(self, body: Body, setting: str) -> None:
        with pytest.raises(InputError, match=setting.removeprefix("velocity_")):
            Motion(**{setting: 1.5}).dynamics(body, 0.04)

    @pytest.mark.parametrize("cameras", [1, 3])
    @pytest.mark.parametrize("method", METHODS)
    def test_every_method_has_its_own(self, body: Body, method: str, cameras: int) -> None:
        """Filters that search take differences; with one camera the body's usual angles count for more, unless the pose
        is guessed.
        """
        motion = motion_of(method, cameras)
        estimated = isinstance(motion.dynamics(body, 0.04), NearlyConstantVelocity)
        assert estimated == (method == "guided")
        if method != "agp-pf":
            assert motion_of(method, 1).usual_weight > motion_of(method, 3).usual_weight
            assert method == "guided" or motion_of(method, 3) == SEARCHING
