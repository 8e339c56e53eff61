"""What `_kernels.silhouette` and `_kernels.draw` mean: pixel by pixel, whether it lies within a segment's span of
its row.
"""

from __future__ import annotations

import numpy as np

from muybridge._kernels.chain import segment_frames
from muybridge._kernels.outline import KIND, OUTLINE_COLUMNS, outlines_of, row_span
from muybridge.body.model import BodyArrays


def outlines(pose: np.ndarray, arrays: BodyArrays, camera: np.ndarray) -> np.ndarray:
    """(K, OUTLINE_COLUMNS) of one pose (D,) in one camera row."""
    frames = segment_frames(np.ascontiguousarray(pose[None]), arrays.parent, arrays.fixed, arrays.axis, arrays.dof)[0]
    out = np.zeros((len(arrays.shaped), OUTLINE_COLUMNS))
    outlines_of(camera, frames, arrays.shaped, arrays.ends, arrays.half_axes, out)
    return out


def segment_mask(outline: np.ndarray, width: int, height: int) -> np.ndarray:
    """(H, W) bool."""
    mask = np.zeros((height, width), bool)
    if outline[KIND] == 0:
        return mask
    columns = np.arange(width)
    for y in range(height):
        left, right = row_span(outline, float(y))
        mask[y] = (left <= columns) & (columns <= right)
    return mask


def model_mask(pose: np.ndarray, arrays: BodyArrays, camera: np.ndarray) -> np.ndarray:
    """(H, W) bool: the union of all segments."""
    width, height = int(camera[23]), int(camera[24])
    return np.any([segment_mask(o, width, height) for o in outlines(pose, arrays, camera)], axis=0)


def iou(observed: np.ndarray, model: np.ndarray) -> float:
    """(5.1)"""
    return np.sum(observed & model) / np.sum(observed | model)


def two_sided(observed: np.ndarray, model: np.ndarray) -> float:
    """(12)"""
    return 0.5 * (np.sum(observed & ~model) / np.sum(observed) + np.sum(model & ~observed) / np.sum(model))
