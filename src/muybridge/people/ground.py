"""How tall a person is in the picture, by where the feet are: what a fixed camera over flat ground lets one expect.

Over flat ground, and with the horizon level in the picture, a standing person's height in pixels is linear in the row
of the feet. `ground_fit` finds the line.

Not in Zhao (2009), who sets thresholds by hand for each camera (5.1).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.people.blobs import Blob

NEAR = (
    0.1  # of the expected height: what agrees with the line; people differ by 4 % (standard deviation), masks by more
)
SHORTEST = 8.0  # pixels, whatever the line says


@dataclass(frozen=True)
class GroundScale:
    """height = offset + slope * row of the feet, in pixels.

    Parameters
    ----------
    offset : float, pixels
    slope : float
    aspect : float
        Width over height.
    spread : float
        Standard deviation of heights and of widths, as a share of what is expected: taken smaller than people's own, so
        that a box is not stretched over two of them.
    """

    offset: float
    slope: float
    aspect: float
    spread: float = 0.04

    def __post_init__(self) -> None:
        if not (np.isfinite([self.offset, self.slope]).all() and self.aspect > 0 and self.spread > 0):
            raise InputError("ground scale", expected="finite numbers, aspect and spread above 0", got=str(self))

    def height(self, feet: float | FloatArray) -> FloatArray:
        """Expected heights, pixels, for rows of feet, of the same shape; at least `SHORTEST`."""
        return np.maximum(SHORTEST, self.offset + self.slope * np.asarray(feet, dtype=np.float64))

    def area(self, feet: float) -> float:
        """Pixels of the box of a person whose feet are in a row."""
        return self.aspect * float(self.height(feet)) ** 2

    def of_person(self, stature: float, breadth: float = 1.0) -> GroundScale:
        """The same for somebody so many times as tall, and for their height as broad, as people are on average."""
        aspect = breadth * self.aspect
        return replace(self, offset=stature * self.offset, slope=stature * self.slope, aspect=aspect)

    def standing(self, x: FloatArray, feet: FloatArray) -> FloatArray:
        """Boxes (N, 4), centre, width, height, of people of the expected size who stand at columns and rows (N,)."""
        height = self.height(feet)
        return np.column_stack([x, feet - height / 2, self.aspect * height, height])

    def log_prob(self, states: FloatArray) -> FloatArray:
        """(N,) how usual the sizes of boxes (N, >= 4) are where they stand, up to a constant."""
        height = (states[:, 3] / self.height(states[:, 1] + states[:, 3] / 2) - 1) / self.spread
        width = (states[:, 2] / states[:, 3] / self.aspect - 1) / self.spread
        return -0.5 * (height * height + width * width)


def touches_side(blob: Blob, picture: tuple[int, int]) -> bool:
    """Whether a region reaches a side of the picture (width, height), and so may go on beyond it."""
    left, top, width, height = blob.box
    return bool(left <= 0 or top <= 0 or left + width >= picture[0] or top + height >= picture[1])
