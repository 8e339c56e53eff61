"""A picture as it would be in the light of another: for lamps that are switched, and exposures that follow.

By how much the light has changed is smooth over the picture, and people are not: their share of a wide window is small.
So the change is the ratio of the two pictures cell by cell, the median over a window, and smoothed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

CELLS = 40  # across the picture
WINDOW = 21  # cells: half of the picture's width, so that a person is less than half of it
SMOOTH = 2.0  # cells, standard deviation
STEPS = 64.0  # to a factor of two: the median is taken of whole numbers, and reaches from 1/4 to 4
CHANGED = 1.04  # factor of most of the picture; less is noise, and people


def relit(picture: NDArray[np.uint8], plate: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The picture (H, W, C) in the light of a plate (H, W, C) of the same scene; itself where most of it has that."""
    import cv2

    size = CELLS, max(1, round(CELLS * picture.shape[0] / picture.shape[1]))
    now, then = (cv2.resize(each, size, interpolation=cv2.INTER_AREA).astype(np.float32) for each in (picture, plate))
    change = np.log2((now + 1) / (then + 1))
    if abs(np.median(change)) < np.log2(CHANGED):
        return picture
    gain = np.exp2(_smooth(change))
    gain = cv2.resize(gain, picture.shape[1::-1], interpolation=cv2.INTER_LINEAR)
    return np.clip(picture / gain + 0.5, 0, 255).astype(np.uint8)


def _smooth(change: NDArray[np.float32]) -> NDArray[np.float32]:
    """Medians over a window, then means: of logarithms to base 2 (h, w, C)."""
    import cv2

    middle = 128.0
    coded = np.clip(np.rint(STEPS * change + middle), 0, 255).astype(np.uint8)
    medians = [cv2.medianBlur(np.ascontiguousarray(coded[..., c]), WINDOW) for c in range(coded.shape[2])]
    smooth = cv2.GaussianBlur(np.stack(medians, axis=-1).astype(np.float32), (0, 0), SMOOTH)
    return (smooth.reshape(change.shape) - middle) / STEPS
