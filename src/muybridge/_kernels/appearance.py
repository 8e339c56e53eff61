"""Pixels' colours as numbers of joint bins, and of two people, one before the other, whose a pixel is."""

from __future__ import annotations

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
            luma = np.int64(picture[y, x, 0]) * LUMA // 256
            red = min(max((np.int64(picture[y, x, 1]) - _FIRST) // 8, 0), CHROMA - 1)
            blue = min(max((np.int64(picture[y, x, 2]) - _FIRST) // 8, 0), CHROMA - 1)
            out[y, x] = (luma * CHROMA + red) * CHROMA + blue


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
