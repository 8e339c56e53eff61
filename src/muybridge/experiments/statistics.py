"""Means with intervals over seeds, paired differences, and means within one clip.

The unit is the seed: it decides scene, noise and the tracker's draws, so that seeds are independent and frames, people
and motions inside one are not. Trials of one seed are averaged first; the interval is Student's t over those averages.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from muybridge.errors import InputError

LEVEL = 0.95
RESAMPLES = 2000
"""A bound of an interval then moves by a tenth of its distance from the mean, or less."""


@dataclass(frozen=True)
class Interval:
    """A mean with its confidence interval; low and high are NaN where there is only one value."""

    mean: float
    low: float
    high: float
    count: int

    @property
    def excludes_zero(self) -> bool:
        """Whether the whole interval lies on one side of 0."""
        return bool(self.low > 0 or self.high < 0)

    @property
    def half_width(self) -> float:
        """Half of the interval's length."""
        return 0.5 * (self.high - self.low)


def mean_interval(values: Sequence[float] | np.ndarray, level: float = LEVEL) -> Interval:
    """Mean and two-sided t interval of independent values (n,); NaN are left out.

    Notes
    -----
    mean +- t_{n-1, (1 + level) / 2} s / sqrt(n), s with n - 1 in its denominator: exact for normal values.
    """
    from scipy.stats import t

    if not 0 < level < 1:
        raise InputError("interval: level", expected="between 0 and 1", got=str(level))
    known = np.asarray(values, dtype=np.float64)
    known = known[np.isfinite(known)]
    nan = float("nan")
    if not len(known):
        return Interval(nan, nan, nan, 0)
    mean = float(known.mean())
    if len(known) == 1:
        return Interval(mean, nan, nan, 1)
    reach = float(t.ppf(0.5 + 0.5 * level, len(known) - 1) * known.std(ddof=1) / np.sqrt(len(known)))
    return Interval(mean, mean - reach, mean + reach, len(known))


def block_interval(values: Sequence[float] | np.ndarray, block: int, level: float = LEVEL) -> Interval:
    """Mean and two-sided interval of values (n,) of one clip, in the order of time, neighbours of which are alike.

    Parameters
    ----------
    block : values that are drawn together, so many that those further apart are nearly independent

    Notes
    -----
    The circular block bootstrap of Politis and Romano (1992): quantiles of the means of `RESAMPLES` clips made of
    stretches drawn with replacement, the clip's end joined to its beginning. The same values have the same interval.
    """
    if block < 1:
        raise InputError("interval: block", expected="at least 1 value", got=str(block))
    known = np.asarray(values, dtype=np.float64)
    count = len(known)
    if count < 2 * block:
        mean = float(known.mean()) if count else float("nan")
        return Interval(mean, float("nan"), float("nan"), count)
    starts = np.random.default_rng(0).integers(count, size=(RESAMPLES, -(-count // block)))
    drawn = (starts[..., None] + np.arange(block)).reshape(RESAMPLES, -1)[:, :count] % count
    low, high = np.quantile(known[drawn].mean(axis=1), [0.5 - 0.5 * level, 0.5 + 0.5 * level])
    return Interval(float(known.mean()), float(low), float(high), count)


def over_seeds(values: Mapping[tuple[int, str], float], level: float = LEVEL) -> Interval:
    """Interval over seeds of values by (seed, clip): the clips of a seed are averaged first.

    Examples
    --------
    >>> over_seeds({(0, "walk"): 1.0, (0, "wave"): 3.0, (1, "walk"): 4.0, (1, "wave"): 4.0}).mean
    3.0
    """
    return mean_interval(list(_by_seed(values).values()), level)


def paired(
    first: Mapping[tuple[int, str], float], second: Mapping[tuple[int, str], float], level: float = LEVEL
) -> Interval:
    """Interval of first - second over the (seed, clip) that both have: what the scenes share cancels."""
    shared = first.keys() & second.keys()
    return over_seeds({key: first[key] - second[key] for key in sorted(shared)}, level)


def _by_seed(values: Mapping[tuple[int, str], float]) -> dict[int, float]:
    seeds: dict[int, list[float]] = {}
    for (seed, _), value in values.items():
        if np.isfinite(value):
            seeds.setdefault(seed, []).append(value)
    return {seed: float(np.mean(found)) for seed, found in seeds.items()}
