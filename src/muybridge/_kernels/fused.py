"""All cues of many poses in one pass: every segment is projected and drawn once, front to back.

Floors: `measure` (parallel) -> `_measure_lanes` (chain and outlines of LANES poses at once) -> `_one_view` -> the
cues' own kernels. What belongs together travels as a tuple: the body, the evidence, the room to draw in.
A cue that is not wanted costs nothing. Cost with silhouette, colour and boundary: see `bench`.
"""

from __future__ import annotations

import numba
import numpy as np

from muybridge._kernels._jit import kernel, parallel_kernel
from muybridge._kernels.boundary import (
    SAMPLES,
    SIDE,
    descriptor_distance,
    fourier_descriptor,
    resample_closed,
    trace_largest,
)
from muybridge._kernels.chain import LANES, chain_lanes, lane_space, load_lanes
from muybridge._kernels.colour import LANES as COLOUR_LANES
from muybridge._kernels.colour import add_seen, colour_distance
from muybridge._kernels.draw import fill_word, fill_word_seen, outline_spans
from muybridge._kernels.edges import outline_edges
from muybridge._kernels.outline import END, KIND, outline_space, outlines_lanes, take_lane
from muybridge._kernels.silhouette import count_inside, whole_blocks

#: Columns of a result: pixels of the model, of these inside the mask, colour distance D (5.5), distance of Fourier
#: descriptors in pixels, edge points seen, their summed cost.
MODEL, INSIDE, COLOUR, BOUNDARY, EDGE_POINTS, EDGE_COST, RESULT_COLUMNS = 0, 1, 2, 3, 4, 5, 6
#: Bits of `wanted`.
WANT_COLOUR, WANT_BOUNDARY, WANT_EDGES = 1, 2, 4


@kernel
def front_to_back(outlines, order):
    """Sort `order` (K,) by the mean depth of the two ends, nearest first; segments that are not seen come last."""
    for k in range(outlines.shape[0]):
        depth = _depth(outlines[k])
        i = k
        while i > 0 and _depth(outlines[order[i - 1]]) > depth:
            order[i] = order[i - 1]
            i -= 1
        order[i] = k


@kernel
def _depth(out):
    return out[END + 5] + out[END + 11] if out[KIND] != 0.0 else np.inf


@kernel
def draw_in_order(outlines, order, width, height, wanted, table, edge_map, canvas, first, last, seen, histograms):
    """Draw all segments front to back, adding up colours and edges; returns rows and words touched, edge points,
    edge cost.
    """
    top, bottom, word, end = height, 0, canvas.shape[0], 0
    points, cost = 0, 0.0
    if wanted & WANT_COLOUR:
        histograms[:] = 0
    for i in range(order.shape[0]):
        k = order[i]
        if wanted & WANT_EDGES:
            n, c = outline_edges(outlines[k], edge_map, canvas, width, height)
            points += n
            cost += c
        t, rows, w0, w1 = outline_spans(outlines[k], width, height, first, last)
        if rows == 0:
            continue
        top, bottom, word, end = min(top, t), max(bottom, t + rows), min(word, w0), max(end, w1)
        for w in range(w0, w1):
            column = canvas[w, t + 1 : t + 1 + rows]
            if wanted & WANT_COLOUR:
                fill_word_seen(first, last, rows, w << 6, column, seen)
                add_seen(seen, rows, t, w << 6, table, histograms[k])
            else:
                fill_word(first, last, rows, w << 6, column)
    return top, bottom, word, end, points, cost


@kernel
def boundary_of(canvas, top, bottom, pixels, spare, xs, ys, square):
    """Fourier descriptor of the canvas' outer border into square[0], square[1]; returns the border's length, 0 if
    none.
    """
    count = trace_largest(canvas, top, bottom, pixels, spare, xs, ys)
    if count > 0:
        resample_closed(xs, ys, count, square[0].reshape(SAMPLES), square[1].reshape(SAMPLES))
        fourier_descriptor(square[0], square[1], square[2], square[3])
    return count


@kernel
def _picture_space(words, rows, shapes, wanted):
    """Room for one picture: canvas and a spare one, both (words, rows) uint64 and the first empty; a segment's first,
    last and seen pixels by row; histograms (K, LANES) and products (LANES,) for colour; xs, ys of the border, and the
    descriptor's real and imaginary part with two spare ones (4, SIDE, SIDE).
    """
    canvas, spare = np.zeros((words, rows), np.uint64), np.empty((words, rows), np.uint64)
    first, last, seen = np.empty(rows, np.int64), np.empty(rows, np.int64), np.empty(rows, np.uint64)
    histograms, products = np.zeros((shapes, COLOUR_LANES), np.int32), np.empty(COLOUR_LANES, np.float32)
    longest = words * 64 * rows if wanted & WANT_BOUNDARY else 2
    xs, ys, square = np.empty(longest, np.int32), np.empty(longest, np.int32), np.empty((4, SIDE, SIDE))
    return canvas, spare, first, last, seen, histograms, products, xs, ys, square


