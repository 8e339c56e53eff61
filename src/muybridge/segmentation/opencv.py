"""OpenCV's own background models, MOG2 and KNN, in the shape of ours: to compare with, and where speed is all.

Zivkovic (2004) and Zivkovic and van der Heijden (2006). Both learn every picture, wherever people are, and say only
which pixels are foreground: they have no score. Shadows are left to `muybridge.segmentation.shadows`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.segmentation.cleaning import check_squares, close_open
from muybridge.segmentation.pictures import check_same_shape, learn_each


@dataclass(frozen=True)
class Mog2Config:
    """Settings of OpenCV's mixture of Gaussians."""

    history: int = 500
    """Pictures: 1 / history is the share of the newest."""
    threshold: float = 16.0
    """Squared standard deviations; OpenCV's varThreshold."""
    closing: int = 3
    """Pixels: as of the mixture model, whose mask is cleaned the same way."""
    opening: int = 5
    """Likewise."""

    def __post_init__(self) -> None:
        _check("mog2 background", self)


@dataclass(frozen=True)
class KnnConfig:
    """Settings of OpenCV's nearest neighbours."""

    history: int = 500
    """Pictures over which samples are spread."""
    threshold: float = 400.0
    """Squared grey values up to which a sample is a neighbour; OpenCV's dist2Threshold."""
    closing: int = 3
    """As of `Mog2Config`."""
    opening: int = 5
    """Likewise."""

    def __post_init__(self) -> None:
        _check("knn background", self)


class OpenCVBackground:
    """A subtractor of OpenCV; `apply` learns the picture."""

    def __init__(self, shape: tuple[int, ...], config: Mog2Config | KnnConfig | None = None) -> None:
        import cv2

        self.config = config or Mog2Config()
        self._shape = shape
        make: Any = cv2.createBackgroundSubtractorMOG2
        if isinstance(self.config, KnnConfig):
            make = cv2.createBackgroundSubtractorKNN
        self._subtractor = make(self.config.history, self.config.threshold, False)

    @classmethod
    def train(cls, pictures: Iterable[NDArray], config: Mog2Config | KnnConfig | None = None) -> OpenCVBackground:
        """Learn from pictures, each (H, W) or (H, W, 3) uint8, all of one size."""
        return learn_each(pictures, lambda shape: cls(shape, config))

    @property
    def background(self) -> NDArray:
        """(H, W, C) uint8: what OpenCV takes for the empty scene."""
        return self._subtractor.getBackgroundImage().reshape(self._shape)

    def learn(self, image: NDArray) -> None:
        """Learn a picture."""
        self._foreground(image)

    def apply(self, image: NDArray) -> NDArray:
        """Foreground (H, W) bool; learns the picture."""
        return close_open(self._foreground(image), self.config.closing, self.config.opening)

    def _foreground(self, image: NDArray) -> NDArray:
        picture = np.ascontiguousarray(check_same_shape(image, self._shape))
        return np.asarray(self._subtractor.apply(picture)).reshape(self._shape[:2]) > 0


def _check(what: str, config: Mog2Config | KnnConfig) -> None:
    if config.history < 1:
        raise InputError(f"{what} history", expected="1 picture or more", got=str(config.history))
    if not 0 < config.threshold < np.inf:
        raise InputError(f"{what} threshold", expected="above 0", got=f"{config.threshold:g}")
    check_squares(what, config.closing, config.opening)
