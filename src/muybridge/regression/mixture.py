"""What a silhouette says of the pose: a mixture of normal densities with diagonal covariances (Sedai 2013, (10)).

==========  =========================================
symbol      name
==========  =========================================
g_k         PoseMixture.weights
y_k         PoseMixture.means
Sigma_k     PoseMixture.variances, the diagonals
sigma^2     PoseMixture.uncertainty, of (19)
lambda      trusted_variance
alpha       PoseMixture.alpha
==========  =========================================

Components that wrap have wrapped normal densities; of their images the nearest three are summed, which is exact to
1e-6 for deviations up to 1.5 radians.

Differences from the paper
    With several cameras it does not say whose descriptor is used: `combined` takes all of them as one mixture, each
    weighed by its own alpha, and may let the cameras vote (`agreement`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.regression.components import PoseComponents

PRINTED_TRUSTED_VARIANCE = 0.003  # lambda, square radians; section V-C.1


@dataclass(frozen=True, eq=False)
class PoseMixture:
    """p(y | x) of (10).

    Parameters
    ----------
    components : what the D numbers are
    weights : (K,) float64, not negative; made to sum to 1
    means, variances : (K, D) float64, radians and their squares
    """

    components: PoseComponents
    weights: FloatArray
    means: FloatArray
    variances: FloatArray

    def __post_init__(self) -> None:
        weights = np.array(self.weights, dtype=np.float64)
        means = self.components.wrapped(self.components.checked("means of a mixture", self.means))
        variances = self.components.checked("variances of a mixture", self.variances)
        total = weights.sum()
        if weights.shape != (len(means),) or not (weights >= 0).all() or not 0 < total < np.inf:
            expected = f"{len(means)} numbers, none negative, not all 0"
            raise InputError("weights of a mixture", expected=expected, got=str(weights))
        if variances.shape != means.shape or not (variances > 0).all():
            raise InputError("variances of a mixture", expected=f"shape {means.shape}, above 0", got=str(variances))
        for name, value in (("weights", weights / total), ("means", means), ("variances", variances.copy())):
            value.flags.writeable = False
            object.__setattr__(self, name, value)

    def sample(self, rng: np.random.Generator, count: int) -> FloatArray:
        """(count, D) poses drawn from the mixture, what is circular in [-pi, pi)."""
        modes = rng.choice(len(self.weights), size=count, p=self.weights)
        noise = rng.standard_normal((count, len(self.components)))
        return self.components.wrapped(self.means[modes] + np.sqrt(self.variances[modes]) * noise)

    def log_prob(self, poses: FloatArray) -> FloatArray:
        """(N,) log density of poses (N, D)."""
        poses = self.components.checked("poses", poses)
        with np.errstate(divide="ignore"):
            terms = np.log(self.weights) + self.mode_log_probs(poses)
        return _log_sum(terms)

    def mode_log_probs(self, poses: FloatArray) -> FloatArray:
        """(N, K) log N(y; y_k, Sigma_k) of poses (N, D)."""
        return _log_normal(self.components, poses[:, None] - self.means, self.variances)

    @property
    def most_probable(self) -> int:
        """The mode of the highest gating probability."""
        return int(np.argmax(self.weights))

    @property
    def uncertainty(self) -> float:
        """sigma^2 = trace(Sigma_k) / d of the most probable mode, square radians."""
        return float(np.mean(self.variances[self.most_probable]))

    def alpha(self, trusted_variance: float = PRINTED_TRUSTED_VARIANCE) -> float:
        """exp(-sigma^2 / lambda) in [0, 1], (19): how much of the next prior this guess deserves."""
        return float(np.exp(-self.uncertainty / _positive(trusted_variance)))

    @cached_property
    def mean(self) -> FloatArray:
        """(D,) expectation; of what is circular the mean direction."""
        shrunk = self.weights[:, None] * np.exp(-0.5 * self.variances)  # of a normal angle's mean cosine
        turning = np.arctan2(np.sum(shrunk * np.sin(self.means), axis=0), np.sum(shrunk * np.cos(self.means), axis=0))
        mean: FloatArray = self.weights @ self.means
        circular = list(self.components.circular)
        mean[circular] = turning[circular]
        return mean


def turned(mixture: PoseMixture, angle: float) -> PoseMixture:
    """The mixture with the person turned about the vertical, radians, counter-clockwise seen from above (IV-B).

    A regressor's heading is relative to the camera; turned by `outputs.bearing` of a camera it is that in the world.
    """
    heading = mixture.components.heading
    if heading is None:
        raise InputError("mixture to turn", expected="a heading among its components", got="none")
    means = mixture.means.copy()
    means[:, heading] += angle
    return replace(mixture, means=means)


def combined(
    mixtures: Sequence[PoseMixture], trusted_variance: float = PRINTED_TRUSTED_VARIANCE, agreement: float = 0.0
) -> PoseMixture:
    """The guesses of several cameras as one mixture.

    Parameters
    ----------
    mixtures : one a camera, of the same components, with headings in one frame (see `turned`)
    trusted_variance : float, square radians
        lambda: each camera's modes are weighed by its alpha.
    agreement : float
        Each mode's weight is multiplied by the density that every other camera's mixture has where it lies (and as wide
        as it is), to this power. 0 is off: the cameras are alternatives. 1 takes them for independent witnesses of
        independent components, which they are not.
    """
    if not mixtures:
        raise InputError("mixtures to combine", expected="at least one", got="none")
    first = mixtures[0].components
    if any(mixture.components != first for mixture in mixtures):
        raise InputError("mixtures to combine", expected="the same components in all", got="different ones")
    logs = []
    for mixture in mixtures:
        with np.errstate(divide="ignore"):
            log = np.log(mixture.weights) - mixture.uncertainty / _positive(trusted_variance)
        if agreement:
            log = log + agreement * sum(_overlap(mixture, other) for other in mixtures if other is not mixture)
        logs.append(log)
    log_weights = np.concatenate(logs)
    return PoseMixture(
        first,
        np.exp(log_weights - log_weights.max()),
        np.concatenate([mixture.means for mixture in mixtures]),
        np.concatenate([mixture.variances for mixture in mixtures]),
    )


def _overlap(mixture: PoseMixture, other: PoseMixture) -> FloatArray:
    """(K,) log of the integral of each mode's density times the other mixture's."""
    away = mixture.means[:, None] - other.means
    with np.errstate(divide="ignore"):
        terms = np.log(other.weights) + _log_normal(
            mixture.components, away, mixture.variances[:, None] + other.variances
        )
    return _log_sum(terms)


def _log_normal(components: PoseComponents, away: FloatArray, variances: FloatArray) -> FloatArray:
    """(N, K) log N(away; 0, variances), of what is circular wrapped round; away (N, K, D) and what broadcasts to it."""
    away = components.wrapped(away)
    exponents = -0.5 * away**2 / variances
    for index in components.circular:
        images = away[..., index, None] + 2 * np.pi * np.array([-1.0, 0.0, 1.0])
        exponents[..., index] = _log_sum(-0.5 * images**2 / variances[..., index, None])
    out: FloatArray = np.sum(exponents - 0.5 * np.log(2 * np.pi * variances), axis=-1)
    return out


def _log_sum(logs: FloatArray) -> FloatArray:
    """Logarithm of the sum of exponentials over the last axis."""
    highest = logs.max(axis=-1)
    out: FloatArray = highest + np.log(np.exp(logs - highest[..., None]).sum(axis=-1))
    return out


def _positive(trusted_variance: float) -> float:
    if not (np.isfinite(trusted_variance) and trusted_variance > 0):
        raise InputError("trusted variance (lambda)", expected="above 0, square radians", got=repr(trusted_variance))
    return trusted_variance
