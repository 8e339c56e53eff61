"""Outlines to spans, spans to bits: the two inner loops, written so that the compiler turns them into vector code.

A canvas is (words, canvas_rows(H)) uint64, the transpose of a packed mask: one word column of a segment is a
contiguous run of rows, so a row costs a lane and not a loop. A canvas has one spare row above the picture (row y lies
at y + 1) and some below, which the border's tracing reads and which let every loop run over whole vectors; they stay
empty.
"""

from __future__ import annotations

import math

import numpy as np

from muybridge._kernels._jit import kernel
from muybridge._kernels.outline import BOTTOM, END, KIND, SIDE, TOP

_0, _1, _ONES = np.uint64(0), np.uint64(1), np.uint64(0xFFFFFFFFFFFFFFFF)
FAR = 1e6  # pixels; farther than any picture is wide
VECTOR = 8  # rows that the compiler takes at once; a remainder would be done one by one
BLOCK = 32  # rows counted at once


@kernel
def outline_spans(out, width, height, first, last):
    """Spans of one outline: `first` and `last` (rows,) int64 from its top row on, first > last where a row is empty.

    Returns the top row, the number of rows (a multiple of VECTOR: some may lie below the outline or the picture, and
    are empty), and the range of words touched [word, end).
    """
    if out[KIND] == 0.0:
        return 0, 0, 0, 0
    top = int(math.ceil(max(0.0, min(out[TOP], FAR))))
    bottom = int(math.floor(min(height - 1.0, max(out[BOTTOM], -FAR))))
    reach_a, reach_b = math.sqrt(out[END + 2]), math.sqrt(out[END + 8])
    leftmost = max(0.0, min(out[END] - reach_a, out[END + 6] - reach_b, FAR))
    rightmost = min(width - 1.0, max(out[END] + reach_a, out[END + 6] + reach_b, -FAR))
    if bottom < top or rightmost < leftmost:
        return 0, 0, 0, 0
    ax, ay, bx, by = out[END], out[END + 1], out[END + 6], out[END + 7]
    lean_a, lean_b = out[END + 3] / out[END + 4], out[END + 9] / out[END + 10]
    wide_a, wide_b = out[END + 2] - out[END + 3] * lean_a, out[END + 8] - out[END + 9] * lean_b
    flat_a, flat_b = 1.0 / out[END + 4], 1.0 / out[END + 10]
    px, py, slope_p, low_p, high_p = _side(out, SIDE)
    qx, qy, slope_q, low_q, high_q = _side(out, SIDE + 6)
    widest, lowest = width - 1.0, float(bottom)
    rows = (bottom - top + VECTOR) // VECTOR * VECTOR
    for i in range(rows):
        y = float(top + i)
        da, db = y - ay, y - by
        rest_a, rest_b = 1.0 - da * da * flat_a, 1.0 - db * db * flat_b
        half_a, half_b = math.sqrt(max(0.0, wide_a * rest_a)), math.sqrt(max(0.0, wide_b * rest_b))
        middle_a, middle_b = ax + lean_a * da, bx + lean_b * db
        left = middle_a - half_a if rest_a >= 0.0 else FAR
        right = middle_a + half_a if rest_a >= 0.0 else -FAR
        left = min(left, middle_b - half_b if rest_b >= 0.0 else FAR)
        right = max(right, middle_b + half_b if rest_b >= 0.0 else -FAR)
        p, q = px + (y - py) * slope_p, qx + (y - qy) * slope_q
        on_p, on_q = (low_p <= y) & (y < high_p), (low_q <= y) & (y < high_q)
        left = min(left, p if on_p else FAR, q if on_q else FAR)
        right = max(right, p if on_p else -FAR, q if on_q else -FAR)
        right = right if y <= lowest else -FAR
        first[i] = np.int64(math.ceil(max(0.0, left)))
        last[i] = np.int64(math.floor(min(widest, max(right, -1.0))))
    return top, rows, int(leftmost) >> 6, (int(rightmost) >> 6) + 1


@kernel
def _side(out, base):
    """One tangent line as x, y, dx/dy and the rows [low, high) it spans; an empty range where there is none."""
    if out[KIND] != 2.0 or out[base + 3] == out[base + 5]:
        return 0.0, 0.0, 0.0, FAR, -FAR
    slope = (out[base + 4] - out[base + 2]) / (out[base + 5] - out[base + 3])
    return out[base + 2], out[base + 3], slope, min(out[base + 3], out[base + 5]), max(out[base + 3], out[base + 5])


@kernel
def span_bits(first, last, offset):
    """Bits of the pixels first..last that fall into the word whose bit 0 is the pixel `offset`."""
    low, high = max(0, first - offset), max(0, last + 1 - offset)
    head = _ONES << np.uint64(min(low, 63)) if low < 64 else _0
    tail = _ONES << np.uint64(min(high, 63)) if high < 64 else _0
    return head & ~tail


@kernel
def fill_word(first, last, rows, offset, column):
    """Set the spans' bits in one word column (rows,) of a canvas."""
    for i in range(rows):
        column[i] |= span_bits(first[i], last[i], offset)


@kernel
def fill_word_seen(first, last, rows, offset, column, seen):
    """As `fill_word`; `seen` (rows,) takes the bits that were not set before."""
    for i in range(rows):
        bits, before = span_bits(first[i], last[i], offset), column[i]
        seen[i] = bits & ~before
        column[i] = before | bits


@kernel
def draw_outline(out, width, height, canvas, first, last):
    """Set the outline's pixels in `canvas` (words, rows); returns rows [top, end) and words [word, end) touched."""
    top, rows, word, end = outline_spans(out, width, height, first, last)
    if rows > 0:
        for w in range(word, end):
            fill_word(first, last, rows, w << 6, canvas[w, top + 1 : top + 1 + rows])
    return top, top + rows, word, end


def canvas_rows(height: int) -> int:
    """Rows of a canvas for a picture of `height` rows: one above, at least one and a vector below, a multiple of
    BLOCK.
    """
    return -(-(height + 1 + VECTOR) // BLOCK) * BLOCK


def transpose_rows(bits: np.ndarray) -> np.ndarray:
    """Packed masks (C, H, words) uint64 -> (C, words, canvas_rows(H)) as the canvases are laid out, spare rows
    empty.
    """
    cameras, height, words = bits.shape
    out = np.zeros((cameras, words, canvas_rows(height)), np.uint64)
    out[:, :, 1 : height + 1] = bits.transpose(0, 2, 1)
    return out
