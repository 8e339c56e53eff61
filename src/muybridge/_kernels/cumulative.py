"""Cumulative histogram maps: a box's colour histogram for the price of four look-ups, whatever its size.

Zhao (2009), section 4.3.

`table[y, x]` holds the bins of all pixels above row y and left of column x: one integral image a bin (4.15), made row
by row (4.16). A box's bins are the table at two corners less the table at the other two (4.17).

A cell is one cache line: 24 bins, three to a word of 64 bits. What overflows a bin of the table is carried into the
next, and the differences of (4.17), modulo 2^64, take it back: only the box's own counts must fit into their 21 bits.
"""

from __future__ import annotations

import math

import numpy as np

from muybridge._kernels._jit import kernel, vector_kernel

CHANNELS, BINS = 3, 8
LANES = CHANNELS * BINS
LANE_BITS, PER_WORD = 21, 3
WORDS = LANES // PER_WORD
LARGEST_BOX = 2**LANE_BITS - 1
"""Pixels; more of one colour than a bin can count."""
_LANE, _SHIFT1, _SHIFT2 = np.uint64(LARGEST_BOX), np.uint64(LANE_BITS), np.uint64(2 * LANE_BITS)


@kernel
def fill_table(image, shown, ones, table):
    """Fill table (H + 1, W + 1, WORDS) uint64 from image (H, W, 3) uint8, of the pixels that are shown (H, W) bool.

    ones : (3, 256, WORDS) uint64, a one in the lane of each value's bin; channel 0 has words 0-2, 1 has 2-5, 2 has 5-7.
    """
    height, width = image.shape[0], image.shape[1]
    table[0] = np.uint64(0)
    for y in range(height):
        table[y + 1, 0] = np.uint64(0)
        s0 = s1 = s2 = s3 = s4 = s5 = s6 = s7 = np.uint64(0)  # this row so far
        for x in range(width):
            if shown[y, x]:
                a, b, c = ones[0, image[y, x, 0]], ones[1, image[y, x, 1]], ones[2, image[y, x, 2]]
                s0, s1, s2, s3 = s0 + a[0], s1 + a[1], s2 + a[2] + b[2], s3 + b[3]
                s4, s5, s6, s7 = s4 + b[4], s5 + b[5] + c[5], s6 + c[6], s7 + c[7]
            above, here = table[y, x + 1], table[y + 1, x + 1]
            here[0], here[1], here[2], here[3] = above[0] + s0, above[1] + s1, above[2] + s2, above[3] + s3
            here[4], here[5], here[6], here[7] = above[4] + s4, above[5] + s5, above[6] + s6, above[7] + s7


@vector_kernel
def cut(box, left, top, width, height):
    """A box (4,) int64 of the picture in the pixels of a part that begins at (left, top), cut at the part's sides.

    Left, top, right, bottom, the last two beyond it; never right < left nor bottom < top.
    """
    x0, y0 = min(max(box[0] - left, 0), width), min(max(box[1] - top, 0), height)
    return x0, y0, max(x0, min(box[2] - left, width)), max(y0, min(box[3] - top, height))


@vector_kernel
def _shares(table, x0, y0, x1, y1, out):
    """Fill out (LANES,) float32: the counts of (4.17) over the box's pixels, whose number is returned."""
    area = (x1 - x0) * (y1 - y0)
    scale = np.float32(1.0 / max(1, area))
    a, b, c, d = table[y1, x1], table[y0, x0], table[y0, x1], table[y1, x0]
    for word in range(WORDS):
        counts = a[word] + b[word] - c[word] - d[word]
        out[PER_WORD * word] = np.float32(np.int32(counts & _LANE)) * scale
        out[PER_WORD * word + 1] = np.float32(np.int32((counts >> _SHIFT1) & _LANE)) * scale
        out[PER_WORD * word + 2] = np.float32(np.int32((counts >> _SHIFT2) & _LANE)) * scale
    return area


@kernel
def box_histograms(table, left, top, boxes, out):
    """(4.17): fill out (N, LANES) float32 with the shares of each box's pixels, 0 where it has none.

    table : (H + 1, W + 1, WORDS) uint64, of the part of the picture that begins at (left, top), see `fill_table`;
    boxes : (N, 4) int64, see `cut`.
    """
    height, width = table.shape[0] - 1, table.shape[1] - 1
    for n in range(boxes.shape[0]):
        x0, y0, x1, y1 = cut(boxes[n], left, top, width, height)
        _shares(table, x0, y0, x1, y1, out[n])