@kernel
def _one_view(camera, outlines, order, wanted, evidence, space, out):
    """One row of results (RESULT_COLUMNS,) for outlines (K, OUTLINE_COLUMNS) in one camera.

    evidence : what `measure` takes of this camera, from mask to edge map; space : of `_picture_space`.
    """
    mask, table, roots, known, by_area, descriptor, coefficients, edge_map = evidence
    canvas, spare, first, last, seen, histograms, products, xs, ys, square = space
    width, height = int(camera[23]), int(camera[24])
    front_to_back(outlines, order)
    top, bottom, word, end, points, cost = draw_in_order(
        outlines, order, width, height, wanted, table, edge_map, canvas, first, last, seen, histograms
    )
    out[EDGE_POINTS], out[EDGE_COST], out[COLOUR], out[BOUNDARY] = points, cost, 0.0, 0.0
    if wanted & WANT_COLOUR:
        out[COLOUR] = colour_distance(histograms, roots, known, by_area, products)
    low, high = whole_blocks(top, bottom, canvas.shape[1])
    model = inside = 0
    for w in range(word, end):
        m, i = count_inside(canvas[w, low:high], mask[w, low:high])
        model += m
        inside += i
    out[MODEL], out[INSIDE] = model, inside
    if wanted & WANT_BOUNDARY:
        out[BOUNDARY] = np.inf
        if boundary_of(canvas, top, bottom, model, spare, xs, ys, square) > 0:
            out[BOUNDARY] = descriptor_distance(square[0], square[1], descriptor[0], descriptor[1], coefficients)
    for w in range(word, end):
        canvas[w, low:high] = 0


@kernel
def _measure_lanes(start, poses, body, cameras, wanted, evidence, out, histograms_out):
    """What `measure` does for LANES poses from `start` on.

    body : parent to half_axes; evidence : masks to edge_maps, in the order of `measure`.
    """
    parent, fixed, axis, dof, shaped, ends, half_axes = body
    masks, tables, roots, known, by_area, descriptors, coefficients, edge_maps = evidence
    lanes, cosines, sines, frames = lane_space(poses.shape[1], parent.shape[0])
    kinds, ellipses, sides, outlines = outline_space(shaped.shape[0])
    order = np.empty(shaped.shape[0], np.int64)
    space = _picture_space(masks.shape[1], masks.shape[2], shaped.shape[0], wanted)
    load_lanes(poses, start, lanes, cosines, sines)
    chain_lanes(lanes, cosines, sines, parent, fixed, axis, dof, frames)
    for c in range(cameras.shape[0]):
        outlines_lanes(cameras[c], frames, shaped, ends, half_axes, kinds, ellipses, sides)
        view = masks[c], tables[c], roots[c], known[c], by_area, descriptors[c], coefficients, edge_maps[c]
        for n in range(start, min(poses.shape[0], start + LANES)):
            take_lane(kinds, ellipses, sides, n - start, outlines)
            _one_view(cameras[c], outlines, order, wanted, view, space, out[n, c])
            if histograms_out.shape[0] > 0:
                histograms_out[n, c] = space[5]


@parallel_kernel
def measure(
    poses,
    parent,
    fixed,
    axis,
    dof,
    shaped,
    ends,
    half_axes,
    cameras,
    wanted,
    masks,
    tables,
    roots,
    known,
    by_area,
    descriptors,
    coefficients,
    edge_maps,
    out,
    histograms_out,
):
    """Fill out (N, C, RESULT_COLUMNS) for poses (N, D).

    masks (C, words, canvas_rows(H)) uint64; tables (C, H, W + 1, LANES / 4) uint64 (uint16 taken four at a time),
    roots (C, K, LANES) float32, known (C, K) bool for colour; descriptors (C, 2, SIDE, SIDE) float64 for the
    boundary; edge_maps (C, H, W) float32. What is not wanted may have any size with the same number of cameras.
    histograms_out (N, C, K, LANES) int32 takes the counts unless it is empty.
    """
    for chunk in numba.prange((poses.shape[0] + LANES - 1) // LANES):
        body = parent, fixed, axis, dof, shaped, ends, half_axes
        evidence = masks, tables, roots, known, by_area, descriptors, coefficients, edge_maps
        _measure_lanes(chunk * LANES, poses, body, cameras, wanted, evidence, out, histograms_out)


@kernel
def describe_masks(masks, descriptors):
    """Fill descriptors (C, 2, SIDE, SIDE) of masks (C, words, canvas_rows(H)) uint64; returns the borders' lengths
    (C,), 0 if empty.
    """
    lengths = np.zeros(masks.shape[0], np.int64)
    longest = masks.shape[1] * 64 * masks.shape[2]
    xs, ys, square = np.empty(longest, np.int32), np.empty(longest, np.int32), np.empty((4, SIDE, SIDE))
    spare = np.empty(masks.shape[1:], np.uint64)
    for c in range(masks.shape[0]):
        lengths[c] = boundary_of(masks[c], 0, masks.shape[2] - 2, 0, spare, xs, ys, square)
        descriptors[c] = square[:2]
    return lengths
