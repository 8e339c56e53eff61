"""What a body's segments look like in a picture, as polygons to draw; accuracy for the eye, not for a likelihood."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from muybridge.body import Body
    from muybridge.cameras import Camera

NEAREST = 0.05
"""Metres; a segment that comes nearer to the camera, or lies behind it, is not drawn."""
AROUND, ALONG = 16, 9
"""Points on each end of a segment; the polygon misses its outline by less than 2 % of the radius."""


def segment_outlines(body: Body, pose: np.ndarray, camera: Camera) -> tuple[list[np.ndarray], list[str]]:
    """The outlines of a body's segments, far ones first.

    Parameters
    ----------
    body : Body
    pose : (D,) float64, metres and radians
    camera : Camera

    Returns
    -------
    outlines : list of (K, 2) float64, pixels
        Convex; segments behind the camera are left out.
    names : list of str
        Their segments.
    """
    points = segment_points(body, pose)
    depths = camera.world_to_camera(points)[..., 2]
    order = [int(i) for i in np.argsort(-depths.mean(axis=1)) if depths[i].min() > NEAREST]
    names = [body.segment_names[body.arrays.shaped[i]] for i in order]
    return [_hull(camera.world_to_pixel(points[i])) for i in order], names


def segment_points(body: Body, pose: np.ndarray) -> np.ndarray:
    """Points on both ends of each shaped segment: (K, P, 3) float64, metres, world."""
    arrays = body.arrays
    frames = body.frames(pose)[0][arrays.shaped]
    ends, half_axes = arrays.ends[arrays.shaped], arrays.half_axes[arrays.shaped]
    local = ends[:, :, None] + np.einsum("pj,kejc->kepc", _sphere(), half_axes)
    local = local.reshape(len(local), -1, 3)
    return np.einsum("kab,kpb->kpa", frames[..., :3], local) + frames[:, None, :, 3]


def _sphere() -> np.ndarray:
    """Directions (P, 3): coefficients of the three half axes of an end."""
    latitudes = np.linspace(-np.pi / 2, np.pi / 2, ALONG)
    longitudes = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)
    return np.array(
        [(np.cos(a) * np.cos(b), np.cos(a) * np.sin(b), np.sin(a)) for a, b in product(latitudes, longitudes)]
    )


def _hull(pixels: np.ndarray) -> np.ndarray:
    """The convex hull's corners (K, 2)."""
    import cv2

    if not np.isfinite(pixels).all():
        return np.full((1, 2), np.nan)
    return cv2.convexHull(pixels.astype(np.float32)).reshape(-1, 2).astype(np.float64)
