"""Which cluster a silhouette belongs to (Sedai 2013, (11)): multinomial logistic regression, or the variances.

The logistic gate is fitted by bound optimisation: the log likelihood's Hessian is replaced by a lower bound that does
not depend on the weights (Boehning 1992; Krishnapuram et al. 2005, the paper's [55]), so that one factorisation serves
all iterations and each of them can only improve.

=============  ========================================
symbol         name
=============  ========================================
v_k            -LogisticGate.weights[:, k]
x              `_features`: standardised, with a constant
l_k            one row of `targets`
=============  ========================================

The bound is -1/2 (1 - 1 1^T / K) x X^T X. Gradients sum to zero over the classes, and so do weights that begin at zero:
there 1 - 1 1^T / K is the identity, and every class has the same small system, X^T X / 2 plus the penalty.

Differences from the paper
    v_k enters with the other sign; there is a constant, which is not penalised, and an l2 penalty on the rest.
    With `landmarks`, closeness to so many of the examples, exp(-|x - x_l|^2 width / (2 median)), is appended to the
    descriptor: whether a silhouette comes or goes is no linear question.
    The other gate, 1 / trace(Sigma_k), is `by_variance`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.regression.gaussian_process import squared_distances


@dataclass(frozen=True, kw_only=True)
class GateConfig:
    """Settings of the logistic gate."""

    penalty: float = 0.3  # of half the sum of squared weights, on standardised features
    landmarks: int = 0  # examples to which closeness is measured
    width: float = 4.0  # theta_2 of that closeness, times the median squared distance
    tolerance: float = 1e-4  # improvement of the mean log likelihood in 10 iterations at which they end
    iterations: int = 2000

    def __post_init__(self) -> None:
        if not self.penalty > 0 or not self.width > 0:
            raise InputError("gate penalty and width", expected="above 0", got=f"{self.penalty:g}, {self.width:g}")
        if self.landmarks < 0 or self.iterations < 1:
            expected = "0 or more landmarks, at least 1 iteration"
            raise InputError("gate", expected=expected, got=f"{self.landmarks}, {self.iterations}")


@dataclass(frozen=True, eq=False)
class LogisticGate:
    """g_k(x) of (11).

    landmarks : (L, F) float64; inverse_scale : float, theta_2 of the closeness to them
    centre, scale : (F + L,) float64, of the features
    weights : (F + L + 1, K) float64, the constant's last
    """

    landmarks: FloatArray
    inverse_scale: float
    centre: FloatArray
    scale: FloatArray
    weights: FloatArray

    def log_prob(self, inputs: FloatArray) -> FloatArray:
        """(N, K) log g_k of inputs (N, F)."""
        features = (_raw_features(inputs, self.landmarks, self.inverse_scale) - self.centre) / self.scale
        return _log_softmax(features @ self.weights[:-1] + self.weights[-1])


def by_variance(variances: FloatArray) -> FloatArray:
    """(K,) weights proportional to 1 / trace(Sigma_k), the paper's other gate. variances : (K, D)."""
    weights = 1.0 / np.sum(variances, axis=1)
    out: FloatArray = weights / weights.sum()
    return out


def fit_gate(
    rng: np.random.Generator, inputs: FloatArray, labels: np.ndarray, classes: int, config: GateConfig = GateConfig()
) -> tuple[LogisticGate, FloatArray]:
    """The gate, and the penalised log likelihood after each iteration, which only grows.

    Parameters
    ----------
    inputs : (N, F) float64
    labels : (N,) int, 0 to classes - 1
    """
    chosen = np.sort(rng.permutation(len(inputs))[: config.landmarks])
    landmarks = inputs[chosen].astype(np.float32).astype(np.float64)
    inverse_scale = 1.0
    if len(landmarks):
        median = float(np.median(squared_distances(landmarks, landmarks)))
        inverse_scale = config.width / max(median, 1e-12)
    raw = _raw_features(inputs, landmarks, inverse_scale)
    centre, scale = raw.mean(axis=0), raw.std(axis=0)
    scale = np.where(scale > 1e-9, scale, 1.0)
    targets = np.eye(classes)[labels]
    weights, history = maximise(with_constant((raw - centre) / scale), targets, config)
    return LogisticGate(landmarks, inverse_scale, centre, scale, weights), history


def maximise(features: FloatArray, targets: FloatArray, config: GateConfig) -> tuple[FloatArray, FloatArray]:
    """Weights (F + 1, K) and the penalised log likelihoods on the way. features : (N, F + 1), the last column 1."""
    penalty = np.full(features.shape[1], config.penalty)
    penalty[-1] = 0.0
    factor = cho_factor(0.5 * features.T @ features + np.diag(penalty + 1e-9 * len(features)))
    weights = np.zeros((features.shape[1], targets.shape[1]))
    history: list[float] = []
    for _ in range(config.iterations):
        log_prob = _log_softmax(features @ weights)
        history.append(float(np.sum(targets * log_prob) - 0.5 * np.sum(penalty[:, None] * weights**2)))
        if len(history) > 10 and history[-1] - history[-11] < config.tolerance * len(features):
            break
        gradient = features.T @ (targets - np.exp(log_prob)) - penalty[:, None] * weights
        weights = weights + cho_solve(factor, gradient)
    return weights, np.array(history)


def with_constant(features: FloatArray) -> FloatArray:
    """(N, F + 1): a last column of ones."""
    return np.concatenate([features, np.ones((len(features), 1))], axis=1)


def _raw_features(inputs: FloatArray, landmarks: FloatArray, inverse_scale: float) -> FloatArray:
    if not len(landmarks):
        return inputs
    return np.concatenate([inputs, np.exp(-0.5 * inverse_scale * squared_distances(inputs, landmarks))], axis=1)


def _log_softmax(scores: FloatArray) -> FloatArray:
    shifted = scores - scores.max(axis=1, keepdims=True)
    out: FloatArray = shifted - np.log(np.exp(shifted).sum(axis=1, keepdims=True))
    return out
