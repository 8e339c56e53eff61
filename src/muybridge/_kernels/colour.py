"""Colour histograms of a segment's visible pixels, read from per-row prefix sums (Du 2005, 5.2.2).

A table of cumulative histograms, row by row, makes a visible run of pixels cost two look-ups of all bins, however
long it is. Three channels of ten bins fill 30 of the 32 lanes of a table cell; lane 30 counts pixels.
"""

from __future__ import annotations

import math

import numpy as np

from muybridge._kernels._jit import kernel
from muybridge._kernels.bits import popcount

BINS, CHANNELS, LANES, COUNT_LANE = 10, 3, 32, 30
TALLEST = 1023  # rows: a word column's 64 pixels times these stay below 2^16
_0, _1, _ONES, _LANE = np.uint64(0), np.uint64(1), np.uint64(0xFFFFFFFFFFFFFFFF), np.uint64(0xFFFF)


@kernel
def histogram_table(image, table):
    """Fill table (H, W + 1, LANES) uint16: table[y, x] counts the pixels left of x in row y of image (H, W, 3)
    uint8.
    """
    height, width = image.shape[0], image.shape[1]
    for y in range(height):
        for lane in range(LANES):
            table[y, 0, lane] = 0
        for x in range(width):
            for lane in range(LANES):
                table[y, x + 1, lane] = table[y, x, lane]
            for channel in range(CHANNELS):
                table[y, x + 1, channel * BINS + np.int64(image[y, x, channel]) * BINS // 256] += np.uint16(1)
            table[y, x + 1, COUNT_LANE] += np.uint16(1)


@kernel
def add_seen(seen, rows, top, offset, packed, histogram):
    """Add the pixels whose bits are set in `seen` (rows,) uint64 to a histogram (LANES,) int32.

    Row i of `seen` is the picture's row top + i; its bit 0 is the pixel `offset`. `packed` (H, W + 1, 8) uint64 is a
    table whose lanes are taken four at a time: a lane's total stays below 2^16 within a word column, so that no carry
    leaves it.
    """
    s0 = s1 = s2 = s3 = s4 = s5 = s6 = s7 = _0
    any_seen = False
    for i in range(rows):
        rest = seen[i]
        while rest != _0:
            any_seen = True
            start = popcount(~rest & (rest - _1))  # trailing zeros
            run = ~(rest >> np.uint64(start))
            stop = start + (popcount(~run & (run - _1)) if run != _0 else 64)
            before, after = packed[top + i, offset + start], packed[top + i, offset + stop]
            s0, s1, s2, s3 = (
                s0 + (after[0] - before[0]),
                s1 + (after[1] - before[1]),
                s2 + (after[2] - before[2]),
                s3 + (after[3] - before[3]),
            )
            s4, s5, s6, s7 = (
                s4 + (after[4] - before[4]),
                s5 + (after[5] - before[5]),
                s6 + (after[6] - before[6]),
                s7 + (after[7] - before[7]),
            )
            rest = rest & (_ONES << np.uint64(stop)) if stop < 64 else _0
    if any_seen:
        for w, word in enumerate((s0, s1, s2, s3, s4, s5, s6, s7)):
            for lane in range(4):
                histogram[4 * w + lane] += np.int32((word >> np.uint64(16 * lane)) & _LANE)


@kernel
def histogram_distance(histogram, root_reference, roots):
    """Sum over channels of sqrt(1 - sum_n sqrt(Hr Hk)), (5.4); `root_reference` (LANES,) holds sqrt(Hr), float32.

    roots (LANES,) float32 is room to work in: all roots at once are one vector or two.
    """
    for lane in range(LANES):
        roots[lane] = math.sqrt(np.float32(histogram[lane])) * root_reference[lane]
    scale = 1.0 / math.sqrt(np.float64(histogram[COUNT_LANE]))
    total = 0.0
    for channel in range(CHANNELS):
        overlap = 0.0
        for n in range(channel * BINS, (channel + 1) * BINS):
            overlap += roots[n]
        total += math.sqrt(max(0.0, 1.0 - overlap * scale))
    return total


@kernel
def colour_distance(histograms, root_reference, known, by_area, roots):
    """D of (5.5) over the segments seen, alpha_m their share of the visible area, or equal shares as in (5.3).

    histograms (K, LANES) int32, root_reference (K, LANES) float32, known (K,) bool: segments that have a reference.
    A segment that is hidden, or that has none, says nothing: the shares of the others sum to 1. 0 where none is seen.
    """
    total = weights = 0.0
    for k in range(histograms.shape[0]):
        area = histograms[k, COUNT_LANE]
        if area > 0 and known[k]:
            weight = float(area) if by_area else 1.0
            total += weight * histogram_distance(histograms[k], root_reference[k], roots)
            weights += weight
    return total / weights if weights > 0.0 else 0.0
