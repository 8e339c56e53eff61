"""What `_kernels.outline` means: the convex hull of a cone's densely sampled, exactly projected surface."""

from __future__ import annotations

import cv2
import numpy as np

from muybridge.cameras.model import Camera


def end_points(frame: np.ndarray, end: np.ndarray, half_axes: np.ndarray, steps: int = 60) -> np.ndarray:
    """Points on the surface of one end's ellipsoid (or disc), world: (M, 3) for frame (3, 4), end (3,), half_axes
    (3, 3).
    """
    turn, tilt = np.meshgrid(np.linspace(0, 2 * np.pi, 2 * steps), np.linspace(-np.pi / 2, np.pi / 2, steps))
    unit = np.stack([np.cos(tilt) * np.cos(turn), np.cos(tilt) * np.sin(turn), np.sin(tilt)], axis=-1).reshape(-1, 3)
    return (end + unit @ half_axes) @ frame[:, :3].T + frame[:, 3]


def hull(camera: Camera, frame: np.ndarray, ends: np.ndarray, half_axes: np.ndarray) -> np.ndarray:
    """Corners (M, 2) of the convex hull of a segment's picture, pixels."""
    points = np.concatenate([end_points(frame, ends[e], half_axes[e]) for e in range(2)])
    return cv2.convexHull(camera.world_to_pixel(points).astype(np.float32))[:, 0].astype(float)


def polygon_span(corners: np.ndarray, y: float) -> tuple[float, float]:
    """First and last x of a convex polygon on the line y; (inf, -inf) where it does not reach."""
    crossings = []
    for (xa, ya), (xb, yb) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if min(ya, yb) <= y <= max(ya, yb) and ya != yb:
            crossings.append(xa + (y - ya) / (yb - ya) * (xb - xa))
    return (min(crossings), max(crossings)) if crossings else (np.inf, -np.inf)
