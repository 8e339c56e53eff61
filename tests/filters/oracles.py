"""Truth by other roads: likelihoods with known answers, a Kalman filter, and bounds from Monte-Carlo error."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

FALSE_ALARM = 1e-4  # chance that a correct program fails one test, whatever the number of comparisons in it


@dataclass(frozen=True)
class GaussianLikelihood:
    """log N(observation; pose, sd^2), up to its constant."""

    observation: np.ndarray
    sd: float = 1.0

    def log_prob(self, poses: np.ndarray) -> np.ndarray:
        return -0.5 * (((poses - self.observation) / self.sd) ** 2).sum(axis=1)

    def normal_equations(
        self, pose: np.ndarray, spread: float, components: np.ndarray | None = None
    ) -> NormalEquations:
        """The same, as a filter that climbs wants to know it; exact, so that `spread` is not needed."""
        return NormalEquations(np.eye(pose.size) / self.sd**2, (self.observation - pose) / self.sd**2).of(components)


@dataclass(frozen=True)
class NormalEquations:
    """Minus the second derivative (D, D) and the first (D,) of a log likelihood."""

    curvature: np.ndarray
    gradient: np.ndarray

    def of(self, components: np.ndarray | None) -> NormalEquations:
        """Of some components (B,), the others standing."""
        if components is None:
            return self
        return NormalEquations(self.curvature[np.ix_(components, components)], self.gradient[components])


@dataclass(frozen=True)
class Kalman:
    """Textbook filter for x' = x + N(0, walk_sd^2), y = x + N(0, sd^2), every component by itself."""

    mean: np.ndarray
    variance: np.ndarray

    def step(self, observation: np.ndarray, walk_sd: float, sd: float) -> Kalman:
        predicted = self.variance + walk_sd**2
        gain = predicted / (predicted + sd**2)
        return Kalman(self.mean + gain * (observation - self.mean), (1.0 - gain) * predicted)


def t_of(replicates: np.ndarray, truth: np.ndarray | float) -> np.ndarray:
    """Student's t of independent replicates (R, ...) against the truth; their spread is the Monte-Carlo error."""
    replicates = np.asarray(replicates, dtype=np.float64)
    with np.errstate(divide="ignore"):  # replicates that all agree on a wrong value: infinitely far off
        return (replicates.mean(axis=0) - truth) / (replicates.std(axis=0, ddof=1) / np.sqrt(len(replicates)))


def t_bound(replicates: int, comparisons: int) -> float:
    """|t| that a correct program exceeds with probability FALSE_ALARM in any of the comparisons (Bonferroni)."""
    return float(stats.t.ppf(1.0 - 0.5 * FALSE_ALARM / comparisons, replicates - 1))


def agrees(replicates: np.ndarray, truth: np.ndarray | float) -> bool:
    """No component of the replicates' mean is further from the truth than Monte-Carlo error allows."""
    t = np.atleast_1d(t_of(replicates, truth))
    return bool((np.abs(t) < t_bound(len(replicates), t.size)).all())
