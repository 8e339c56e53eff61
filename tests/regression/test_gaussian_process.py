"""Gaussian processes: the likelihood, mean and variance of scikit-learn's, gradients by finite differences."""

from __future__ import annotations

import numpy as np
import pytest
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

from muybridge.regression.gaussian_process import (
    BOUNDS,
    GaussianProcess,
    HyperParameters,
    covariance,
    fit_hyper_parameters,
    log_marginal_likelihood,
    squared_distances,
)

HYPER = HyperParameters(signal=0.8, inverse_scale=0.3, offset=0.2, noise=0.05)


def made(count=40, outputs=3, seed=0):
    """Inputs (N, 4) and standardised outputs (N, Q) that follow them smoothly, with noise of a fifth."""
    rng = np.random.default_rng(seed)
    inputs = rng.normal(size=(count, 4))
    values = np.sin(inputs @ rng.normal(size=(4, outputs))) + 0.2 * rng.normal(size=(count, outputs))
    return inputs, (values - values.mean(0)) / values.std(0)


def scikit_kernel(hyper):
    smooth = ConstantKernel(hyper.signal) * RBF(hyper.inverse_scale**-0.5)
    return smooth + ConstantKernel(hyper.offset) + WhiteKernel(hyper.noise)


def scikit(hyper, inputs, output):
    return GaussianProcessRegressor(scikit_kernel(hyper), alpha=0.0, optimizer=None).fit(inputs, output)


def test_squared_distances_are_those_of_the_definition():
    a, b = np.random.default_rng(0).normal(size=(2, 7, 3))
    np.testing.assert_allclose(squared_distances(a, b), np.sum((a[:, None] - b) ** 2, axis=2), atol=1e-13)
    assert squared_distances(a, a).min() >= 0


def test_covariance_likelihood_mean_and_variance_are_scikit_learns():
    inputs, outputs = made()
    distances = squared_distances(inputs, inputs)
    np.testing.assert_allclose(covariance(distances, HYPER), scikit_kernel(HYPER)(inputs), atol=1e-13)
    peers = [scikit(HYPER, inputs, output) for output in outputs.T]
    value, _ = log_marginal_likelihood(HYPER.log, distances, outputs)
    # conditioning: noise .05 against eigenvalues up to about 30, so 600 times 1e-16 of rounding, and sums of 40 terms
    assert value == pytest.approx(sum(peer.log_marginal_likelihood_value_ for peer in peers), rel=1e-10)
    new = np.random.default_rng(9).normal(size=(5, 4))
    process = GaussianProcess(distances, outputs, HYPER)
    for point in new:
        mean, variance = process.predict(squared_distances(point[None], inputs)[0])
        expected = [peer.predict(point[None], return_std=True) for peer in peers]
        np.testing.assert_allclose(mean, [m[0] for m, _ in expected], atol=1e-10)
        assert variance == pytest.approx(expected[0][1][0] ** 2, rel=1e-9)


@pytest.mark.parametrize("outputs", [1, 3])
@pytest.mark.parametrize("seed", range(3))
def test_the_gradient_is_that_of_finite_differences(outputs, seed):
    inputs, values = made(outputs=outputs, seed=seed)
    distances = squared_distances(inputs, inputs)
    log = np.random.default_rng(seed).uniform(-2, 0.5, 4)
    _, gradient = log_marginal_likelihood(log, distances, values)
    # central differences of step 1e-5: truncation 1e-10 of third derivatives below 1e3, rounding 1e-13 / 1e-5
    numeric = [
        (
            log_marginal_likelihood(log + step, distances, values)[0]
            - log_marginal_likelihood(log - step, distances, values)[0]
        )
        / 2e-5
        for step in 1e-5 * np.eye(4)
    ]
    np.testing.assert_allclose(gradient, numeric, rtol=1e-5, atol=1e-5)


def test_the_maximum_is_no_lower_than_scikit_learns():
    """Both climb from the same start; the same peak, or a better one, to what their stopping rules leave (1e-3)."""
    inputs, outputs = made(60, 1)
    distances = squared_distances(inputs, inputs)
    found = fit_hyper_parameters(distances, outputs)
    value, gradient = log_marginal_likelihood(found.log, distances, outputs)
    start = HyperParameters(1.0, 1.0 / np.median(distances[distances > 0]), 0.1, 0.1)
    peer = GaussianProcessRegressor(scikit_kernel(start), alpha=0.0).fit(inputs, outputs[:, 0])
    assert value >= peer.log_marginal_likelihood_value_ - 1e-3
    inside = [low + 1e-6 < x < high - 1e-6 for x, (low, high) in zip(found.log, BOUNDS)]
    inside[1] = True  # its bounds are relative to the start
    assert np.abs(gradient[inside]).max() < 0.05  # a peak: 1e-4 of what it is at the start
    assert np.abs(log_marginal_likelihood(start.log, distances, outputs)[1]).max() > 1


def test_frames_that_occur_twice_do_no_harm():
    inputs, outputs = made(30, 2)
    twice, doubled = np.repeat(inputs, 3, axis=0), np.repeat(outputs, 3, axis=0)
    distances = squared_distances(twice, twice)
    hyper = fit_hyper_parameters(distances, doubled)
    mean, variance = GaussianProcess(distances, doubled, hyper).predict(distances[0])
    assert np.isfinite(mean).all() and variance >= hyper.noise
    least = HyperParameters(1e2, hyper.inverse_scale, 10.0, 1e-6)  # the worst that the bounds allow
    mean, variance = GaussianProcess(distances, doubled, least).predict(distances[0])
    assert np.isfinite(mean).all() and variance >= 1e-6


def test_inputs_that_are_all_alike_have_hyper_parameters_too():
    hyper = fit_hyper_parameters(np.zeros((12, 12)), made(12, 1)[1])
    assert all(np.isfinite(hyper.log))
