"""Weights are normalised once, cannot be changed, and survive every kind of log weight."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from muybridge.errors import InputError
from muybridge.filters.particles import Weights, covariance, maximum_estimate, mean_estimate, standard_deviation

LOG_WEIGHTS = st.lists(st.floats(-1e4, 1e4), min_size=1, max_size=40)


class TestWeights:
    @given(LOG_WEIGHTS, st.floats(-1e4, 1e4))
    def test_sum_to_one_and_ignore_a_common_constant(self, log_weights: list[float], constant: float) -> None:
        weights = Weights(log_weights)
        assert weights.values.sum() == pytest.approx(1.0, abs=1e-12)
        # adding c in float64 rounds a log weight by up to eps * 2e4 = 4.4e-12, hence a weight relatively by twice that
        np.testing.assert_allclose(weights.values, Weights(np.array(log_weights) + constant).values, atol=1e-11)
        assert 1.0 - 1e-9 <= weights.ess <= len(log_weights) * (1 + 1e-9)

    def test_ess_of_equal_and_of_single(self) -> None:
        assert Weights(np.zeros(7)).ess == pytest.approx(7.0)
        assert Weights([0.0, -np.inf, -np.inf]).ess == pytest.approx(1.0)
        assert Weights(np.zeros(7)).survival_rate == pytest.approx(1.0)

    def test_nan_counts_as_impossible(self) -> None:
        np.testing.assert_array_equal(Weights([0.0, np.nan]).values, [1.0, 0.0])

    @pytest.mark.parametrize("nothing", [-np.inf, np.nan])
    def test_collapse_is_a_status_with_uniform_weights(self, nothing: float) -> None:
        weights = Weights([nothing] * 4)
        assert weights.collapsed and weights.ess == 0.0
        np.testing.assert_allclose(weights.values, 0.25)

    def test_immutable_and_detached_from_its_source(self) -> None:
        source = np.zeros(3)
        weights = Weights(source)
        source[0] = 5.0
        np.testing.assert_allclose(weights.values, 1 / 3)
        for array in (weights.log, weights.values):
            with pytest.raises(ValueError, match="read-only"):
                array[0] = 1.0

    @pytest.mark.parametrize("bad", [np.zeros((2, 2)), [], [0.0, np.inf]])
    def test_bad_input(self, bad: object) -> None:
        with pytest.raises(InputError, match="log weights"):
            Weights(bad)


class TestEstimates:
    def test_against_numpy(self) -> None:
        rng = np.random.default_rng(0)
        particles, raw = rng.normal(size=(50, 3)), rng.random(50)
        weights = Weights(np.log(raw))
        expected = np.cov(particles.T, aweights=raw, ddof=0)
        # 50 terms of order 1: rounding below 50 eps = 1.1e-14
        np.testing.assert_allclose(mean_estimate(particles, weights), np.average(particles, 0, raw), atol=1e-13)
        np.testing.assert_allclose(covariance(particles, weights), expected, atol=1e-13)
        np.testing.assert_allclose(standard_deviation(particles, weights), np.sqrt(np.diag(expected)), atol=1e-13)

    def test_maximum_is_a_copy_of_the_first_best(self) -> None:
        particles = np.arange(6.0).reshape(3, 2)
        best = maximum_estimate(particles, Weights([0.0, 1.0, 1.0]))
        np.testing.assert_array_equal(best, particles[1])
        best[0] = -1
        assert particles[1, 0] == 2.0
