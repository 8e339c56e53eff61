"""What the kernels look at: cameras as rows of numbers, masks as reduced grey levels and as packed bits."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from muybridge._kernels.bits import pack_rows
from muybridge._kernels.outline import CAMERA_COLUMNS
from muybridge.cameras.distortion import fold_radius_squared
from muybridge.cameras.model import Camera, Rig

#: A reduced mask counts how much of a pixel is foreground, 0 to FULL; one byte a pixel, for many are kept at once.
FULL = 255
HALF = 128  # from here on more foreground than background

#: The factor of distortion is frozen a little inside the fold, where its derivative is still positive.
_FOLD_MARGIN = 0.98


def camera_rows(rig: Rig | Sequence[Camera]) -> np.ndarray:
    """Cameras as the kernels take them, (C, CAMERA_COLUMNS) float64; see `_kernels.outline`."""
    rows = np.zeros((len(rig), CAMERA_COLUMNS))
    for row, camera in zip(rows, rig, strict=True):
        matrix = camera.matrix
        row[:5] = matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2], matrix[0, 1]
        row[5:10] = camera.distortion
        row[10] = min(1e6, _FOLD_MARGIN * fold_radius_squared(camera.distortion)) if np.any(camera.distortion) else 1e6
        row[11:20], row[20:23], row[23:25] = camera.rotation.ravel(), camera.translation, camera.size
    return rows


def reduce_mask(mask: np.ndarray, factor: int) -> np.ndarray:
    """(H, W) bool -> (H // factor, W // factor) uint8: the share of foreground in every block of `factor` x `factor`.

    0 to FULL. What is left over at the right and bottom is cut off, so that the scale is exact.
    """
    height, width = (side // factor * factor for side in mask.shape)
    whole = mask[:height, :width].astype(np.uint8) * np.uint8(FULL)
    if factor == 1:
        return whole
    return cv2.resize(whole, (width // factor, height // factor), interpolation=cv2.INTER_AREA)


def stack_masks(shares: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Masks of several cameras, padded to one size: shares (C, H, W) uint8 and bits (C, H, words) uint64."""
    height, width = max(s.shape[0] for s in shares), max(s.shape[1] for s in shares)
    grey = np.zeros((len(shares), height, width), np.uint8)
    bits = np.zeros((len(shares), height, -(-width // 64)), np.uint64)
    for c, share in enumerate(shares):
        h, w = share.shape
        grey[c, :h, :w] = share
        packed = pack_rows(share >= HALF)
        bits[c, :h, : packed.shape[1]] = packed
    return grey, bits
