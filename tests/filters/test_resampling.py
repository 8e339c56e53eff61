"""Every scheme is unbiased, within the Monte-Carlo error of its counts; one that is not is caught by the same test."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from filters.oracles import agrees
from muybridge.errors import InputError
from muybridge.filters.particles import Weights
from muybridge.filters.resampling import RESAMPLING, _look_up, resample

WEIGHTS = Weights(np.log([0.31, 0.02, 0.17, 0.05, 0.33, 0.12]))
REPLICATES, COUNT = 4000, 10


def counts_of(scheme, seed: int = 1) -> np.ndarray:
    rng = np.random.default_rng(seed)
    draws = [np.bincount(scheme(rng, WEIGHTS, COUNT), minlength=len(WEIGHTS)) for _ in range(REPLICATES)]
    return np.array(draws)


@pytest.mark.parametrize("name", RESAMPLING)
def test_unbiased(name: str) -> None:
    """Expected copies are N w_i. The error is that of the mean of 4000 independent counts."""
    assert agrees(counts_of(RESAMPLING[name]), COUNT * WEIGHTS.values)


def test_a_comb_without_its_random_shift_is_caught() -> None:
    """Negative control: teeth in the middle of their strata, jittered a little, prefer some particles."""

    def biased(rng: np.random.Generator, weights: Weights, count: int) -> np.ndarray:
        return _look_up(weights.values, (np.arange(count) + rng.uniform(0.2, 0.7)) / count)

    assert not agrees(counts_of(biased), COUNT * WEIGHTS.values)


@pytest.mark.parametrize("name", ["systematic", "residual"])
def test_copies_differ_from_expectation_by_less_than(name: str) -> None:
    """Systematic: floor or ceiling of N w_i. Residual: at least the floor."""
    counts, expected = counts_of(RESAMPLING[name]), COUNT * WEIGHTS.values
    assert (counts >= np.floor(expected)).all()
    if name == "systematic":
        assert (counts <= np.ceil(expected)).all()


def test_added_variance_is_smaller_than_multinomial() -> None:
    """Stratified and residual never add more variance than multinomial (Douc et al., 2005), nor does the comb here.

    Ratio bound: the relative error of a variance from 4000 draws is sqrt(2 / 4000) = 2.2 %; six components and two
    schemes give less than 5 of it, 11 %.
    """
    reference = counts_of(RESAMPLING["multinomial"]).var(axis=0).sum()
    for name in ("stratified", "residual", "systematic"):
        assert counts_of(RESAMPLING[name]).var(axis=0).sum() < reference * 1.11


@pytest.mark.parametrize("name", RESAMPLING)
@given(log_weights=st.lists(st.floats(-800, 0) | st.just(-np.inf), min_size=1, max_size=30), count=st.integers(1, 60),
       seed=st.integers(0, 2**32))  # fmt: skip
def test_shape_range_and_no_impossible_particle(name: str, log_weights: list[float], count: int, seed: int) -> None:
    weights = Weights(log_weights)
    chosen = resample(np.random.default_rng(seed), weights, count, name)
    assert chosen.shape == (count,)
    assert ((chosen >= 0) & (chosen < len(weights))).all()
    assert (weights.values[chosen] > 0).all()


def test_edges_of_the_unit_interval() -> None:
    """Position 0 skips a first weight of zero; a position that rounding pushed to 1 still finds the last real one."""
    np.testing.assert_array_equal(_look_up(np.array([0.0, 1.0, 0.0]), np.array([0.0, 1.0])), [1, 1])


@pytest.mark.parametrize("name", RESAMPLING)
def test_equal_weights_keep_everybody_where_the_scheme_can(name: str) -> None:
    chosen = resample(np.random.default_rng(0), Weights(np.zeros(8)), 8, name)
    if name in ("stratified", "residual", "systematic"):
        np.testing.assert_array_equal(np.sort(chosen), np.arange(8))


def test_unknown_scheme() -> None:
    with pytest.raises(InputError, match="multinomial | systematic"):
        resample(np.random.default_rng(0), WEIGHTS, 3, "lottery")
