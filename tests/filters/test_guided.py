"""The guided filter where the answer is known: linear-Gaussian likelihoods, and one with two modes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from filters.oracles import GaussianLikelihood, NormalEquations
from muybridge.errors import InputError
from muybridge.filters import ConstantVelocity, GaussianWalk, Guess, NearlyConstantVelocity, guided
from muybridge.filters.dynamics import Belief

SIZE = 3
SEES = np.array([[1.0, 0.5, 0.0], [0.0, 1.0, -0.4], [0.3, 0.0, 1.0], [1.0, 1.0, 1.0]])  # (M, D)
VARIANCE = np.array([0.02, 0.01, 0.03, 0.05])  # (M,)
START_SD, WALK_SD = np.array([0.2, 0.1, 0.15]), np.array([0.1, 0.05, 0.2])
#: A linear problem is solved in one step; two, because a step of more than 0.3 would be shortened.
LINEAR = guided.Config(particles=4000, sharpness=1.0, dependence=1.0, spreads=(1.0, 1.0))


@dataclass(frozen=True)
class Linear:
    """log N(measured; SEES pose, diag(VARIANCE)) and its derivatives."""

    measured: np.ndarray

    def log_prob(self, poses: np.ndarray) -> np.ndarray:
        return -0.5 * ((poses @ SEES.T - self.measured) ** 2 / VARIANCE).sum(axis=1)

    def normal_equations(
        self, pose: np.ndarray, spread: float, components: np.ndarray | None = None
    ) -> NormalEquations:
        weighted = SEES.T / VARIANCE
        return NormalEquations(weighted @ SEES, weighted @ (self.measured - SEES @ pose)).of(components)


def measurements(frames: int) -> np.ndarray:
    rng = np.random.default_rng(5)
    truth = np.cumsum(0.3 * WALK_SD * rng.standard_normal((frames, SIZE)), axis=0)
    return truth @ SEES.T + np.sqrt(VARIANCE) * rng.standard_normal((frames, len(VARIANCE)))


def kalman(mean: np.ndarray, covariance: np.ndarray, measured: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Textbook update after a random walk, in the form with a gain."""
    predicted = covariance + np.diag(WALK_SD**2)
    gain = predicted @ SEES.T @ np.linalg.inv(SEES @ predicted @ SEES.T + np.diag(VARIANCE))
    return mean + gain @ (measured - SEES @ mean), (np.eye(SIZE) - gain @ SEES) @ predicted


def begin(config: guided.Config, seed: int = 0) -> tuple[np.random.Generator, guided.State]:
    rng = np.random.default_rng(seed)
    return rng, guided.init(rng, np.zeros(SIZE), START_SD, config)


