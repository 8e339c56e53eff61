"""The annealed GP guided filter: its special cases to the bit, its prior, and what the guess is good for."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from scipy import stats

from filters.oracles import FALSE_ALARM, GaussianLikelihood
from muybridge.errors import InputError
from muybridge.filters import Guess, agp_pf, annealed, condensation, state_to_arrays
from muybridge.filters.dynamics import ConstantVelocity, GaussianWalk
from muybridge.filters.schedule import TOLERANCE
from muybridge.filters.state import State

SIZE = 4
SPOKEN = np.array([1, 3])  # components that the guess speaks of
COMMON = {"particles": 200, "layers": 3, "survival": 0.4, "shrink": 0.6, "estimate": "mean", "sharpness": 3.0}
CONFIG = agp_pf.Config(**COMMON)


@dataclass
class Asked:
    """A Gaussian around `truth` with a guess, that keeps what it was asked."""

    truth: float = 0.0
    sd: float = 0.3
    guess: Guess | None = None
    impossible: float = np.inf  # from here on, in the first component that is guessed
    asked: list[np.ndarray] = field(default_factory=list)

    def log_prob(self, poses: np.ndarray) -> np.ndarray:
        self.asked.append(poses.copy())
        answer = GaussianLikelihood(np.full(poses.shape[1], self.truth), self.sd).log_prob(poses)
        return np.where(poses[:, SPOKEN[0]] > self.impossible, -np.inf, answer)


def at(place: float, sd: float = 0.1, weight: float = 1.0) -> Guess:
    """One mode at `place`, a poor one far below, of the spoken components."""
    means = np.array([np.full(2, place), np.full(2, -50.0)])
    return Guess(np.array([weight, 1.0 - weight]), means, np.full((2, 2), sd**2), SPOKEN)


def begun(config, place: float = 0.0, module=agp_pf) -> tuple[np.random.Generator, State]:
    rng = np.random.default_rng(6)
    return rng, module.init(rng, np.full(SIZE, place), np.full(SIZE, 0.2), config)


def followed(module, config, guess: Guess | None, frames: int = 4) -> list[bytes]:
    """States after each frame, as bytes; limits and velocities take part."""
    rng, state = begun(config, module=module)
    dynamics = ConstantVelocity(np.full(SIZE, 0.2), np.full(SIZE, -1.0), np.full(SIZE, 1.0), gain=0.5)
    out = []
    for frame in range(frames):
        state, _ = module.step(rng, state, Asked(0.1 * frame, guess=guess), dynamics, config)
        out.append(b"".join(array.tobytes() for array in state_to_arrays(state).values()))
    return out


class TestSpecialCases:
    @pytest.mark.parametrize("guess", [None, at(0.5)])
    def test_without_a_share_it_is_the_annealed_filter(self, guess: Guess | None) -> None:
        """The same random numbers give the same bytes, frame after frame."""
        plain = followed(annealed, annealed.Config(**COMMON), None)
        assert followed(agp_pf, replace(CONFIG, alpha=0.0), guess) == plain

    def test_without_a_guess_too(self) -> None:
        assert followed(agp_pf, CONFIG, None) == followed(annealed, annealed.Config(**COMMON), None)

    def test_with_a_share_it_is_not(self) -> None:
        """Negative control."""
        plain = followed(annealed, annealed.Config(**COMMON), None)
        assert followed(agp_pf, replace(CONFIG, alpha=0.3), at(0.5))[0] != plain[0]

    def test_one_layer_more_is_condensation(self) -> None:
        """`PRESETS["pf"]` at the same settings: the same bytes."""
        common = {"particles": 200, "estimate": "mean", "resampling": "multinomial", "sharpness": 3.0}
        pf = replace(agp_pf.PRESETS["pf"], **common)
        assert followed(agp_pf, pf, at(0.5)) == followed(condensation, condensation.Config(**common), None)

    def test_presets_are_the_papers(self) -> None:
        assert {name: (row.alpha, row.layers, row.exponents) for name, row in agp_pf.PRESETS.items()} == {
            "agp-pf": (None, 5, None),
            "apf": (0.0, 5, None),
            "agp": (1.0, 5, None),
            "gp-pf": (None, 1, (1.0,)),
            "pf": (0.0, 1, (1.0,)),
        }
        assert all(row.particles == 300 and row.survival == 0.5 for row in agp_pf.PRESETS.values())

    def test_nothing_but_the_guess_does_not_track(self) -> None:
        """alpha = 1: two states that are far apart give the same spoken components, draw for draw; not the others."""
        first = []
        for place in (0.0, 3.0):
            config, likelihood = replace(CONFIG, alpha=1.0), Asked(guess=at(0.5))
            _, state = begun(config, place)
            agp_pf.step(np.random.default_rng(1), state, likelihood, GaussianWalk(np.full(SIZE, 0.1)), config)
            first.append(likelihood.asked[0])
        np.testing.assert_array_equal(first[0][:, SPOKEN], first[1][:, SPOKEN])
        assert np.abs(first[0][:, [0, 2]] - first[1][:, [0, 2]]).min() > 1.0


class TestPrior:
    def test_is_the_mixture(self) -> None:
        """(22): of n = 4000 particles a share alpha lies about the guess, the others about the prediction.

        What the guess does not speak of is the prediction's for all of them.
        """
        config = agp_pf.Config(particles=4000, layers=1, alpha=0.3)
        likelihood = Asked(guess=at(5.0))
        rng, state = begun(config)
        _, info = agp_pf.step(rng, state, likelihood, GaussianWalk(np.full(SIZE, 0.1)), config)
        first = likelihood.asked[0]
        own = first[:, SPOKEN[0]] > 2.5
        assert info.alpha == 0.3
        assert stats.binomtest(int(own.sum()), 4000, 0.3).pvalue > FALSE_ALARM
        assert stats.binomtest(int(own.sum()), 4000, 0.35).pvalue < FALSE_ALARM, "another share would pass as well"
        moved = np.sqrt(0.2**2 + 0.1**2)
        for sample, mean, sd in ((first[own][:, SPOKEN], 5.0, 0.1), (first[~own][:, SPOKEN], 0.0, moved),
                                 (first[own][:, [0, 2]], 0.0, moved)):  # fmt: skip
            assert stats.kstest((sample.ravel() - mean) / sd, "norm").pvalue > FALSE_ALARM

    def test_its_share_follows_from_the_most_likely_modes_variance(self) -> None:
        """(19) with lambda = .003: e^-1 at .003; nearly 0 above .015, as section V-C1 asks: e^-5 = .0067."""
        for variance, alpha in ((0.0, 1.0), (0.003, np.exp(-1.0)), (0.015, np.exp(-5.0))):
            guess = Guess(np.array([0.4, 0.6]), np.zeros((2, 2)), np.array([[1.0, 1.0], [0.0, 2 * variance]]), SPOKEN)
            assert agp_pf.share_of_guess(guess, agp_pf.PRINTED) == pytest.approx(alpha)
        wider = replace(agp_pf.PRINTED, trusted_variance=0.03)
        assert agp_pf.share_of_guess(guess, wider) == pytest.approx(np.exp(-0.5))
        assert agp_pf.share_of_guess(None, replace(wider, alpha=0.4)) == 0.0

    def test_its_lambda_is_the_settings_else_the_guesses_own_else_the_papers(self) -> None:
        guess = Guess(np.ones(1), np.zeros((1, 2)), np.full((1, 2), 0.003), SPOKEN)
        calibrated, open_ = replace(guess, trusted_variance=0.03), replace(agp_pf.PRINTED, trusted_variance=None)
        assert agp_pf.share_of_guess(calibrated, open_) == pytest.approx(np.exp(-0.1))
        assert agp_pf.share_of_guess(calibrated, agp_pf.PRINTED) == pytest.approx(np.exp(-1.0))
        assert agp_pf.share_of_guess(guess, open_) == pytest.approx(np.exp(-1.0))

    def test_the_guess_is_drawn_from_once(self) -> None:
        """Where it is impossible, no later layer goes there: 30 standard deviations of the noise away."""
        likelihood = Asked(guess=at(5.0), impossible=3.0)
        config = replace(CONFIG, alpha=0.3)
        rng, state = begun(config)
        agp_pf.step(rng, state, likelihood, GaussianWalk(np.full(SIZE, 0.1)), config)
        there = [int((layer[:, SPOKEN[0]] > 3.0).sum()) for layer in likelihood.asked[:3]]
        assert there[0] > 30 and there[1:] == [0, 0]

    def test_keeps_limits(self) -> None:
        likelihood = Asked(guess=at(1.0, sd=0.5))
        rng, state = begun(CONFIG)
        dynamics = GaussianWalk(np.full(SIZE, 0.1), np.full(SIZE, -1.0), np.full(SIZE, 1.0))
        agp_pf.step(rng, state, likelihood, dynamics, replace(CONFIG, alpha=1.0))
        assert np.abs(likelihood.asked[0]).max() <= 1.0

    def test_the_covariance_halves_and_half_survive(self) -> None:
        """Section IV-C and (24): Sigma is a covariance, so standard deviations shrink by the root of a half."""
        config = agp_pf.PRINTED
        scales = np.array(list(annealed._noise_scales(config, 1)))[:, 0]
        np.testing.assert_allclose(scales**2, 0.5 ** np.arange(5))
        rng, state = begun(config)
        _, info = agp_pf.step(rng, state, Asked(guess=at(0.2)), GaussianWalk(np.full(SIZE, 0.1)), config)
        np.testing.assert_allclose(info.survival_rate, 0.5, rtol=1.01 * TOLERANCE)


class TestUse:
    DYNAMICS = GaussianWalk(np.full(SIZE, 0.1))

    def lost(self, guess: Guess | None, alpha: float | None) -> tuple[State, float]:
        """One frame: the state at 0, the truth 3 away in what the guess speaks of, 30 of the noise's sd."""

        class Away(Asked):
            def log_prob(self, poses: np.ndarray) -> np.ndarray:
                truth = np.zeros(SIZE)
                truth[SPOKEN] = 3.0
                return GaussianLikelihood(truth, 0.1).log_prob(poses)

        config = replace(agp_pf.PRINTED, alpha=alpha, survival=0.1)
        rng, state = begun(config)
        state, info = agp_pf.step(rng, state, Away(guess=guess), self.DYNAMICS, config)
        return state, info.alpha

    def test_who_is_lost_is_found(self) -> None:
        """To three of the likelihood's sd; a mode of no use beside the right one does not matter."""
        state, alpha = self.lost(at(3.1, sd=0.2, weight=0.6), 0.3)
        assert np.abs(state.estimate[SPOKEN] - 3.0).max() < 0.3 and alpha == 0.3

    @pytest.mark.parametrize(("guess", "share"), [(None, 0.3), (at(3.1, sd=0.2), 0.0)])
    def test_and_is_not_without_the_guess(self, guess: Guess | None, share: float) -> None:
        """Negative control: 5 layers of noise, sd .1 (1 + .5 + ... + .5^4)^.5 = .14, and .2 at the start: 12 sd."""
        state, alpha = self.lost(guess, share)
        assert np.abs(state.estimate[SPOKEN]).max() < 2.0 and alpha == 0.0

    def test_a_guess_that_is_unsure_of_itself_counts_for_nothing(self) -> None:
        """sd .2: sigma^2 / lambda = 13, alpha = 1.6e-6."""
        state, alpha = self.lost(at(3.1, sd=0.2), None)
        assert np.abs(state.estimate[SPOKEN]).max() < 2.0 and alpha == pytest.approx(np.exp(-0.04 / 0.003))

    def test_a_wrong_guess_is_survived(self) -> None:
        """Every frame 3 away with a share of .3; the truth stands still. The estimate is within one sd of it."""
        config = replace(agp_pf.PRINTED, alpha=0.3)
        rng, state = begun(config)
        for _ in range(5):
            state, _ = agp_pf.step(rng, state, Asked(guess=at(3.0)), self.DYNAMICS, config)
        assert np.abs(state.estimate).max() < 0.3


