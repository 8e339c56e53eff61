"""The annealing schedule: which power of the likelihood leaves a wanted share of the particles alive."""

from __future__ import annotations

import numpy as np

from muybridge.filters.particles import FloatArray

TOLERANCE = 1e-3  # of the survival rate: a tenth of a particle in a hundred
DOUBLINGS = 60
BISECTIONS = 60


def exponent_for_survival(log_likelihoods: FloatArray, survival: float, highest: float = np.inf) -> float:
    """The exponent beta at which the weights exp(beta log_likelihoods) have the wanted survival rate.

    The survival rate 1 / (N sum w^2) falls as beta rises (its logarithm's derivative is twice a difference of tempered
    means of the log likelihood, which rise with the power), so doubling brackets and bisection finds.

    Parameters
    ----------
    log_likelihoods : (N,) float64
        -inf counts as dead at every exponent.
    survival : float
        Wanted effective fraction, between 0 and 1.
    highest : float
        Upper bound of the exponent; returned where even that leaves more alive than wanted.

    Returns
    -------
    float
        0 where the impossible particles alone already push survival below the wanted share; 1 (or `highest`, if that is
        less) where all possible particles are equal, so that no exponent makes a difference.
    """
    possible = log_likelihoods[log_likelihoods > -np.inf]
    if possible.size == 0:
        return min(1.0, highest)
    range_ = float(possible.max() - possible.min())
    if range_ == 0.0:
        return min(1.0, highest)
    if possible.size <= survival * log_likelihoods.size:
        return 0.0
    alive = possible - possible.max()
    wanted = survival * log_likelihoods.size / possible.size
    low, high = 0.0, min(1.0 / range_, highest)
    for _ in range(DOUBLINGS):
        if high >= highest or _survival_rate(alive, high) < wanted:
            break
        low, high = high, min(2.0 * high, highest)
    if _survival_rate(alive, high) >= wanted:
        return high
    return _bisect(alive, wanted, low, high)


def _bisect(alive: FloatArray, wanted: float, low: float, high: float) -> float:
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        rate = _survival_rate(alive, middle)
        if abs(rate - wanted) < TOLERANCE * wanted:
            return middle
        low, high = (middle, high) if rate > wanted else (low, middle)
    return 0.5 * (low + high)


def _survival_rate(alive: FloatArray, exponent: float) -> float:
    """1 / (N sum w^2) of the weights exp(exponent alive), whose largest is 1; without a `Weights`, for speed."""
    weights = np.exp(exponent * alive)
    return float(weights.sum() ** 2 / (np.sum(weights**2) * weights.size))


def powered(log_likelihoods: FloatArray, exponent: float) -> FloatArray:
    """(N,) float64 log of likelihood ** exponent, where the impossible stays impossible at an exponent of zero too."""
    possible = log_likelihoods > -np.inf
    return np.where(possible, exponent * np.where(possible, log_likelihoods, 0.0), -np.inf)
