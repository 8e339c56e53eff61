"""Motion models: moments as stated, limits kept without piling up, noise that can be scaled by component."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from filters.oracles import agrees
from muybridge.errors import InputError
from muybridge.filters.dynamics import (
    STANDING,
    TAIL,
    WIDEST,
    Belief,
    ConstantVelocity,
    GaussianWalk,
    NearlyConstantVelocity,
    reflect,
)

ANY = st.floats(-1e3, 1e3)


class TestReflect:
    @given(st.lists(ANY, min_size=1, max_size=20), ANY, st.floats(0, 1e3))
    def test_always_inside(self, values: list[float], low: float, span: float) -> None:
        lower, upper = np.array([low]), np.array([low + span])
        inside = reflect(np.array(values)[:, None], lower, upper)
        assert ((inside >= lower) & (inside <= upper)).all()

    @given(ANY, st.integers(-5, 5))
    def test_folding_has_the_period_of_two_spans(self, value: float, periods: int) -> None:
        """Arguments are below 1e3 + 10 * 7: rounding below 10 eps * 1.1e3 = 2.4e-12."""
        lower, upper = np.array([-2.0]), np.array([5.0])
        moved = reflect(np.array([[value + 14.0 * periods]]), lower, upper)
        np.testing.assert_allclose(moved, reflect(np.array([[value]]), lower, upper), atol=1e-11)

    def test_by_hand(self) -> None:
        inf = np.inf
        values = np.array([[1.25, -3.0, 7.0, 9.0, 4.0]])
        lower, upper = np.array([0, -1, -inf, -inf, 2.0]), np.array([1, inf, 5, inf, 2.0])
        np.testing.assert_allclose(reflect(values, lower, upper), [[0.75, 1.0, 3.0, 9.0, 2.0]])

    def test_inside_stays_to_the_bit(self) -> None:
        values = np.random.default_rng(0).uniform(-1, 1, (100, 2))
        with_one_outside = np.vstack((values, [[7.0, 0.1]]))
        np.testing.assert_array_equal(reflect(with_one_outside, -np.ones(2), np.ones(2))[:-1], values)

    def test_uniform_stays_uniform(self) -> None:
        """A walk between two walls keeps the uniform density; clipping, the negative control, piles up on them."""
        rng = np.random.default_rng(3)
        start = rng.uniform(0, 1, (400, 50, 1))
        moved = start + rng.normal(0, 0.4, start.shape)
        low, high = np.zeros(1), np.ones(1)
        folded = np.array([reflect(sample, low, high) for sample in moved])
        for power, truth in ((1, 1 / 2), (2, 1 / 3), (8, 1 / 9)):
            assert agrees((folded**power).mean(axis=1), truth)
        assert not agrees((np.clip(moved, 0, 1) ** 8).mean(axis=1), 1 / 9)


class TestModels:
    def test_walk_moments(self) -> None:
        walk, rng = GaussianWalk(np.array([0.5, 2.0])), np.random.default_rng(0)
        draws = np.array([walk.sample(rng, np.ones((20, 2)), velocity=np.full(2, 9.0)) - 1.0 for _ in range(500)])
        assert agrees(draws.mean(axis=1), np.zeros(2))
        assert agrees((draws**2).mean(axis=1), walk.noise_sd**2)
        assert not agrees((draws**2).mean(axis=1), (1.1 * walk.noise_sd) ** 2)

    @pytest.mark.parametrize("gain", [0.0, 0.5, 1.0])
    def test_velocity_by_its_gain(self, gain: float) -> None:
        model = ConstantVelocity(np.ones(2), gain=gain)
        moved = model.sample(np.random.default_rng(0), np.zeros((3, 2)), np.array([1.0, -2.0]), scale=0.0)
        np.testing.assert_array_equal(moved, np.tile([gain, -2.0 * gain], (3, 1)))

    def test_scale_by_component(self) -> None:
        walk = GaussianWalk(np.ones(3))
        moved = walk.sample(np.random.default_rng(0), np.zeros((50, 3)), scale=np.array([1.0, 0.0, 2.0]))
        assert (moved[:, 1] == 0).all() and moved[:, 2].std() > moved[:, 0].std() > 0.5

    def test_limits(self) -> None:
        model = ConstantVelocity(np.full(2, 3.0), np.array([-1.0, 0.0]), np.array([1.0, np.inf]))
        moved = model.sample(np.random.default_rng(0), np.zeros((500, 2)), np.array([5.0, -5.0]))
        assert (moved >= model.lower).all() and (moved <= model.upper).all()

    @pytest.mark.parametrize(
        ("make", "what"),
        [
            (lambda: GaussianWalk(np.array([-1.0])), "noise_sd"),
            (lambda: GaussianWalk(np.array([np.nan])), "noise_sd"),
            (lambda: GaussianWalk(np.ones(2), np.ones(2), np.zeros(2)), "component 0"),
            (lambda: GaussianWalk(np.ones(2), np.ones(3), np.ones(3)), "limits"),
            (lambda: GaussianWalk(np.ones(1), np.array([np.nan])), "limits"),
            (lambda: GaussianWalk(np.ones(2), usual_sd=np.array([1.0, 0.0])), "usual"),
            (lambda: GaussianWalk(np.ones(2), usual_sd=np.array([1.0, np.nan])), "usual"),
            (lambda: GaussianWalk(np.ones(2), usual_sd=np.ones(3)), "usual"),
            (lambda: GaussianWalk(np.ones(2), usual=np.array([0.0, np.nan])), "usual"),
            (lambda: ConstantVelocity(np.ones(1), gain=1.5), "gain"),
            (lambda: NearlyConstantVelocity(np.ones(2)), "acceleration_sd"),
            (lambda: NearlyConstantVelocity(np.ones(2), acceleration_sd=np.ones(3)), "acceleration_sd"),
            (lambda: NearlyConstantVelocity(np.ones(1), acceleration_sd=-np.ones(1)), "acceleration_sd"),
            (lambda: NearlyConstantVelocity(np.ones(1), acceleration_sd=np.array([np.inf])), "acceleration_sd"),
            (lambda: NearlyConstantVelocity(np.ones(1), acceleration_sd=np.ones(1), follow=1.5), "follow"),
            (lambda: NearlyConstantVelocity(np.ones(1), acceleration_sd=np.ones(1), follow=np.nan), "follow"),
        ],
    )
    def test_bad_input(self, make, what: str) -> None:
        with pytest.raises(InputError, match=what):
            make()

    def test_frozen(self) -> None:
        walk = GaussianWalk([1.0, 2.0])
        with pytest.raises(ValueError, match="read-only"):
            walk.noise_sd[0] = 3.0


USUAL, USUAL_SD = np.array([0.3, -1.0, 0.0]), np.array([0.2, 1.5, np.inf])


class TestUsual:
    """Independent Student densities, nothing where nothing is known."""

    WALK = GaussianWalk(np.ones(3), usual=USUAL, usual_sd=USUAL_SD)
    PLACES = np.random.default_rng(0).normal(USUAL, 3.0, (50, 3))

    def test_is_the_students_density_up_to_a_constant(self) -> None:
        """Rounding of sums of logarithms below 100: 1e-12. A normal density, the control, is another by far."""
        away = (self.PLACES[:, :2] - USUAL[:2]) / USUAL_SD[:2]
        for density, same in ((stats.t(TAIL), True), (stats.norm(), False)):
            difference = self.WALK.log_usual(self.PLACES) - density.logpdf(away).sum(axis=1)
            assert (np.ptp(difference) < 1e-12) == same

    def test_precision_is_the_pull_over_the_distance(self) -> None:
        """Central differences of step h: an error of h^2 / 6 of the third derivative, < 5 / sd^3 = 625: 1e-8."""
        h = 1e-5
        for place in self.PLACES:
            ends = self.WALK.log_usual(np.vstack([place + h * np.eye(3), place - h * np.eye(3)]))
            slope = (ends[:3] - ends[3:]) / (2 * h)
            pull = self.WALK.usual_precision(place) * (USUAL - place)
            np.testing.assert_allclose(slope, pull, atol=2e-8)

    def test_far_away_pulls_less_than_a_spring(self) -> None:
        near, far = (self.WALK.usual_precision(USUAL + away * USUAL_SD[0]) for away in (0.0, 10.0))
        assert near[0] == pytest.approx((TAIL + 1) / TAIL / USUAL_SD[0] ** 2)
        assert far[0] == pytest.approx((TAIL + 1) / (TAIL + 100) / USUAL_SD[0] ** 2)

    def test_knows_nothing_unless_told(self) -> None:
        walk = GaussianWalk(np.ones(3))
        assert (walk.log_usual(self.PLACES) == 0).all() and (walk.usual_precision(self.PLACES[0]) == 0).all()


def some_belief(size: int = 3, seed: int = 0) -> Belief:
    """Place and velocity that hang together, as after some frames."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(2 * size, 2 * size)) / 10
    both = root @ root.T + 0.01 * np.eye(2 * size)
    gain = np.linalg.solve(both[:size, :size], both[:size, size:]).T
    mean, velocity = rng.normal(size=(2, size))
    return Belief(mean, both[:size, :size], velocity, both[:size, size:], both[size:, size:], gain)


