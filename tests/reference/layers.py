"""Literal twins of `_kernels.layers`."""

from __future__ import annotations

import numpy as np


def composite(
    background: np.ndarray, coverage: np.ndarray, colours: np.ndarray, depth: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Back to front, pixel by pixel: each layer over what lies behind it; and what of each is left to see."""
    picture, visible = background.astype(np.float64), np.zeros(coverage.shape)
    for y, x in np.ndindex(background.shape[:2]):
        near_first = np.argsort(depth[:, y, x], kind="stable")
        for index in near_first[::-1]:
            picture[y, x] = picture[y, x] * (1.0 - coverage[index, y, x]) + colours[index, y, x]
        left = 1.0
        for index in near_first:
            visible[index, y, x] = left * coverage[index, y, x]
            left *= 1.0 - coverage[index, y, x]
    return picture, visible


def mark_parts(pixels: np.ndarray, faces: np.ndarray, face_parts: np.ndarray, height: int, width: int) -> np.ndarray:
    """(H, W) uint32: a pixel's centre is in a face if it is on the same side of all three edges, or on one."""
    marks = np.zeros((height, width), dtype=np.uint32)
    for face, part in zip(faces, face_parts, strict=True):
        corners = pixels[face]
        if not np.isfinite(corners).all():
            continue
        for y, x in np.ndindex(height, width):
            sides = []
            for first, second in zip(corners, np.roll(corners, -1, axis=0), strict=True):
                along, to = second - first, np.array([x, y]) - first
                sides.append(along[0] * to[1] - along[1] * to[0])
            if min(sides) >= 0 or max(sides) <= 0:
                marks[y, x] |= np.uint32(1 << part)
    return marks
