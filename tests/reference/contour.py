"""What `_kernels.contour` means: walk in small steps to the mask's border, and move the pose a little to see the
outline move.
"""

from __future__ import annotations

import numpy as np

from muybridge._kernels.outline import END
from muybridge.body.model import BodyArrays
from reference.silhouette import outlines


def look(mask: np.ndarray, x: float, y: float) -> float:
    """Bilinear value of a mask (H, W), 0 outside."""
    padded = np.pad(mask.astype(float), 1)
    x, y = np.clip(x + 1, 0, padded.shape[1] - 1.000001), np.clip(y + 1, 0, padded.shape[0] - 1.000001)
    i, j = int(y), int(x)
    v, u = y - i, x - j
    upper = padded[i, j] * (1 - u) + padded[i, j + 1] * u
    lower = padded[i + 1, j] * (1 - u) + padded[i + 1, j + 1] * u
    return float(upper * (1 - v) + lower * v)


def distance(mask: np.ndarray, pixel: np.ndarray, normal: np.ndarray, reach: float, step: float = 0.01) -> float:
    """Signed distance along the normal to where the mask first falls (inside: outwards) or rises (outside: inwards)."""
    inside = look(mask, *pixel) >= 0.5
    sense = 1.0 if inside else -1.0
    for travelled in np.arange(step, reach, step):
        if (look(mask, *(pixel + sense * travelled * normal)) >= 0.5) != inside:
            return sense * travelled
    return np.inf


def reach_of(outline: np.ndarray, end: int, normal: np.ndarray) -> float:
    """How far an end reaches along a normal: c n + sqrt(n M n)."""
    x, y, mxx, mxy, myy = outline[END + 6 * end : END + 6 * end + 5]
    matrix = np.array([[mxx, mxy], [mxy, myy]])
    return float(np.array([x, y]) @ normal + np.sqrt(normal @ matrix @ normal))


def slope(
    pose: np.ndarray, arrays: BodyArrays, camera: np.ndarray, segment: int, along: float, normal: np.ndarray, dof: int
) -> float:
    """Pixels along the normal per metre or radian, by central differences; `along` 0 at the base, 1 at the tip."""
    size, k = 1e-5, list(arrays.shaped).index(segment)
    step = np.zeros(len(pose))
    step[dof] = size
    ahead, behind = (outlines(pose + sign * step, arrays, camera)[k] for sign in (1, -1))
    moved = [reach_of(ahead, e, normal) - reach_of(behind, e, normal) for e in range(2)]
    return ((1 - along) * moved[0] + along * moved[1]) / (2 * size)