class TestBelief:
    def test_at_rest(self) -> None:
        belief = Belief.at_rest(np.arange(2.0), np.array([0.5, 2.0]))
        np.testing.assert_array_equal(belief.covariance, np.diag([0.25, 4.0]))
        assert (belief.velocity == 0).all() and (belief.cross == 0).all()
        assert np.isnan(belief.velocity_covariance).all()

    def test_corrected_is_the_conditional_of_both(self) -> None:
        """A measurement y = H X + noise of place alone: the textbook's update of place and velocity at once."""
        belief, size = some_belief(), 3
        both = np.block([[belief.covariance, belief.cross], [belief.cross.T, belief.velocity_covariance]])
        sees, noise, measured = np.array([[1.0, 0.5, 0.0, 0, 0, 0]]), np.array([[0.01]]), np.array([0.7])
        gain = both @ sees.T @ np.linalg.inv(sees @ both @ sees.T + noise)
        mean = np.concatenate([belief.mean, belief.velocity])
        mean, after = mean + gain @ (measured - sees @ mean), both - gain @ sees @ both
        found = belief.corrected(mean[:size], after[:size, :size])
        np.testing.assert_allclose(found.velocity, mean[size:], atol=1e-12)
        np.testing.assert_allclose(found.cross, after[:size, size:], atol=1e-12)
        np.testing.assert_allclose(found.velocity_covariance, after[size:, size:], atol=1e-12)
        assert np.abs(found.velocity - belief.velocity).max() > 0.01, "no correction would pass as well"

    def test_freed_cuts_one_block_alone(self) -> None:
        belief, block, rest = some_belief(), np.array([0, 2]), np.array([1])
        freed = belief.freed(block, np.array([5.0, 6.0]), 0.5)
        np.testing.assert_array_equal(freed.mean, [5.0, belief.mean[1], 6.0])
        assert freed.covariance[1, 1] == belief.covariance[1, 1] and (freed.covariance[1, block] == 0).all()
        np.testing.assert_array_equal(freed.covariance[np.ix_(block, block)], 0.25 * np.eye(2))
        assert (freed.cross[block] == 0).all()
        np.testing.assert_array_equal(freed.cross[rest], belief.cross[rest])
        np.testing.assert_array_equal(freed.velocity, belief.velocity)

    def test_a_freed_place_tells_no_velocity_and_the_others_still_do(self) -> None:
        belief, block = some_belief(), np.array([0, 2])
        freed = belief.freed(block, np.zeros(2), 0.5)
        assert np.abs(freed.velocity_gain[:, block]).max() < 1e-12
        np.testing.assert_allclose(freed.velocity_gain[:, 1], belief.cross[1] / belief.covariance[1, 1], atol=1e-12)
        assert np.abs(belief.velocity_gain[:, block]).max() > 1e-3

    def test_freed_leaves_the_belief_as_it_was(self) -> None:
        belief, same = some_belief(), some_belief()
        belief.freed(np.array([1]), np.array([9.0]), 0.5)
        for name in ("mean", "covariance", "cross", "velocity_gain"):
            np.testing.assert_array_equal(getattr(belief, name), getattr(same, name))