class TestLinear:
    def test_is_the_kalman_filter(self) -> None:
        """Five frames; both are exact, but for the density of 1e-9 that stands for components without limits."""
        rng, state = begin(LINEAR)
        mean, covariance = np.zeros(SIZE), np.diag(START_SD**2)
        for measured in measurements(5):
            state, info = guided.step(rng, state, Linear(measured), GaussianWalk(WALK_SD), LINEAR)
            mean, covariance = kalman(mean, covariance, measured)
            np.testing.assert_allclose(state.estimate, mean, atol=1e-7)
            np.testing.assert_allclose(state.covariance, covariance, atol=1e-7)

    @pytest.mark.parametrize("weighting", ["laplace", "importance"])
    def test_particles_have_its_covariance(self, weighting: str) -> None:
        """N draws: an entry's standard error is at most sqrt(2 / N) of the variances; five of them.

        Where proposal and posterior are the same, importance weights are all equal, so that both have N draws.
        """
        config = replace(LINEAR, weighting=weighting)
        rng, state = begin(config)
        measured = measurements(1)[0]
        state, info = guided.step(rng, state, Linear(measured), GaussianWalk(WALK_SD), config)
        mean, covariance = kalman(np.zeros(SIZE), np.diag(START_SD**2), measured)
        assert info.ess == pytest.approx(config.particles, rel=1e-3)
        away = state.particles - mean
        found = np.einsum("n,nd,ne->de", np.exp(state.log_weights), away, away)
        sd = np.sqrt(np.diag(covariance))
        bound = 5 * np.sqrt(2 / config.particles)
        assert np.abs((found - covariance) / np.outer(sd, sd)).max() < bound
        wider = np.diag(START_SD**2) + np.diag(WALK_SD**2)
        assert np.abs((found - wider) / np.outer(sd, sd)).max() > bound, "the prediction would pass as well"

    @pytest.mark.parametrize("weighting", ["likelihood", "importance"])
    def test_weights_make_the_estimate_too(self, weighting: str) -> None:
        """`importance` keeps the posterior's mean; `likelihood` counts the likelihood twice and is drawn to it."""
        config = replace(LINEAR, weighting=weighting)
        rng, state = begin(config)
        measured = measurements(1)[0]
        state, _ = guided.step(rng, state, Linear(measured), GaussianWalk(WALK_SD), config)
        mean, covariance = kalman(np.zeros(SIZE), np.diag(START_SD**2), measured)
        information = (SEES.T / VARIANCE) @ SEES
        twice = np.linalg.inv(np.linalg.inv(covariance) + information)
        if weighting == "likelihood":
            mean, covariance = twice @ (np.linalg.inv(covariance) @ mean + (SEES.T / VARIANCE) @ measured), twice
        error = np.sqrt(np.diag(covariance) / config.particles)
        assert (np.abs(state.estimate - mean) < 5 * 1.5 * error).all()  # 1.5: weights that differ make N smaller

    def test_dependence_widens(self) -> None:
        """The likelihood's information is divided by it: the mode moves towards the prior, and is known less well."""
        measured = measurements(1)[0]
        rng, state = begin(LINEAR)
        config = replace(LINEAR, dependence=3.0)
        wide, _ = guided.step(rng, state, Linear(measured), GaussianWalk(WALK_SD), config)
        prior = np.linalg.inv(np.diag(START_SD**2 + WALK_SD**2))
        expected = np.linalg.inv((SEES.T / VARIANCE) @ SEES / 3.0 + prior)
        np.testing.assert_allclose(wide.covariance, expected, atol=1e-7)
        np.testing.assert_allclose(wide.estimate, expected @ (SEES.T / VARIANCE @ measured) / 3.0, atol=1e-7)

    def test_what_is_usual_counts_once_a_frame(self) -> None:
        """A third density: its precision where the prediction is, (nu + 1) / (nu + z^2) / sd^2, pulls to its mean."""
        measured = measurements(1)[0]
        rng, state = begin(LINEAR)
        usual, usual_sd = np.array([1.0, 0.0, -1.0]), np.array([0.2, np.inf, 0.1])
        dynamics = GaussianWalk(WALK_SD, usual=usual, usual_sd=usual_sd)
        state, _ = guided.step(rng, state, Linear(measured), dynamics, LINEAR)
        pulling = 5.0 / (4.0 + (usual / usual_sd) ** 2) / usual_sd**2
        precision = (SEES.T / VARIANCE) @ SEES + np.diag((START_SD**2 + WALK_SD**2) ** -1 + pulling)
        np.testing.assert_allclose(state.covariance, np.linalg.inv(precision), atol=1e-7)
        pull = (SEES.T / VARIANCE) @ measured + usual * pulling
        np.testing.assert_allclose(state.estimate, np.linalg.solve(precision, pull), atol=1e-7)

    @pytest.mark.parametrize("sharpness", [1.0, 50.0])
    def test_importance_counts_what_is_usual_once(self, sharpness: float) -> None:
        """One component: p(y|x)^K N(x; carried) student(x), summed over a fine grid; the control has it twice."""
        sd, usual, usual_sd = 0.3, 0.5, 0.15
        config = guided.Config(particles=20000, sharpness=sharpness, dependence=1.0, weighting="importance",
                               resampling="systematic", spreads=(1.0,) * 4)  # fmt: skip
        dynamics = GaussianWalk(np.full(1, 0.2), usual=np.full(1, usual), usual_sd=np.full(1, usual_sd))
        rng = np.random.default_rng(0)
        state = guided.init(rng, np.zeros(1), np.full(1, 0.1), config)
        likelihood = GaussianLikelihood(np.full(1, -0.2), sd * np.sqrt(sharpness))
        state, info = guided.step(rng, state, likelihood, dynamics, config)
        x = np.linspace(-3, 3, 6001)[:, None]
        log_carried = -0.5 * (x[:, 0] ** 2) / (0.1**2 + 0.2**2)
        log_density = sharpness * likelihood.log_prob(x) + log_carried
        means, sds = [], []
        for times in (1, 2):
            weights = np.exp(log_density + times * dynamics.log_usual(x))
            weights /= weights.sum()
            means.append(float(weights @ x[:, 0]))
            sds.append(float(np.sqrt(weights @ (x[:, 0] - means[-1]) ** 2)))
        bound = 5 * sds[0] / np.sqrt(info.ess)
        assert abs(state.estimate[0] - means[0]) < bound
        assert abs(state.estimate[0] - means[1]) > bound


