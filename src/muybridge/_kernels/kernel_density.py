"""Kernel densities of recent colours at every pixel (Elgammal 2002): a table of the kernel, sums, bandwidths.

The kernel of one channel is looked up by bandwidth (LEVELS of them) and difference (0..255). Samples come in pairs of
consecutive pictures, 2 i and 2 i + 1: what changes within a pair is noise and fast motion, not a change of state.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from muybridge._kernels._jit import kernel, parallel_kernel
from muybridge._kernels.mixture import LEAST

LEVELS = 64
NARROWEST, WIDEST = 0.5, 36.0
"""Bandwidths, grey values; levels lie evenly between their logarithms."""
MEDIAN_TO_DEVIATION = 1.0 / (0.68 * math.sqrt(2.0))
"""The median of |difference| of two normal colours over their standard deviation is 0.68 sqrt 2."""


def bandwidths():
    """(LEVELS,) float64, grey values."""
    return np.geomspace(NARROWEST, WIDEST, LEVELS)


def kernel_table():
    """(LEVELS, 256) float32: the kernel of one channel over the density of evenly spread grey values.

    A normal density to four deviations; beyond, its exponent grows with the logarithm only, as in `mixture`.
    """
    width = bandwidths()[:, None]
    squared = (np.arange(256) / width) ** 2
    exponent = np.where(squared > 16.0, 16.0 * (1.0 + np.log(np.maximum(squared, 16.0) / 16.0)), squared)
    return (256.0 / (width * math.sqrt(2.0 * math.pi)) * np.exp(-0.5 * exponent)).astype(np.float32)


@kernel
def sum_of_kernels(colour, samples, count, level, table, enough):
    """Sum over `count` samples (N, C) of the kernels' product at a colour (C,); stops where it exceeds `enough`."""
    total = np.float32(0.0)
    for n in range(count):
        product = np.float32(1.0)
        for c in range(colour.shape[0]):
            off = np.int64(colour[c]) - np.int64(samples[n, c])
            product *= table[level[c], off if off >= 0 else -off]
        total += product
        if total > enough:
            break
    return total


@parallel_kernel
def _over_rows_density(image, samples, counts, levels, table, enough, out):
    for y in numba.prange(image.shape[0]):
        for x in range(image.shape[1]):
            count = counts[y, x]
            total = sum_of_kernels(image[y, x], samples[y, x], count, levels[y, x], table, enough * np.float32(count))
            out[y, x] = total / np.float32(max(count, 1))


@parallel_kernel
def _over_rows_displaced(image, asked, samples, counts, levels, table, radius, out):
    height, width = asked.shape
    for row in numba.prange(height):
        y = np.int64(row)
        for x in range(width):
            out[y, x] = np.float32(0.0)
            if not asked[y, x]:
                continue
            most = np.float32(0.0)
            for v in range(max(0, y - radius), min(height, y + radius + 1)):
                for u in range(max(0, x - radius), min(width, x + radius + 1)):
                    if (v - y) ** 2 + (u - x) ** 2 <= radius * radius + 1:
                        total = sum_of_kernels(
                            image[y, x], samples[v, u], counts[v, u], levels[v, u], table, np.float32(np.inf)
                        )
                        most = max(most, total / np.float32(max(counts[v, u], 1)))
            out[y, x] = most


@parallel_kernel
def _over_rows_learn(image, learnt, samples, counts, heads):
    size = samples.shape[2]
    for y in numba.prange(image.shape[0]):
        for x in range(image.shape[1]):
            if not learnt[y, x]:
                continue
            head = heads[y, x]
            for c in range(image.shape[2]):
                samples[y, x, head, c] = image[y, x, c]
            heads[y, x] = (head + 1) % size
            counts[y, x] = min(size, counts[y, x] + 1)


@kernel
def median_of_differences(samples, count, c, histogram):
    """Median of |x_2i - x_2i+1| in one channel, within half a grey value: values are spread evenly in their bin."""
    pairs = count // 2
    histogram[:] = 0
    for i in range(pairs):
        histogram[abs(np.int64(samples[2 * i, c]) - np.int64(samples[2 * i + 1, c]))] += 1
    below, half = 0, 0.5 * pairs
    for value in range(histogram.shape[0]):
        here = histogram[value]
        if below + here >= half and here > 0:
            share = (half - below) / here
            return 0.5 * share if value == 0 else value - 0.5 + share
        below += here
    return 0.0


@parallel_kernel
def _over_rows_bandwidths(samples, counts, first, step, levels):
    height = samples.shape[0]
    stretch = (LEVELS - 1) / math.log(WIDEST / NARROWEST)
    for r in numba.prange((height - first + step - 1) // step):
        y = first + np.int64(r) * step
        histogram = np.empty(256, np.int64)
        for x in range(samples.shape[1]):
            for c in range(samples.shape[3]):
                median = median_of_differences(samples[y, x], counts[y, x], c, histogram)
                deviation = min(max(median * MEDIAN_TO_DEVIATION, NARROWEST), WIDEST)
                levels[y, x, c] = np.int64(math.log(deviation / NARROWEST) * stretch + 0.5)


@parallel_kernel
def _over_rows_logarithm(density, out):
    for y in numba.prange(density.shape[0]):
        for x in range(density.shape[1]):
            out[y, x] = -math.log(max(density[y, x], LEAST))


def density(image, samples, counts, levels, table, out, enough=np.inf):
    """Kernel density of every pixel's colour over that of evenly spread colours.

    Parameters
    ----------
    image : (H, W, C) uint8
    samples : (H, W, N, C) uint8, of which the first `counts` (H, W) uint8 are filled
    levels : (H, W, C) uint8: bandwidth of each channel, an index into `bandwidths()`
    table : (LEVELS, 256) float32, `kernel_table()`
    out : (H, W) float32, filled
    enough : summing stops above it, for who only asks whether it is exceeded
    """
    _over_rows_density(image, samples, counts, levels, table, np.float32(enough), out)


def displaced_density(image, asked, samples, counts, levels, table, radius, out):
    """The largest density of each asked pixel's colour at any pixel of a disc around it; 0 where not asked."""
    _over_rows_displaced(image, asked, samples, counts, levels, table, radius, out)


def learn_samples(image, learnt, samples, counts, heads):
    """Put a picture's colours in the places of the oldest, where `learnt` (H, W) bool; heads (H, W) uint8 move on."""
    _over_rows_learn(image, learnt, samples, counts, heads)


def learn_bandwidths(samples, counts, first, step, levels):
    """Bandwidths of rows first, first + step ...: deviation = median / (0.68 sqrt 2)."""
    _over_rows_bandwidths(samples, counts, first, step, levels)