@kernel
def direct_histograms(image, lanes, boxes, out):
    """The same as `fill_table` and `box_histograms` by counting every pixel of every box: (4.14), to compare with.

    lanes : (3, 256) uint8, the bin of each value.
    """
    counts = np.empty(LANES, np.int32)
    for n in range(boxes.shape[0]):
        x0, y0, x1, y1 = cut(boxes[n], 0, 0, image.shape[1], image.shape[0])
        counts[:] = 0
        for y in range(y0, y1):
            for x in range(x0, x1):
                for channel in range(CHANNELS):
                    counts[lanes[channel, image[y, x, channel]]] += np.int32(1)
        scale = np.float32(1.0 / max(1, (x1 - x0) * (y1 - y0)))
        for lane in range(LANES):
            out[n, lane] = np.float32(counts[lane]) * scale


@kernel
def ratio_distances(now, empty, left, top, boxes, target, floor, out):
    """(4.13): fill out (N,) float64 with |z - x| / max(|z - b|, floor), infinite for a box without pixels.

    now, empty : (H + 1, W + 1, WORDS) uint64, tables of the picture and of the background, see `box_histograms`;
    target : (LANES,) float32.
    """
    height, width = now.shape[0] - 1, now.shape[1] - 1
    z, b = np.empty(LANES, np.float32), np.empty(LANES, np.float32)
    for n in range(boxes.shape[0]):
        x0, y0, x1, y1 = cut(boxes[n], left, top, width, height)
        _shares(empty, x0, y0, x1, y1, b)
        if _shares(now, x0, y0, x1, y1, z) == 0:
            out[n] = np.inf
            continue
        to_target = to_background = np.float32(0)
        for lane in range(LANES):
            to_target += (z[lane] - target[lane]) ** 2
            to_background += (z[lane] - b[lane]) ** 2
        out[n] = math.sqrt(to_target) / max(math.sqrt(to_background), floor)


@kernel
def contrast_scores(now, empty, left, top, bands, roots, floor, out):
    """Fill out (N,) float64 with the mean over bands of v (min(|z - b|^2, c^2) - |z - x|^2) / c^2.

    Here z, b and x are square roots of shares, c is the larger of |x - b| and the floor, and v is the share of the
    band's pixels that was counted: those that are in the picture and shown. A band without them says nothing.

    now, empty : (H + 1, W + 1, WORDS) uint64, tables of the picture and of the background, see `box_histograms`;
    bands : (N, B, 4) int64, see `cut`; roots : (B, LANES) float32, x of each band.
    """
    height, width = now.shape[0] - 1, now.shape[1] - 1
    z, b = np.empty(LANES, np.float32), np.empty(LANES, np.float32)
    for n in range(bands.shape[0]):
        total = 0.0
        for band in range(bands.shape[1]):
            box = bands[n, band]
            x0, y0, x1, y1 = cut(box, left, top, width, height)
            pixels = _shares(now, x0, y0, x1, y1, z)
            _shares(empty, x0, y0, x1, y1, b)
            counted = np.float32(0)
            for lane in range(BINS):
                counted += z[lane]
            if pixels == 0 or counted == 0:
                continue
            to_target = to_background = contrast = np.float32(0)
            for lane in range(LANES):
                seen, bare, own = math.sqrt(z[lane] / counted), math.sqrt(b[lane] / counted), roots[band, lane]
                to_target += (seen - own) ** 2
                to_background += (seen - bare) ** 2
                contrast += (own - bare) ** 2
            contrast = max(contrast, floor * floor)
            share = counted * pixels / ((box[2] - box[0]) * (box[3] - box[1]))
            total += share * (min(to_background, contrast) - to_target) / contrast
        out[n] = total / bands.shape[1]


@kernel
def round_boxes(states, out):
    """Fill out (N, 4) int64 with the pixels of boxes (N, >= 4): centre, width, height; returns what holds them all.

    A pixel belongs to the box whose edges, in the continuous plane, its centre lies between.
    """
    left = top = np.int64(2**31)
    right = bottom = -left
    for n in range(states.shape[0]):
        x, y, half_width, half_height = states[n, 0], states[n, 1], states[n, 2] / 2, states[n, 3] / 2
        x0, y0 = np.int64(math.ceil(x - half_width)), np.int64(math.ceil(y - half_height))
        x1, y1 = np.int64(math.ceil(x + half_width)), np.int64(math.ceil(y + half_height))
        out[n, 0], out[n, 1], out[n, 2], out[n, 3] = x0, y0, x1, y1
        left, top, right, bottom = min(left, x0), min(top, y0), max(right, x1), max(bottom, y1)
    return left, top, right, bottom
