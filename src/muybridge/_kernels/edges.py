"""Edge cost along the visible outline of every cone (Sedai 2013, eq. 13).

Points lie at equal steps along both side lines and round the ends. Segments are visited front to back: a point that
falls on a pixel already drawn is hidden and dropped. One that lies before a segment behind it stays: inner edges
count.
"""

from __future__ import annotations

import math

import numpy as np

from muybridge._kernels._jit import kernel
from muybridge._kernels.outline import END, KIND, SIDE, support

SIDE_POINTS = 10  # on each side line
#: Cosine and sine of the directions, off the axis' own, of the points round an end: 60, 30, 0, -30, -60 degrees.
_ANGLES = np.radians([60.0, 30.0, 0.0, -30.0, -60.0])
CAP_COSINES, CAP_SINES = np.cos(_ANGLES), np.sin(_ANGLES)
_CIRCLE = np.arange(12) * (np.pi / 6.0)
CIRCLE_COSINES, CIRCLE_SINES = np.cos(_CIRCLE), np.sin(_CIRCLE)
_1 = np.uint64(1)


@kernel
def look_up(edge_map, canvas, width, height, x, y):
    """Points counted (0 or 1) and cost (1 - map)^2 at the nearest pixel; none outside the picture or where it is
    drawn on.
    """
    i, j = math.floor(y + 0.5), math.floor(x + 0.5)
    if not (0.0 <= i <= height - 1.0 and 0.0 <= j <= width - 1.0):
        return 0, 0.0
    row, column = int(i), int(j)
    if (canvas[column >> 6, row + 1] >> np.uint64(column & 63)) & _1 != np.uint64(0):
        return 0, 0.0
    miss = 1.0 - edge_map[row, column]
    return 1, miss * miss


@kernel
def outline_edges(out, edge_map, canvas, width, height):
    """Visible points of one outline and their summed cost; `canvas` holds what lies before this segment."""
    points, cost = 0, 0.0
    if out[KIND] == 0.0:
        return points, cost
    if out[KIND] == 2.0:
        for side in range(2):
            base = SIDE + 6 * side
            dx, dy = (out[base + 4] - out[base + 2]) / SIDE_POINTS, (out[base + 5] - out[base + 3]) / SIDE_POINTS
            for i in range(SIDE_POINTS):
                n, c = look_up(
                    edge_map, canvas, width, height, out[base + 2] + (i + 0.5) * dx, out[base + 3] + (i + 0.5) * dy
                )
                points += n
                cost += c
        dx, dy = out[END + 6] - out[END], out[END + 7] - out[END + 1]
        length = math.sqrt(dx * dx + dy * dy)
        dx, dy = dx / length, dy / length
        for i in range(CAP_COSINES.shape[0]):
            nx, ny = dx * CAP_COSINES[i] - dy * CAP_SINES[i], dx * CAP_SINES[i] + dy * CAP_COSINES[i]
            n, c = _end_point(out, END, -nx, -ny, edge_map, canvas, width, height)
            m, d = _end_point(out, END + 6, nx, ny, edge_map, canvas, width, height)
            points += n + m
            cost += c + d
        return points, cost
    base = (
        END if out[END + 2] + out[END + 4] >= out[END + 8] + out[END + 10] else END + 6
    )  # the larger covers the other
    for i in range(CIRCLE_COSINES.shape[0]):
        n, c = _end_point(out, base, CIRCLE_COSINES[i], CIRCLE_SINES[i], edge_map, canvas, width, height)
        points += n
        cost += c
    return points, cost


@kernel
def _end_point(out, base, nx, ny, edge_map, canvas, width, height):
    """As `look_up`, at the point of an end that lies farthest along (nx, ny)."""
    h = support(out, base, nx, ny)
    x = out[base] + (out[base + 2] * nx + out[base + 3] * ny) / h
    y = out[base + 1] + (out[base + 3] * nx + out[base + 4] * ny) / h
    return look_up(edge_map, canvas, width, height, x, y)
