"""Silhouettes of many poses, drawn as bits and counted against the observed mask (Du 2005, 5.2.1; Sedai 2013, IV-A).

Three floors: `silhouette_counts` (parallel over chunks of particles) -> `_one_particle` -> `outline` and `bits`.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from muybridge._kernels._jit import kernel, parallel_kernel
from muybridge._kernels.bits import fill_span, popcount
from muybridge._kernels.chain import one_chain
from muybridge._kernels.outline import BOTTOM, KIND, OUTLINE_COLUMNS, TOP, outline_of, row_span

CHUNK = 16  # particles a thread takes at a time


@kernel
def draw_outline(outline, width, height, canvas):
    """Set the outline's pixels in `canvas` (rows, words); returns first and last row touched (first > last: none)."""
    if outline[KIND] == 0.0:
        return height, -1
    first = int(max(0.0, math.ceil(min(outline[TOP], 1e6))))
    last = int(min(height - 1.0, math.floor(max(outline[BOTTOM], -1e6))))
    for y in range(first, last + 1):
        left, right = row_span(outline, float(y))
        x0 = int(max(0.0, math.ceil(max(-1.0, min(left, 1e6)))))
        x1 = int(min(width - 1.0, math.floor(max(-1.0, min(right, 1e6)))))
        if x0 <= x1:
            fill_span(canvas[y], x0, x1)
    return first, last


@kernel
def _one_particle(pose, parent, fixed, axis, dof, shaped, ends, half_axes, cameras, masks, frames, outline, canvas, out):
    """Counts (C, 2) of one pose: pixels of the model, and of these the ones inside the mask."""
    one_chain(pose, parent, fixed, axis, dof, frames)
    for c in range(cameras.shape[0]):
        width, height = int(cameras[c, 23]), int(cameras[c, 24])
        first, last = height, -1
        for k in range(shaped.shape[0]):
            s = shaped[k]
            outline_of(cameras[c], frames[s], ends[s], half_axes[s], outline)
            a, b = draw_outline(outline, width, height, canvas)
            if a <= b:
                first, last = min(first, a), max(last, b)
        words = (width + 63) >> 6
        model = inside = 0
        for y in range(first, last + 1):
            for w in range(words):
                word = canvas[y, w]
                if word != np.uint64(0):
                    model += popcount(word)
                    inside += popcount(word & masks[c, y, w])
                    canvas[y, w] = np.uint64(0)
        out[c, 0], out[c, 1] = model, inside


@parallel_kernel
def silhouette_counts(poses, parent, fixed, axis, dof, shaped, ends, half_axes, cameras, masks):
    """Model pixels and model pixels inside the mask, (N, C, 2) int64, for poses (N, D) and masks (C, H, words)."""
    count, views = poses.shape[0], cameras.shape[0]
    out = np.empty((count, views, 2), np.int64)
    for chunk in numba.prange((count + CHUNK - 1) // CHUNK):
        frames = np.empty((parent.shape[0], 3, 4))
        outline = np.empty(OUTLINE_COLUMNS)
        canvas = np.zeros((masks.shape[1], masks.shape[2]), np.uint64)
        for n in range(chunk * CHUNK, min(count, (chunk + 1) * CHUNK)):
            _one_particle(poses[n], parent, fixed, axis, dof, shaped, ends, half_axes, cameras, masks, frames, outline, canvas,
                          out[n])
    return out