class TestCarry:
    NOISE = np.array([0.1, 0.2, 0.0])

    def test_a_walk_stays_and_grows_less_sure(self) -> None:
        belief = some_belief()
        carried = GaussianWalk(self.NOISE).carry(belief)
        np.testing.assert_array_equal(carried.mean, belief.mean)
        np.testing.assert_allclose(carried.covariance - belief.covariance, np.diag(self.NOISE**2), atol=1e-12)
        np.linalg.cholesky(GaussianWalk(self.NOISE).carry(Belief.at_rest(np.zeros(3), np.zeros(3))).covariance)
        moved = carried.corrected(carried.mean + 1.0, 0.5 * carried.covariance)
        assert (carried.velocity == 0).all() and (moved.velocity == 0).all()

    @pytest.mark.parametrize("gain", [0.5, 1.0])
    def test_constant_velocity_becomes_the_step(self, gain: float) -> None:
        """(6.19), whatever the gain."""
        belief = some_belief()
        carried = ConstantVelocity(self.NOISE, gain=gain).carry(belief)
        np.testing.assert_allclose(carried.mean, belief.mean + gain * belief.velocity, atol=1e-15)
        after = carried.mean + (0.3, -0.2, 0.1)
        corrected = carried.corrected(after, 0.5 * carried.covariance)
        np.testing.assert_allclose(corrected.velocity, after - belief.mean, atol=1e-12)
        assert np.abs(corrected.velocity - belief.velocity).max() > 0.1

    def test_constant_velocity_turns_back_at_a_limit(self) -> None:
        model = ConstantVelocity(self.NOISE[:1], np.zeros(1), np.ones(1))
        belief = Belief(np.array([0.9]), np.eye(1), np.array([0.3]), *np.zeros((3, 1, 1)))
        carried = model.carry(belief)
        assert carried.mean[0] == pytest.approx(0.8) and carried.velocity[0] == pytest.approx(-0.1)

    @pytest.mark.parametrize("gain", [0.6, 1.0])
    def test_nearly_constant_velocity_is_f_p_ft_plus_q(self, gain: float) -> None:
        change = np.array([0.05, 0.1, 0.02])
        model = NearlyConstantVelocity(np.full(3, 9.0), gain=gain, acceleration_sd=change)
        belief, one, none, q = some_belief(), np.eye(3), np.zeros((3, 3)), np.diag(change**2)
        moves, noise = np.block([[one, gain * one], [none, gain * one]]), np.block([[q / 4, q / 2], [q / 2, q]])
        both = np.block([[belief.covariance, belief.cross], [belief.cross.T, belief.velocity_covariance]])
        expected = moves @ both @ moves.T + noise
        carried = model.carry(belief)
        found = np.block([[carried.covariance, carried.cross], [carried.cross.T, carried.velocity_covariance]])
        np.testing.assert_allclose(found, expected, atol=1e-12)
        np.testing.assert_allclose(carried.mean, belief.mean + gain * belief.velocity, atol=1e-15)
        np.testing.assert_allclose(carried.velocity_gain @ expected[:3, :3], expected[3:, :3], atol=1e-12)


