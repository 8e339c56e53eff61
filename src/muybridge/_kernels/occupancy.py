"""Sums over boxes of a map of evidence: what foreground a box explains, for the price of four look-ups."""

from __future__ import annotations

import numpy as np

from muybridge._kernels._jit import exact_kernel
from muybridge._kernels.cumulative import cut


@exact_kernel
def fill_sums(values, table):
    """Fill table (H + 1, W + 1) float64: table[y, x] is the sum of values (H, W) float32 above row y, left of column x."""
    table[0] = 0.0
    for y in range(values.shape[0]):
        row = table[y + 1, 0] = 0.0
        for x in range(values.shape[1]):
            row += np.float64(values[y, x])
            table[y + 1, x + 1] = table[y, x + 1] + row


@exact_kernel
def box_sums(table, left, top, boxes, out):
    """Fill out (N,) float64 with the sums over boxes (N, 4) int64 of the picture, see `cumulative.cut`.

    table : (H + 1, W + 1) float64, of the part of the picture that begins at (left, top), see `fill_sums`.
    """
    height, width = table.shape[0] - 1, table.shape[1] - 1
    for n in range(boxes.shape[0]):
        x0, y0, x1, y1 = cut(boxes[n], left, top, width, height)
        out[n] = table[y1, x1] + table[y0, x0] - table[y0, x1] - table[y1, x0]
