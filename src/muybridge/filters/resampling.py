"""Selection: N indices drawn so that particle i is expected N w_i times.

All four schemes are unbiased; they differ in the variance they add, multinomial most, systematic as a rule
least. Each takes `(rng, weights, count)` and returns `(count,)` indices; `RESAMPLING` names them.

References: multinomial, Du (2005), section 3.5, (3.26)-(3.27); the others as compared in Douc, Cappe and
Moulines, "Comparison of resampling schemes for particle filtering", 2005.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray, Weights

Indices = NDArray[np.intp]
BELOW_ONE = np.nextafter(1.0, 0.0)


def multinomial(rng: np.random.Generator, weights: Weights, count: int) -> Indices:
    """Independent draws by binary search in the cumulative weights, (3.26)-(3.27)."""
    return _look_up(weights.values, rng.random(count))


def systematic(rng: np.random.Generator, weights: Weights, count: int) -> Indices:
    """One uniform number shifts a comb of `count` equally spaced teeth."""
    return _look_up(weights.values, (np.arange(count) + rng.random()) / count)


def stratified(rng: np.random.Generator, weights: Weights, count: int) -> Indices:
    """One uniform number in each of `count` equal strata."""
    return _look_up(weights.values, (np.arange(count) + rng.random(count)) / count)


def residual(rng: np.random.Generator, weights: Weights, count: int) -> Indices:
    """floor(count w_i) copies for certain; what is left over is drawn multinomially from the remainders."""
    expected = count * weights.values
    certain = np.floor(expected).astype(np.intp)
    copies = np.repeat(np.arange(len(weights)), certain)
    missing = count - copies.size
    if missing <= 0:  # rounding may floor an expected number upwards by one unit in the last place
        return copies[:count]
    remainders = expected - certain
    if not remainders.any():  # the other way round: integers to the last place but one copy short
        remainders = expected
    return np.concatenate((copies, _look_up(remainders / remainders.sum(), rng.random(missing))))


def _look_up(probabilities: FloatArray, positions: FloatArray) -> Indices:
    """Index of the interval of the cumulative probabilities that holds each position in [0, 1).

    The side is chosen so that weight zero is never selected, not even at position zero.
    """
    cumulative = np.cumsum(probabilities)
    cumulative /= cumulative[-1]
    return np.searchsorted(cumulative, np.minimum(positions, BELOW_ONE), side="right")


Resampler = Callable[[np.random.Generator, Weights, int], Indices]
RESAMPLING: dict[str, Resampler] = {
    "multinomial": multinomial,
    "systematic": systematic,
    "stratified": stratified,
    "residual": residual,
}


def resample(rng: np.random.Generator, weights: Weights, count: int, scheme: str) -> Indices:
    """Select `count` indices by the named scheme. Returns (count,) int."""
    if scheme not in RESAMPLING:
        raise InputError("resampling", expected=" | ".join(RESAMPLING), got=repr(scheme))
    return RESAMPLING[scheme](rng, weights, count)
