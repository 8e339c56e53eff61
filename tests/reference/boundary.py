"""What `_kernels.boundary` means: erosion, Moore's tracing as a textbook has it, and the transform as a sum."""

from __future__ import annotations

import cv2
import numpy as np

CLOCKWISE = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]  # (dx, dy), y down, from east


def border_pixels(mask: np.ndarray) -> np.ndarray:
    """B = S - erode(S, 3 x 3), (5.8): (H, W) bool."""
    padded = np.pad(mask, 1)
    height, width = mask.shape
    windows = [padded[1 + dy : 1 + dy + height, 1 + dx : 1 + dx + width] for dx in (-1, 0, 1) for dy in (-1, 0, 1)]
    return mask & ~np.all(windows, axis=0)


def trace(mask: np.ndarray) -> list[tuple[int, int]]:
    """Outer border of the component that holds the topmost, there leftmost pixel, clockwise, as (x, y)."""
    ys, xs = np.nonzero(mask)
    start = (int(xs[0]), int(ys[0]))
    here, back, second = start, (start[0] - 1, start[1]), None
    border = []
    while True:
        first = CLOCKWISE.index((back[0] - here[0], back[1] - here[1]))
        for turn in range(1, 9):
            dx, dy = CLOCKWISE[(first + turn) % 8]
            x, y = here[0] + dx, here[1] + dy
            if 0 <= y < mask.shape[0] and 0 <= x < mask.shape[1] and mask[y, x]:
                break
            back = (x, y)
        else:
            return [start]
        if here == start and (x, y) == second:  # the second time that it leaves the start this way
            return border
        second = second or (x, y)
        border.append(here)
        here = (x, y)


def descriptor(border: list[tuple[int, int]], samples: int = 256) -> np.ndarray:
    """(samples,) complex: the transform over `samples`, (5.10), of points at equal steps along the closed border."""
    closed = np.array([*border, border[0]], float)
    places = np.arange(samples) * len(border) / samples
    steps = np.arange(len(border) + 1)
    curve = np.interp(places, steps, closed[:, 0]) + 1j * np.interp(places, steps, closed[:, 1])
    n = np.arange(samples)
    return np.array([np.sum(curve * np.exp(-2j * np.pi * f * n / samples)) for f in n]) / samples


def distance(a: np.ndarray, b: np.ndarray, coefficients: int) -> float:
    """Euclidean distance of the lowest frequencies, -coefficients / 2 and up."""
    lowest = np.arange(coefficients) - coefficients // 2
    return float(np.linalg.norm(a[lowest] - b[lowest]))


def largest_border(mask: np.ndarray) -> list[tuple[int, int]]:
    """Border of the 8-connected component that encloses most pixels, holes included."""
    number, labels = cv2.connectedComponents(mask.astype(np.uint8), connectivity=8)
    borders = [trace(labels == i) for i in range(1, number)]
    return max(borders, key=lambda b: cv2.contourArea(np.array(b, np.int32)) + len(b) / 2)
