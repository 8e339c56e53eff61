"""At every pixel, the moments that show the colour that lasts: from the first time that it is seen to the last."""

from __future__ import annotations

import numba
import numpy as np

from muybridge._kernels._jit import kernel, parallel_kernel


@kernel
def is_near(colour, other, tolerance):
    """Whether two colours (C,) uint8 differ by no more than the tolerance in each channel."""
    for c in range(colour.shape[0]):
        off = np.int64(colour[c]) - np.int64(other[c])
        if off > tolerance or off < -tolerance:
            return False
    return True


@kernel
def lasting_score(colours, moment, tolerance, fewest, weight, passing, ended):
    """Of moments (T, C): how far apart the first and the last like this one are, and how many there are, as shares.

    -1 where there are fewer than `fewest`. The first and the last of all may be chance, and are not reckoned with. What
    was there neither at the beginning nor, if the clip has `ended`, at its end counts `passing` times as much.
    """
    count, before_last, last, second = 0, -1, -1, -1
    for t in range(colours.shape[0]):
        if is_near(colours[t], colours[moment], tolerance):
            count += 1
            before_last, last = last, t
            if count == 2:
                second = t
    if count < fewest:
        return -1.0
    ends = 2 + colours.shape[0] // 20
    came_and_went = second > ends and (not ended or before_last < colours.shape[0] - 1 - ends)
    return (passing if came_and_went else 1.0) * (before_last - second + weight * count) / colours.shape[0]


@parallel_kernel
def over_rows_lasting(pixels, step, tolerance, fewest, weight, passing, ended, out):
    """Of pixels (H, W, T, C) every `step`-th moment is tried: out (H, W, T) bool, which are like the best of those."""
    for y in numba.prange(pixels.shape[0]):
        for x in range(pixels.shape[1]):
            colours = pixels[y, x]
            best, chosen = -2.0, 0
            for moment in range(0, colours.shape[0], step):
                if moment > 0 and is_near(colours[moment], colours[chosen], tolerance):
                    continue  # much the same was tried, and is best so far
                score = lasting_score(colours, moment, tolerance, fewest, weight, passing, ended)
                if score > best:
                    best, chosen = score, moment
            for t in range(colours.shape[0]):
                out[y, x, t] = is_near(colours[t], colours[chosen], tolerance)
