"""How tall a person is in the picture, by where the feet are: what a fixed camera over flat ground lets one expect.

Over flat ground, and with the horizon level in the picture, a standing person's height in pixels is linear in the row
of the feet. The line is fitted to regions of the foreground: most are one person each, the others are outliers.

Not in Zhao (2009), who sets thresholds by hand for each camera (5.1).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.people.blobs import Blob

FEWEST = 12  # regions; fewer say nothing about a line
TRIALS, ROUNDS = 300, 8  # of the robust fit: pairs tried, refinements
NEAR = 0.1  # of the expected height: what agrees with a line; people differ by 4 % (standard deviation), masks by more
ABOVE = 0.5  # of a vote, against a line, of each region well above it: one that is two people, or the line is too low
SAME = 3  # pixels: regions whose lower left corners are nearer are one that stands, seen again
SHORTEST = 8.0  # pixels, whatever the line says
UPRIGHT = (0.15, 0.7)  # width over height of what may be one standing person


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
    spread: float = 0.06

    def __post_init__(self) -> None:
        if not (np.isfinite([self.offset, self.slope]).all() and self.aspect > 0 and self.spread > 0):
            raise InputError("ground scale", expected="finite numbers, aspect and spread above 0", got=str(self))

    def height(self, feet: float | FloatArray) -> FloatArray:
        """Expected heights, pixels, for rows of feet, of the same shape; at least `SHORTEST`."""
        return np.maximum(SHORTEST, self.offset + self.slope * np.asarray(feet, dtype=np.float64))

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


def fit_ground(blobs: Sequence[Blob], picture: tuple[int, int]) -> GroundScale | None:
    """The line most regions agree on, of a picture (width, height); None where too few look like standing people.

    Regions that touch a side of the picture are cut off and say nothing.
    """
    whole = [blob.box for blob in blobs if not touches_side(blob, picture)]
    boxes = np.array(whole).reshape(-1, 4)
    shape = boxes[:, 2] / np.maximum(boxes[:, 3], 1)
    boxes = _once(boxes[(shape > UPRIGHT[0]) & (shape < UPRIGHT[1])])
    if len(boxes) < FEWEST:
        return None
    feet, heights = boxes[:, 1] + boxes[:, 3] - 0.5, boxes[:, 3]
    near = _agreeing(feet, heights)
    for _ in range(ROUNDS):
        offset, slope = _least_squares(feet[near], heights[near])
        close = _close(feet, heights, offset, slope)
        if close.sum() < FEWEST / 2 or (close == near).all():
            break
        near = close
    return GroundScale(float(offset), float(slope), float(np.median(boxes[near, 2] / boxes[near, 3])))


def touches_side(blob: Blob, picture: tuple[int, int]) -> bool:
    """Whether a region reaches a side of the picture (width, height), and so may go on beyond it."""
    left, top, width, height = blob.box
    return bool(left <= 0 or top <= 0 or left + width >= picture[0] or top + height >= picture[1])


def _once(boxes: FloatArray) -> FloatArray:
    """Boxes (N, 4) without those of somebody who stands there already: the narrowest stays, alone more likely."""
    boxes = boxes[np.argsort(boxes[:, 2], kind="stable")]
    corners = np.column_stack([boxes[:, 0], boxes[:, 1] + boxes[:, 3]])
    _, first = np.unique(np.rint(corners / SAME), axis=0, return_index=True)
    return boxes[np.sort(first)]


def _agreeing(feet: FloatArray, heights: FloatArray) -> NDArray[np.bool_]:
    """Which lie near the line through some two of them that fits best; people do not shrink towards the camera.

    What is cut short, by a thing in the way or by a hole in the mask, lies below the line, and little above: so what
    does counts against it.
    """
    rng = np.random.default_rng(0)  # only which pairs are tried
    best = np.ones(len(feet), bool)
    most = 0.0
    for a, b in rng.integers(0, len(feet), (TRIALS, 2)):
        span = feet[b] - feet[a]
        slope = 0.0 if abs(span) < 1 else (heights[b] - heights[a]) / span
        offset = heights[a] - slope * feet[a]
        close = _close(feet, heights, offset, slope)
        above = heights > (1 + 2 * NEAR) * np.maximum(SHORTEST, offset + slope * feet)
        score = float(close.sum()) - ABOVE * float(above.sum())
        if 0 <= slope < 1 and score > most:
            most, best = score, close
    return best


def _least_squares(feet: FloatArray, heights: FloatArray) -> tuple[float, float]:
    """Offset and slope; level where all feet are in one row."""
    if np.ptp(feet) < 1:
        return float(heights.mean()), 0.0
    matrix = np.column_stack([np.ones(len(feet)), feet])
    offset, slope = np.linalg.lstsq(matrix, heights, rcond=None)[0]
    return float(offset), float(slope)


def _close(feet: FloatArray, heights: FloatArray, offset: float, slope: float) -> NDArray[np.bool_]:
    close: NDArray[np.bool_] = np.abs(heights / np.maximum(SHORTEST, offset + slope * feet) - 1) < NEAR
    return close
