"""Filters that claim a posterior, on a linear-Gaussian model, against the Kalman filter that knows the answer.

Mean and variance of the last of five frames, in two dimensions, over 60 independent runs on the same observations. The
error is that of the mean over the runs; a particle filter's own bias is of order 1 / N, at N = 1000 a tenth of it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from filters.oracles import GaussianLikelihood, Kalman, agrees
from muybridge.filters import GaussianWalk, Weights, annealed, condensation, demc, standard_deviation, tempered

WALK_SD, SD, START_SD = 0.7, 0.5, 1.0
RUNS, FRAMES = 60, 5

COMMON = {"particles": 1000, "estimate": "mean", "resampling": "systematic", "sharpness": 1.0}
CONDENSATION = condensation.Config(**COMMON)
TEMPERED = tempered.Config(**COMMON, layers=3, survival=0.5)
CASES = {
    "condensation": (condensation, CONDENSATION),
    "condensation, multinomial": (condensation, replace(CONDENSATION, resampling="multinomial")),
    "condensation, residual": (condensation, replace(CONDENSATION, resampling="residual")),
    "condensation, stratified": (condensation, replace(CONDENSATION, resampling="stratified")),
    "annealed, one layer": (annealed, annealed.Config(**COMMON, layers=1, exponents=(1.0,))),
    "demc, no moves": (demc, demc.Config(**COMMON, layers=0, dynamics_noise=1.0)),
    "tempered": (tempered, TEMPERED),
}


def observations() -> np.ndarray:
    rng = np.random.default_rng(42)
    truth = np.cumsum(WALK_SD * rng.standard_normal((FRAMES, 2)), axis=0)
    return truth + SD * rng.standard_normal((FRAMES, 2))


def kalman(sd: float = SD) -> np.ndarray:
    """(4,) mean and variance of both components after the last frame."""
    filter_ = Kalman(np.zeros(2), np.full(2, START_SD**2))
    for observation in observations():
        filter_ = filter_.step(observation, WALK_SD, sd)
    return np.concatenate((filter_.mean, filter_.variance))


def run(module, config) -> np.ndarray:
    """(RUNS, 4) the same from the particles."""
    dynamics, rows = GaussianWalk(np.full(2, WALK_SD)), []
    for rng in np.random.default_rng(7).spawn(RUNS):
        state = module.init(rng, np.zeros(2), np.full(2, START_SD), config)
        for observation in observations():
            state, _ = module.step(rng, state, GaussianLikelihood(observation, SD), dynamics, config)
        spread = standard_deviation(state.particles, Weights(state.log_weights))
        rows.append(np.concatenate((state.estimate, spread**2)))
    return np.array(rows)


@pytest.mark.parametrize("case", CASES)
def test_posterior(case: str) -> None:
    assert agrees(run(*CASES[case]), kalman())


def test_wrong_observation_noise_is_caught() -> None:
    """Negative control: a Kalman filter that believes in 5 % more noise."""
    assert not agrees(run(condensation, CONDENSATION), kalman(1.05 * SD))


@pytest.mark.parametrize(
    ("module", "config"),
    [
        (tempered, replace(TEMPERED, keep_prior=False)),  # moves that forget where the particle came from
        (annealed, annealed.Config(**COMMON, layers=3)),  # a search by design, and said so
        (demc, demc.Config(**COMMON, layers=3, dynamics_noise=1.0)),
    ],
)
def test_searches_are_told_from_posteriors(module, config) -> None:
    """Negative control: what is documented not to be a posterior must not pass for one."""
    assert not agrees(run(module, config), kalman())


class TwoPeaks:
    """Likelihood with peaks at -2 and 2 of sd .2; the right one three times as high."""

    def log_prob(self, poses: np.ndarray) -> np.ndarray:
        x = poses[:, 0]
        return np.logaddexp(-0.5 * ((x + 2) / 0.2) ** 2, np.log(3.0) - 0.5 * ((x - 2) / 0.2) ** 2)


@pytest.mark.parametrize("case", ["condensation", "tempered", "annealed, one layer"])
def test_both_modes_with_their_shares(case: str) -> None:
    """One frame from N(.5, 1.5^2): the share right of zero in closed form.

    Product of normals: each peak weighs height x N(peak; .5, 1.5^2 + .2^2); what either peak leaks over zero, ten
    sigma away, is below 1e-22.
    """
    module, config = CASES[case]
    shares = []
    for rng in np.random.default_rng(3).spawn(150):
        state = module.init(rng, np.array([0.5]), np.zeros(1), config)
        state, _ = module.step(rng, state, TwoPeaks(), GaussianWalk(np.array([1.5])), config)
        shares.append(Weights(state.log_weights).values @ (state.particles[:, 0] > 0))
    left, right = (height * np.exp(-0.5 * (peak - 0.5) ** 2 / 2.29) for height, peak in ((1, -2), (3, 2)))
    assert agrees(np.array(shares), right / (left + right))
    assert not agrees(np.array(shares), 0.75)  # negative control: the prior forgotten
