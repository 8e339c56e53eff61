"""Whether the stated standard deviations are true: how often the truth lies inside the regions they claim.

An isotropic normal error in space with deviation s along each axis has |error| / s distributed as chi with 3 degrees of
freedom. A region of probability p is the ball of radius s times that distribution's p-quantile; a calibrated track has
the truth inside it in a share p of all cases.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

LEVELS = (0.50, 0.80, 0.95)
CHI3_RADII = (1.53817225, 2.15444370, 2.79548348)
"""Quantiles of the chi distribution with 3 degrees of freedom at LEVELS: sqrt(scipy.stats.chi2.ppf(level, 3))."""


@dataclass(frozen=True)
class DeviationCalibration:
    """Coverage of the stated uncertainty.

    Attributes
    ----------
    levels : tuple of float
        What was claimed.
    coverage : tuple of float
        The share of true joints inside each region. Below the level: the track is too sure of itself.
    scale : float
        The factor on the deviations that would make them right on average, sqrt(mean(error^2 / (3 s^2))).
    count : int
        Joints that were counted (known, with a positive deviation). Neighbouring frames are not independent.
    """

    levels: tuple[float, ...]
    coverage: tuple[float, ...]
    scale: float
    count: int

    def describe(self) -> str:
        """One line: claimed and found, and the factor that would mend it."""
        pairs = ", ".join(
            f"{found:.0%} in the {level:.0%} region" for level, found in zip(self.levels, self.coverage, strict=True)
        )
        return f"{pairs}; deviations would fit if multiplied by {self.scale:.2f}"


def calibrate_deviations(distances: np.ndarray, deviations: np.ndarray) -> DeviationCalibration | None:
    """Compare distances to the truth with the deviations stated beside them.

    Parameters
    ----------
    distances, deviations : (T, J) float64, one unit
        The deviation is that along each axis. NaN, and deviations of zero, are left out.

    Returns
    -------
    DeviationCalibration or None
        None where no deviation was stated.
    """
    known = np.isfinite(distances) & np.isfinite(deviations) & (deviations > 0)
    if not known.any():
        return None
    ratios = distances[known] / deviations[known]
    coverage = tuple(float(np.mean(ratios <= radius)) for radius in CHI3_RADII)
    return DeviationCalibration(LEVELS, coverage, float(np.sqrt(np.mean(ratios**2) / 3)), int(known.sum()))
