"""How far a guess deserves trust: lambda of (19) from frames that were not learnt from, and whether variances are true.

alpha = exp(-sigma^2 / lambda) is to be the probability that the guess is good, given how uncertain it says it is. Good
means that the most probable mode is off by at most `GOOD` (root mean square over the components): near enough for a
tracker's climb or annealing to find the rest. lambda is the value under which the held-out frames' good and bad guesses
are most probable, sum log alpha over the good ones plus sum log(1 - alpha) over the others.

The paper chose lambda = 0.003 square radians by eye, so that alpha is near 0 above 0.015 (Figs. 8, 9); that value stays
`mixture.PRINTED_TRUSTED_VARIANCE`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.stats import chi2, spearmanr

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.regression.regressor import SilhouetteRegressor

GOOD = 0.2  # radians: 11 degrees
LEVELS = (0.50, 0.80, 0.95)
SMALLEST, LARGEST = 1e-6, 10.0  # square radians: lambda lies between


@dataclass(frozen=True, eq=False)
class Calibration:
    """What held-out frames say of a regressor.

    Attributes
    ----------
    trusted_variance : float, square radians
        lambda.
    predicted, realised : (N,) float64, square radians
        sigma^2 of (19), and the mean squared error of the most probable mode.
    alpha : (N,) float64
        With this lambda.
    good : (N,) bool
        The guess was off by at most the limit.
    coverage : tuple of float
        The share of components inside their `LEVELS` intervals, in the mode that is nearest to the truth.
    scale : float
        Factor on the standard deviations that would make them right on average, in that mode. Above 1: too sure.
    rank_correlation : float
        Spearman's, of predicted and realised; 0 where the variance tells nothing.
    """

    trusted_variance: float
    predicted: FloatArray
    realised: FloatArray
    alpha: FloatArray
    good: np.ndarray
    coverage: tuple[float, ...]
    scale: float
    rank_correlation: float

    def describe(self) -> str:
        """One line."""
        found = ", ".join(f"{share:.0%} in the {level:.0%} interval" for share, level in zip(self.coverage, LEVELS))
        return (
            f"lambda {self.trusted_variance:.4g}: {self.good.mean():.0%} of guesses good, mean alpha "
            f"{self.alpha.mean():.0%}; {found}; deviations would fit if multiplied by {self.scale:.2f}"
        )


def calibrate_lambda(
    regressor: SilhouetteRegressor, descriptors: FloatArray, poses: FloatArray, good: float = GOOD
) -> Calibration:
    """lambda for a regressor, from frames that it has not learnt from.

    Parameters
    ----------
    descriptors : (N, F) float64
    poses : (N, D) float64, radians, as those it was trained on
    good : float, radians
        Root mean square error up to which a guess is good.
    """
    components = regressor.components
    poses = components.checked("poses to calibrate by", poses)
    if len(descriptors) != len(poses) or len(poses) < 2 or not good > 0:
        expected = "at least 2 frames, a descriptor for each, and a limit above 0"
        raise InputError("held-out frames", expected=expected, got=f"{len(descriptors)}, {len(poses)} and {good:g}")
    predicted, realised, ratios = np.empty(len(poses)), np.empty(len(poses)), np.empty(poses.shape)
    for row, (descriptor, pose) in enumerate(zip(descriptors, poses, strict=True)):
        mixture = regressor.predict(descriptor)
        away = components.wrapped(pose - mixture.means)
        best = mixture.most_probable
        predicted[row], realised[row] = mixture.uncertainty, np.mean(away[best] ** 2)
        nearest = int(np.argmax(mixture.mode_log_probs(pose[None])[0]))
        ratios[row] = away[nearest] ** 2 / mixture.variances[nearest]
    changing = np.ptp(poses, axis=0) > 0
    within = tuple(float(np.mean(ratios[:, changing] <= chi2.ppf(level, 1))) for level in LEVELS)
    hit = realised <= good**2
    trusted = fit_trusted_variance(predicted, hit)
    return Calibration(
        trusted, predicted, realised, np.exp(-predicted / trusted), hit, within,
        float(np.sqrt(np.mean(ratios[:, changing]))), float(spearmanr(predicted, realised).statistic),
    )  # fmt: skip


def fit_trusted_variance(predicted: FloatArray, good: np.ndarray) -> float:
    """lambda that makes exp(-predicted / lambda) the probability of `good` (N,) bool; within SMALLEST and LARGEST."""

    def cost(log: float) -> float:
        exponent = predicted / np.exp(log)
        bad = np.log(-np.expm1(-np.maximum(exponent[~good], 1e-12)))
        return float(np.sum(exponent[good]) - np.sum(bad))

    found = minimize_scalar(cost, bounds=(np.log(SMALLEST), np.log(LARGEST)), method="bounded")
    return float(np.exp(found.x))
