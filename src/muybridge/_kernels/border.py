"""The border of a mask along a line: how far away it is, and which way it faces."""

from __future__ import annotations

import math

import numpy as np

from muybridge._kernels._jit import kernel

FULL = 255.0  # a mask's value where all of a pixel is foreground
STEP = 0.5  # pixels between looks at the mask


@kernel
def look(mask, x, y):
    """Bilinear value of a mask (H, W) uint8 at a pixel, as a share in [0, 1]; 0 outside the picture."""
    height, width = mask.shape
    x0, y0 = math.floor(x), math.floor(y)
    fx, fy = x - x0, y - y0
    i, j = int(y0), int(x0)
    value = 0.0
    for a in range(2):
        for b in range(2):
            if 0 <= i + a < height and 0 <= j + b < width:
                value += mask[i + a, j + b] * (fy if a else 1.0 - fy) * (fx if b else 1.0 - fx)
    return value / FULL


@kernel
def border_distance(mask, x, y, nx, ny, reach):
    """Signed distance along (nx, ny) to where the mask next falls through one half; `inf` if that is out of reach."""
    here = look(mask, x, y)
    sense = 1.0 if here >= 0.5 else -1.0
    before, travelled = here, 0.0
    while travelled < reach:
        travelled += STEP
        value = look(mask, x + sense * travelled * nx, y + sense * travelled * ny)
        if (value < 0.5) == (sense > 0.0):
            part = (before - 0.5) / (before - value)
            return sense * (travelled - STEP + part * STEP)
        before = value
    return np.inf


@kernel
def border_alignment(mask, x, y, nx, ny):
    """Cosine between the outward normal and the direction in which the mask falls at (x, y), not below 0."""
    gx = look(mask, x - 1.0, y) - look(mask, x + 1.0, y)
    gy = look(mask, x, y - 1.0) - look(mask, x, y + 1.0)
    length = math.sqrt(gx * gx + gy * gy)
    return max(0.0, (gx * nx + gy * ny) / length) if length > 1e-6 else 0.0