class Reflecting(NearlyConstantVelocity):
    """Negative control: at a limit the place is folded back and the velocity goes on."""

    def carry(self, belief: Belief) -> Belief:
        carried = super().carry(belief)
        mean = reflect((belief.mean + belief.velocity)[None], self.lower, self.upper)[0]
        return replace(carried, mean=mean, velocity=belief.velocity)


class TestLimit:
    """A joint that lies at its limit, and is seen there in every frame, half as surely as it was expected."""

    def speed(self, kind: type[NearlyConstantVelocity]) -> float:
        model = kind(np.full(1, 0.1), np.zeros(1), np.ones(1), acceleration_sd=np.full(1, 0.05))
        belief = replace(Belief.at_rest(np.zeros(1), np.full(1, 0.1)), velocity=np.full(1, -0.01))
        for _ in range(40):
            belief = model.carry(belief)
            belief = belief.corrected(np.zeros(1), 0.5 * belief.covariance)
        return float(abs(belief.velocity[0]))

    def test_is_a_stop(self) -> None:
        model = NearlyConstantVelocity(np.full(1, 0.1), np.zeros(1), np.ones(1), acceleration_sd=np.full(1, 0.05))
        belief = replace(Belief.at_rest(np.full(1, 0.02), np.full(1, 0.1)), velocity=np.full(1, -0.05))
        carried = model.carry(belief)
        assert carried.mean[0] == 0.0 and carried.velocity[0] == 0.0

    def test_is_no_source_of_speed(self) -> None:
        assert self.speed(NearlyConstantVelocity) < 0.01

    def test_reflected_it_is_one(self) -> None:
        assert self.speed(Reflecting) > 0.1