class TestBegin:
    def test_all_particles_come_from_the_guess(self) -> None:
        """Table I, t = 0: equal weights, modes by their weights, and what it does not speak of as it is said."""
        config = agp_pf.Config(particles=4000)
        guess, mean, sd = at(2.0, weight=0.8), np.full(SIZE, 7.0), np.full(SIZE, 0.5)
        state = agp_pf.begin(np.random.default_rng(2), guess, mean, sd, config)
        assert (state.log_weights == -np.log(4000)).all() and not state.velocity.any()
        upper = state.particles[:, SPOKEN[0]] > 0
        assert stats.binomtest(int(upper.sum()), 4000, 0.8).pvalue > FALSE_ALARM
        assert stats.kstest((state.particles[upper][:, SPOKEN].ravel() - 2.0) / 0.1, "norm").pvalue > FALSE_ALARM
        assert stats.kstest((state.particles[:, [0, 2]].ravel() - 7.0) / 0.5, "norm").pvalue > FALSE_ALARM
        np.testing.assert_array_equal(state.estimate, [7.0, 2.0, 7.0, 2.0])  # the likeliest mode

    def test_keeps_limits(self) -> None:
        limits = np.full(SIZE, -1.0), np.full(SIZE, 1.0)
        state = agp_pf.begin(np.random.default_rng(2), at(2.0), np.zeros(SIZE), np.ones(SIZE), CONFIG, *limits)
        assert np.abs(state.particles).max() <= 1.0 and np.abs(state.estimate).max() <= 1.0


@pytest.mark.parametrize(("name", "value"), [("alpha", 1.5), ("alpha", -0.1), ("trusted_variance", 0.0)])
def test_bad_settings(name: str, value: float) -> None:
    with pytest.raises(InputError, match=name):
        replace(CONFIG, **{name: value})
