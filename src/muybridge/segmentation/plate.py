"""The difference to a plate: one picture of the empty scene.

`lab` measures it in CIE Lab with lightness at half weight, so that a change of light counts less than a change of
colour; `rgb` takes the plain Euclidean difference of the three channels. A grey picture has one channel only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.segmentation.pictures import check_same_shape, with_channels

DEFAULT_THRESHOLDS = {"lab": 6.0, "rgb": 20.0, "grey": 8.0}
"""For a quarter of the resolution (grey: a half), where noise has averaged out; about twice that at full resolution.

Means over 24 real pictures of four cameras, against capsules round detected joints; shadows removed, cleaned:

==========  ======  =========  ====
space       recall  precision  IoU
==========  ======  =========  ====
lab 5       0.88    0.82       0.74
lab 6       0.88    0.83       0.74
lab 10      0.84    0.85       0.74
rgb 16      0.88    0.82       0.74
rgb 20      0.87    0.83       0.73
rgb 30      0.85    0.84       0.73
==========  ======  =========  ====

The capsules are no truth either: 0.77 is what perfect-looking masks reach. `lab` lets less shadow and changing light
through.
"""


@dataclass(frozen=True)
class PlateConfig:
    """Settings of the plate model."""

    space: str = "lab"
    """`lab` or `rgb`; grey pictures have only one and ignore it."""
    threshold: float | None = None
    """Difference above which a pixel is foreground: grey values (rgb) or CIE Lab units. None: DEFAULT_THRESHOLDS."""
    lightness_weight: float = 0.5
    """Weight of the L difference in `lab`."""

    def __post_init__(self) -> None:
        if self.space not in ("rgb", "lab"):
            raise InputError("plate background space", expected="rgb or lab", got=repr(self.space))
        if self.threshold is not None and self.threshold <= 0:
            raise InputError("plate background threshold", expected="above 0", got=f"{self.threshold:g}")
        if self.lightness_weight < 0:
            raise InputError("plate lightness_weight", expected="0 or more", got=f"{self.lightness_weight:g}")


class PlateBackground:
    """Foreground is what differs from the plate by more than a threshold."""

    def __init__(self, plate: NDArray, config: PlateConfig | None = None) -> None:
        self.config = config or PlateConfig()
        self._plate = with_channels(plate)
        self._space = "grey" if self._plate.shape[2] == 1 else self.config.space
        self._threshold = self.config.threshold or DEFAULT_THRESHOLDS[self._space]
        self._features = self._measure(self._plate)

    @property
    def background(self) -> NDArray:
        """(H, W, channels): the plate."""
        return self._plate

    def difference(self, image: NDArray) -> NDArray:
        """(H, W) float32: how far each pixel is from the plate, in the units of the threshold."""
        return np.sqrt(self._squared_difference(image))

    def apply(self, image: NDArray) -> NDArray:
        """Foreground (H, W) bool."""
        return self._squared_difference(image) > self._threshold**2

    def _squared_difference(self, image: NDArray) -> NDArray:
        features = self._measure(check_same_shape(image, self._plate.shape))
        return sum((now - then) ** 2 for now, then in zip(features, self._features, strict=True))

    def _measure(self, picture: NDArray) -> list[NDArray]:
        """Channels as float32 planes, in the space where distance is taken."""
        if self._space != "lab":
            return [picture[..., c].astype(np.float32) for c in range(picture.shape[2])]
        import cv2

        lab = cv2.cvtColor(picture.astype(np.float32) / 255, cv2.COLOR_BGR2Lab)
        return [self.config.lightness_weight * lab[..., 0], lab[..., 1], lab[..., 2]]
