"""The annealing schedule reaches the survival rate it is asked for, whenever that can be reached."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from muybridge.filters.particles import Weights
from muybridge.filters.schedule import TOLERANCE, exponent_for_survival, powered


@given(st.integers(0, 2**32), st.floats(0.05, 0.95), st.floats(-3, 6), st.floats(0, 0.04))
def test_reaches_survival(seed: int, survival: float, magnitude: float, impossible: float) -> None:
    """Distinct likelihoods at any scale, a few impossible: the rate is met to the tolerance of the bisection."""
    rng = np.random.default_rng(seed)
    log_likelihoods = 10.0**magnitude * rng.standard_normal(200)
    log_likelihoods[rng.random(200) < impossible / 2] = -np.inf
    if np.isfinite(log_likelihoods).mean() <= survival:
        return
    exponent = exponent_for_survival(log_likelihoods, survival)
    assert Weights(powered(log_likelihoods, exponent)).survival_rate == pytest.approx(survival, rel=1.01 * TOLERANCE)


def test_lower_survival_is_a_higher_exponent() -> None:
    log_likelihoods = np.random.default_rng(0).standard_normal(500)
    exponents = [exponent_for_survival(log_likelihoods, rate) for rate in (0.9, 0.5, 0.25, 0.1, 0.03)]
    assert exponents == sorted(exponents) and exponents[0] < exponents[-1]


class TestLimits:
    def test_highest_is_kept(self) -> None:
        log_likelihoods = np.random.default_rng(0).standard_normal(500)
        assert exponent_for_survival(log_likelihoods, 0.1, highest=1e-3) == 1e-3

    def test_equal_likelihoods_and_none(self) -> None:
        assert exponent_for_survival(np.full(9, -3.0), 0.5) == 1.0
        assert exponent_for_survival(np.full(9, -np.inf), 0.5) == 1.0

    def test_too_few_possible(self) -> None:
        assert exponent_for_survival(np.array([0.0, -1.0] + [-np.inf] * 8), 0.5) == 0.0

    def test_ties_at_the_top_that_no_exponent_can_split(self) -> None:
        exponent = exponent_for_survival(np.array([0.0] * 8 + [-1.0, -2.0]), 0.5)
        assert np.isfinite(exponent) and Weights(exponent * np.array([0.0] * 8 + [-1, -2])).survival_rate >= 0.5

    def test_power_zero_of_the_impossible_is_impossible(self) -> None:
        np.testing.assert_array_equal(powered(np.array([-5.0, -np.inf]), 0.0), [0.0, -np.inf])
