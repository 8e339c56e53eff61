"""The colour likelihood to compare with, of Nummiaro, Koller-Meier and Van Gool (2003).

"An adaptive color-based particle filter", Image and Vision Computing 21; restated by Zhao (2009) in (6.1) and (6.2).
One 8 x 8 x 8 histogram of an upright ellipse, pixels weighed by 1 - r^2, compared by the Bhattacharyya coefficient.

==========  ==============================================
symbol      name
==========  ==============================================
p_y, q      weighted histograms of candidate and target
rho, d      overlap sum sqrt(p q); d = sqrt(1 - rho)
sigma       NummiaroConfig.spread
alpha       NummiaroConfig.update_rate
pi_T        NummiaroConfig.update_above
==========  ==============================================

Differences from the paper: the state is `people.box`'s, whose width and height are twice the half axes Hx and Hy,
instead of one with a change of scale. From Zhao's restatement: the region is the paper's ellipse and
a = sqrt(Hx^2 + Hy^2) is made of half axes; he writes a rectangle and whole sides, with which no pixel would weigh less
than 3/4.

Cost: O(pixels) a box.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from muybridge._kernels.weighted_histogram import BINS, ellipse_histograms, ellipse_overlaps
from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.people.colour_likelihood import Picture


@dataclass(frozen=True, kw_only=True)
class NummiaroConfig:
    """Settings of the comparison method."""

    spread: float = 0.15  # sigma of the weights, in units of d; of the order the field uses
    update_rate: float = 0.05  # alpha, per frame
    update_above: float = 0.0  # pi_T: no update where exp(-d^2 / (2 sigma^2)) of the estimate is lower

    def __post_init__(self) -> None:
        if not (self.spread > 0 and 0 <= self.update_rate <= 1 and 0 <= self.update_above <= 1):
            raise InputError("Nummiaro's likelihood", expected="spread above 0, update_rate and update_above in 0..1",
                             got=f"{self.spread}, {self.update_rate}, {self.update_above}")  # fmt: skip


@dataclass(frozen=True, eq=False)
class NummiaroTarget:
    """q: the target's weighted histogram (512,) float64, of sum 1."""

    histogram: FloatArray
    config: NummiaroConfig

    @classmethod
    def learn(cls, picture: Picture, state: FloatArray, config: NummiaroConfig | None = None) -> NummiaroTarget:
        """From a picture (H, W, 3) uint8, of any colour space, and the box (>= 4,) that holds the target in it."""
        return cls(_histogram(picture, state), config or NummiaroConfig())

    def observe(self, picture: Picture, background: Picture | None = None) -> NummiaroLikelihood:
        """One frame (H, W, 3) uint8; the background is not used."""
        return NummiaroLikelihood(self, picture)

    def updated(self, seen: FloatArray) -> NummiaroTarget:
        """q_t = (1 - alpha) q_{t-1} + alpha p, with the histogram (512,) seen at the estimate, unless pi < pi_T."""
        squared = max(0.0, 1.0 - float(np.sqrt(seen * self.histogram).sum()))
        if np.exp(-0.5 * squared / self.config.spread**2) < self.config.update_above:
            return self
        rate = self.config.update_rate
        return replace(self, histogram=(1 - rate) * self.histogram + rate * seen)


@dataclass(frozen=True, eq=False)
class NummiaroLikelihood:
    """One frame, seen with one target in mind."""

    target: NummiaroTarget
    picture: Picture

    def log_prob(self, states: FloatArray) -> FloatArray:
        """-d^2 / (2 sigma^2) with d^2 = 1 - rho. states : (N, >= 4); returns (N,); -inf for one without pixels."""
        rho = np.empty(len(states))
        ellipse_overlaps(self.picture, np.ascontiguousarray(states), np.sqrt(self.target.histogram), rho)
        log_prob: FloatArray = -0.5 * np.maximum(0.0, 1.0 - rho) / self.target.config.spread**2
        return np.where(np.isnan(rho), -np.inf, log_prob)

    def histogram(self, state: FloatArray) -> FloatArray:
        """(512,) of one ellipse (>= 4,)."""
        return _histogram(self.picture, state)


def _histogram(picture: Picture, state: FloatArray) -> NDArray[np.float64]:
    out = np.empty((1, BINS))
    ellipse_histograms(np.ascontiguousarray(picture), np.atleast_2d(np.asarray(state, np.float64)), out)
    return out[0]
