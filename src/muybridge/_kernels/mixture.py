"""A mixture of Gaussians at every pixel: densities, matching, and the update (Zhao 2009, 2.1 to 2.5).

Covariances are diagonal. A slot whose weight is 0 is empty. Pixels are independent of each other and rows are shared
out over threads, so that threads change nothing.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from muybridge._kernels._jit import kernel, parallel_kernel

TAIL = 16.0
"""Squared Mahalanobis distance from which on densities fall with the logarithm: far colours keep their order, and
products of two densities stay above nought."""
SLOTS = 8
"""The most components of a mixture: what a pixel's distances are kept in."""
_UNIFORM = 256.0 / math.sqrt(2.0 * math.pi)


@kernel
def slot_densities(colour, weight, mean, variance, out):
    """Fill out (K,) with each component's density at colour (C,) over that of evenly spread colours; 0 in empty slots."""
    channels = colour.shape[0]
    for k in range(weight.shape[0]):
        if weight[k] == np.float32(0.0):
            out[k] = np.float32(0.0)
            continue
        distance, spread = np.float32(0.0), np.float32(1.0)
        for c in range(channels):
            off = np.float32(colour[c]) - mean[k, c]
            distance += off * off / variance[k, c]
            spread *= np.float32(_UNIFORM * _UNIFORM) / variance[k, c]
        if distance > np.float32(TAIL):
            distance = np.float32(TAIL) * (np.float32(1.0) + np.float32(math.log(distance / np.float32(TAIL))))
        out[k] = np.float32(math.exp(np.float32(-0.5) * distance)) * np.float32(math.sqrt(spread))


@kernel
def best_slot(colour, weight, mean, variance, limit):
    """The component nearest to colour (C,) by Mahalanobis distance (3.4); -1 where all are further than `limit`."""
    best, least = -1, limit
    for k in range(weight.shape[0]):
        if weight[k] > np.float32(0.0):
            distance = np.float32(0.0)
            for c in range(colour.shape[0]):
                off = np.float32(colour[c]) - mean[k, c]
                distance += off * off / variance[k, c]
            if distance < least:
                best, least = k, distance
    return best


@kernel
def slot_is_background(slot, weight, variance, portion):
    """Whether the components before this one, by weight over deviation, hold less than `portion` of the weight."""
    before = np.float32(0.0)
    rank = weight[slot] * weight[slot] / variance[slot].sum()
    for k in range(weight.shape[0]):
        if k != slot and weight[k] * weight[k] / variance[k].sum() > rank:
            before += weight[k]
    return before < portion


@kernel
def follow(colour, slot, weight, mean, variance, rate, floor):
    """(2.3), (2.4) and (2.5) for the matched component `slot`; a mean moves at the rate over the weight."""
    for k in range(weight.shape[0]):
        weight[k] *= np.float32(1.0) - rate
    weight[slot] += rate
    share = rate / weight[slot]
    for c in range(colour.shape[0]):
        off = np.float32(colour[c]) - mean[slot, c]
        mean[slot, c] += share * off
        left = (np.float32(1.0) - share) * off
        variance[slot, c] = max(variance[slot, c] + share * (left * left - variance[slot, c]), floor)


@kernel
def replace(colour, weight, mean, variance, rate, wide):
    """A new component in the slot of least weight; the weights sum to 1 again. Returns the slot."""
    slot = 0
    for k in range(weight.shape[0]):
        if weight[k] < weight[slot]:
            slot = k
    weight[slot] = np.float32(0.0)
    rest = weight.sum()
    left = np.float32(0.0) if rest == np.float32(0.0) else (np.float32(1.0) - rate) / rest
    for k in range(weight.shape[0]):
        weight[k] *= left
    weight[slot] = rate if rest > np.float32(0.0) else np.float32(1.0)
    for c in range(colour.shape[0]):
        mean[slot, c] = colour[c]
        variance[slot, c] = wide
    return slot


@parallel_kernel
def _over_rows_density(image, weights, means, variances, out):
    for y in numba.prange(image.shape[0]):
        for x in range(image.shape[1]):
            slot_densities(image[y, x], weights[y, x], means[y, x], variances[y, x], out[y, x])


@parallel_kernel
def _over_rows_background(image, weights, means, variances, limit, portion, out):
    for y in numba.prange(image.shape[0]):
        for x in range(image.shape[1]):
            slot = best_slot(image[y, x], weights[y, x], means[y, x], variances[y, x], limit)
            out[y, x] = slot >= 0 and slot_is_background(slot, weights[y, x], variances[y, x], portion)


@parallel_kernel
def _over_rows_update(image, learnt, weights, means, variances, limit, rate, floor, wide, matched, fresh):
    for y in numba.prange(image.shape[0]):
        for x in range(image.shape[1]):
            if not learnt[y, x]:
                matched[y, x], fresh[y, x] = -1, -1
                continue
            colour, weight, mean, variance = image[y, x], weights[y, x], means[y, x], variances[y, x]
            slot = best_slot(colour, weight, mean, variance, limit)
            matched[y, x], fresh[y, x] = slot, -1
            if slot >= 0:
                follow(colour, slot, weight, mean, variance, rate, floor)
            else:
                fresh[y, x] = replace(colour, weight, mean, variance, rate, wide)


def mixture_densities(image, weights, means, variances, out):
    """Densities of every component at every pixel, over that of colours spread evenly over 0..255.

    Parameters
    ----------
    image : (H, W, C) uint8
    weights : (H, W, K) float32; 0 in an empty slot
    means, variances : (H, W, K, C) float32, grey values and their squares
    out : (H, W, K) float32, filled
    """
    _over_rows_density(image, weights, means, variances, out)


def mixture_background(image, weights, means, variances, limit, portion, out):
    """Where the nearest component is near and among those that hold the first `portion` of the weight.

    limit : squared Mahalanobis distance; out : (H, W) bool, filled
    """
    _over_rows_background(image, weights, means, variances, np.float32(limit), np.float32(portion), out)


def mixture_update(image, learnt, weights, means, variances, limit, rate, floor, wide, matched, fresh):
    """Learn one picture.

    Parameters
    ----------
    limit : squared Mahalanobis distance up to which a component matches
    rate : alpha of (2.5)
    floor, wide : least variance, and that of a new component
    matched, fresh : (H, W) int8, filled: the component that matched, the slot of a new one; -1 for none
    """
    numbers = (np.float32(number) for number in (limit, rate, floor, wide))
    _over_rows_update(image, learnt, weights, means, variances, *numbers, matched, fresh)
