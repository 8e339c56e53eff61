"""How tall a person is in the picture, by where the feet are: what a fixed camera over flat ground lets one expect.

Over flat ground, and with the horizon level in the picture, a standing person's height in pixels is linear in the row
of the feet. The line is fitted to regions of the foreground, most of which are one person each; the others are outliers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from muybridge.filters.particles import FloatArray
from muybridge.people.blobs import Blob

FEWEST = 12  # regions; fewer say nothing about a line
ROUNDS, TRIALS = 8, 300
SPREAD = 0.06  # of the expected height, standard deviation: adults, and what a mask misses at head and feet
UPRIGHT = (0.15, 0.7)  # width over height of what may be one standing person


@dataclass(frozen=True)
class GroundScale:
    """height = offset + slope * foot row, in pixels; `aspect` is width over height; `spread` that of the heights."""

    offset: float
    slope: float
    aspect: float
    spread: float = SPREAD

    def height(self, feet: FloatArray) -> FloatArray:
        """Expected heights (N,), pixels, for the rows of the feet (N,); at least 8."""
        return np.maximum(8.0, self.offset + self.slope * np.asarray(feet, dtype=np.float64))

    def log_prob(self, states: FloatArray) -> FloatArray:
        """(N,) how usual the sizes of boxes (N, >= 4) are where they stand, up to a constant."""
        expected = self.height(states[:, 1] + states[:, 3] / 2)
        height = (states[:, 3] / expected - 1) / self.spread
        width = (states[:, 2] / states[:, 3] / self.aspect - 1) / self.spread
        return -0.5 * (height * height + width * width)

    @classmethod
    def fit(cls, blobs: Sequence[Blob], picture: tuple[int, int]) -> GroundScale | None:
        """The line most of the regions agree on, of a picture (width, height); None where too few look like people.

        Regions that touch a side of the picture are cut off and say nothing.
        """
        boxes = np.array([blob.box for blob in blobs]).reshape(-1, 4)
        inside = (boxes[:, :2] > 0).all(axis=1) & (boxes[:, :2] + boxes[:, 2:] < np.array(picture)).all(axis=1)
        shape = boxes[:, 2] / np.maximum(boxes[:, 3], 1)
        boxes = boxes[inside & (shape > UPRIGHT[0]) & (shape < UPRIGHT[1])]
        if len(boxes) < FEWEST:
            return None
        feet, heights = boxes[:, 1] + boxes[:, 3] - 0.5, boxes[:, 3]
        offset, slope, near = _line(feet, heights)
        aspect = float(np.median(boxes[near, 2] / boxes[near, 3]))
        return cls(offset, slope, aspect)


def _line(feet: FloatArray, heights: FloatArray) -> tuple[float, float, NDArray[np.bool_]]:
    """The line that most pairs lie near, then least squares over these; and which they are."""
    rng = np.random.default_rng(0)  # of the fit alone: which pairs are tried
    best, near = -1, np.ones(len(feet), bool)
    for _ in range(TRIALS):
        a, b = rng.choice(len(feet), 2, replace=False)
        span = feet[b] - feet[a]
        slope = 0.0 if abs(span) < 1 else (heights[b] - heights[a]) / span
        close = _close(feet, heights, heights[a] - slope * feet[a], slope)
        if 0 <= slope < 1 and close.sum() > best:
            best, near = int(close.sum()), close
    offset = slope = 0.0
    for _ in range(ROUNDS):
        matrix = np.column_stack([np.ones(near.sum()), feet[near]])
        offset, slope = np.linalg.lstsq(matrix, heights[near], rcond=None)[0]
        close = _close(feet, heights, offset, slope)
        if close.sum() < 2 or (close == near).all():
            break
        near = close
    return float(offset), float(slope), near


def _close(feet: FloatArray, heights: FloatArray, offset: float, slope: float) -> NDArray[np.bool_]:
    expected = np.maximum(8.0, offset + slope * feet)
    close: NDArray[np.bool_] = np.abs(heights / expected - 1) < SPREAD
    return close
