"""The contour as a least-squares problem: how far the model's outline lies from the border of the mask, and which way.

This is what the guided filter climbs by (`filters.guided`). For outline point i of a pose, the border of the mask lies
d_i metres further along the outward normal, and J_i says how fast the outline moves there with each degree of freedom,
so that near the optimum

    -log p(mask | pose) = 1/2 sum_i w_i (d_i - J_i delta)^2 / sd^2,      w = (s^2 / (s^2 + d^2))^2.

The weight w is Geman and McClure's: points further than the spread s from the border hardly count, so holes, shadows
and other people do not pull. Shrinking s from steps to steps makes the search coarse to fine.
"""

from __future__ import annotations

from typing import NamedTuple

import cv2
import numpy as np

from muybridge._kernels import contour as kernel
from muybridge.body.model import Body
from muybridge.likelihood.pictures import HALF

SIDE_POINTS = 8  # along each side line of a segment
REACH = 1.5  # the border is searched up to this many spreads away
BORDER_SPACING = 6  # pixels between the mask's own border points
SHORTEST_BORDER = 24  # pixels; a shorter outline is speckle
STIFFER, STIFFEST = 1.0, 3.0  # for every segment that hangs below; at most


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


class Borders(NamedTuple):
    """Points on the masks' borders: points (C, B, 2) float64, reduced pixels; counts (C,) int64, how many are used."""

    points: np.ndarray
    counts: np.ndarray


def mask_borders(shares: np.ndarray, spacing: int = BORDER_SPACING) -> Borders:
    """Every `spacing`-th pixel along the borders of masks (C, H, W) uint8."""
    found = []
    for share in shares:
        contours, _ = cv2.findContours((share >= HALF).view(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        kept = [line.reshape(-1, 2)[::spacing] for line in contours if len(line) >= SHORTEST_BORDER]
        found.append(np.concatenate(kept) if kept else np.zeros((0, 2), np.int32))
    points = np.zeros((len(found), max(1, *map(len, found)) if found else 1, 2))
    for c, line in enumerate(found):
        points[c, : len(line)] = line
    return Borders(points, np.array([len(line) for line in found], np.int64))


def no_borders(cameras: int) -> Borders:
    """Nothing to be explained."""
    return Borders(np.zeros((cameras, 1, 2)), np.zeros(cameras, np.int64))


def stiffness(body: Body) -> np.ndarray:
    """(S,) float64: how much further than it is a segment counts from a border point that nothing covers.

    What hangs at the end of a chain moves most freely: a hand counts once, an upper arm with two parts below it thrice.
    """
    return np.minimum(1.0 + STIFFER * body.parts_below, STIFFEST)


def contour_rows(
    body: Body,
    cameras: np.ndarray,
    shares: np.ndarray,
    borders: Borders,
    pose: np.ndarray,
    spread: float,
    side_points: int = SIDE_POINTS,
    moved: np.ndarray | None = None,
) -> ContourRows:
    """Residuals of one pose.

    Parameters
    ----------
    cameras : (C, CAMERA_COLUMNS) float64, of the reduced pictures
    shares : (C, H, W) uint8, share of foreground, 0 to `pictures.FULL`
    borders : their borders
    pose : (D,) float64, metres and radians
    spread : float, metres
        The border is searched up to 1.5 spreads away from each point.
    moved : (B,) int, optional
        Only the outlines that these components of the pose move.
    """
    arrays, dofs = body.arrays, len(pose)
    wanted = np.any(body.moved_by if moved is None else body.moved_by[:, moved], axis=1)
    points = 2 * side_points + kernel.TURNS
    capacity = len(cameras) * int(wanted[arrays.shaped].sum()) * points + int(borders.counts.sum()) + 1
    rows, slopes = np.empty((capacity, kernel.ROW_COLUMNS)), np.empty((capacity, dofs))
    focal = np.sqrt(cameras[:, 0] * cameras[:, 1])
    root = cameras[:, 11:20].reshape(-1, 3, 3)[:, 2] @ pose[:3] + cameras[:, 22]
    reaches = np.clip(REACH * spread * focal / np.maximum(root, 0.1), 2.0, 0.5 * max(shares.shape[1:]))
    count = kernel.contour_rows(
        np.ascontiguousarray(pose, np.float64),
        *arrays,
        body.moved_by,
        wanted,
        cameras,
        shares,
        borders.points,
        borders.counts,
        stiffness(body),
        reaches,
        side_points,
        rows,
        slopes,
    )
    return _in_metres(rows[:count], slopes[:count])


def _in_metres(rows: np.ndarray, slopes: np.ndarray) -> ContourRows:
    """The kernel's rows (R, ROW_COLUMNS) and slopes (R, D), pixels, by name and in metres."""
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
