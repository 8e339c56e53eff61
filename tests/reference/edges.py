"""What `_kernels.edges` means: walk round every segment, look which pixels are hidden, look the rest up."""

from __future__ import annotations

import numpy as np

from muybridge._kernels.outline import END, KIND, SIDE
from muybridge.body.model import BodyArrays
from reference.colour import depth_order
from reference.silhouette import outlines, segment_mask


def far_point(outline: np.ndarray, end: int, normal: np.ndarray) -> np.ndarray:
    """Where an end's ellipse is farthest along `normal`: c + M n / sqrt(n M n)."""
    x, y, mxx, mxy, myy = outline[END + 6 * end : END + 6 * end + 5]
    matrix = np.array([[mxx, mxy], [mxy, myy]])
    return np.array([x, y]) + matrix @ normal / np.sqrt(normal @ matrix @ normal)


def points(outline: np.ndarray) -> np.ndarray:
    """(M, 2) pixels: ten on each side line, five round each end; twelve round the larger end where it covers the
    other.
    """
    if outline[KIND] == 2:
        sides = [outline[SIDE + 6 * s + 2 : SIDE + 6 * s + 6].reshape(2, 2) for s in range(2)]
        found = [a + (i + 0.5) / 10 * (b - a) for a, b in sides for i in range(10)]
        axis = outline[END + 6 : END + 8] - outline[END : END + 2]
        heading = np.arctan2(axis[1], axis[0])
        for degrees in (60, 30, 0, -30, -60):
            angle = heading + np.radians(degrees)
            normal = np.array([np.cos(angle), np.sin(angle)])
            found += [far_point(outline, 0, -normal), far_point(outline, 1, normal)]
        return np.array(found)
    sizes = [outline[END + 6 * e + 2] + outline[END + 6 * e + 4] for e in range(2)]
    angles = np.radians(30.0 * np.arange(12))
    return np.array([far_point(outline, int(np.argmax(sizes)), np.array([np.cos(a), np.sin(a)])) for a in angles])


def cost(pose: np.ndarray, arrays: BodyArrays, camera: np.ndarray, edge_map: np.ndarray) -> tuple[int, float]:
    """Visible points and their summed (1 - map)^2."""
    width, height = int(camera[23]), int(camera[24])
    before = np.zeros((height, width), bool)
    rows, seen, total = outlines(pose, arrays, camera), 0, 0.0
    for k in depth_order(rows):
        for x, y in points(rows[k]):
            j, i = int(np.floor(x + 0.5)), int(np.floor(y + 0.5))
            if 0 <= i < height and 0 <= j < width and not before[i, j]:
                seen += 1
                total += (1 - float(edge_map[i, j])) ** 2
        before |= segment_mask(rows[k], width, height)
    return seen, total
