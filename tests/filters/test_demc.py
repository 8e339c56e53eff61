"""DE-MC: bootstrap as its limit, both readings of the adaptive sigma, and what the printed settings cannot do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from filters.oracles import GaussianLikelihood
from muybridge.errors import InputError
from muybridge.filters import GaussianWalk, Weights, condensation, demc, resample
from muybridge.filters.moves import Target, differential_move
from muybridge.filters.state import CountingLikelihood, Population


def one_step(config: demc.Config, dimensions: int = 3, sd: float = 1.0):
    rng = np.random.default_rng(0)
    state = demc.init(rng, np.zeros(dimensions), np.ones(dimensions), config)
    likelihood = GaussianLikelihood(np.ones(dimensions), sd)
    return demc.step(rng, state, likelihood, GaussianWalk(np.ones(dimensions)), config)


def test_without_moves_it_is_the_bootstrap_filter() -> None:
    """The same random numbers give the same bytes, frame after frame."""
    common = {"particles": 200, "estimate": "maximum", "resampling": "stratified", "sharpness": 2.0}
    results = []
    for module, config in (
        (demc, demc.Config(**common, layers=0, dynamics_noise=1.0)),
        (condensation, condensation.Config(**common)),
    ):
        rng, dynamics = np.random.default_rng(4), GaussianWalk(np.ones(3), -np.ones(3), np.ones(3))
        state = module.init(rng, np.zeros(3), np.ones(3), config)
        for frame in range(5):
            state, _ = module.step(rng, state, GaussianLikelihood(np.full(3, frame / 5)), dynamics, config)
        results.append(state)
    for name in ("particles", "log_weights", "estimate", "velocity"):
        np.testing.assert_array_equal(getattr(results[0], name), getattr(results[1], name))


def test_printed_settings_are_the_printed_ones() -> None:
    printed = demc.PRINTED
    assert (printed.particles, printed.layers, printed.c, printed.estimate) == (500, 7, 0.1, "maximum")
    assert demc._difference_scale(printed, 24) == pytest.approx(0.437, abs=5e-4)  # (6.17), "around 0.437"


@pytest.mark.parametrize("crossover", [0.0, 0.5])
def test_evaluations(crossover: float) -> None:
    """N (T + 1), and N T more with crossover."""
    _, info = one_step(demc.Config(particles=40, layers=3, crossover_rate=crossover))
    assert info.evaluations == 40 * (4 + (3 if crossover else 0))
    assert info.acceptance.shape == (3,) and ((info.acceptance > 0) & (info.acceptance < 1)).all()


def test_after_many_layers_the_particles_are_the_likelihood() -> None:
    """30 layers forget the start at (0, 0, 0). Bounds: 6 standard errors of 2000 draws, times 3 for ties."""
    config = demc.Config(particles=2000, layers=30, estimate="mean", adaptation="off", dynamics_noise=1.0)
    state, _ = one_step(config, sd=0.5)
    np.testing.assert_allclose(state.particles.mean(axis=0), 1.0, atol=3 * 6 * 0.5 / np.sqrt(2000))
    np.testing.assert_allclose(state.particles.std(axis=0), 0.5, rtol=3 * 6 / np.sqrt(4000))


class TestSigmaFactor:
    """(6.20) in its two readings."""

    FIRST = np.log(np.array([0.2, 0.1, 0.3, 0.2]))

    def factor(self, reading: str, log_likelihoods: np.ndarray) -> float:
        return demc._sigma_factor(log_likelihoods, self.FIRST, demc.Config(adaptation=reading))

    def test_off(self) -> None:
        assert self.factor("off", self.FIRST + 1.0) == 1.0

    def test_raw_likelihood_by_hand(self) -> None:
        """Sum of squares .18 at first, .72 when every likelihood has doubled: a quarter of the jump."""
        assert self.factor("raw_likelihood", self.FIRST) == pytest.approx(1.0)
        assert self.factor("raw_likelihood", self.FIRST + np.log(2.0)) == pytest.approx(0.25)

    def test_effective_sample_size_by_hand(self) -> None:
        assert self.factor("effective_sample_size", np.zeros(4)) == pytest.approx(1.0)
        assert self.factor("effective_sample_size", np.array([0, 0, -np.inf, -np.inf])) == pytest.approx(0.5)

    def test_the_readings_disagree_as_the_spec_says(self) -> None:
        """From one survivor to four equal ones: the text wants the jump to shrink, normalised weights make it grow."""
        one, four = np.array([-0.1, -50, -50, -50]), np.full(4, -0.1)
        assert self.factor("raw_likelihood", four) < self.factor("raw_likelihood", one)
        assert self.factor("effective_sample_size", four) > self.factor("effective_sample_size", one)

    @pytest.mark.parametrize("reading", demc.ADAPTATIONS)
    @pytest.mark.parametrize("log_likelihood", [-np.inf, -1e6, -1e3, 0.0, 1e6])
    def test_always_within_bounds(self, reading: str, log_likelihood: float) -> None:
        factor = self.factor(reading, np.full(4, log_likelihood))
        assert 1 / demc.FACTOR_BOUND <= factor <= demc.FACTOR_BOUND

    def test_reported_by_the_jumps(self) -> None:
        rng = np.random.default_rng(0)
        uniform = demc._jumps(rng, (5000, 2), np.array([1.0, 3.0]), demc.Config())
        normal = demc._jumps(rng, (5000, 2), np.array([1.0, 3.0]), demc.Config(jump="normal"))
        assert (np.abs(uniform) <= [1, 3]).all() and (np.abs(normal) > [1, 3]).any()
        np.testing.assert_allclose(uniform.std(axis=0), np.array([1, 3]) / np.sqrt(3), rtol=6 / np.sqrt(10000))
        np.testing.assert_allclose(normal.std(axis=0), [1, 3], rtol=6 / np.sqrt(10000))


def printed_step(rng, state, likelihood, dynamics, config: demc.Config) -> np.ndarray:
    """Section 6.4 read out literally, with neither selection between layers nor blocks: the particles (N, D)."""
    counted = CountingLikelihood(likelihood, dynamics, config.sharpness)
    target = Target(counted, dynamics.lower, dynamics.upper, exponent=config.sharpness)
    selected = resample(rng, Weights(state.log_weights), config.particles, config.resampling)
    predicted = dynamics.sample(rng, state.particles[selected], state.velocity, config.dynamics_noise)
    population = first = target.measure(predicted)
    for _ in range(config.layers):
        factor = demc._sigma_factor(population.log_likelihoods, first.log_likelihoods, config)
        jump = demc._jumps(rng, predicted.shape, config.c * factor * dynamics.noise_sd, config)
        scale = demc._difference_scale(config, predicted.shape[1])
        population, _ = differential_move(rng, population, target, scale, jump, config.partners)
    return population.particles


class TestReselect:
    CONFIG = demc.Config(particles=400, layers=3, resampling="systematic", dynamics_noise=0.5, sharpness=4.0)
    DYNAMICS = GaussianWalk(np.ones(3))

    def particles(self, config: demc.Config) -> tuple[np.ndarray, np.ndarray]:
        """After one step, by the filter and by the printed text with the same random numbers."""
        found = []
        for step in (lambda *given: demc.step(*given)[0].particles, printed_step):
            rng = np.random.default_rng(3)
            state = demc.init(rng, np.zeros(3), np.ones(3), config)
            found.append(step(rng, state, GaussianLikelihood(np.ones(3), 0.3), self.DYNAMICS, config))
        return found[0], found[1]

    def test_off_is_as_printed_to_the_bit(self) -> None:
        found, printed = self.particles(self.CONFIG)
        np.testing.assert_array_equal(found, printed)

    def test_on_is_not(self) -> None:
        found, printed = self.particles(replace(self.CONFIG, reselect=0.5))
        assert (found != printed).any()

    def population(self, log_likelihoods: np.ndarray) -> Population:
        return Population(np.arange(float(len(log_likelihoods)))[:, None], log_likelihoods)

    def copies(self, log_likelihoods: np.ndarray, config: demc.Config) -> np.ndarray:
        """(N,) of each member after a selection."""
        chosen = demc._reselected(np.random.default_rng(0), self.population(log_likelihoods), config)
        np.testing.assert_array_equal(log_likelihoods[chosen.particles[:, 0].astype(int)], chosen.log_likelihoods)
        return np.bincount(chosen.particles[:, 0].astype(int), minlength=len(log_likelihoods))

    @pytest.mark.parametrize("share", [0.2, 0.6])
    def test_so_many_survive(self, share: float) -> None:
        """Systematic selection takes each member floor or ceil of N w times; w ~ p^beta, and 1 / (N sum w^2) = share.

        Weights exp(-beta x) of x uniform in (0, L) survive to 2 tanh(beta L / 2) / (beta L): so beta is found apart.
        """
        log_likelihoods = -np.linspace(0.0, 50.0, 400)
        steepness = brentq(lambda a: 2 * np.tanh(a / 2) / a - share, 1e-3, 100.0)  # beta L
        weights = np.exp(steepness / 50.0 * log_likelihoods)
        weights /= weights.sum()
        copies = self.copies(log_likelihoods, replace(self.CONFIG, reselect=share, sharpness=1e3))
        assert np.abs(copies - 400 * weights).max() < 1.05  # one, and the sum's and the bisection's coarseness
        others = replace(self.CONFIG, reselect=0.5 * share, sharpness=1e3)
        assert np.abs(self.copies(log_likelihoods, others) - 400 * weights).max() > 1.05

    def test_never_sharper_than_the_likelihood(self) -> None:
        """Sharpened fully here, weights differ by 2 %: copies are floor or ceil of N w, between 0 and 2.

        Free to be as sharp as the share asks for (negative control), it takes the best more often.
        """
        log_likelihoods = -np.linspace(0.0, 50.0, 400)
        weights = np.exp(4e-4 * log_likelihoods)
        copies = self.copies(log_likelihoods, replace(self.CONFIG, reselect=0.2, sharpness=4e-4))
        assert np.abs(copies - 400 * weights / weights.sum()).max() < 1.0
        assert self.copies(log_likelihoods, replace(self.CONFIG, reselect=0.2, sharpness=1e3)).max() > 2

    def test_nobody_possible_nobody_selected(self) -> None:
        copies = self.copies(np.full(400, -np.inf), replace(self.CONFIG, reselect=0.5))
        assert (copies == 1).all()

    def test_before_every_layer(self) -> None:
        """Without moves only selection changes anything: a share of 1/2 three times leaves far fewer distinct ones."""
        still = replace(self.CONFIG, c=0.0, difference_scale=0.0, sharpness=1e3, layers=1)
        alive = {}
        for layers, reselect in ((1, None), (1, 0.5), (3, 0.5)):
            found, _ = self.particles(replace(still, layers=layers, reselect=reselect))
            alive[layers, reselect] = len(np.unique(found, axis=0))
        assert alive[3, 0.5] < alive[1, 0.5] < alive[1, None] == 400


class TestBlocks:
    def after(self, layers: int, blocks: demc.Blocks) -> np.ndarray:
        """(N, D) bool: which components moved, from particles at rest."""
        config = demc.Config(particles=100, layers=layers, blocks=blocks, resampling="systematic")
        rng = np.random.default_rng(0)
        state = demc.init(rng, np.zeros(3), np.ones(3), config)
        before = state.particles
        state, _ = demc.step(rng, state, GaussianLikelihood(np.ones(3)), GaussianWalk(np.ones(3)), config)
        return state.particles != before

    def test_the_others_stay_in_that_layer(self) -> None:
        """Equal weights, selected systematically, are all kept in order; without noise they are the prediction."""
        moved = self.after(1, ((0, 2),))
        assert not moved[:, 1].any()
        assert (moved[:, 0] == moved[:, 2]).all() and moved[:, 0].any()

    def test_taken_in_turn(self) -> None:
        moved = self.after(2, ((0, 2), (1,)))
        assert moved.any(axis=0).all() and (moved[:, 0] != moved[:, 1]).any()
        moved = self.after(3, ((0,), (2,)))
        assert not moved[:, 1].any() and moved[:, [0, 2]].any(axis=0).all()

    def test_the_step_is_that_of_so_many_components(self) -> None:
        """(6.17) with the block's size for D: lambda is 2.38 (1 - c) for one component, 2.38 (1 - c) / sqrt 3 for all.

        With c = 0 and a likelihood that accepts everything, a move is lambda times a difference of two members.
        """
        for blocks, size in ((((0,),), 1), (None, 3)):
            config = demc.Config(particles=50, layers=1, blocks=blocks, c=0.0, resampling="systematic")
            rng = np.random.default_rng(0)
            state = demc.init(rng, np.zeros(3), np.ones(3), config)
            before = state.particles[:, 0]
            flat = GaussianLikelihood(np.zeros(3), 1e9)
            state, _ = demc.step(rng, state, flat, GaussianWalk(np.ones(3)), config)
            steps = (state.particles[:, 0] - before) / (2.38 / np.sqrt(size))
            differences = (before[:, None] - before).ravel()
            assert max(np.abs(differences - step).min() for step in steps) < 1e-12
            wrong = steps * np.sqrt(2.0)
            assert max(np.abs(differences - step).min() for step in wrong) > 1e-9

    @pytest.mark.parametrize("blocks", [((0, 3),), ((-1,),)])
    def test_components_that_there_are_not(self, blocks: demc.Blocks) -> None:
        with pytest.raises(InputError, match="blocks.*components 0 to 2"):
            self.after(1, blocks)


def test_working_settings_follow_a_motion_that_the_printed_ones_lose() -> None:
    """Predicted: copies have no differences, so c = .1 of sigma cannot follow one sigma a frame in 24 dimensions.

    Measured over six seeds, mean error of frames 6 to 20 in sigma: printed 11.1 (standard error .1), working .92 (.02).
    After the last frame of this one seed: 17.3 and .91; the bounds are half of the one and twice the other.
    """
    errors = {}
    for name, config in (("printed", demc.PRINTED), ("working", replace(demc.WORKING, sharpness=1.0))):
        rng = np.random.default_rng(0)
        state = demc.init(rng, np.zeros(24), np.ones(24), config)
        for frame in range(1, 21):
            likelihood = GaussianLikelihood(np.full(24, float(frame)), 0.5)
            state, _ = demc.step(rng, state, likelihood, GaussianWalk(np.ones(24)), config)
        errors[name] = np.abs(state.estimate - 20.0).mean()
    assert errors["working"] < 1.8 and errors["printed"] > 8.6, errors


@pytest.mark.parametrize(
    ("setting", "value"),
    [
        ("layers", -1),
        ("c", 1.1),
        ("jump", "cauchy"),
        ("adaptation", "magic"),
        ("crossover_rate", 2.0),
        ("partners", "none"),
        ("dynamics_noise", -0.1),
        ("reselect", 0.0),
        ("reselect", 1.0),
        ("blocks", ()),
        ("blocks", ((0,), ())),
    ],
)
def test_bad_settings(setting: str, value: object) -> None:
    with pytest.raises(InputError, match=setting):
        replace(demc.PRINTED, **{setting: value})
