"""The silhouette likelihood as one would write it without kernels: a pose and a camera at a time, drawn with OpenCV.

Each segment is two circles and the quadrangle between their tangent points, which is less work than the ellipses of the
kernel; the poses' frames come from the same fast chain. So what is measured is the drawing and counting alone, and the
comparison is in this version's favour.
"""

from __future__ import annotations

import numpy as np

from muybridge.body import Body
from muybridge.cameras import Camera

SUBPIXEL_BITS = 4


def silhouette_costs(body: Body, poses: np.ndarray, cameras: list[Camera], masks: list[np.ndarray]) -> np.ndarray:
    """Two-sided silhouette cost (Sedai 2013, eq. 12) of poses (N, D) in C cameras with masks (H, W) bool: (N, C)."""
    frames = body.frames(poses)[:, body.arrays.shaped]
    ends = np.einsum("nkab,keb->nkea", frames[..., :3], body.arrays.ends[body.arrays.shaped])
    ends += frames[:, :, None, :, 3]
    radii = np.linalg.norm(body.arrays.half_axes[body.arrays.shaped], axis=-1).max(axis=-1)
    costs = np.empty((len(poses), len(cameras)))
    for c, (camera, mask) in enumerate(zip(cameras, masks, strict=True)):
        area = max(int(np.count_nonzero(mask)), 1)
        for n in range(len(poses)):
            drawn = draw_body(camera, ends[n], radii)
            covered = max(int(np.count_nonzero(drawn)), 1)
            costs[n, c] = 1.0 - 0.5 * np.count_nonzero(drawn & mask) * (1.0 / area + 1.0 / covered)
    return costs


def draw_body(camera: Camera, ends: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """The body's mask (H, W) bool; ends (K, 2, 3) metres, world; radii (K, 2) metres."""
    import cv2

    pixels = camera.world_to_pixel(ends.reshape(-1, 3)).reshape(-1, 2, 2)
    depths = camera.world_to_camera(ends.reshape(-1, 3))[:, 2].reshape(-1, 2)
    sizes = camera.matrix[0, 0] * radii / depths
    drawn, one = np.zeros(camera.size[::-1], np.uint8), 2**SUBPIXEL_BITS
    for (first, last), (r, s) in zip(pixels, sizes, strict=True):
        for centre, radius in ((first, r), (last, s)):
            place = (int(centre[0] * one), int(centre[1] * one))
            cv2.circle(drawn, place, int(radius * one), 1, -1, shift=SUBPIXEL_BITS)
        corners = tangent_points(first, last, r, s)
        if corners is not None:
            cv2.fillConvexPoly(drawn, (corners * one).astype(np.int32), 1, shift=SUBPIXEL_BITS)
    return drawn.view(bool)


def tangent_points(first: np.ndarray, last: np.ndarray, r: float, s: float) -> np.ndarray | None:
    """Where the outer tangents touch two circles, (4, 2); None where one circle lies inside the other."""
    along = last - first
    distance = float(np.hypot(*along))
    if distance <= abs(r - s):
        return None
    along /= distance
    across = np.array([-along[1], along[0]])
    sine = (r - s) / distance
    cosine = np.sqrt(1.0 - sine * sine)
    left, right = along * sine + across * cosine, along * sine - across * cosine
    return np.array([first + r * left, last + s * left, last + s * right, first + r * right])
