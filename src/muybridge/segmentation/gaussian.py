"""A normal distribution for each pixel of the empty scene.

N pictures without the person give every pixel and channel its mean and standard deviation; what lies further
from the mean than a few standard deviations is foreground (the thesis' section 5.1 asks for N > 100 and 2 to 3
standard deviations).

Differences from the paper: the standard deviation has a floor, because a pixel that never changed by chance would
otherwise call every later change foreground; the on-line update leaves foreground alone, so a person who
stands still is not learnt into the background.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.segmentation.pictures import check_same_shape, with_channels

MINIMUM_PICTURES = 5
"""Fewer say nothing about a spread; the paper asks for more than 100."""


@dataclass(frozen=True)
class GaussianConfig:
    """Settings of the Gaussian model."""

    threshold: float = 3.0
    """Standard deviations; the largest over the channels decides (paper: 2 to 3)."""
    sd_floor: float = 4.0
    """Grey values of 255. Lower it with the noise: 2 suits pictures reduced to a quarter."""
    update_rate: float = 0.0
    """Share of each new background pixel that enters the mean and the variance, 0..1; 0 keeps the model as trained."""

    def __post_init__(self) -> None:
        if self.threshold <= 0 or self.sd_floor <= 0:
            raise InputError("gaussian background", expected="threshold and sd_floor above 0",
                             got=f"{self.threshold:g} and {self.sd_floor:g}")  # fmt: skip
        if not 0 <= self.update_rate <= 1:
            raise InputError("gaussian background update_rate", expected="0..1", got=f"{self.update_rate:g}")


class GaussianBackground:
    """Mean and variance of every pixel; `apply` changes them only where `update_rate` is above 0.

    Attributes
    ----------
    mean, variance : (H, W, channels) float32, grey values and their squares
    """

    def __init__(self, mean: NDArray, variance: NDArray, config: GaussianConfig | None = None) -> None:
        self.mean, self.variance = mean.astype(np.float32), variance.astype(np.float32)
        self.config = config or GaussianConfig()

    @classmethod
    def train(cls, pictures: Sequence[NDArray], config: GaussianConfig | None = None) -> GaussianBackground:
        """Learn from pictures of the empty scene, each (H, W) or (H, W, 3) uint8, all of one size."""
        if len(pictures) < MINIMUM_PICTURES:
            raise InputError(
                "empty pictures for the gaussian background",
                expected=f"{MINIMUM_PICTURES} or more (better 100)",
                got=str(len(pictures)),
                remedy="give a clip of the empty scene, or use the plate model with one picture",
            )
        shape = with_channels(pictures[0]).shape
        total, squares = np.zeros(shape), np.zeros(shape)
        for picture in pictures:
            values = check_same_shape(picture, shape).astype(np.float64)
            total += values
            squares += values * values
        mean = total / len(pictures)
        variance = (squares - len(pictures) * mean * mean) / (len(pictures) - 1)
        return cls(mean, np.maximum(variance, 0), config)

    @property
    def background(self) -> NDArray:
        """(H, W, channels) float32: the empty scene as it is believed to look now."""
        return self.mean

    def apply(self, image: NDArray) -> NDArray:
        """Foreground (H, W) bool; learns from the background pixels where `update_rate` is above 0."""
        difference = check_same_shape(image, self.mean.shape).astype(np.float32) - self.mean
        squared = difference * difference
        limit = self.config.threshold**2 * np.maximum(self.variance, self.config.sd_floor**2)
        mask: NDArray = np.any(squared > limit, axis=2)
        if self.config.update_rate:
            self._learn(difference, squared, ~mask)
        return mask

    def _learn(self, difference: NDArray, squared: NDArray, where: NDArray) -> None:
        rate = np.float32(self.config.update_rate) * where[..., None]
        self.mean = self.mean + rate * difference
        self.variance = (1 - rate) * self.variance + rate * squared
