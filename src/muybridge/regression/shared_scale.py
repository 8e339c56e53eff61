"""Gaussian processes that share their inputs and their length scale: one eigendecomposition for all outputs.

The outputs of a cluster differ in how strongly and how noisily they follow the silhouette, but little in how fast. With
one theta_2 for all, the matrix E of exp(-theta_2 / 2 |x - x'|^2) is the same for every output, and with E = U L U^T

    C_q = theta_1q E + theta_3q 1 1^T + 1/beta_q = U diag(m_q) U^T + theta_3q 1 1^T,    m_q = theta_1q L + 1/beta_q

so that the likelihood (5), its gradient, mean (8) and variance (9) of each output cost N operations once U is known;
the rank-one term is taken in by Sherman and Morrison's formula. The likelihood, maximised over every output's own
theta_1, theta_3 and beta, is a function of theta_2 alone, and its derivative is that with the others held (they are at
their best).

Ours, in place of the paper's separate length scales; not an approximation, but a constraint on the model. What it costs
and gains is in `docs/benchmarks.md`, "From silhouette to pose".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh
from scipy.optimize import minimize

from muybridge.filters.particles import FloatArray
from muybridge.regression.gaussian_process import BOUNDS, STEPS, HyperParameters, first_guess

SCALE_STEPS = 20  # of the search for theta_2, at most
SCANNED = (0.25, 1.0, 4.0, 16.0)  # times the first guess of theta_2: the best of these is where the search begins
_OWN = (0, 2, 3)  # of `HyperParameters.log`: what each output has for itself


@dataclass(frozen=True, eq=False)
class Spectrum:
    """E = U L U^T for one theta_2. values : (N,); vectors : (N, N), one a column; ones : (N,), U^T 1."""

    values: FloatArray
    vectors: FloatArray
    ones: FloatArray

    @classmethod
    def of(cls, distances: FloatArray, inverse_scale: float) -> Spectrum:
        """Of squared distances (N, N)."""
        values, vectors = eigh(np.exp(-0.5 * inverse_scale * distances), driver="evd", check_finite=False)
        return cls(np.maximum(values, 0.0), vectors, vectors.sum(axis=0))


def output_likelihood(log: FloatArray, spectrum: Spectrum, projected: FloatArray) -> tuple[float, FloatArray]:
    """(5) of one output and its gradient.

    Parameters
    ----------
    log : (3,) float64
        log theta_1, log theta_3, log 1 / beta
    projected : (N,) float64
        U^T y

    Returns
    -------
    float, (3,) float64
    """
    signal, offset, noise = np.exp(log)
    values, ones = spectrum.values, spectrum.ones
    inverse = 1.0 / (signal * values + noise)
    grown = 1.0 + offset * np.sum(ones**2 * inverse)
    common = np.sum(ones * projected * inverse)
    solved = (projected - offset * common / grown * ones) * inverse  # U^T C^-1 y
    value = -0.5 * (
        np.sum(projected * solved) - np.sum(np.log(inverse)) + np.log(grown) + len(values) * np.log(2 * np.pi)
    )
    leverage = inverse - offset / grown * (ones * inverse) ** 2  # diagonal of U^T C^-1 U
    away = solved**2 - leverage
    by_offset = np.sum(ones * solved) ** 2 - (grown - 1.0) / (offset * grown)
    return float(value), 0.5 * np.array([signal * np.sum(away * values), offset * by_offset, noise * np.sum(away)])


def scale_gradient(
    distances: FloatArray, spectrum: Spectrum, projected: FloatArray, hyper: list[HyperParameters]
) -> float:
    """Derivative by log theta_2 of the sum of (5) over outputs. projected : (N, D)."""
    scale = hyper[0].inverse_scale
    slope = -0.5 * scale * distances * np.exp(-0.5 * scale * distances)
    rotated = spectrum.vectors.T @ slope @ spectrum.vectors
    total = 0.0
    for own, output in zip(hyper, projected.T, strict=True):
        inverse = 1.0 / (own.signal * spectrum.values + own.noise)
        weighted = spectrum.ones * inverse
        grown = 1.0 + own.offset * np.sum(spectrum.ones * weighted)
        solved = output * inverse - own.offset * np.sum(weighted * output) / grown * weighted
        trace = np.sum(np.diag(rotated) * inverse) - own.offset / grown * (weighted @ rotated @ weighted)
        total += 0.5 * own.signal * (solved @ rotated @ solved - trace)
    return float(total)


def fit_shared_scale(distances: FloatArray, outputs: FloatArray) -> list[HyperParameters]:
    """Hyper-parameters of each output, all with the same theta_2. distances : (N, N); outputs : (N, D)."""
    guess = first_guess(distances)
    start = np.tile(guess.log[list(_OWN)], (outputs.shape[1], 1))

    def best_for(relative: float, start: FloatArray) -> tuple[float, float, FloatArray]:
        """Likelihood, its slope, and each output's own logarithms (D, 3) at log theta_2 relative to the guess."""
        scale = guess.inverse_scale * float(np.exp(relative))
        spectrum = Spectrum.of(distances, scale)
        projected = spectrum.vectors.T @ outputs
        own, value = _fit_outputs(start, spectrum, projected)
        return value, scale_gradient(distances, spectrum, projected, _joined(own, scale)), own

    scanned = [(*best_for(np.log(factor), start), np.log(factor)) for factor in SCANNED]
    _, _, own, begin = max(scanned, key=lambda row: row[0])

    def objective(relative: FloatArray) -> tuple[float, float]:
        nonlocal own
        value, slope, own = best_for(float(relative[0]), own)
        return -value, -slope

    found = minimize(
        objective, [begin], jac=True, method="L-BFGS-B", bounds=BOUNDS[1:2], options={"maxiter": SCALE_STEPS}
    )
    own = best_for(float(found.x[0]), own)[2]
    return _joined(own, guess.inverse_scale * float(np.exp(found.x[0])))


