"""The Gaussian where the background is calm, pairs of pixels where it changes: decided at each pixel, from what it saw.

Zhao (2009, 6.1) finds a single Gaussian better in calm places and the spatial model better where the background
changes, and leaves the choice to future work. Here the mixture of each pixel is the evidence: a pixel whose heaviest
component holds `calm` of the weight has one appearance, and that component alone judges it; every other pixel is judged
by (3.1). Both are measured in nats per colour against evenly spread colours, a Gaussian over one colour and (3.1) over
1 + 2 M of them, so that one threshold serves both.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from muybridge._kernels.pairs import calm_scores
from muybridge.errors import InputError
from muybridge.segmentation.pictures import learn_each
from muybridge.segmentation.spatial import SpatialBackground, SpatialConfig


@dataclass(frozen=True)
class AutoConfig(SpatialConfig):
    """Settings of the spatial model, and when a pixel is calm."""

    calm: float = 0.9
    """Weight of the heaviest component, 0..1, from which on a pixel is judged by it alone."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0 < self.calm <= 1:
            raise InputError("auto background calm", expected="above 0, at most 1", got=f"{self.calm:g}")


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
        heaviest: NDArray = self.mixtures.weights.max(axis=2)
        return heaviest >= self.config.calm

    def _score(self, picture: NDArray) -> NDArray:
        densities, out = self.mixtures.densities(picture), np.empty(picture.shape[:2], np.float32)
        self._pair_scores(densities, out)
        weights, kept = self.mixtures.weights, self.mixtures.kept
        calm_scores(weights, kept, densities, self.config.calm, 1 + 2 * self.config.partners, out)
        return out
