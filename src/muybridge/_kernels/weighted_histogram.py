"""Colour histograms of ellipses whose pixels count less towards the rim (Nummiaro, Koller-Meier and Van Gool 2003, 3).

Every pixel of every ellipse is visited: the weight of a pixel depends on the ellipse, so that no table can help.
"""

from __future__ import annotations

import math

import numpy as np

from muybridge._kernels._jit import kernel

SIDE = 8
BINS = SIDE**3
_SHIFT = 5  # 256 values in 8 bins


@kernel
def _fill_one(image, x, y, half_width, half_height, out):
    """Fill out (BINS,) float64 with the weighted histogram of one ellipse; returns its sum before it is made 1.

    A pixel at distance d from the centre weighs 1 - d^2 / (Hx^2 + Hy^2), (5) and (6).
    """
    height, width = image.shape[0], image.shape[1]
    out[:] = 0.0
    total, reach = 0.0, half_width * half_width + half_height * half_height
    for row in range(max(0, math.ceil(y - half_height)), min(height, math.floor(y + half_height) + 1)):
        dy = row - y
        span = half_width * math.sqrt(max(0.0, 1.0 - (dy / half_height) ** 2))
        for column in range(max(0, math.ceil(x - span)), min(width, math.floor(x + span) + 1)):
            dx = column - x
            weight = 1.0 - (dx * dx + dy * dy) / reach
            u = 0
            for channel in range(3):
                u = u * SIDE + (int(image[row, column, channel]) >> _SHIFT)
            out[u] += weight
            total += weight
    if total > 0.0:
        for u in range(BINS):
            out[u] /= total
    return total


@kernel
def ellipse_histograms(image, states, out):
    """Fill out (N, BINS) float64 from image (H, W, 3) uint8 and states (N, >= 4): centre, width, height, pixels."""
    for n in range(states.shape[0]):
        _fill_one(image, states[n, 0], states[n, 1], states[n, 2] / 2, states[n, 3] / 2, out[n])


@kernel
def ellipse_overlaps(image, states, root_target, out):
    """Fill out (N,) float64 with the Bhattacharyya coefficients rho = sum sqrt(p q), (8); NaN for no pixels.

    root_target : (BINS,) float64, sqrt(q).
    """
    histogram = np.empty(BINS)
    for n in range(states.shape[0]):
        if _fill_one(image, states[n, 0], states[n, 1], states[n, 2] / 2, states[n, 3] / 2, histogram) <= 0.0:
            out[n] = np.nan
            continue
        rho = 0.0
        for u in range(BINS):
            rho += math.sqrt(histogram[u]) * root_target[u]
        out[n] = rho
