"""Calibration: lambda found again in made guesses, and variances that are true or not."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.regression.calibration import LEVELS, calibrate_lambda, fit_trusted_variance
from muybridge.regression.components import PoseComponents
from muybridge.regression.mixture import PoseMixture

COMPONENTS = PoseComponents(tuple("abcde"))


@dataclass(frozen=True)
class Oracle:
    """A regressor whose descriptor is its answer: the mean, then the variance of all components."""

    components: PoseComponents = COMPONENTS

    def predict(self, descriptor):
        return PoseMixture(self.components, np.ones(1), descriptor[None, :5], np.full((1, 5), descriptor[5]))


@pytest.mark.parametrize("truth", [0.003, 0.02, 0.3])
def test_lambda_is_found_again(truth):
    """Good with probability exp(-s / lambda). The information on log lambda of one guess of exponent u = s / lambda is
    u^2 e^-u / (1 - e^-u); its mean over u uniform in 0 to 3 is 0.57, so 2000 guesses leave a deviation of .03."""
    rng = np.random.default_rng(0)
    predicted = truth * rng.uniform(0, 3, 2000)
    good = rng.random(2000) < np.exp(-predicted / truth)
    found = fit_trusted_variance(predicted, good)
    assert abs(np.log(found / truth)) < 4 * 0.03
    assert abs(np.mean(np.exp(-predicted / found)) - good.mean()) < 0.02  # and alpha is the share of good guesses


def test_nothing_good_and_nothing_bad():
    predicted = np.full(50, 0.01)
    assert np.exp(-0.01 / fit_trusted_variance(predicted, np.zeros(50, bool))) < 1e-3
    assert np.exp(-0.01 / fit_trusted_variance(predicted, np.ones(50, bool))) > 0.99


def guesses(rng, count, too_sure=1.0):
    """Descriptors for the oracle and truths; claimed variances are too small by `too_sure` squared."""
    variances = rng.uniform(0.001, 0.05, count)
    means = rng.normal(size=(count, 5))
    poses = means + too_sure * np.sqrt(variances)[:, None] * rng.normal(size=(count, 5))
    return np.column_stack([means, variances]), poses


@pytest.mark.parametrize("too_sure", [1.0, 2.0])
def test_variances_that_are_true_and_that_are_not(too_sure):
    """5000 squared normal ratios: the scale is known to 1 / sqrt(2 * 5000) = .7 %, shares to .7 points."""
    found = calibrate_lambda(Oracle(), *guesses(np.random.default_rng(0), 1000, too_sure))
    assert found.scale == pytest.approx(too_sure, rel=0.04)
    if too_sure == 1.0:
        np.testing.assert_allclose(found.coverage, LEVELS, atol=4 * 0.007)
    else:
        assert found.coverage[2] < 0.75  # the negative control: P(|z| < 0.98) = .67
    assert found.rank_correlation > 0.5  # 5 squares say little of one variance, but of 1000 together
    assert f"multiplied by {found.scale:.2f}" in found.describe()
    np.testing.assert_array_equal(found.good, found.realised <= 0.04)


def test_held_out_frames_that_cannot_be_used():
    descriptors, poses = guesses(np.random.default_rng(0), 10)
    for arguments in ((descriptors[:5], poses), (descriptors[:1], poses[:1]), (descriptors, poses, 0.0)):
        with pytest.raises(InputError, match="held-out frames"):
            calibrate_lambda(Oracle(), *arguments)