class TestBelief:
    def test_freeing_a_block_leaves_a_covariance(self) -> None:
        """Place and velocity together stay positive definite after a jump and what is then seen, over many frames."""
        rng = np.random.default_rng(0)
        dynamics = NearlyConstantVelocity(np.full(SIZE, 0.3), gain=1.0, acceleration_sd=np.full(SIZE, 0.05))
        belief = Belief.at_rest(np.zeros(SIZE), START_SD)
        for frame in range(30):
            belief = dynamics.carry(belief)
            if frame % 3 == 0:
                belief = belief.freed(np.array([frame // 3 % SIZE]), np.array([0.5]), 0.5)
            sees = rng.normal(size=(1, SIZE))  # one direction a frame: the others drift
            precision = np.linalg.inv(belief.covariance) + 1e4 * sees.T @ sees
            belief = belief.corrected(belief.mean, np.linalg.inv(precision))
            both = np.block([[belief.covariance, belief.cross], [belief.cross.T, belief.velocity_covariance]])
            assert np.linalg.eigvalsh(0.5 * (both + both.T)).min() > 0

    def test_a_jump_moves_no_velocity(self) -> None:
        dynamics = NearlyConstantVelocity(np.full(SIZE, 0.3), gain=1.0, acceleration_sd=np.full(SIZE, 0.05))
        carried = dynamics.carry(Belief.at_rest(np.zeros(SIZE), START_SD))
        freed = carried.freed(np.array([1]), np.array([0.5]), 0.5)
        elsewhere = freed.mean + (0.0, 2.0, 0.0)
        np.testing.assert_allclose(
            freed.corrected(elsewhere, 0.1 * freed.covariance).velocity, carried.velocity, atol=1e-12
        )
        assert np.abs(carried.corrected(elsewhere, 0.1 * carried.covariance).velocity[1]) > 0.1


class TestVelocity:
    """Place and velocity under white accelerations, against the textbook's Kalman filter of twice the size."""

    SPEED_SD, CHANGE_SD = np.array([0.3, 0.4, 0.3]), np.array([0.02, 0.05, 0.01])  # velocities stay within the first

    def textbook(self, frames: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        one, none = np.eye(SIZE), np.zeros((SIZE, SIZE))
        moves, sees = np.block([[one, one], [none, one]]), np.hstack([SEES, np.zeros_like(SEES)])
        q = np.diag(self.CHANGE_SD**2)
        noise = np.block([[q / 4, q / 2], [q / 2, q]])
        mean = np.zeros(2 * SIZE)
        covariance = np.diag(np.concatenate([START_SD**2, self.SPEED_SD**2]))
        for measured in frames:
            mean, covariance = moves @ mean, moves @ covariance @ moves.T + noise
            gain = covariance @ sees.T @ np.linalg.inv(sees @ covariance @ sees.T + np.diag(VARIANCE))
            mean, covariance = mean + gain @ (measured - sees @ mean), covariance - gain @ sees @ covariance
        return mean, covariance

    @pytest.mark.parametrize("frames", [1, 2, 6])
    def test_is_the_kalman_filter_of_both(self, frames: int) -> None:
        rng, state = begin(LINEAR)
        dynamics = NearlyConstantVelocity(self.SPEED_SD, gain=1.0, acceleration_sd=self.CHANGE_SD)
        for measured in measurements(frames):
            state, _ = guided.step(rng, state, Linear(measured), dynamics, LINEAR)
        mean, covariance = self.textbook(measurements(frames))
        np.testing.assert_allclose(np.concatenate([state.estimate, state.velocity]), mean, atol=1e-6)
        found = np.block([[state.covariance, state.cross], [state.cross.T, state.velocity_covariance]])
        np.testing.assert_allclose(found, covariance, atol=1e-6)

    def test_a_walk_is_another_filter(self) -> None:
        """Negative control: without velocities the second frame's estimate differs by far more than the tolerance."""
        rng, state = begin(LINEAR)
        for measured in measurements(2):
            state, _ = guided.step(rng, state, Linear(measured), GaussianWalk(self.SPEED_SD), LINEAR)
        assert np.abs(state.estimate - self.textbook(measurements(2))[0][:SIZE]).max() > 1e-3

    def test_limits_hold_the_mode(self) -> None:
        upper = np.array([0.05, np.inf, np.inf])
        rng, state = begin(LINEAR)
        dynamics = GaussianWalk(WALK_SD, np.full(SIZE, -np.inf), upper)
        state, _ = guided.step(rng, state, Linear(np.full(len(VARIANCE), 3.0)), dynamics, LINEAR)
        assert state.estimate[0] == 0.05 and (state.particles <= upper).all()

    def test_needs_to_know_which_way_is_up(self) -> None:
        class Blind:
            def log_prob(self, poses: np.ndarray) -> np.ndarray:
                return np.zeros(len(poses))

        rng, state = begin(LINEAR)
        with pytest.raises(InputError, match="normal_equations"):
            guided.step(rng, state, Blind(), GaussianWalk(WALK_SD), LINEAR)


LOW, HIGH, MODE_SD = -1.0, 1.0, 0.1


@dataclass(frozen=True)
class TwoModes:
    """The second component is at LOW or, `better` times as likely, at HIGH; the others are at `place`."""

    better: float = 100.0
    place: float = 0.0
    misfit: float = 0.0  # minus the log likelihood at the lower mode
    guess: Guess | None = None

    def log_prob(self, poses: np.ndarray) -> np.ndarray:
        x = poses[:, 1]
        both = np.logaddexp(-0.5 * ((x - LOW) / MODE_SD) ** 2, np.log(self.better) - 0.5 * ((x - HIGH) / MODE_SD) ** 2)
        return both - self.misfit - 0.5 * ((poses[:, [0, 2]] - self.place) ** 2).sum(axis=1) / MODE_SD**2

    def normal_equations(
        self, pose: np.ndarray, spread: float, components: np.ndarray | None = None
    ) -> NormalEquations:
        """The nearer mode's."""
        target = np.array([self.place, HIGH if pose[1] > 0 else LOW, self.place])
        return NormalEquations(np.eye(SIZE) / MODE_SD**2, (target - pose) / MODE_SD**2).of(components)


class TestClimb:
    DYNAMICS = GaussianWalk(WALK_SD)

    def test_the_others_stand(self) -> None:
        """Of a Gaussian, some components given the others: mean_B - H_BB^-1 H_BA (x_A - mean_A), H = H_L + Lambda."""
        likelihood, start, prior = Linear(measurements(1)[0]), np.array([0.1, -0.2, 0.05]), np.diag(WALK_SD**-2)
        moved, given = np.array([0, 2]), np.array([1])
        mode, seen = guided.climb(start, prior, likelihood, self.DYNAMICS, (1.0,) * 8, moved)
        whole, there = guided.climb(start, prior, likelihood, self.DYNAMICS, (1.0,) * 8)
        precision = there.curvature + prior
        away = np.linalg.solve(
            precision[np.ix_(moved, moved)], precision[np.ix_(moved, given)] @ (start - whole)[given]
        )
        assert mode[1] == start[1] != pytest.approx(whole[1])
        np.testing.assert_allclose(mode[moved], whole[moved] - away, atol=1e-12)
        assert seen.curvature.shape == (2, 2)

    def test_a_block_set_free_has_no_past(self) -> None:
        """Its covariance with the others is cut, its own is what is said; the others keep theirs."""
        covariance = np.array([[0.04, 0.01, 0.0], [0.01, 0.09, 0.02], [0.0, 0.02, 0.25]])
        belief = replace(Belief.at_rest(np.zeros(SIZE), WALK_SD), covariance=covariance)
        prior = guided._Prior(belief, self.DYNAMICS)
        free = prior.freed(np.array([1]), np.array([0.7]), 0.5)
        assert free.mean.tolist() == [0.0, 0.7, 0.0]
        expected = np.array([[0.04, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0, 0.0, 0.25]])
        np.testing.assert_allclose(np.linalg.inv(free.precision), expected, rtol=1e-8)  # limits: 1e-9 of a precision
        assert covariance[1, 1] == 0.09


class TestRedraw:
    CONFIG = guided.Config(particles=100, sharpness=1.0, dependence=1.0, spreads=(1.0,) * 8, redraws=60)
    SPEED = 0.02  # a frame, of the components that are not redrawn

    def follow(self, config: guided.Config, likelihood: TwoModes, frames: int) -> guided.State:
        """From the lower mode, with dynamics that repeat the last step."""
        rng = np.random.default_rng(2)
        state = guided.init(rng, np.array([0.0, LOW, 0.0]), np.full(SIZE, 0.05), config)
        limits = np.array([np.inf, 1.5, np.inf])
        dynamics = ConstantVelocity(np.full(SIZE, 0.1), -limits, limits, gain=0.5)
        for frame in range(1, frames + 1):
            state, _ = guided.step(rng, state, replace(likelihood, place=self.SPEED * frame), dynamics, config)
        return state

    def test_finds_the_better_mode(self) -> None:
        """60 uniform draws on [-1.5, 1.5], half of them on the other side: none is there once in 2^60."""
        state = self.follow(replace(self.CONFIG, blocks=((1,),)), TwoModes(), 1)
        assert state.estimate[1] == pytest.approx(HIGH, abs=MODE_SD)

    def test_no_redraw_no_other_mode(self) -> None:
        """Negative control: the climb alone stays where it is."""
        assert self.follow(self.CONFIG, TwoModes(), 5).estimate[1] == pytest.approx(LOW, abs=MODE_SD)

    @pytest.mark.parametrize(("improvement", "mode"), [(0.1, LOW), (0.05, HIGH)])
    def test_a_mode_hardly_better_is_left_alone(self, improvement: float, mode: float) -> None:
        """log 2 = 0.69 is less than a tenth of a misfit of 10, and more than a twentieth."""
        config = replace(self.CONFIG, blocks=((1,),), improvement=improvement)
        state = self.follow(config, TwoModes(better=2.0, misfit=10.0), 5)
        assert state.estimate[1] == pytest.approx(mode, abs=MODE_SD)

    def test_a_jump_is_no_velocity(self) -> None:
        """The redrawn component's velocity is what the climb did after the jump, not the jump of 2.

        The best of 400 draws on a range of 3 lies within 3 / 400 of the mode on average, ten times that once in
        22,000. The other components' is the way they went: with P + Q = 0.05^2 + 0.1^2 a climb gains 5/9 of the step.
        """
        state = self.follow(replace(self.CONFIG, blocks=((1,),), redraws=400, tries=1), TwoModes(), 1)
        assert state.estimate[1] - LOW > 1.5
        assert abs(state.velocity[1]) < 10 * 3 / 400
        plain = self.follow(self.CONFIG, TwoModes(), 1)
        assert plain.velocity[0] == pytest.approx(5 / 9 * self.SPEED)
        assert plain.velocity[0] - 1e-12 <= state.velocity[0] <= self.SPEED


class TestGuess:
    """The mode that no climb reaches, guessed: one mode of the guess lies near it, another, likelier one nowhere."""

    CONFIG = guided.Config(particles=100, sharpness=1.0, dependence=1.0, spreads=(1.0,) * 8)
    GUESS = Guess(np.array([0.7, 0.3]), np.array([[-0.3], [HIGH - 0.2]]), np.full((2, 1), 0.2**2), np.array([1]))

    def follow(self, likelihood: TwoModes, frames: int = 1, **settings: object) -> tuple[guided.State, float]:
        """From the lower mode; the last state, and whether the guess was taken."""
        rng, config = np.random.default_rng(2), replace(self.CONFIG, **settings)
        state = guided.init(rng, np.array([0.0, LOW, 0.0]), np.full(SIZE, 0.05), config)
        limits = np.array([np.inf, 1.5, np.inf])
        dynamics = ConstantVelocity(np.full(SIZE, 0.1), -limits, limits, gain=0.5)
        for _ in range(frames):
            state, info = guided.step(rng, state, likelihood, dynamics, config)
        return state, info.alpha

    def test_finds_the_better_mode(self) -> None:
        state, taken = self.follow(TwoModes(guess=self.GUESS))
        assert state.estimate[1] == pytest.approx(HIGH, abs=MODE_SD) and taken == 1.0

    @pytest.mark.parametrize(
        ("guess", "settings"),
        [
            (None, {}),  # nothing guessed
            (GUESS, {"guesses": 0}),  # not asked for
            (GUESS, {"guesses": 1}),  # only the likelier of its modes, which is of no use
        ],
    )
    def test_not_without_it(self, guess: Guess | None, settings: dict) -> None:
        """Negative control."""
        state, taken = self.follow(TwoModes(guess=guess), 5, **settings)
        assert state.estimate[1] == pytest.approx(LOW, abs=MODE_SD)
        assert np.isnan(taken) if guess is None or settings["guesses"] == 0 else taken == 0.0

    @pytest.mark.parametrize(("improvement", "mode"), [(0.1, LOW), (0.05, HIGH)])
    def test_a_mode_hardly_better_is_left_alone(self, improvement: float, mode: float) -> None:
        """As for a redrawn limb: log 2 = 0.69 is less than a tenth of a misfit of 10, more than a twentieth."""
        likelihood = TwoModes(better=2.0, misfit=10.0, guess=self.GUESS)
        state, taken = self.follow(likelihood, improvement=improvement)
        assert state.estimate[1] == pytest.approx(mode, abs=MODE_SD) and taken == (mode == HIGH)

    def test_it_is_set_free_as_far_as_the_guess_says(self) -> None:
        """The posterior of the guess's N(.8, .2^2) and the mode's N(1, .1^2); the carried covariance plays no part."""
        state, _ = self.follow(TwoModes(guess=self.GUESS))
        precision = 1 / 0.2**2 + 1 / MODE_SD**2 + 12.0 / 3.0**2  # the last: of a uniform density between the limits
        assert state.covariance[1, 1] == pytest.approx(1.0 / precision)
        assert state.estimate[1] == pytest.approx((0.8 / 0.2**2 + HIGH / MODE_SD**2 + 0.8 * 12.0 / 9.0) / precision)

    def test_a_jump_is_no_velocity(self) -> None:
        """It keeps the one it had, none."""
        state, _ = self.follow(TwoModes(guess=self.GUESS))
        assert state.estimate[1] - LOW > 1.5 and state.velocity[1] == 0.0


@pytest.mark.parametrize(
    "settings",
    [
        {"spreads": ()},
        {"guesses": -1},
        {"spreads": (0.1, 0.2)},
        {"spreads": (0.1, 0.0)},
        {"dependence": 0.0},
        {"weighting": "equal"},
        {"freedom": 0.0},
        {"redraws": -1},
        {"tries": 0},
    ],
)
def test_settings_that_make_no_sense(settings: dict) -> None:
    with pytest.raises(InputError):
        guided.Config(**settings)