class Unbounded(NearlyConstantVelocity):
    """Negative control: what is not seen grows for ever."""

    def _bounded(self, belief: Belief):
        return belief.covariance, belief.cross, np.nan_to_num(belief.velocity_covariance, nan=0.09)


class TestUnseenDirections:
    """One direction in three dimensions is seen, and not along an axis, for 1000 frames."""

    SPEED, CHANGE, FRAMES = 0.3, 0.05, 1000
    #: X + V + A / 2 with standard deviations of at most WIDEST, SPEED and CHANGE; X and V may hang together fully.
    PLACE_BOUND = float(np.hypot(WIDEST + SPEED, CHANGE / 2)) + STANDING
    SPEED_BOUND = float(np.hypot(SPEED, CHANGE))

    def watched(self, kind: type[NearlyConstantVelocity]) -> Belief:
        model = kind(np.full(3, self.SPEED), acceleration_sd=np.full(3, self.CHANGE))
        belief, sees = Belief.at_rest(np.zeros(3), np.full(3, 0.1)), np.array([[1.0, -1.0, 0.5]])
        for _ in range(self.FRAMES):
            belief = model.carry(belief)
            after = np.linalg.inv(np.linalg.inv(belief.covariance) + 1e4 * sees.T @ sees)
            belief = belief.corrected(belief.mean, after)
        return model.carry(belief)

    def test_stay_bounded_and_a_covariance(self) -> None:
        belief = self.watched(NearlyConstantVelocity)
        assert np.sqrt(np.diag(belief.covariance)).max() < self.PLACE_BOUND * (1 + 1e-9)
        assert np.sqrt(np.diag(belief.velocity_covariance)).max() < self.SPEED_BOUND * (1 + 1e-9)
        both = np.block([[belief.covariance, belief.cross], [belief.cross.T, belief.velocity_covariance]])
        assert np.linalg.eigvalsh(both).min() > 0

    def test_without_bounds_they_do_not(self) -> None:
        """The velocity's variance alone grows by CHANGE^2 a frame: to 1.6 from 0.3."""
        belief = self.watched(Unbounded)
        assert np.sqrt(np.diag(belief.covariance)).max() > self.PLACE_BOUND
        assert np.sqrt(np.diag(belief.velocity_covariance)).max() > self.SPEED_BOUND


class TestVelocityAfter:
    STEP, BEFORE = np.array([0.5, -0.2]), np.array([0.1, 0.3])

    def test_of_a_walk_and_of_constant_velocity_it_is_the_step(self) -> None:
        for model in (GaussianWalk(np.ones(2)), ConstantVelocity(np.ones(2), gain=0.5)):
            np.testing.assert_array_equal(model.velocity_after(self.BEFORE, self.STEP), self.STEP)

    @pytest.mark.parametrize(("follow", "gain"), [(0.4, 1.0), (0.4, 0.5), (0.0, 0.5), (1.0, 0.5)])
    def test_follows_the_surprise_in_part(self, follow: float, gain: float) -> None:
        model = NearlyConstantVelocity(np.ones(2), gain=gain, acceleration_sd=np.ones(2), follow=follow)
        expected = (1 - follow) * gain * self.BEFORE + follow * self.STEP
        np.testing.assert_allclose(model.velocity_after(self.BEFORE, self.STEP), expected, atol=1e-15)
