"""A mixture of Gaussians at every pixel: densities, matching, and the update (Zhao 2009, 2.1 to 2.5).

Covariances are diagonal. A slot whose weight is 0 is empty. `kept` has a bit for every component that counts as
background. Pixels are independent of each other and rows are shared out over threads, so that threads change nothing.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from muybridge._kernels._jit import kernel, parallel_kernel

TAIL = 16.0
"""Squared Mahalanobis distance from which on densities fall with the logarithm: far colours keep their order, and
products of two densities stay above nought."""
MOST_SLOTS = 8
"""Bits of `kept`."""
LEAST = 1e-37
"""The least density whose logarithm is taken."""
_UNIFORM_SQUARED = np.float32(256.0 * 256.0 / (2.0 * math.pi))
_0, _1 = np.float32(0.0), np.float32(1.0)


@kernel
def tailed(distance):
    """A squared distance, from TAIL on its logarithm in its place."""
    if distance <= np.float32(TAIL):
        return distance
    return np.float32(TAIL) * (_1 + np.float32(math.log(distance * np.float32(1.0 / TAIL))))


@kernel
def squared_distance(colour, mean, variance):
    """Squared Mahalanobis distance of a colour (C,) to one component."""
    if colour.shape[0] == 3:  # written out, the loop is a few instructions
        blue = np.float32(colour[0]) - mean[0]
        green = np.float32(colour[1]) - mean[1]
        red = np.float32(colour[2]) - mean[2]
        return blue * blue / variance[0] + green * green / variance[1] + red * red / variance[2]
    distance = _0
    for c in range(colour.shape[0]):
        off = np.float32(colour[c]) - mean[c]
        distance += off * off / variance[c]
    return distance


@kernel
def slot_density(colour, mean, variance):
    """The density (2.2) of a colour (C,) in one component, over that of colours spread evenly over 0..255."""
    spread = _1
    for c in range(colour.shape[0]):
        spread *= _UNIFORM_SQUARED / variance[c]
    distance = tailed(squared_distance(colour, mean, variance))
    return np.float32(math.exp(np.float32(-0.5) * distance)) * np.float32(math.sqrt(spread))


@kernel
def best_slot(colour, weight, mean, variance, limit):
    """The component nearest to a colour (C,) by Mahalanobis distance (3.4); -1 where all are further than `limit`."""
    best, least = -1, limit
    for k in range(weight.shape[0]):
        if weight[k] > _0:
            distance = squared_distance(colour, mean[k], variance[k])
            if distance < least:
                best, least = k, distance
    return best


@kernel
def background_slots(weight, variance, portion, ranks):
    """Bits of the components that make up the background: the first by weight over deviation that hold `portion`.

    ranks : (K,) float32, written over: squared weights over summed variances
    """
    bits = 0
    for k in range(weight.shape[0]):
        ranks[k] = _0
        if weight[k] > _0:
            total = variance[k, 0]
            for c in range(1, variance.shape[1]):
                total += variance[k, c]
            ranks[k] = weight[k] * weight[k] / total
    for k in range(weight.shape[0]):
        if weight[k] > _0:
            before = _0
            for j in range(weight.shape[0]):
                if ranks[j] > ranks[k]:
                    before += weight[j]
            if before < portion:
                bits |= 1 << k
    return bits


@kernel
def follow(colour, slot, weight, mean, variance, rate, floor):
    """(2.3), (2.4) and (2.5) for the component `slot` that matched; it moves at the rate over its weight."""
    for k in range(weight.shape[0]):
        weight[k] *= _1 - rate
    weight[slot] += rate
    share = min(_1, rate / weight[slot])
    for c in range(colour.shape[0]):
        off = np.float32(colour[c]) - mean[slot, c]
        mean[slot, c] += share * off
        off *= _1 - share
        variance[slot, c] = max(variance[slot, c] + share * (off * off - variance[slot, c]), floor)


@kernel
def replace(colour, weight, mean, variance, rate, wide):
    """A new component in the slot of least weight; the weights then sum to 1. Returns the slot."""
    slot, rest = 0, _0
    for k in range(weight.shape[0]):
        if weight[k] < weight[slot]:
            slot = k
    weight[slot] = _0
    for k in range(weight.shape[0]):
        rest += weight[k]
    first = rest == _0
    for k in range(weight.shape[0]):
        weight[k] *= _0 if first else (_1 - rate) / rest
    weight[slot] = _1 if first else rate
    for c in range(colour.shape[0]):
        mean[slot, c] = np.float32(colour[c])
        variance[slot, c] = wide
    return slot


@kernel
def learn_pixel(colour, weight, mean, variance, limit, rate, floor, wide):
    """Update one mixture by one colour. Returns the slot that matched and that of a new component; -1 for none."""
    slot = best_slot(colour, weight, mean, variance, limit)
    if slot >= 0:
        follow(colour, slot, weight, mean, variance, rate, floor)
        return slot, -1
    return -1, replace(colour, weight, mean, variance, rate, wide)


@parallel_kernel
def _over_rows_densities(image, weights, means, variances, kept, out):
    for y in numba.prange(image.shape[0]):
        for x in range(image.shape[1]):
            for k in range(weights.shape[2]):
                out[y, x, k] = _0
                if kept[y, x] >> k & 1:
                    out[y, x, k] = slot_density(image[y, x], means[y, x, k], variances[y, x, k])


@parallel_kernel
def _over_rows_scores(image, weights, means, variances, kept, out):
    for y in numba.prange(image.shape[0]):
        for x in range(image.shape[1]):
            density = 0.0
            for k in range(weights.shape[2]):
                if kept[y, x] >> k & 1:
                    density += weights[y, x, k] * slot_density(image[y, x], means[y, x, k], variances[y, x, k])
            out[y, x] = -math.log(max(density, LEAST))


@parallel_kernel
def _over_rows_update(image, learnt, weights, means, variances, kept, numbers, matched, fresh, background):
    limit, rate, floor, wide, portion = numbers[0], numbers[1], numbers[2], numbers[3], numbers[4]
    for y in numba.prange(image.shape[0]):
        ranks = np.empty(weights.shape[2], np.float32)
        for x in range(image.shape[1]):
            matched[y, x] = fresh[y, x] = -1
            background[y, x] = False
            if learnt[y, x]:
                weight, mean, variance = weights[y, x], means[y, x], variances[y, x]
                slot, new = learn_pixel(image[y, x], weight, mean, variance, limit, rate, floor, wide)
                matched[y, x], fresh[y, x] = slot, new
                background[y, x] = slot >= 0 and (kept[y, x] >> slot & 1) == 1
                kept[y, x] = background_slots(weight, variance, portion, ranks)


def mixture_densities(image, weights, means, variances, kept, out):
    """Densities of the background's components at every pixel, over that of colours spread evenly over 0..255.

    Parameters
    ----------
    image : (H, W, C) uint8
    weights : (H, W, K) float32; 0 in an empty slot
    means, variances : (H, W, K, C) float32, grey values and their squares
    kept : (H, W) uint8, bits of the components that count
    out : (H, W, K) float32, filled; 0 where a component does not count
    """
    _over_rows_densities(image, weights, means, variances, kept, out)


def mixture_scores(image, weights, means, variances, kept, out):
    """-log of (2.1) over evenly spread colours, nats, into out (H, W) float32; the rest as `mixture_densities`."""
    _over_rows_scores(image, weights, means, variances, kept, out)


def mixture_update(
    image, learnt, weights, means, variances, kept, *, limit, rate, floor, wide, portion, matched, fresh, background
):
    """Learn one picture where `learnt` (H, W) bool says so; arrays as for `mixture_densities`, changed in place.

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
