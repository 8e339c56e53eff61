"""Silhouettes of many poses, drawn as bits and counted against the observed mask (Du 2005, 5.2.1; Sedai 2013, IV-A).

Three floors: `silhouette_counts` -> `_over_particles` (parallel; chain and outlines of LANES poses at once) ->
`_one_view`.
"""

from __future__ import annotations

import numba
import numpy as np

from muybridge._kernels._jit import kernel, parallel_kernel
from muybridge._kernels.bits import popcount
from muybridge._kernels.chain import LANES, chain_lanes, lane_space, load_lanes
from muybridge._kernels.draw import BLOCK, draw_outline, transpose_rows
from muybridge._kernels.outline import outline_space, outlines_lanes, take_lane

_0 = np.uint64(0)


@kernel
def whole_blocks(top, bottom, rows):
    """Rows of a canvas, in whole blocks, that hold the picture's rows [top, bottom); none where there are none."""
    return ((top + 1) // BLOCK * BLOCK, min(rows, (bottom + BLOCK) // BLOCK * BLOCK)) if top < bottom else (0, 0)


@kernel
def count_and_clear(column, mask):
    """Bits set in a word column, and of these the ones in the mask; the column is empty afterwards."""
    model = inside = 0
    for i in range(column.shape[0]):
        word = column[i]
        model += popcount(word)
        inside += popcount(word & mask[i])
        column[i] = _0
    return model, inside


@kernel
def count_inside(column, mask):
    """As `count_and_clear`, but the column stays."""
    model = inside = 0
    for i in range(column.shape[0]):
        model += popcount(column[i])
        inside += popcount(column[i] & mask[i])
    return model, inside


@kernel
def _one_view(outlines, width, height, mask, canvas, first, last, out):
    """Counts (2,) of outlines (K, OUTLINE_COLUMNS): pixels of the model, and of these the ones inside the mask."""
    top, bottom, word, end = height, 0, canvas.shape[0], 0
    for k in range(outlines.shape[0]):
        t, b, w, e = draw_outline(outlines[k], width, height, canvas, first, last)
        if t < b:
            top, bottom, word, end = min(top, t), max(bottom, b), min(word, w), max(end, e)
    top, bottom = whole_blocks(top, bottom, canvas.shape[1])
    model = inside = 0
    for w in range(word, end):
        m, i = count_and_clear(canvas[w, top:bottom], mask[w, top:bottom])
        model += m
        inside += i
    out[0], out[1] = model, inside


@parallel_kernel
def _over_particles(poses, parent, fixed, axis, dof, shaped, ends, half_axes, cameras, masks, out):
    """Fill out (N, C, 2); particles are independent, so that threads change nothing."""
    count, rows = poses.shape[0], masks.shape[2]
    for chunk in numba.prange((count + LANES - 1) // LANES):
        lanes, cosines, sines, frames = lane_space(poses.shape[1], parent.shape[0])
        kinds, ellipses, sides, outlines = outline_space(shaped.shape[0])
        canvas = np.zeros((masks.shape[1], rows), np.uint64)
        first, last = np.empty(rows, np.int64), np.empty(rows, np.int64)
        start = chunk * LANES
        load_lanes(poses, start, lanes, cosines, sines)
        chain_lanes(lanes, cosines, sines, parent, fixed, axis, dof, frames)
        for c in range(cameras.shape[0]):
            width, height = int(cameras[c, 23]), int(cameras[c, 24])
            outlines_lanes(cameras[c], frames, shaped, ends, half_axes, kinds, ellipses, sides)
            for n in range(start, min(count, start + LANES)):
                take_lane(kinds, ellipses, sides, n - start, outlines)
                _one_view(outlines, width, height, masks[c], canvas, first, last, out[n, c])


def silhouette_counts(poses, parent, fixed, axis, dof, shaped, ends, half_axes, cameras, bits):
    """Count the model's pixels, and those of them inside the mask, for every pose and camera.

    Parameters
    ----------
    poses : (N, D) float64, metres and radians
    parent, fixed, axis, dof, shaped, ends, half_axes : the fields of `body.BodyArrays`
    cameras : (C, CAMERA_COLUMNS) float64, see `_kernels.outline`
    bits : (C, H, words) uint64, packed masks, see `_kernels.bits`

    Returns
    -------
    (N, C, 2) int64, pixels: |H| and |Z n H| in the notation of (12)
    """
    poses = np.ascontiguousarray(poses, dtype=np.float64)
    out = np.empty((poses.shape[0], cameras.shape[0], 2), np.int64)
    _over_particles(poses, parent, fixed, axis, dof, shaped, ends, half_axes, cameras, transpose_rows(bits), out)
    return out
