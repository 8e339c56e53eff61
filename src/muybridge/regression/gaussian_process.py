"""Exact Gaussian process regression (Sedai 2013, (2) to (9)): one set of hyper-parameters for one output, or for many.

=============  =======================================
symbol         name
=============  =======================================
theta_1        HyperParameters.signal
theta_2        HyperParameters.inverse_scale
theta_3        HyperParameters.offset
1 / beta       HyperParameters.noise
C              `covariance`, (N, N)
c              `GaussianProcess.predict`: k(X, x)
=============  =======================================

Outputs are expected with mean 0 and variance 1, see `cluster_regression`; hyper-parameters stay within `BOUNDS`. The
noise is at least 1e-6, which is all the jitter that C needs: frames that occur twice do no harm.

Differences from the paper
    Q outputs may share all their hyper-parameters, and so one factorisation; with Q = 1 this is the paper's. (9) is
    printed without its leading c. The paper names conjugate gradients; L-BFGS-B keeps the bounds.

Cost: one factorisation and one inverse, N^3, a look at the likelihood; N^2 / 2 a predicted variance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import blas, lapack
from scipy.optimize import minimize

from muybridge.filters.particles import FloatArray

#: Of log theta_1, log theta_2 relative to the start, log theta_3 and log 1 / beta, for outputs of variance 1.
BOUNDS = tuple((np.log(low), np.log(high)) for low, high in ((1e-3, 1e2), (1e-3, 1e3), (1e-6, 1e1), (1e-6, 1e1)))
STEPS = 100  # of the maximisation, at most


@dataclass(frozen=True)
class HyperParameters:
    """Of the kernel theta_1 exp(-theta_2 / 2 |x - x'|^2) + theta_3 and the noise 1 / beta, (4)."""

    signal: float
    inverse_scale: float
    offset: float
    noise: float

    @property
    def log(self) -> FloatArray:
        """(4,): log theta_1, log theta_2, log theta_3, log 1 / beta."""
        return np.log([self.signal, self.inverse_scale, self.offset, self.noise])

    @classmethod
    def from_log(cls, log: FloatArray) -> HyperParameters:
        """The inverse of `log`."""
        return cls(*np.exp(log).tolist())


def squared_distances(a: FloatArray, b: FloatArray) -> FloatArray:
    """(N, M): |a_i - b_j|^2 of inputs (N, F) and (M, F)."""
    squares = np.sum(a**2, axis=1)[:, None] + np.sum(b**2, axis=1) - 2.0 * a @ b.T
    out: FloatArray = np.maximum(squares, 0.0)
    return out


def first_guess(distances: FloatArray) -> HyperParameters:
    """Where the search begins: a length scale like the typical distance, a tenth of noise."""
    others = distances[distances > 0]
    return HyperParameters(1.0, 1.0 / float(np.median(others)) if others.size else 1.0, 0.1, 0.1)


def covariance(distances: FloatArray, hyper: HyperParameters) -> FloatArray:
    """C of (3), (N, N)."""
    matrix: FloatArray = hyper.signal * np.exp(-0.5 * hyper.inverse_scale * distances) + hyper.offset
    matrix[np.diag_indices_from(matrix)] += hyper.noise
    return matrix


def log_marginal_likelihood(log: FloatArray, distances: FloatArray, outputs: FloatArray) -> tuple[float, FloatArray]:
    """(5), summed over outputs that share their hyper-parameters, and its gradient.

    Parameters
    ----------
    log : (4,) float64
        As `HyperParameters.log`.
    distances : (N, N) float64
        Squared, of the inputs.
    outputs : (N, Q) float64

    Returns
    -------
    float, (4,) float64
        The gradient is by the logarithms: 1/2 tr((a a^T - Q C^-1) dC / d log theta), a = C^-1 Y.
    """
    hyper = HyperParameters.from_log(log)
    smooth = hyper.signal * np.exp(-0.5 * hyper.inverse_scale * distances)
    matrix = smooth + hyper.offset
    matrix[np.diag_indices_from(matrix)] += hyper.noise
    factor = _cholesky(matrix)
    solved = lapack.dpotrs(factor, outputs, lower=1)[0]
    count, shared = outputs.shape
    log_determinant = 2.0 * np.sum(np.log(np.diag(factor)))
    value = -0.5 * (shared * (log_determinant + count * np.log(2 * np.pi)) + np.sum(outputs * solved))
    lower = np.tril(lapack.dpotri(factor, lower=1)[0])
    inverse = lower + lower.T
    inverse[np.diag_indices_from(inverse)] *= 0.5
    away = solved @ solved.T - shared * inverse
    weighted = away * smooth
    gradient = 0.5 * np.array([
        np.sum(weighted),
        -0.5 * hyper.inverse_scale * np.sum(weighted * distances),
        hyper.offset * np.sum(away),
        hyper.noise * np.trace(away),
    ])  # fmt: skip
    return float(value), gradient


def fit_hyper_parameters(distances: FloatArray, outputs: FloatArray) -> HyperParameters:
    """Those that maximise (5) within `BOUNDS`, from `first_guess`. distances : (N, N); outputs : (N, Q)."""
    start = first_guess(distances)
    origin = np.array([0.0, np.log(start.inverse_scale), 0.0, 0.0])

    def objective(relative: FloatArray) -> tuple[float, FloatArray]:
        value, gradient = log_marginal_likelihood(relative + origin, distances, outputs)
        return -value, -gradient

    found = minimize(
        objective, start.log - origin, jac=True, method="L-BFGS-B", bounds=BOUNDS, options={"maxiter": STEPS}
    )
    return HyperParameters.from_log(found.x + origin)


class GaussianProcess:
    """Q outputs of the same inputs under the same hyper-parameters, conditioned on N examples.

    Parameters
    ----------
    distances : (N, N) float64, squared
    outputs : (N, Q) float64
    """

    def __init__(self, distances: FloatArray, outputs: FloatArray, hyper: HyperParameters) -> None:
        self.hyper = hyper
        factor = _cholesky(covariance(distances, hyper))
        self._solved = lapack.dpotrs(factor, outputs, lower=1)[0]
        self._packed = lapack.dtrttp(factor, uplo="L")[0]  # half of the memory to run through

    def predict(self, distances: FloatArray) -> tuple[FloatArray, float]:
        """Mean (Q,), (8), and variance, (9), at a point whose squared distances to the examples are (N,)."""
        hyper = self.hyper
        near = hyper.signal * np.exp(-0.5 * hyper.inverse_scale * distances) + hyper.offset
        explained = blas.dtpsv(near.size, self._packed, near, lower=1)
        variance = hyper.signal + hyper.offset + hyper.noise - float(explained @ explained)
        return near @ self._solved, max(variance, hyper.noise)


def _cholesky(matrix: FloatArray) -> FloatArray:
    """Lower factor, (N, N); the upper triangle is zero."""
    factor, failed = lapack.dpotrf(matrix, lower=1, clean=1)
    if failed:
        raise np.linalg.LinAlgError(f"covariance of {len(matrix)} examples is not positive definite")
    return factor
