"""DE-MC: bootstrap as its limit, both readings of the adaptive sigma, and what the printed settings cannot do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from filters.oracles import GaussianLikelihood
from muybridge.errors import InputError
from muybridge.filters import GaussianWalk, condensation, demc


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
    ],
)
def test_bad_settings(setting: str, value: object) -> None:
    with pytest.raises(InputError, match=setting):
        replace(demc.PRINTED, **{setting: value})
