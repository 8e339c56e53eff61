"""Weighted particles: the weights as a value, and what is read off a weighted set.

Everything here takes `particles (N, D)` and `weights`, knows nothing of where they come from, and changes
neither.

Sums over particles are written with einsum and sum, not with @ and dot: BLAS adds in another order when it has
another number of threads, and results may not depend on that.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from muybridge.errors import InputError

FloatArray = NDArray[np.float64]


class Weights:
    """Normalised weights, kept as logarithms; an immutable value.

    Parameters
    ----------
    log_weights : (N,) float64
        Logarithms of the weights up to a common constant. -inf is weight zero; NaN counts as -inf.

    Attributes
    ----------
    log : (N,) float64, read-only
        Normalised: `exp(log).sum() == 1`.
    collapsed : bool
        No weight was above zero. `log` is then uniform, so that selecting from it is safe, and `ess` is zero.

    Examples
    --------
    >>> import numpy as np
    >>> weights = Weights(np.log([1.0, 1.0, 2.0]))
    >>> weights.values
    array([0.25, 0.25, 0.5 ])
    >>> round(weights.ess, 3)
    2.667
    """

    log: FloatArray
    collapsed: bool

    def __init__(self, log_weights: ArrayLike) -> None:
        log = np.array(log_weights, dtype=np.float64)
        if log.ndim != 1 or log.size == 0:
            raise InputError("log weights", expected="shape (N,) with N > 0", got=f"shape {log.shape}")
        log[np.isnan(log)] = -np.inf
        highest = log.max()
        if highest == np.inf:
            raise InputError("log weights", expected="values below infinity", got="+inf")
        self.collapsed = bool(highest == -np.inf)
        if self.collapsed:
            log[:] = 0.0
            highest = 0.0
        log -= highest  # the largest term of the sum becomes 1: nothing overflows
        log -= np.log(np.exp(log).sum())
        log.flags.writeable = False
        self.log = log

    def __len__(self) -> int:
        return self.log.size

    @cached_property
    def values(self) -> FloatArray:
        """(N,) float64, read-only: the weights themselves; they sum to 1."""
        values = np.exp(self.log)
        values /= values.sum()
        values.flags.writeable = False
        return values

    @property
    def ess(self) -> float:
        """Effective sample size 1 / sum w^2, between 1 and N; 0 when collapsed."""
        return 0.0 if self.collapsed else float(1.0 / np.sum(self.values**2))

    @property
    def survival_rate(self) -> float:
        """Effective sample size as a fraction of N: the alpha of (3.28)."""
        return self.ess / len(self)


def mean_estimate(particles: FloatArray, weights: Weights) -> FloatArray:
    """Expectation of the state, (3.25). particles : (N, D); returns (D,), both float64."""
    mean: FloatArray = np.einsum("n,nd->d", weights.values, particles)
    return mean


def maximum_estimate(particles: FloatArray, weights: Weights) -> FloatArray:
    """The particle of largest weight, (3.24) and (6.18); the first of equals. particles : (N, D); returns (D,)."""
    best: FloatArray = particles[int(np.argmax(weights.log))].copy()
    return best


def covariance(particles: FloatArray, weights: Weights) -> FloatArray:
    """Weighted covariance, sum w (x - mean)(x - mean)^T. particles : (N, D); returns (D, D), both float64.

    Divides by 1 and not by 1 - sum w^2: this is the second moment of the distribution that the weighted set is, not an
    estimate from independent draws.
    """
    deviations = particles - mean_estimate(particles, weights)
    moment: FloatArray = np.einsum("ni,nj->ij", weights.values[:, None] * deviations, deviations)
    return moment


def standard_deviation(particles: FloatArray, weights: Weights) -> FloatArray:
    """Square root of the covariance's diagonal. particles : (N, D); returns (D,), both float64, state units."""
    deviations = particles - mean_estimate(particles, weights)
    variance: FloatArray = np.einsum("n,nd->d", weights.values, deviations**2)
    return np.sqrt(variance)


ESTIMATES = {"mean": mean_estimate, "maximum": maximum_estimate}
