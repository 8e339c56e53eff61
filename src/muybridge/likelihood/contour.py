"""The contour as a least-squares problem: how far the model's outline lies from the border of the mask, and which way.

This is what the guided filter climbs by (`filters.guided`). For outline point i of a pose, the border of the mask lies d_i
metres further along the outward normal, and J_i says how fast the outline moves there with each degree of freedom, so that
near the optimum

    -log p(mask | pose) = 1/2 sum_i w_i (d_i - J_i delta)^2 / sd^2,      w = (s^2 / (s^2 + d^2))^2.

The weight w is Geman and McClure's: points further than the spread s from the border hardly count, so holes, shadows and
other people do not pull. Shrinking s from steps to steps makes the search coarse to fine.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from muybridge._kernels import contour as kernel
from muybridge.body.model import Body, BodyArrays

SIDE_POINTS = 8  # along each side line of a segment
REACH = 1.5  # the border is searched up to this many spreads away


class ContourRows(NamedTuple):
    """Residuals at R outline points, in metres at the depth of each point.

    camera, segment : (R,) int64
    distance : (R,) float64, metres; outwards positive
    slopes : (R, D) float64, metres per metre and per radian
    normal : (R, 2) float64, unit, in the picture; pixel : (R, 2) float64, reduced pixels
    metres : (R,) float64, metres per (reduced) pixel
    along : (R,) float64, 0 at the segment's base, 1 at its tip
    width, depth : (R,) float64, metres the outline moves per log width and log depth of the segment
    alignment : (R,) float64, cosine between normal and the border's own normal, in [0, 1]
    """

    camera: np.ndarray
    segment: np.ndarray
    distance: np.ndarray
    slopes: np.ndarray
    normal: np.ndarray
    pixel: np.ndarray
    metres: np.ndarray
    along: np.ndarray
    width: np.ndarray
    depth: np.ndarray
    alignment: np.ndarray


class NormalEquations(NamedTuple):
    """Gauss-Newton's view of a log likelihood around a pose.

    curvature : (D, D), its negative second derivative; gradient : (D,); noise : weighted mean square of the residuals
    relative to the variance assumed for them; points : how many residuals there were.
    """

    curvature: np.ndarray
    gradient: np.ndarray
    noise: float
    points: int


def moved_by(arrays: BodyArrays, dofs: int) -> np.ndarray:
    """(S, D) bool: whether a degree of freedom moves a segment."""
    moved = np.zeros((len(arrays.parent), dofs), bool)
    moved[:, :3] = True
    for segment, parent in enumerate(arrays.parent):
        if parent >= 0:
            moved[segment] |= moved[parent]
        own = arrays.dof[segment]
        moved[segment, own[own >= 0]] = True
    return moved


def contour_rows(body: Body, cameras: np.ndarray, shares: np.ndarray, pose: np.ndarray, spread: float,
                 side_points: int = SIDE_POINTS) -> ContourRows:
    """Residuals of one pose.

    Parameters
    ----------
    cameras : (C, CAMERA_COLUMNS) float64, of the reduced pictures
    shares : (C, H, W) float32, share of foreground in [0, 1]
    pose : (D,) float64, metres and radians
    spread : float, metres
        The border is searched up to 1.5 spreads away from each point.
    """
    arrays, dofs = body.arrays, len(pose)
    capacity = len(cameras) * len(arrays.shaped) * (2 * side_points + 12)
    rows, slopes = np.empty((capacity, kernel.ROW_COLUMNS)), np.empty((capacity, dofs))
    focal = np.sqrt(cameras[:, 0] * cameras[:, 1])
    root = cameras[:, 11:20].reshape(-1, 3, 3)[:, 2] @ pose[:3] + cameras[:, 22]
    reaches = np.clip(REACH * spread * focal / np.maximum(root, 0.1), 2.0, 0.5 * max(shares.shape[1:]))
    count = kernel.contour_rows(np.ascontiguousarray(pose, np.float64), *arrays, moved_by(arrays, dofs), cameras, shares, reaches,
                                side_points, rows, slopes)
    rows, slopes = rows[:count], slopes[:count]
    metres = rows[:, kernel.METRES]
    return ContourRows(
        camera=rows[:, kernel.CAMERA].astype(np.int64),
        segment=rows[:, kernel.SEGMENT].astype(np.int64),
        distance=rows[:, kernel.DISTANCE] * metres,
        slopes=slopes * metres[:, None],
        normal=rows[:, kernel.NORMAL : kernel.NORMAL + 2],
        pixel=rows[:, kernel.PIXEL : kernel.PIXEL + 2],
        metres=metres,
        along=rows[:, kernel.ALONG],
        width=rows[:, kernel.WIDTH] * metres,
        depth=rows[:, kernel.DEPTH] * metres,
        alignment=rows[:, kernel.ALIGNMENT],
    )


def robust_weights(distance: np.ndarray, spread: float) -> np.ndarray:
    """Geman and McClure's weight (s^2 / (s^2 + d^2))^2 of each residual; both in metres."""
    return (spread * spread / (spread * spread + distance * distance)) ** 2
