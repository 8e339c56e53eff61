"""One pass of the fused kernel for whatever cues are wanted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from muybridge._kernels import fused
from muybridge._kernels.boundary import SIDE
from muybridge._kernels.colour import LANES
from muybridge._kernels.draw import canvas_rows
from muybridge.body.model import BodyArrays
from muybridge.errors import InputError

SMALLEST_PROBABILITY = 1e-6  # of one camera: a likelihood of 0 would make every further difference of logs undefined


@dataclass(frozen=True, eq=False)
class ColourInput:
    """tables (C, H, W + 1, LANES) uint16; roots (C, K, LANES) float32; known (C, K) bool; by_area: (5.5) or (5.3)."""

    tables: np.ndarray
    roots: np.ndarray
    known: np.ndarray
    by_area: bool


@dataclass(frozen=True, eq=False)
class BoundaryInput:
    """descriptors (C, 2, SIDE, SIDE) float64; how many of the lowest frequencies count."""

    descriptors: np.ndarray
    coefficients: int


def measure_cues(
    poses: np.ndarray,
    arrays: BodyArrays,
    cameras: np.ndarray,
    size: tuple[int, int],
    masks: np.ndarray | None = None,
    colour: ColourInput | None = None,
    boundary: BoundaryInput | None = None,
    edge_maps: np.ndarray | None = None,
) -> np.ndarray:
    """Results (N, C, RESULT_COLUMNS) float64 of poses (N, D); see `_kernels.fused` for the columns.

    size : (int, int), pixels
        Width and height of the canvas: no camera's picture is larger.
    masks : (C, words, canvas_rows(H)) uint64
    """
    return _run(poses, arrays, cameras, size, masks, colour, boundary, edge_maps, False)[0]


def visible_histograms(
    pose: np.ndarray, arrays: BodyArrays, cameras: np.ndarray, size: tuple[int, int], tables: np.ndarray
) -> np.ndarray:
    """Counts (C, K, LANES) int32 of the visible pixels of every segment at one pose (D,)."""
    count, shapes = cameras.shape[0], arrays.shaped.shape[0]
    colour = ColourInput(tables, np.zeros((count, shapes, LANES), np.float32), np.zeros((count, shapes), bool), True)
    return _run(np.atleast_2d(pose), arrays, cameras, size, None, colour, None, None, True)[1][0]


def _run(
    poses, arrays, cameras, size, masks, colour, boundary, edge_maps, keep_histograms
) -> tuple[np.ndarray, np.ndarray]:
    poses = np.ascontiguousarray(np.atleast_2d(poses), dtype=np.float64)
    count, shapes = cameras.shape[0], arrays.shaped.shape[0]
    wanted = (
        fused.WANT_COLOUR * (colour is not None)
        | fused.WANT_BOUNDARY * (boundary is not None)
        | fused.WANT_EDGES * (edge_maps is not None)
    )
    masks = np.zeros((count, -(-size[0] // 64), canvas_rows(size[1])), np.uint64) if masks is None else masks
    nothing = np.zeros((count, 1, LANES), np.float32)
    colour = colour or ColourInput(np.zeros((count, 1, 1, LANES), np.uint16), nothing, np.zeros((count, 1), bool), True)
    boundary = boundary or BoundaryInput(np.zeros((count, 2, SIDE, SIDE)), 0)
    edge_maps = np.zeros((count, 1, 1), np.float32) if edge_maps is None else edge_maps
    out = np.empty((len(poses), count, fused.RESULT_COLUMNS))
    histograms = np.empty((len(poses) if keep_histograms else 0, count, shapes, LANES), np.int32)
    fused.measure(  # type: ignore[call-arg]
        poses,
        *arrays,
        cameras,
        wanted,
        masks,
        colour.tables.view(np.uint64),
        colour.roots,
        colour.known,
        colour.by_area,
        boundary.descriptors,
        boundary.coefficients,
        edge_maps,
        out,
        histograms,
    )
    return out, histograms


def shares(weights: np.ndarray | None, cameras: int) -> np.ndarray:
    """Weights of the cameras, (C,) float64, made to sum to 1; equal where none are given."""
    given = np.ones(cameras) if weights is None else np.asarray(weights, dtype=np.float64)
    if given.shape != (cameras,) or not np.all(np.isfinite(given)) or np.any(given < 0) or given.sum() <= 0:
        raise InputError(
            "camera weights", expected=f"{cameras} finite numbers, none negative, not all 0", got=str(weights)
        )
    return given / given.sum()


def average(log_probs: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Weighted mean over cameras of (N, C) -> (N,); a camera of weight 0 is not looked at, whatever it says."""
    used = weights > 0
    return log_probs[:, used] @ weights[used]
