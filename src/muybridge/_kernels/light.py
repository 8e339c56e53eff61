"""Divide a picture by a light that changes smoothly over it: the exponential of a quadratic of the place.

Along a row such a light is a product of three numbers from pixel to pixel, so that no exponential is taken but at the
row's beginning.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from muybridge._kernels._jit import parallel_kernel


@parallel_kernel
def _over_rows_relight(image, field, out):
    height, width = image.shape[:2]
    step = 2.0 / max(width - 1, 1)
    for row in numba.prange(height):
        y = 2.0 * row / max(height - 1, 1) - 1.0
        for c in range(image.shape[2]):
            linear, square = field[1, c] + field[4, c] * y, field[3, c]
            start = field[0, c] + field[2, c] * y + field[5, c] * y * y - linear + square
            gain = math.exp(-start)
            ratio = math.exp(-(linear * step + square * (step * step - 2.0 * step)))
            bend = math.exp(-2.0 * square * step * step)
            for x in range(width):
                out[row, x, c] = np.uint8(min(255.0, image[row, x, c] * gain + 0.5))
                gain *= ratio
                ratio *= bend


def relight(image, field, out):
    """Divide by exp(1, x, y, x^2, x y, y^2 times `field`), where x and y go from -1 to 1 over the picture.

    Parameters
    ----------
    image : (H, W, C) uint8
    field : (6, C) float64
    out : (H, W, C) uint8, filled: rounded, and 255 where it would be more
    """
    _over_rows_relight(image, field, out)
