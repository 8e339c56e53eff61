"""What foreground a person's box would explain, cell by cell of a mean silhouette, for a few look-ups a cell."""

from __future__ import annotations

import math

import numpy as np

from muybridge._kernels._jit import exact_kernel

SIDES = 2  # of a pixel: foreground, background


@exact_kernel
def fill_sums(share, weights, table):
    """Fill table (H + 1, W + 1, 2) float64: summed weights of foreground and of background above row y, left of x.

    share : (H, W) float32 or bool, how far each pixel is foreground; weights : (H, W) float32, how far it counts.
    """
    height, width = share.shape
    table[0] = 0.0
    for y in range(height):
        table[y + 1, 0] = 0.0
        full = empty = 0.0
        for x in range(width):
            full += np.float64(weights[y, x]) * np.float64(share[y, x])
            empty += np.float64(weights[y, x]) * (1.0 - np.float64(share[y, x]))
            table[y + 1, x + 1, 0] = table[y, x + 1, 0] + full
            table[y + 1, x + 1, 1] = table[y, x + 1, 1] + empty


@exact_kernel
def silhouette_scores(table, left, top, states, gain, cost, out):
    """Fill out (N,) float64: sum over cells of gain x foreground + cost x background.

    table : (H + 1, W + 1, 2) float64, of the part of the picture that begins at (left, top), see `fill_sums`;
    states : (N, >= 4), centre, width, height; gain, cost : (rows, columns) float64, per pixel of each cell of a box.
    A cell's pixels are those whose centres lie in it; what is outside the part counts nothing.
    """
    height, width = table.shape[0] - 1, table.shape[1] - 1
    rows, columns = gain.shape
    above = np.empty((columns + 1, SIDES))
    for n in range(states.shape[0]):
        x0, y0 = states[n, 0] - states[n, 2] / 2 - left, states[n, 1] - states[n, 3] / 2 - top
        total = 0.0
        for r in range(rows + 1):
            y = min(max(np.int64(math.ceil(y0 + r * states[n, 3] / rows)), 0), height)
            full = empty = 0.0  # of the cells between this edge and the last, left of the edge before
            for c in range(columns + 1):
                x = min(max(np.int64(math.ceil(x0 + c * states[n, 2] / columns)), 0), width)
                now_full, now_empty = table[y, x, 0] - above[c, 0], table[y, x, 1] - above[c, 1]
                if r > 0 and c > 0:
                    total += gain[r - 1, c - 1] * (now_full - full) + cost[r - 1, c - 1] * (now_empty - empty)
                full, empty = now_full, now_empty
                above[c, 0], above[c, 1] = table[y, x, 0], table[y, x, 1]
        out[n] = total
