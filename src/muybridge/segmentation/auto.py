"""The Gaussian where the background is calm, pairs of pixels where it changes: decided at each pixel, from what it saw.

Zhao (2009, 6.1) finds a single Gaussian better in calm places and the spatial model better where the background
changes, and leaves the choice to future work. Here the mixture of each pixel is the evidence. Where one component holds
`portion` of the weight, that Gaussian alone judges, by its largest deviation over the channels, as the `gaussian` model
does. Where there are several, each is asked, and its squared deviation is raised by twice -log P(k | ki) for each
partner, as a Gaussian's log density is: a component counts less that was not seen with the one, ki, that the partner
shows now. The least is the score, in standard deviations, so that one threshold serves both.

What (3.1) has and this has not: the partner's own rarity, which widens people, and sums over the channels, which tell
people from shadows less well than the largest channel does.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from muybridge._kernels.deviations import pooled_scores, slot_deviations
from muybridge.segmentation.pictures import learn_each
from muybridge.segmentation.spatial import OFFSETS, SpatialBackground, SpatialConfig


@dataclass(frozen=True)
class AutoConfig(SpatialConfig):
    """Settings of the spatial model, in whose place some mean another thing."""

    threshold: float = 4.0
    """Standard deviations."""
    partner_limit: float = 4.0
    """Nats: the most that one partner may count."""
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
            config.threshold**2, config.partner_limit, out,
        )  # fmt: skip
        return out, mixtures.nearest(picture)
