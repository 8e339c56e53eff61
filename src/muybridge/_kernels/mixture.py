"""A mixture of Gaussians at every pixel: densities, matching, and the update (Zhao 2009, 2.1 to 2.5).

Covariances are diagonal. A slot whose weight is 0 is empty. `kept` has a bit for every component that counts as
background. Pixels are independent of each other and rows are shared out over threads, so that threads change nothing.

Functions of one pixel take whole arrays and its place, and the small ones are inlined: to make views, and to call with
whole arrays, costs more than what is done there.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from muybridge._kernels._jit import kernel, parallel_kernel, vector_kernel

TAIL = 16.0
"""Squared Mahalanobis distance from which on densities fall with its TAIL / 2 = 8th power, exp(-TAIL / 2) at first: far
colours keep their order, and products of two densities stay above nought."""
MOST_SLOTS = 8
"""Bits of `kept`."""
LEAST = 1e-37
"""The least density whose logarithm is taken."""
_TAIL_HEIGHT = np.float32(math.exp(-TAIL / 2.0))
_PER_RANGE_SQUARED = np.float32(2.0 * math.pi / (256.0 * 256.0))
_0, _1 = np.float32(0.0), np.float32(1.0)


@vector_kernel
def squared_distance(image, means, variances, y, x, k):
    """Squared Mahalanobis distance of a pixel's colour to one component."""
    if image.shape[2] == 3:  # written out, with one division
        blue = np.float32(image[y, x, 0]) - means[y, x, k, 0]
        green = np.float32(image[y, x, 1]) - means[y, x, k, 1]
        red = np.float32(image[y, x, 2]) - means[y, x, k, 2]
        a, b, c = variances[y, x, k, 0], variances[y, x, k, 1], variances[y, x, k, 2]
        return (blue * blue * b * c + green * green * a * c + red * red * a * b) / (a * b * c)
    distance = _0
    for c in range(image.shape[2]):
        off = np.float32(image[y, x, c]) - means[y, x, k, c]
        distance += off * off / variances[y, x, k, c]
    return distance


@vector_kernel
def slot_density(image, means, variances, y, x, k):
    """The density (2.2) of a pixel's colour in one component, over that of colours spread evenly over 0..255."""
    spread = _1
    for c in range(image.shape[2]):
        spread *= variances[y, x, k, c] * _PER_RANGE_SQUARED
    distance = squared_distance(image, means, variances, y, x, k)
    height = _1 / np.float32(math.sqrt(spread))
    if distance <= np.float32(TAIL):
        return np.float32(math.exp(np.float32(-0.5) * distance)) * height
    share = np.float32(TAIL) / distance
    share *= share
    share *= share
    return share * share * _TAIL_HEIGHT * height


@vector_kernel
def best_slot(image, weights, means, variances, y, x, limit):
    """The component nearest to a pixel's colour by Mahalanobis distance (3.4); -1 where all are beyond `limit`."""
    best, least = -1, limit
    for k in range(weights.shape[2]):
        if weights[y, x, k] > _0:
            distance = squared_distance(image, means, variances, y, x, k)
            if distance < least:
                best, least = k, distance
    return best


@vector_kernel
def _rank(weights, variances, y, x, k):
    """Squared weight over summed variances."""
    total = variances[y, x, k, 0]
    for c in range(1, variances.shape[3]):
        total += variances[y, x, k, c]
    return weights[y, x, k] * weights[y, x, k] / total


@vector_kernel
def background_slots(weights, variances, y, x, slot, portion, floor, ranks):
    """Bits of the components that make up the background: the first by weight over deviation that hold `portion`.

    slot : the component to ask first: where it holds `portion` and all others together, as narrow as variances can
        be, rank after it, no other is looked at
    ranks : (K,) float32, written over
    """
    heavy = weights[y, x, slot]
    rest = _1 - heavy
    if heavy >= portion and _rank(weights, variances, y, x, slot) > rest * rest / (variances.shape[3] * floor):
        return 1 << slot
    for k in range(weights.shape[2]):
        ranks[k] = _rank(weights, variances, y, x, k) if weights[y, x, k] > _0 else _0
    bits, held = 0, _0
    while held < portion:
        best = 0
        for k in range(1, weights.shape[2]):
            if ranks[k] > ranks[best]:
                best = k
        if ranks[best] == _0:
            break
        ranks[best] = _0
        held += weights[y, x, best]
        bits |= 1 << best
    return bits


