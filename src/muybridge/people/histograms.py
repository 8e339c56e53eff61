"""Colour histograms of boxes: 8 bins in each of Y, Cb and Cr, their edges fitted to the target.

Zhao (2009), sections 4.2.1 and 4.3.

Even bins put a small region's colours into one or two of them. "Specific histogram mapping" sets the edges so that a
reference histogram - the target's - fills all bins alike; other regions, mapped by the same edges, then differ from it.

=================  ===========================================
symbol             name
=================  ===========================================
M(.)               BinMap
CHM(x, y, i)       CumulativeMap.table
h_R(i)             CumulativeMap.histograms
=================  ===========================================

Differences from the paper: histograms are shares of the box's pixels, so that boxes of different sizes compare; the map
covers the part of the picture that holds all boxes, not the whole of it.

Cost: (4.16) once a picture, O(pixels x bins); then O(bins) a box.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from muybridge._kernels.cumulative import (
    BINS,
    CHANNELS,
    LANE_BITS,
    LANES,
    PER_WORD,
    WORDS,
    box_histograms,
    direct_histograms,
    fill_table,
)
from muybridge.errors import InputError

Boxes = NDArray[np.int64]
"""(N, 4): left, top, right, bottom, whole pixels; the last two lie just beyond the box."""

Hull = tuple[int, int, int, int]
"""Likewise, of one box that holds others."""


def to_luma_chroma(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Picture (H, W, 3) uint8 BGR -> Y, Cr, Cb, the same shape; the order of the channels is OpenCV's."""
    import cv2

    if image.ndim != 3 or image.shape[2] != 3 or image.dtype != np.uint8:
        raise InputError("picture", expected="(H, W, 3) uint8", got=f"{image.shape} {image.dtype}",
                         remedy="colour histograms need a colour picture")  # fmt: skip
    converted: NDArray[np.uint8] = cv2.cvtColor(image, cv2.COLOR_BGR2YCrCb)  # type: ignore[assignment]
    return converted


@dataclass(frozen=True, eq=False)
class BinMap:
    """M(.) of 4.2.1: which bin each value of each channel falls into.

    lanes : (3, 256) uint8
        Bin of 24: channel c's lie in 8 c .. 8 c + 7, never falling from one value to the next.
    """

    lanes: NDArray[np.uint8]

    def __post_init__(self) -> None:
        bins = np.asarray(self.lanes).astype(np.int64) - BINS * np.arange(CHANNELS)[:, None]
        if bins.shape != (CHANNELS, 256) or bins.min() < 0 or bins.max() >= BINS or (np.diff(bins, axis=1) < 0).any():
            raise InputError("bin map", expected=f"(3, 256), bins 0..{BINS - 1}, never falling", got=str(bins.shape))

    @classmethod
    def even(cls) -> BinMap:
        """Bins of 32 values each: no mapping, to compare with."""
        return cls((np.arange(256) // (256 // BINS) + BINS * np.arange(CHANNELS)[:, None]).astype(np.uint8))

    @classmethod
    def equalising(cls, pixels: NDArray[np.uint8]) -> BinMap:
        """The edges that spread a region's pixels (..., 3) uint8 evenly over the bins.

        A value goes where the middle of its share of the cumulative histogram lies: that of a flat region has a bin of
        its own, and there are others for what is darker and what is brighter.
        """
        values = np.asarray(pixels).reshape(-1, CHANNELS)
        if not len(values):
            raise InputError("reference histogram", expected="a region with pixels", got="none")
        counts = np.stack([np.bincount(values[:, c], minlength=256) for c in range(CHANNELS)])
        before = np.cumsum(counts, axis=1) - counts / 2
        bins = np.minimum(BINS - 1, np.floor(BINS * before / counts.sum(axis=1, keepdims=True)))
        return cls((bins + BINS * np.arange(CHANNELS)[:, None]).astype(np.uint8))

    @cached_property
    def ones(self) -> NDArray[np.uint64]:
        """(3, 256, 8) uint64: what a pixel of each value adds to a cell of the table."""
        ones = np.zeros((CHANNELS, 256, WORDS), np.uint64)
        word, place = np.divmod(self.lanes.astype(np.int64), PER_WORD)
        channel, value = np.indices(word.shape)
        ones[channel, value, word] = np.uint64(1) << (LANE_BITS * place).astype(np.uint64)
        return ones


@dataclass(frozen=True, eq=False)
class CumulativeMap:
    """CHM of (4.15) over part of a picture.

    table : (H + 1, W + 1, 8) uint64
        table[y, x] counts, bin by bin, the part's pixels above row y and left of column x; see `_kernels.cumulative`.
    left, top : int, pixels
        Where the part begins in the picture.
    """

    table: NDArray[np.uint64]
    left: int = 0
    top: int = 0

    def histograms(self, boxes: Boxes) -> NDArray[np.float32]:
        """(N, 24) float32: shares of the pixels of boxes (N, 4) that lie in the part, (4.17)."""
        out = np.empty((len(boxes), LANES), np.float32)
        box_histograms(self.table, self.left, self.top, np.asarray(boxes, np.int64), out)
        return out

    def covers(self, hull: Hull, shape: tuple[int, ...]) -> bool:
        """Whether all of `hull` that lies in a picture of that shape is in the part."""
        left, top, right, bottom = inside(hull, shape)
        height, width = self.table.shape[0] - 1, self.table.shape[1] - 1
        empty = left == right or top == bottom
        fits = self.left <= left and self.top <= top and right <= self.left + width and bottom <= self.top + height
        return empty or fits


def cumulative_map(
    image: NDArray[np.uint8], bins: BinMap, around: Hull | None = None, shown: NDArray[np.bool_] | None = None
) -> CumulativeMap:
    """(4.16) over the part `around` of a picture (H, W, 3) uint8, Y Cr Cb; None: all of it.

    shown : (H, W) bool, the pixels that are counted; None: all
    """
    left, top, right, bottom = inside(around or (0, 0, image.shape[1], image.shape[0]), image.shape)
    part = np.ascontiguousarray(image[top:bottom, left:right])
    counted = (
        np.ones(part.shape[:2], np.bool_) if shown is None else np.ascontiguousarray(shown[top:bottom, left:right])
    )
    table = np.empty((part.shape[0] + 1, part.shape[1] + 1, WORDS), np.uint64)
    fill_table(part, counted, bins.ones, table)
    return CumulativeMap(table, left, top)


def count_histograms(image: NDArray[np.uint8], bins: BinMap, boxes: Boxes) -> NDArray[np.float32]:
    """(4.14), pixel by pixel: (N, 24) float32 of boxes (N, 4), cut at the picture's sides. To compare with."""
    out = np.empty((len(boxes), LANES), np.float32)
    direct_histograms(np.ascontiguousarray(image), bins.lanes, np.asarray(boxes, np.int64), out)
    return out


def inside(hull: Hull, shape: tuple[int, ...]) -> Hull:
    """What of it lies in a picture of that shape; without pixels where none does."""
    (height, width), (left, top, right, bottom) = shape[:2], hull
    left, top = min(max(left, 0), width), min(max(top, 0), height)
    return left, top, max(left, min(right, width)), max(top, min(bottom, height))
