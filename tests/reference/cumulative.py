"""What `_kernels.cumulative`, `weighted_histogram` and `occupancy` mean: visit every pixel."""

from __future__ import annotations

import numpy as np


def shares(image: np.ndarray, lanes: np.ndarray, box: np.ndarray) -> np.ndarray:
    """(24,) shares of the box's pixels that fall into each bin; zeros for a box without pixels."""
    left, top, right, bottom = (max(0, int(edge)) for edge in box)
    part = image[top:bottom, left:right].reshape(-1, 3)
    counts = np.zeros(24)
    for pixel in part:
        for channel in range(3):
            counts[lanes[channel, pixel[channel]]] += 1
    return counts / max(1, len(part))


def contrast_score(
    picture: np.ndarray,
    background: np.ndarray,
    shown: np.ndarray,
    lanes: np.ndarray,
    boxes: np.ndarray,
    known: np.ndarray,
    floor: float,
) -> float:
    """Mean over bands, boxes (B, 4), of v (min(|z - b|^2, c^2) - |z - x|^2) / c^2; known (B, 24) is x^2."""
    total = 0.0
    for box, own in zip(boxes, known, strict=True):
        left, top, right, bottom = (int(edge) for edge in box)
        counts, counted = np.zeros((2, 24)), 0
        for y in range(max(0, top), min(bottom, picture.shape[0])):
            for x in range(max(0, left), min(right, picture.shape[1])):
                if shown[y, x]:
                    counted += 1
                    for channel in range(3):
                        counts[0, lanes[channel, picture[y, x, channel]]] += 1
                        counts[1, lanes[channel, background[y, x, channel]]] += 1
        if counted:
            z, b = np.sqrt(counts / counted)
            c = max(float(np.sum((np.sqrt(own) - b) ** 2)), floor**2)
            away = min(float(np.sum((z - b) ** 2)), c) - float(np.sum((z - np.sqrt(own)) ** 2))
            total += counted / ((right - left) * (bottom - top)) * away / c
    return total / len(boxes)


def ellipse_histogram(image: np.ndarray, state: np.ndarray) -> np.ndarray:
    """(512,) Nummiaro's: weights 1 - r^2 with r = d / sqrt(Hx^2 + Hy^2), pixels of the ellipse."""
    x, y, a, b = state[0], state[1], state[2] / 2, state[3] / 2
    histogram = np.zeros((8, 8, 8))
    for row in range(image.shape[0]):
        for column in range(image.shape[1]):
            if ((column - x) / a) ** 2 + ((row - y) / b) ** 2 <= 1:
                r = np.hypot(column - x, row - y) / np.hypot(a, b)
                histogram[tuple(image[row, column] >> 5)] += 1 - r * r
    return (histogram / max(histogram.sum(), 1e-300)).ravel()


def silhouette_score(
    mask: np.ndarray, weights: np.ndarray, state: np.ndarray, gain: np.ndarray, cost: np.ndarray
) -> float:
    """Sum over pixels of gain or cost of the cell that each lies in, times its weight."""
    rows, columns = gain.shape
    x0, y0 = state[0] - state[2] / 2, state[1] - state[3] / 2
    total = 0.0
    for y in range(mask.shape[0]):
        for x in range(mask.shape[1]):
            r, c = (y - y0) / state[3] * rows, (x - x0) / state[2] * columns
            if 0 <= r < rows and 0 <= c < columns:
                table = gain if mask[y, x] else cost
                total += float(weights[y, x]) * table[int(r), int(c)]
    return total
