"""Evidence made worse on purpose: masks eroded, dilated or with holes, cameras beside where they say they are."""

from __future__ import annotations

import cv2
import numpy as np

from muybridge.cameras.model import Rig

HOLES, HOLE_RADIUS = 4, 0.05  # a mask; of the mask's height
CROSS = np.ones((3, 3), np.uint8)


def spoilt_mask(mask: np.ndarray, fault: str, rng: np.random.Generator) -> np.ndarray:
    """A mask (H, W) bool with a fault of `trial.MASK_FAULTS`: one pixel more or less, or discs cut out."""
    if not fault or not mask.any():
        return mask
    if fault == "holes":
        return _with_holes(mask, rng)
    change = cv2.erode if fault == "eroded" else cv2.dilate
    return change(mask.view(np.uint8), CROSS).view(bool)


def _with_holes(mask: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    rows, columns = np.nonzero(mask)
    radius = max(1, round(HOLE_RADIUS * (rows.max() - rows.min() + 1)))
    out = mask.astype(np.uint8)
    for index in rng.integers(len(rows), size=HOLES):
        cv2.circle(out, (int(columns[index]), int(rows[index])), radius, 0, -1)
    return out.view(bool)


def shifted_rig(rig: Rig, pixels: float, seed: int) -> Rig:
    """Every camera's picture off by so many recorded pixels, each in its own direction."""
    if not pixels:
        return rig
    angles = np.random.default_rng([seed, 20054]).uniform(-np.pi, np.pi, len(rig))
    return Rig(tuple(c.shifted(pixels * np.cos(a), pixels * np.sin(a)) for c, a in zip(rig, angles, strict=True)))
