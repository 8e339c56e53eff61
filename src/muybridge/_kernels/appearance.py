"""Pixels' colours as numbers of joint bins, and of two people, one before the other, whose a pixel is."""

from __future__ import annotations

import math

import numpy as np

from muybridge._kernels._jit import exact_kernel

LUMA, CHROMA = 8, 16
"""Bins of Y, and of each of Cr and Cb."""
CODES = LUMA * CHROMA * CHROMA
_FIRST = 64  # chroma of the first bin; bins are 8 wide: what people wear and rooms are painted in lies in 64..191


@exact_kernel
def fill_codes(picture, out):
    """Fill out (H, W) int16 with the bins of a picture (H, W, 3) uint8, Y Cr Cb."""
    for y in range(picture.shape[0]):
        for x in range(picture.shape[1]):
            code = np.int64(picture[y, x, 0]) * LUMA // 256
            for channel in range(1, 3):
                chroma = (np.int64(picture[y, x, channel]) - _FIRST) // 8
                code = code * CHROMA + min(max(chroma, np.int64(0)), np.int64(CHROMA - 1))
            out[y, x] = code


@exact_kernel
def _cell(at, centre, size, cells):
    """Which of so many cells of a side a pixel is in; -1 or `cells` beyond it."""
    place = (at - centre) / size + 0.5
    return -1 if place < 0.0 else min(cells, np.int64(place * cells))


@exact_kernel
def _cover(y, x, box, share, beyond):
    """How often a person in this box (>= 4,) covers the pixel; `beyond` outside."""
    row, column = _cell(y, box[1], box[3], share.shape[0]), _cell(x, box[0], box[2], share.shape[1])
    if 0 <= row < share.shape[0] and 0 <= column < share.shape[1]:
        return share[row, column]
    return beyond


@exact_kernel
def fill_claims(codes, left, top, near, far, near_colours, far_colours, share, beyond, out):
    """Fill out (h, w) float32: how probable it is that a foreground pixel shows the nearer of two people.

    codes : (h, w) int16, of the part of the picture that begins at (left, top); near, far : (>= 4,) their boxes;
    near_colours, far_colours : (rows, CODES) float32, densities from head to foot; share : (rows, columns) float64, how
    often each cell of a box is covered; beyond : that outside the box
    """
    bands = near_colours.shape[0]
    for i in range(codes.shape[0]):
        y = top + i
        near_band = min(max(_cell(y, near[1], near[3], bands), 0), bands - 1)
        far_band = min(max(_cell(y, far[1], far[3], bands), 0), bands - 1)
        for j in range(codes.shape[1]):
            code = codes[i, j]
            covers = _cover(y, left + j, near, share, beyond)
            nearer = covers * near_colours[near_band, code]
            further = (1.0 - covers) * _cover(y, left + j, far, share, beyond) * far_colours[far_band, code]
            out[i, j] = nearer / (nearer + further)


@exact_kernel
def fill_band_sums(codes, share, ratios, table):
    """Fill table (h + 1, w + 1, B) float64: summed log ratios of pixels above row y, left of x, were they in band b.

    codes (h, w) int16; share (h, w) float32, how far each pixel counts; ratios (CODES, B) float32
    """
    bands = ratios.shape[1]
    line = np.empty(bands)
    table[0] = 0.0
    for y in range(codes.shape[0]):
        line[:] = 0.0
        table[y + 1, 0] = 0.0
        for x in range(codes.shape[1]):
            if share[y, x] > 0:
                for b in range(bands):
                    line[b] += np.float64(share[y, x]) * ratios[codes[y, x], b]
            for b in range(bands):
                table[y + 1, x + 1, b] = table[y, x + 1, b] + line[b]


@exact_kernel
def band_scores(table, left, top, states, out):
    """Fill out (N,) float64: the log ratios of boxes (N, >= 4), centre and size, each pixel in the band it is in."""
    height, width, bands = table.shape[0] - 1, table.shape[1] - 1, table.shape[2]
    for n in range(states.shape[0]):
        x0, y0 = states[n, 0] - states[n, 2] / 2 - left, states[n, 1] - states[n, 3] / 2 - top
        first = min(max(np.int64(math.ceil(x0)), 0), width)
        last = min(max(np.int64(math.ceil(x0 + states[n, 2])), 0), width)
        above = min(max(np.int64(math.ceil(y0)), 0), height)
        total = 0.0
        for b in range(bands):
            below = min(max(np.int64(math.ceil(y0 + (b + 1) * states[n, 3] / bands)), 0), height)
            total += table[below, last, b] - table[below, first, b] - table[above, last, b] + table[above, first, b]
            above = below
        out[n] = total
