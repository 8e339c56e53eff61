"""The shared length scale: an algebra that must give what the plain Gaussian process gives, output by output."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.regression.gaussian_process import (
    GaussianProcess,
    HyperParameters,
    log_marginal_likelihood,
    squared_distances,
)
from muybridge.regression.shared_scale import (
    SharedScaleProcess,
    Spectrum,
    fit_shared_scale,
    output_likelihood,
    scale_gradient,
)

SCALE = 0.3
HYPER = [HyperParameters(0.8, SCALE, 0.2, 0.05), HyperParameters(2.0, SCALE, 1e-3, 0.4),
         HyperParameters(0.1, SCALE, 3.0, 1e-3)]  # fmt: skip


def made(count=50, seed=0):
    rng = np.random.default_rng(seed)
    inputs = rng.normal(size=(count, 4))
    noise = rng.normal(size=(count, 3)) * [0.1, 0.5, 1.0]
    outputs = np.sin(inputs @ rng.normal(size=(4, 3))) + noise
    return inputs, (outputs - outputs.mean(0)) / outputs.std(0)


def test_likelihood_and_gradient_are_the_plain_ones():
    inputs, outputs = made()
    distances = squared_distances(inputs, inputs)
    spectrum = Spectrum.of(distances, SCALE)
    for hyper, output in zip(HYPER, outputs.T):
        expected, slope = log_marginal_likelihood(hyper.log, distances, output[:, None])
        value, gradient = output_likelihood(hyper.log[[0, 2, 3]], spectrum, spectrum.vectors.T @ output)
        # rounding: condition numbers up to 1e5 (noise 1e-3 under a signal with 50 examples)
        assert value == pytest.approx(expected, rel=1e-9)
        np.testing.assert_allclose(gradient, slope[[0, 2, 3]], rtol=1e-7, atol=1e-7)


def test_the_gradient_by_the_scale_is_the_sum_of_the_plain_ones():
    inputs, outputs = made()
    distances = squared_distances(inputs, inputs)
    spectrum = Spectrum.of(distances, SCALE)
    expected = sum(log_marginal_likelihood(h.log, distances, y[:, None])[1][1] for h, y in zip(HYPER, outputs.T))
    found = scale_gradient(distances, spectrum, spectrum.vectors.T @ outputs, HYPER)
    assert found == pytest.approx(expected, rel=1e-7)


def test_predictions_are_the_plain_ones():
    inputs, outputs = made()
    distances = squared_distances(inputs, inputs)
    together = SharedScaleProcess(distances, outputs, HYPER)
    for point in np.random.default_rng(3).normal(size=(5, 4)):
        near = squared_distances(point[None], inputs)[0]
        mean, variance = together.predict(near)
        alone = [GaussianProcess(distances, y[:, None], h).predict(near) for h, y in zip(HYPER, outputs.T)]
        np.testing.assert_allclose(mean, [m[0] for m, _ in alone], rtol=1e-7, atol=1e-8)
        np.testing.assert_allclose(variance, [v for _, v in alone], rtol=1e-6)


def total(distances, outputs, hyper):
    return sum(log_marginal_likelihood(h.log, distances, y[:, None])[0] for h, y in zip(hyper, outputs.T))


def test_the_fit_is_a_peak_and_beats_what_made_the_data():
    """Data drawn from Gaussian processes of one scale: the maximum is above the truth's likelihood, and it is flat."""
    rng = np.random.default_rng(5)
    inputs = rng.normal(size=(80, 3))
    distances = squared_distances(inputs, inputs)
    truth = [HyperParameters(1.0, 0.5, 0.1, noise) for noise in (0.01, 0.1, 1.0)]
    smooth = np.exp(-0.25 * distances)
    factors = [np.linalg.cholesky(h.signal * smooth + h.offset + h.noise * np.eye(80)) for h in truth]
    outputs = np.column_stack([factor @ rng.normal(size=80) for factor in factors])
    found = fit_shared_scale(distances, outputs)
    assert len({h.inverse_scale for h in found}) == 1
    best = total(distances, outputs, found)
    assert best > total(distances, outputs, truth)
    for factor in (0.9, 1.1):  # others held, so a lower bound of the fall on either side
        moved = [HyperParameters(h.signal, factor * h.inverse_scale, h.offset, h.noise) for h in found]
        assert total(distances, outputs, moved) < best
    # the noises differ a hundredfold; with 80 examples a log variance is known to about sqrt(2 / 80), 0.16, or, of the
    # smallest, which the smooth part hides, to a few times that: 4 and 2.5 deviations
    logs = np.log([h.noise for h in found])
    assert abs(logs[2]) < 0.64 and abs(logs[1] - np.log(0.1)) < 1.0


def test_the_scan_escapes_a_scale_at_which_all_is_noise():
    """Outputs so rough that at the first guess of the scale they look like noise: a search from there stands still."""
    rng = np.random.default_rng(0)
    inputs = rng.uniform(-1, 1, (200, 1))
    outputs = np.sin(9 * inputs + [[0.0, 1.0]])
    outputs = (outputs - outputs.mean(0)) / outputs.std(0)
    found = fit_shared_scale(squared_distances(inputs, inputs), outputs)
    assert max(h.noise for h in found) < 1e-3  # there is none in the data
