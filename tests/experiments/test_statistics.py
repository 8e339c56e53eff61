"""Intervals against closed forms, and whether they hold what they claim."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.experiments.statistics import block_interval, mean_interval, over_seeds, paired


def test_two_values_by_hand() -> None:
    """t_1(0.975) = 12.7062; s = sqrt(2), so the reach is 12.7062 sqrt(2) / sqrt(2)."""
    found = mean_interval([1.0, 3.0])
    assert found.mean == 2.0 and found.count == 2
    assert found.high - found.mean == pytest.approx(12.7062047)
    assert found.mean - found.low == pytest.approx(12.7062047)
    assert found.half_width == pytest.approx(12.7062047)


def test_against_scipy() -> None:
    from scipy.stats import ttest_1samp

    values = np.random.default_rng(3).normal(5, 2, 9)
    found, other = mean_interval(values), ttest_1samp(values, 0.0).confidence_interval(0.95)
    assert (found.low, found.high) == pytest.approx((other.low, other.high))


def test_unknown_values_are_left_out_and_one_value_has_no_interval() -> None:
    found = mean_interval([4.0, float("nan")])
    assert found.mean == 4.0 and found.count == 1 and np.isnan(found.low) and not found.excludes_zero
    assert np.isnan(mean_interval([]).mean)


def test_a_block_interval_against_the_bootstrap_variance_in_closed_form() -> None:
    """The mean of n / b blocks drawn from all n of the circle has the variance of a block's mean over n / b.

    A quantile at .975 of 2000 normal draws has a standard deviation of sqrt(.025 .975 / 2000) / .0584 = .06 of theirs,
    3 % of 1.96; four of them, with 50 blocks that are nearly normal. Values that are drawn alone are taken for
    independent: with a correlation of .9, sqrt(1.9 / .1) = 4.4 times less, of which 10 in a block keep some.
    """
    rng, block = np.random.default_rng(5), 10
    values = np.zeros(500)
    for at in range(1, len(values)):
        values[at] = 0.9 * values[at - 1] + rng.normal()
    circle = np.concatenate([values, values[: block - 1]])
    means = np.convolve(circle, np.full(block, 1 / block), "valid")
    expected = 1.96 * means.std() / np.sqrt(len(values) / block)
    found = block_interval(values, block)
    assert found.mean == pytest.approx(values.mean())
    assert found.half_width == pytest.approx(expected, rel=0.12)
    assert found.half_width > 2 * block_interval(values, 1).half_width
    assert block_interval(values, block) == found


def test_a_block_interval_needs_two_blocks() -> None:
    assert np.isnan(block_interval(np.arange(11.0), 6).low) and np.isfinite(block_interval(np.arange(12.0), 6).low)
    with pytest.raises(InputError, match="block"):
        block_interval([1.0, 2.0], 0)


def test_level() -> None:
    with pytest.raises(InputError, match="level"):
        mean_interval([1.0, 2.0], 1.0)


def coverage(rng: np.random.Generator, reach: float | None, repeats: int) -> float:
    """Share of intervals over five normal values that hold the mean; `reach` standard errors instead of Student's t."""
    held = 0
    for values in rng.normal(0, 1, (repeats, 5)):
        if reach is None:
            held += not mean_interval(values).excludes_zero
        else:
            held += abs(values.mean()) <= reach * values.std(ddof=1) / np.sqrt(5)
    return held / repeats


def test_coverage_is_what_is_claimed() -> None:
    """1000 repeats: the binomial's standard deviation at 0.95 is 0.0069, so 4 of them are 0.028.

    Negative control: 1.96 standard errors over five values hold the mean in P(|t_4| <= 1.96) = 0.878 of cases, ten
    standard deviations below.
    """
    bound = 4 * np.sqrt(0.95 * 0.05 / 1000)
    assert abs(coverage(np.random.default_rng(1), None, 1000) - 0.95) <= bound
    assert abs(coverage(np.random.default_rng(1), 1.96, 1000) - 0.95) > bound


def test_clips_of_a_seed_are_averaged_first() -> None:
    """Seeds 0 and 1 have means 2 and 5, however many clips each has."""
    values = {(0, "a"): 1.0, (0, "b"): 3.0, (1, "a"): 5.0, (1, "b"): float("nan")}
    found = over_seeds(values)
    assert found.mean == 3.5 and found.count == 2


def test_pairs_cancel_what_scenes_share() -> None:
    """Scenes differ by hundreds, the filters by 5 to 6: paired, the difference is plain; unpaired, it is not.

    Differences by seed are 5, 6, 5, 6: mean 5.5, s = 0.577, reach 3.1824 x 0.577 / 2 = 0.919.
    """
    scenes = {0: 20.0, 1: 400.0, 2: 90.0, 3: 700.0}
    first = {(seed, "walk"): level + 5 + seed % 2 for seed, level in scenes.items()}
    second = {(seed, "walk"): level for seed, level in scenes.items()} | {(9, "walk"): 1e6}
    found = paired(first, second)
    assert found.mean == pytest.approx(5.5) and found.half_width == pytest.approx(0.9187, abs=1e-3)
    assert found.excludes_zero and found.count == 4
    apart = mean_interval(list(first.values())).low - over_seeds(second).high
    assert apart < 0
