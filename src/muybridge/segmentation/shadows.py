"""Shadows: foreground pixels that are only a darker background.

A shadow scales the light of what it falls on and leaves its colour nearly alone. So a pixel is shadow where brightness
over the plate's brightness lies in a range below and about 1 and the chromaticity (b, g, r over their sum) has hardly moved.
A grey picture has no colour; there the ratio must be even over a small window, because a shadow keeps
the texture of the ground and a person does not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.segmentation.pictures import check_same_shape, with_channels


@dataclass(frozen=True)
class ShadowConfig:
    """What counts as a shadow."""

    darkest: float = 0.45
    """Smallest ratio of brightness to the plate's."""
    brightest: float = 1.05
    """Largest ratio; a little above 1, for light reflected by the person."""
    chroma_change: float = 0.025
    """Largest Euclidean change of the chromaticities b, g, r = B, G, R / (B + G + R)."""
    grey_spread: float = 0.05
    """Grey pictures: largest standard deviation of the ratio over 5 x 5 pixels."""
    minimum_brightness: float = 12.0
    """Mean grey value of the plate below which nothing can be told from the colour: never shadow."""

    def __post_init__(self) -> None:
        if not 0 <= self.darkest < self.brightest:
            raise InputError("shadow brightness range", expected="0 <= darkest < brightest",
                             got=f"{self.darkest:g} and {self.brightest:g}")  # fmt: skip
        if self.chroma_change < 0 or self.grey_spread < 0:
            raise InputError("shadow chroma_change and grey_spread", expected="0 or more",
                             got=f"{self.chroma_change:g} and {self.grey_spread:g}")  # fmt: skip


def shadow_mask(image: NDArray, background: NDArray, config: ShadowConfig | None = None) -> NDArray:
    """Where the picture looks like the background with less light on it.

    Parameters
    ----------
    image, background : (H, W) or (H, W, channels) uint8 or float32
        The picture and the empty scene, of one size.

    Returns
    -------
    (H, W) bool
        True on shadow, and on unchanged background; combine it as `mask & ~shadow_mask(...)`.
    """
    config = config or ShadowConfig()
    empty = with_channels(background).astype(np.float32)
    picture = check_same_shape(image, empty.shape).astype(np.float32)
    light, light_before = picture.mean(axis=2), empty.mean(axis=2)
    ratio = light / np.maximum(light_before, 1)
    darker = (ratio >= config.darkest) & (ratio <= config.brightest) & (light_before >= config.minimum_brightness)
    if picture.shape[2] == 1:
        return darker & (_local_spread(ratio) <= config.grey_spread)
    before = empty / np.maximum(3 * light_before, 1)[..., None]
    change = picture / np.maximum(3 * light, 1)[..., None] - before
    return darker & ((change * change).sum(axis=2) <= config.chroma_change**2)


def _local_spread(ratio: NDArray) -> NDArray:
    """Standard deviation over 5 x 5 pixels."""
    import cv2

    mean = cv2.blur(ratio, (5, 5))
    return np.sqrt(np.maximum(cv2.blur(ratio * ratio, (5, 5)) - mean * mean, 0))
