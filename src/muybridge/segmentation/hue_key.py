"""Blue screen: background is whatever has the screen's hue (the thesis' section 5.1).

Differences from the paper, which thresholds hue alone: hue means nothing where there is hardly any colour, so a
floor on saturation and on brightness is added; set both to 0 for the paper's rule.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.segmentation.pictures import with_channels


@dataclass(frozen=True)
class HueKeyConfig:
    """Settings of the hue key."""

    hue: float = 240.0
    """The screen's hue, degrees: 240 blue, 120 green."""
    tolerance: float = 30.0
    """Degrees either side."""
    minimum_saturation: float = 0.2
    """0..1; below it a pixel has no hue to speak of and is foreground."""
    minimum_brightness: float = 0.1
    """0..1; below it likewise."""

    def __post_init__(self) -> None:
        if not 0 < self.tolerance <= 180:
            raise InputError("hue_key tolerance", expected="in (0, 180] degrees", got=f"{self.tolerance:g}")
        if not 0 <= self.minimum_saturation <= 1 or not 0 <= self.minimum_brightness <= 1:
            raise InputError("hue_key floors", expected="0..1",
                             got=f"{self.minimum_saturation:g} and {self.minimum_brightness:g}")  # fmt: skip


class HueKey:
    """Foreground is what does not have the screen's hue. Needs no training and works at any size."""

    background = None

    def __init__(self, config: HueKeyConfig | None = None) -> None:
        self.config = config or HueKeyConfig()

    def apply(self, image: NDArray) -> NDArray:
        """Foreground (H, W) bool of a colour picture (H, W, 3) uint8 BGR."""
        picture = with_channels(image)
        if picture.shape[2] != 3:
            raise InputError("picture for the hue key", expected="three channels", got="a grey picture")
        import cv2

        hue, saturation, brightness = cv2.split(cv2.cvtColor(picture.astype(np.float32) / 255, cv2.COLOR_BGR2HSV))
        away = np.abs((hue - self.config.hue + 180) % 360 - 180)
        screen = (away <= self.config.tolerance) & (saturation >= self.config.minimum_saturation)
        return ~(screen & (brightness >= self.config.minimum_brightness))
