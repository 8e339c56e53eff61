"""A normal distribution for each pixel of the empty scene.

N pictures without the person give every pixel and channel its mean and standard deviation; what lies further
from the mean than a few standard deviations is foreground (Du 2005, 5.1, asks for N > 100 and 2 to 3 standard
deviations). With an `update_rate` both follow the pictures, as the Gaussian background model of Zhao (2009, 2.3, 2.4).

Differences from the papers: variances are those of the channels, not a covariance; the standard deviation has a
floor, because a pixel that never changed by chance would otherwise call every later change foreground; the on-line
update leaves foreground alone unless `selective` is switched off, so a person who stands still is not learnt into the
background.
"""

from __future__ import annotations

from collections.abc import Iterable
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
    """rho of (2.3, 2.4), 0..1: share of each new pixel in mean and variance; 0 keeps the model as trained."""
    selective: bool = True
    """Learn background alone; False learns every pixel, as (2.3, 2.4) are printed."""

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
    def train(cls, pictures: Iterable[NDArray], config: GaussianConfig | None = None) -> GaussianBackground:
        """Learn from pictures of the empty scene, each (H, W) or (H, W, 3) uint8, all of one size."""
        count, mean, squares = 0, np.zeros(0), np.zeros(0)
        for picture in pictures:
            values = (check_same_shape(picture, mean.shape) if count else with_channels(picture)).astype(np.float64)
            if not count:
                mean, squares = np.zeros(values.shape), np.zeros(values.shape)
            count += 1
            step = values - mean
            mean += step / count
            squares += step * (values - mean)
        if count < MINIMUM_PICTURES:
            raise InputError(
                "empty pictures for the gaussian background",
                expected=f"{MINIMUM_PICTURES} or more (better 100)",
                got=str(count),
                remedy="give a clip of the empty scene, or use the plate model with one picture",
            )
        return cls(mean, squares / (count - 1), config)

    @property
    def background(self) -> NDArray:
        """(H, W, channels) float32: the empty scene as it is believed to look now."""
        return self.mean

    def score(self, image: NDArray) -> NDArray:
        """(H, W) float32: standard deviations from the mean, the largest over the channels; learns nothing."""
        difference = self._difference(image)
        return np.sqrt(_largest(difference * difference / self._spread()))

    def apply(self, image: NDArray) -> NDArray:
        """Foreground (H, W) bool; learns where `update_rate` is above 0."""
        difference = self._difference(image)
        squared = difference * difference
        mask: NDArray = _largest(squared > self.config.threshold**2 * self._spread())
        if self.config.update_rate:
            self._learn(difference, ~mask if self.config.selective else np.ones_like(mask))
        return mask

    def _difference(self, image: NDArray) -> NDArray:
        return check_same_shape(image, self.mean.shape).astype(np.float32) - self.mean

    def _spread(self) -> NDArray:
        return np.maximum(self.variance, np.float32(self.config.sd_floor**2))

    def _learn(self, difference: NDArray, where: NDArray) -> None:
        """(2.3) and (2.4): the variance is that about the new mean."""
        rate = np.float32(self.config.update_rate) * where[..., None]
        self.mean = self.mean + rate * difference
        self.variance = self.variance + rate * (np.square((1 - rate) * difference) - self.variance)


def _largest(values: NDArray) -> NDArray:
    """(H, W): the largest over the channels (H, W, C)."""
    out = values[..., 0]
    for channel in range(1, values.shape[2]):
        out = np.maximum(out, values[..., channel])
    return out
