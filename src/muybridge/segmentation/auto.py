"""The Gaussian where the background is calm, pairs of pixels where it changes: decided at each pixel, from what it saw.

Zhao (2009, 6.1) finds a single Gaussian better in calm places and the spatial model better where the background
changes, and leaves the choice to future work. Here the mixture of each pixel is the evidence. Where one component holds
`portion` of the weight, that Gaussian judges, by its largest deviation over the channels, as the `gaussian` model
does. Where there are several, each is asked, and its squared deviation is raised by twice -log P(k | ki) for each
partner, as a Gaussian's log density is: a component counts less that was not seen with the one, ki, that the partner
shows now. The least is the pixel's deviation a.

The largest channel tells people from shadows better than sums over channels do; pairs of pixels tell limbs from wide
shadows better than pixels by themselves. So both have a say: the spatial model's score (3.1), of 1 + M densities, is
taken for the deviation b at which each of them would have fallen as far, and the score is the geometric mean of a and
b, in standard deviations.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from muybridge._kernels.deviations import pooled_scores, slot_deviations
from muybridge._kernels.mixture import TAIL
from muybridge.segmentation.pictures import learn_each
from muybridge.segmentation.spatial import OFFSETS, SpatialBackground, SpatialConfig


@dataclass(frozen=True)
class AutoConfig(SpatialConfig):
    """Settings of the spatial model, in whose place some mean another thing."""

    threshold: float = 4.0
    """Standard deviations."""
    surprise_limit: float = 4.0
    """Nats: the most that one partner may count against a component."""
    deviation_floor: float = 4.0
    """Grey values: the least standard deviation by which a colour is judged, as of the Gaussian model."""


class AutoBackground(SpatialBackground):
    """A spatial model whose calm pixels are judged by their Gaussian."""

    config: AutoConfig

    def __init__(self, shape: tuple[int, ...], config: AutoConfig | None = None) -> None:
        super().__init__(shape, config or AutoConfig())

    @classmethod
    def train(cls, pictures: Iterable[NDArray], config: SpatialConfig | None = None) -> AutoBackground:
        """Learn from pictures, each (H, W) or (H, W, 3) uint8, all of one size; people may pass through."""
        return learn_each(pictures, lambda shape: cls(shape, config))  # type: ignore[arg-type]

    @property
    def calm(self) -> NDArray:
        """(H, W) bool: where the Gaussian judges."""
        kept: NDArray = self.mixtures.kept
        return (kept & (kept - 1)) == 0

    def _judged(self, picture: NDArray) -> tuple[NDArray, NDArray]:
        mixtures, config = self.mixtures, self.config
        deviations, out = np.empty_like(mixtures.weights), np.empty(picture.shape[:2], np.float32)
        slot_deviations(
            picture, mixtures.weights, mixtures.means, mixtures.variances, mixtures.kept, config.deviation_floor**2,
            deviations,
        )  # fmt: skip
        pooled_scores(
            deviations, mixtures.kept, self.counts, self.totals, OFFSETS, self.partners,
            config.threshold**2, config.surprise_limit, out,
        )  # fmt: skip
        score, nearest = super()._judged(picture)
        return np.sqrt(out * self._as_deviation(score)), nearest

    def _as_deviation(self, score: NDArray) -> NDArray:
        """(H, W) float32: root mean square over the channels, in standard deviations, at which the pixel's densities,
        alone and with each partner, have a score (H, W) of (3.1), falling alike from that of the least noise."""
        channels, partners = self.mixtures.shape[2], self.config.partners
        highest = channels * np.log(256.0 / (np.sqrt(2.0 * np.pi) * self.config.sd_floor))
        fallen = np.maximum((score + (1 + 2 * partners) * highest) / (1 + partners), 0.0)
        squared = np.where(fallen > TAIL / 2, TAIL * np.exp(2.0 * fallen / TAIL - 1.0), 2.0 * fallen)
        deviation: NDArray = np.sqrt(squared / channels).astype(np.float32)
        return deviation
