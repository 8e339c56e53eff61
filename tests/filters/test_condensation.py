"""CONDENSATION: what its few lines say, and what a sharper likelihood does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from filters.oracles import GaussianLikelihood
from muybridge.filters import ConstantVelocity, GaussianWalk, Weights, condensation

START = np.zeros(2)


def test_maximum_is_the_particle_of_largest_weight() -> None:
    """(3.24), with the log likelihood of just that particle in Info, at no further evaluation."""
    likelihood, rng = GaussianLikelihood(np.ones(2)), np.random.default_rng(0)
    state = condensation.init(rng, START, np.ones(2), condensation.PRINTED)
    state, info = condensation.step(rng, state, likelihood, GaussianWalk(np.ones(2)), condensation.PRINTED)
    best = likelihood.log_prob(state.particles)
    np.testing.assert_array_equal(state.estimate, state.particles[np.argmax(best)])
    assert info.log_likelihood == best.max() and info.evaluations == condensation.PRINTED.particles


def test_velocity_is_the_change_of_the_estimate_and_is_used() -> None:
    """(6.19) then (6.16): a motion of one unit a frame is followed with noise far too small to follow it otherwise."""
    config = condensation.Config(particles=400, estimate="mean", resampling="systematic")
    errors = {}
    for gain in (0.0, 1.0):
        rng, dynamics = np.random.default_rng(1), ConstantVelocity(np.full(2, 0.1), gain=gain)
        state = condensation.init(rng, START, np.full(2, 0.5), config)
        for frame in range(1, 30):
            before = state.estimate
            state, _ = condensation.step(rng, state, GaussianLikelihood(np.full(2, frame / 2), 0.2), dynamics, config)
            np.testing.assert_array_equal(state.velocity, state.estimate - before)
        errors[gain] = np.abs(state.estimate - 14.5).max()
    assert errors[1.0] < 0.5 < 2.0 < errors[0.0]


def test_sharpness_is_a_power_of_the_likelihood() -> None:
    """K = 4 on sd 1 is sd 1/2: the same weights from the same random numbers, up to rounding of a product by 4."""
    config = condensation.Config(particles=200, sharpness=4.0)
    states = []
    for likelihood, setting in (
        (GaussianLikelihood(np.ones(2), 1.0), config),
        (GaussianLikelihood(np.ones(2), 0.5), replace(config, sharpness=1.0)),
    ):
        rng = np.random.default_rng(2)
        state = condensation.init(rng, START, np.ones(2), setting)
        states.append(condensation.step(rng, state, likelihood, GaussianWalk(np.ones(2)), setting)[0])
    np.testing.assert_allclose(states[0].log_weights, states[1].log_weights, rtol=1e-12)
    assert Weights(states[0].log_weights).ess < 200


def test_number_of_particles_may_change_between_frames() -> None:
    rng, likelihood = np.random.default_rng(0), GaussianLikelihood(np.ones(2))
    state = condensation.init(rng, START, np.ones(2), condensation.Config(particles=50))
    state, _ = condensation.step(rng, state, likelihood, GaussianWalk(np.ones(2)), condensation.Config(particles=80))
    assert state.particles.shape == (80, 2) and state.log_weights.shape == (80,)
