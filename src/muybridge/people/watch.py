"""Whether a scene is still the one that was learnt: the camera was moved, the light or the exposure jumped.

People never are most of a picture. So: where the foreground is a large share of it for some pictures in a row,
everything has changed. A camera that was knocked need not change so much; the shift between picture and empty scene,
by phase correlation, tells that, and people, who are a small part of it, do not disturb it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.people.blobs import Mask

Picture = NDArray[np.uint8]
WIDTH = 160  # pixels to which pictures are reduced to find a shift
SURE = 0.15  # response of the phase correlation, 0..1: below, the pictures do not match at all
BETTER = 0.05  # by which the correlation of grey values must rise where the pictures are shifted, and a light cannot


@dataclass(frozen=True, kw_only=True)
class WatchConfig:
    """When a scene counts as changed."""

    share: float = 0.4  # of the picture that is foreground
    shift: float = 1.0  # of 160 parts of the picture's width, by which the camera was moved
    frames: int = 5  # in a row

    def __post_init__(self) -> None:
        if not (0 < self.share <= 1 and self.shift > 0 and self.frames >= 1):
            raise InputError("watch", expected="share above 0 up to 1, shift above 0, frames from 1", got=str(self))


class SceneWatch:
    """Compares pictures with the empty scene (H, W, 3) uint8 BGR."""

    def __init__(self, config: WatchConfig, empty: Picture) -> None:
        self.config = config
        self._full = self._moved = 0
        self.adopt(empty)

    def adopt(self, empty: Picture) -> None:
        """Compare with this one from now on."""
        import cv2

        self.empty = empty
        self._plate = _reduced(empty)
        self._window = cv2.createHanningWindow(self._plate.shape[::-1], cv2.CV_32F)

    def step(self, picture: Picture, mask: Mask) -> str:
        """What has changed with this picture, in one line; empty where nothing has."""
        share = float(mask.mean())
        self._full = self._full + 1 if share > self.config.share else 0
        shift = self.shift(picture)
        self._moved = self._moved + 1 if float(np.hypot(*shift)) > self.config.shift * picture.shape[1] / WIDTH else 0
        if self._moved >= self.config.frames:
            self._full = self._moved = 0
            return f"the camera was moved by {shift[0]:.0f}, {shift[1]:.0f} pixels"
        if self._full >= self.config.frames and not self._moved:
            self._full = self._moved = 0
            return f"{share:.0%} of the picture changed"
        return ""

    def shift(self, picture: Picture) -> tuple[float, float]:
        """(x, y) pixels by which the scene lies further right and down than it did; 0 where nothing matches."""
        import cv2

        small = _reduced(picture)
        # It multiplies what it is given by the window, in place.
        (x, y), response = cv2.phaseCorrelate(self._plate.copy(), small.copy(), self._window)
        if (
            response < SURE
            or _alike(self._plate, small, round(x), round(y)) < _alike(self._plate, small, 0, 0) + BETTER
        ):
            return 0.0, 0.0
        scale = picture.shape[1] / self._plate.shape[1]
        return x * scale, y * scale


def _alike(plate: NDArray[np.float32], picture: NDArray[np.float32], x: int, y: int) -> float:
    """Correlation of the two (h, w) where they overlap, the plate moved right and down by (x, y); light cancels out."""
    height, width = plate.shape
    if abs(x) > width // 2 or abs(y) > height // 2:
        return -1.0
    one = plate[max(0, -y) : height - max(0, y), max(0, -x) : width - max(0, x)]
    other = picture[max(0, y) : height - max(0, -y), max(0, x) : width - max(0, -x)]
    deviations = float(one.std()) * float(other.std())
    return float(((one - one.mean()) * (other - other.mean())).mean()) / deviations if deviations > 0 else 0.0


def _reduced(picture: Picture) -> NDArray[np.float32]:
    """(h, w) float32: grey, WIDTH wide at most."""
    import cv2

    scale = min(1.0, WIDTH / picture.shape[1])
    size = max(8, round(picture.shape[1] * scale)), max(8, round(picture.shape[0] * scale))
    grey = cv2.cvtColor(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), cv2.COLOR_BGR2GRAY)
    return grey.astype(np.float32)
