"""The Gaussian where the background is calm, pairs of pixels where it changes: decided at each pixel, from what it saw.

Zhao (2009, 6.1) finds a single Gaussian better in calm places and the spatial model better where the background
changes, and leaves the choice to future work. Here both judge. The spatial model's score (3.1), of 1 + M densities, is
taken for the deviation at which each of them would have fallen as far. Where one component holds `calm` of a pixel's
weight, it has a deviation too, as a Gaussian by itself (2.3, 2.4), the largest over the channels. The larger of the two
counts, in standard deviations.

That Gaussian is the pixel's heaviest component. What people leave behind in the others, their shadows and whoever stood
there, it knows nothing of. Where foreground was learnt, as a door that was opened, the spatial model judges alone until
the pixel shows its heaviest component again.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from muybridge._kernels.mixture import TAIL
from muybridge.errors import InputError
from muybridge.segmentation.pictures import learn_each
from muybridge.segmentation.spatial import SpatialBackground, SpatialConfig


@dataclass(frozen=True)
class AutoConfig(SpatialConfig):
    """Settings of the spatial model, and of the Gaussian beside it."""

    threshold: float = 5.0
    """Standard deviations."""
    learnt_threshold: float = 0.0
    """Nats of the spatial model's score, above which nothing is learnt as background: its own threshold."""
    calm: float = 0.8
    """Share of the weight that one look holds where the background is calm, 0..1; 0: everywhere."""
    gaussian_weight: float = 1.25
    """What a standard deviation of the Gaussian counts against one of the spatial model."""
    deviation_floor: float = 4.0
    """Grey values: the least standard deviation of the Gaussian."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if not np.isfinite(self.learnt_threshold):
            raise InputError("auto background learnt_threshold", expected="nats", got=f"{self.learnt_threshold:g}")
        if not 0 <= self.calm <= 1:
            raise InputError("auto background calm", expected="0 to 1", got=f"{self.calm:g}")
        if not 0 <= self.gaussian_weight < np.inf:
            raise InputError("auto background gaussian_weight", expected="0 or more", got=f"{self.gaussian_weight:g}")
        if not 0 < self.deviation_floor < np.inf:
            raise InputError("auto background deviation_floor", expected="above 0", got=f"{self.deviation_floor:g}")


class AutoBackground(SpatialBackground):
    """A spatial model, and the Gaussian of each pixel whose background is calm."""

    config: AutoConfig

    def __init__(self, shape: tuple[int, ...], config: AutoConfig | None = None) -> None:
        super().__init__(shape, config or AutoConfig())
        self._new = np.zeros(shape[:2], bool)  # shows what was learnt as foreground

    @classmethod
    def train(cls, pictures: Iterable[NDArray], config: SpatialConfig | None = None) -> AutoBackground:
        """Learn from pictures, each (H, W) or (H, W, 3) uint8, all of one size; people may pass through."""
        return learn_each(pictures, lambda shape: cls(shape, config))  # type: ignore[arg-type]

    def score(self, image: NDArray) -> NDArray:
        """(H, W) float32, standard deviations; learns nothing."""
        picture = self._checked(image)
        picture = self._light.taken_out(picture, self._field(picture))
        return self._larger(picture, self._judged(picture)[0])

    def apply(self, image: NDArray) -> NDArray:
        """Foreground (H, W) bool; learns what is background to the spatial model."""
        picture = self._followed(self._checked(image))
        score, nearest = self._judged(picture)
        mask = self._cleaned(self._larger(picture, score) > self.config.threshold)
        self._learn_around(self._cleaned(score > self.config.learnt_threshold), picture, nearest)
        return mask

    def _larger(self, picture: NDArray, score: NDArray) -> NDArray:
        """(H, W) float32: the deviation of the spatial model's score (H, W), or the Gaussian's where that is larger."""
        config = self.config
        gaussian = self.mixtures.calm_deviations(picture, config.calm, config.deviation_floor)
        gaussian *= np.float32(config.gaussian_weight) * ~self._new
        return np.maximum(self._as_deviation(score), gaussian)

    def _learn_around(self, mask: NDArray, picture: NDArray, nearest: NDArray) -> None:
        super()._learn_around(mask, picture, nearest)
        of = self.mixtures
        self._new |= mask & ((of.matched >= 0) | (of.fresh >= 0))
        self._new &= of.matched != of.weights.argmax(axis=1)

    def _as_deviation(self, score: NDArray) -> NDArray:
        """(H, W) float32: root mean square over the channels, in standard deviations, at which the pixel's densities,
        alone and with each partner, have a score (H, W) of (3.1), falling alike from that of the least noise."""
        channels, partners = self.mixtures.shape[2], self.config.partners
        highest = channels * np.log(256.0 / (np.sqrt(2.0 * np.pi) * self.config.sd_floor))
        fallen = np.maximum((score + (1 + 2 * partners) * highest) / (1 + partners), 0.0)
        squared = np.where(fallen > TAIL / 2, TAIL * np.exp(2.0 * fallen / TAIL - 1.0), 2.0 * fallen)
        deviation: NDArray = np.sqrt(squared / channels).astype(np.float32)
        return deviation