def _fit_outputs(start: FloatArray, spectrum: Spectrum, projected: FloatArray) -> tuple[FloatArray, float]:
    """(D, 3) logarithms that maximise each output's likelihood, and the sum of those."""
    bounds = [BOUNDS[index] for index in _OWN]
    best, total = np.empty_like(start), 0.0
    for index, output in enumerate(projected.T):

        def objective(log: FloatArray, output: FloatArray = output) -> tuple[float, FloatArray]:
            value, gradient = output_likelihood(log, spectrum, output)
            return -value, -gradient

        found = minimize(
            objective, start[index], jac=True, method="L-BFGS-B", bounds=bounds, options={"maxiter": STEPS}
        )
        best[index], total = found.x, total - float(found.fun)
    return best, total


def _joined(own: FloatArray, scale: float) -> list[HyperParameters]:
    return [HyperParameters(signal, scale, offset, noise) for signal, offset, noise in np.exp(own).tolist()]


class SharedScaleProcess:
    """D outputs of the same inputs with one length scale, conditioned on N examples.

    Parameters
    ----------
    distances : (N, N) float64, squared
    outputs : (N, D) float64
    hyper : D sets of hyper-parameters with one theta_2
    """

    def __init__(self, distances: FloatArray, outputs: FloatArray, hyper: list[HyperParameters]) -> None:
        self.hyper = hyper
        spectrum = Spectrum.of(distances, hyper[0].inverse_scale)
        signal, offset, noise = np.array([(own.signal, own.offset, own.noise) for own in hyper]).T
        inverse = 1.0 / (spectrum.values[:, None] * signal + noise)  # (N, D), 1 / m
        weighted = spectrum.ones[:, None] * inverse
        ones = np.sum(spectrum.ones[:, None] * weighted, axis=0)  # 1^T M^-1 1
        grown = 1.0 + offset * ones
        projected = spectrum.vectors.T @ outputs
        solved = projected * inverse - offset / grown * np.sum(weighted * projected, axis=0) * weighted
        solved = spectrum.vectors @ solved  # C^-1 y
        # c = theta_1 e + theta_3 1: what (8) and (9) take from it, as sums over e and U^T e
        self._vectors = np.ascontiguousarray(spectrum.vectors.T)
        self._inverse = inverse * signal**2
        self._linear = np.concatenate([signal * solved, signal * (spectrum.vectors @ weighted)], axis=1)
        self._constant = offset * solved.sum(axis=0)
        self._offset, self._ones, self._grown, self._noise = offset, ones, grown, noise
        self._whole = signal + offset + noise

    def predict(self, distances: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Means (D,), (8), and variances (D,), (9), at a point of squared distances (N,) to the examples."""
        near = np.exp(-0.5 * self.hyper[0].inverse_scale * distances)
        means, mixed = np.split(near @ self._linear, 2)  # e^T C^-1 y and theta_1 e^T M^-1 1
        alone = (self._vectors @ near) ** 2 @ self._inverse  # theta_1^2 e^T M^-1 e
        offset, ones = self._offset, self._ones
        # c^T M^-1 c less what the rank-one term takes off: (mixed + offset ones)^2 offset / grown
        explained = alone + 2 * offset * mixed + offset**2 * ones - offset / self._grown * (mixed + offset * ones) ** 2
        return means + self._constant, np.maximum(self._whole - explained, self._noise)