@vector_kernel
def follow(image, weights, means, variances, y, x, slot, rate, floor):
    """(2.3), (2.4) and (2.5) for the component `slot` that matched; it moves at the rate over its weight."""
    for k in range(weights.shape[2]):
        weights[y, x, k] *= _1 - rate
    weights[y, x, slot] += rate
    share = min(_1, rate / weights[y, x, slot])
    for c in range(image.shape[2]):
        off = np.float32(image[y, x, c]) - means[y, x, slot, c]
        means[y, x, slot, c] += share * off
        off *= _1 - share
        spread = variances[y, x, slot, c]
        variances[y, x, slot, c] = max(spread + share * (off * off - spread), floor)


@kernel
def replace(image, weights, means, variances, y, x, rate, wide):
    """A new component in the slot of least weight; the weights then sum to 1. Returns the slot."""
    slot, rest = 0, _0
    for k in range(weights.shape[2]):
        if weights[y, x, k] < weights[y, x, slot]:
            slot = k
    weights[y, x, slot] = _0
    for k in range(weights.shape[2]):
        rest += weights[y, x, k]
    first = rest == _0
    for k in range(weights.shape[2]):
        weights[y, x, k] *= _0 if first else (_1 - rate) / rest
    weights[y, x, slot] = _1 if first else rate
    for c in range(image.shape[2]):
        means[y, x, slot, c] = np.float32(image[y, x, c])
        variances[y, x, slot, c] = wide
    return slot


@parallel_kernel
def _over_rows_densities(image, means, variances, kept, out):
    for row in numba.prange(image.shape[0]):
        y = np.int64(row)
        for x in range(image.shape[1]):
            for k in range(out.shape[2]):
                out[y, x, k] = _0
                if kept[y, x] >> k & 1:
                    out[y, x, k] = slot_density(image, means, variances, y, x, k)


@parallel_kernel
def _over_rows_scores(image, weights, means, variances, kept, out):
    for row in numba.prange(image.shape[0]):
        y = np.int64(row)
        for x in range(image.shape[1]):
            density = 0.0
            for k in range(weights.shape[2]):
                if kept[y, x] >> k & 1:
                    density += weights[y, x, k] * slot_density(image, means, variances, y, x, k)
            out[y, x] = -math.log(max(density, LEAST))


@parallel_kernel
def _over_rows_update(image, learnt, weights, means, variances, kept, numbers, matched, fresh, background):
    limit, rate, floor, wide, portion = numbers[0], numbers[1], numbers[2], numbers[3], numbers[4]
    for row in numba.prange(image.shape[0]):
        y = np.int64(row)
        ranks = np.empty(weights.shape[2], np.float32)
        for x in range(image.shape[1]):
            slot, new = -1, -1
            background[y, x] = False
            if learnt[y, x]:
                slot = best_slot(image, weights, means, variances, y, x, limit)
                if slot >= 0:
                    background[y, x] = (kept[y, x] >> slot & 1) == 1
                    follow(image, weights, means, variances, y, x, slot, rate, floor)
                else:
                    new = replace(image, weights, means, variances, y, x, rate, wide)
                kept[y, x] = background_slots(weights, variances, y, x, max(slot, new), portion, floor, ranks)
            matched[y, x], fresh[y, x] = slot, new


def mixture_densities(image, means, variances, kept, out):
    """Densities of the background's components at every pixel, over that of colours spread evenly over 0..255.

    Parameters
    ----------
    image : (H, W, C) uint8
    means, variances : (H, W, K, C) float32, grey values and their squares
    kept : (H, W) uint8, bits of the components that count
    out : (H, W, K) float32, filled; 0 where a component does not count
    """
    _over_rows_densities(image, means, variances, kept, out)


def mixture_scores(image, weights, means, variances, kept, out):
    """-log of (2.1) over evenly spread colours, nats, into out (H, W) float32.

    weights : (H, W, K) float32; 0 in an empty slot; the rest as for `mixture_densities`
    """
    _over_rows_scores(image, weights, means, variances, kept, out)


def mixture_update(
    image, learnt, weights, means, variances, kept, *, limit, rate, floor, wide, portion, matched, fresh, background
):
    """Learn one picture where `learnt` (H, W) bool says so; arrays as for `mixture_scores`, changed in place.

    Parameters
    ----------
    limit : squared Mahalanobis distance up to which a component matches
    rate : alpha of (2.5)
    floor, wide : least variance, and that of a new component, squared grey values
    portion : share of the weight that the background's components hold
    matched, fresh : (H, W) int8, filled: the component that matched, the slot of a new one; -1 for none
    background : (H, W) bool, filled: what matched counted as background, before this picture
    """
    numbers = np.array([limit, rate, floor, wide, portion], np.float32)
    _over_rows_update(image, learnt, weights, means, variances, kept, numbers, matched, fresh, background)
