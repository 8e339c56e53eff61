"""A mixture of Gaussians at every pixel: distances, densities, and the update (Zhao 2009, 2.1 to 2.5).

Covariances are diagonal. A slot whose weight is 0 is empty. `kept` has a bit for every component that counts as
background. Pixels are independent of each other and rows are shared out over threads, so that threads change nothing.

Of each row, numbers lie slot by slot, and channel by channel within a slot, so that what is done at all pixels alike is
vector code along the row: weights (H, K, W), means and variances (H, K, C, W).
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
FARTHEST = 2500.0
"""Summed squared distance of two pixels, at which their joint density has fallen by 86 nats: as far as float32 goes."""
_TAIL, _2_TAIL, _FARTHEST = np.float32(TAIL), np.float32(2.0 * TAIL), np.float32(FARTHEST)
_PER_RANGE_SQUARED = np.float32(2.0 * math.pi / (256.0 * 256.0))
_0, _1 = np.float32(0.0), np.float32(1.0)
_E0, _E1, _E2, _E3, _E4, _E5, _E6 = (
    np.float32(term)
    for term in np.polynomial.Chebyshev.interpolate(np.exp, 6, [-1, 0]).convert(kind=np.polynomial.Polynomial).coef
)
"""exp from -1 to 0 as a polynomial, to 1e-7: there is no vector code for `math.exp`."""


@vector_kernel
def _root(squared, tail):
    """exp(-d^2 / tail) of a squared distance, up to tail; tail / d^2 / e from there on."""
    u = min(squared, tail) / -tail
    root = _E0 + u * (_E1 + u * (_E2 + u * (_E3 + u * (_E4 + u * (_E5 + u * _E6)))))
    return root * (tail / max(squared, tail))


@vector_kernel
def _fall(squared):
    """exp(-d^2 / 2) of a squared distance, up to TAIL."""
    fall = _root(squared, _TAIL)
    fall *= fall
    fall *= fall
    return fall * fall


@vector_kernel
def fall_together(squared):
    """Of the summed squared distances of two pixels: exp(-d^2 / 2) up to 2 TAIL, falling with its 16th power from there
    on; no more beyond FARTHEST."""
    fall = _root(min(squared, _FARTHEST), _2_TAIL)
    fall *= fall
    fall *= fall
    fall *= fall
    return fall * fall


@vector_kernel
def row_colours(image, y, out):
    """One row of a picture (H, W, C), channel by channel: out (C, W) float32."""
    for c in range(out.shape[0]):
        for x in range(out.shape[1]):
            out[c, x] = image[y, x, c]


@vector_kernel
def _add_squared(colours, means, variances, out):
    for x in range(out.shape[0]):
        off = colours[x] - means[x]
        out[x] += off * off / variances[x]


@vector_kernel
def _slot_distances(colours, means, variances, out):
    """Squared Mahalanobis distances of colours (C, W) to one component: means and variances (C, W), out (W,)."""
    out[:] = _0
    for c in range(colours.shape[0]):
        _add_squared(colours[c], means[c], variances[c], out)


@vector_kernel
def _times_variances(variances, out):
    for x in range(out.shape[0]):
        out[x] *= variances[x] * _PER_RANGE_SQUARED


@vector_kernel
def _over_root(bits, k, out):
    for x in range(out.shape[0]):
        out[x] = np.float32(bits[x] >> np.uint8(k) & 1) / np.float32(math.sqrt(out[x]))


@vector_kernel
def _slot_heights(variances, bits, k, out):
    """Densities (2.2) at the means of component k, over that of colours spread evenly over 0..255; 0 where it does not
    count.

    variances (C, W), bits (W,) of `kept`, out (W,)
    """
    out[:] = _1
    for c in range(variances.shape[0]):
        _times_variances(variances[c], out)
    _over_root(bits, k, out)


@vector_kernel
def _slot_densities(distances, heights, out):
    """The same at these squared distances; all (W,)."""
    for x in range(out.shape[0]):
        out[x] = heights[x] * _fall(distances[x])


@vector_kernel
def _keep_nearer(distances, weights, k, least, nearest):
    for x in range(least.shape[0]):
        nearer = weights[x] > _0 and distances[x] < least[x]
        least[x] = distances[x] if nearer else least[x]
        nearest[x] = k if nearer else nearest[x]


@parallel_kernel
def _over_rows_nearest(image, weights, means, variances, limit, nearest):
    height, slots, width = weights.shape
    for row in numba.prange(height):
        y = np.int64(row)
        colours = np.empty((image.shape[2], width), np.float32)
        distances, least = np.empty(width, np.float32), np.full(width, limit)
        row_colours(image, y, colours)
        nearest[y, :] = -1
        for k in range(slots):
            _slot_distances(colours, means[y, k], variances[y, k], distances)
            _keep_nearer(distances, weights[y, k], np.int8(k), least, nearest[y])


@vector_kernel
def _add_weighted(weights, density, alone):
    for x in range(alone.shape[0]):
        alone[x] += weights[x] * density[x]


@parallel_kernel
def _over_rows_look(image, weights, means, variances, kept, limit, nearest, squares, heights, densities, alone):
    height, slots, width = weights.shape
    for row in numba.prange(height):
        y = np.int64(row)
        colours, least = np.empty((image.shape[2], width), np.float32), np.full(width, limit)
        row_colours(image, y, colours)
        nearest[y, :], alone[y, :] = -1, _0
        for k in range(slots):
            _slot_distances(colours, means[y, k], variances[y, k], squares[y, k])
            _keep_nearer(squares[y, k], weights[y, k], np.int8(k), least, nearest[y])
            _slot_heights(variances[y, k], kept[y], k, heights[y, k])
            _slot_densities(squares[y, k], heights[y, k], densities[y, k])
            _add_weighted(weights[y, k], densities[y, k], alone[y])


@parallel_kernel
def _over_rows_scores(image, weights, means, variances, kept, out):
    height, slots, width = weights.shape
    for row in numba.prange(height):
        y = np.int64(row)
        colours, alone = np.empty((image.shape[2], width), np.float32), np.zeros(width, np.float32)
        distances, density = np.empty(width, np.float32), np.empty(width, np.float32)
        row_colours(image, y, colours)
        for k in range(slots):
            _slot_distances(colours, means[y, k], variances[y, k], distances)
            _slot_heights(variances[y, k], kept[y], k, density)
            _slot_densities(distances, density, density)
            _add_weighted(weights[y, k], density, alone)
        for x in range(width):
            out[y, x] = -math.log(max(float(alone[x]), LEAST))


@vector_kernel
def _keep_larger(colours, means, variances, floor, out):
    for x in range(out.shape[0]):
        off = colours[x] - means[x]
        out[x] = max(out[x], off * off / max(variances[x], floor))


@vector_kernel
def _keep_heavier(weights, squared, heaviest, out):
    for x in range(out.shape[0]):
        out[x] = squared[x] if weights[x] > heaviest[x] else out[x]
        heaviest[x] = max(heaviest[x], weights[x])


@vector_kernel
def _roots_where_calm(heaviest, calm, out):
    for x in range(out.shape[0]):
        out[x] = np.float32(math.sqrt(out[x])) if heaviest[x] >= calm else _0


@parallel_kernel
def _over_rows_deviations(image, weights, means, variances, calm, floor, out):
    height, slots, width = weights.shape
    for row in numba.prange(height):
        y = np.int64(row)
        colours, squared = np.empty((image.shape[2], width), np.float32), np.empty(width, np.float32)
        heaviest = np.full(width, -_1)
        row_colours(image, y, colours)
        for k in range(slots):
            squared[:] = _0
            for c in range(image.shape[2]):
                _keep_larger(colours[c], means[y, k, c], variances[y, k, c], floor, squared)
            _keep_heavier(weights[y, k], squared, heaviest, out[y])
        _roots_where_calm(heaviest, calm, out[y])


@vector_kernel
def _decay(weights, matched, rate):
    for x in range(weights.shape[0]):
        weights[x] *= _1 - rate if matched[x] >= 0 else _1


@vector_kernel
def follow(image, weights, means, variances, y, x, slot, rate, floor):
    """(2.3), (2.4) and (2.5) for the component `slot` that matched, after `_decay`; it moves at the rate over its
    weight."""
    weights[y, slot, x] += rate
    share = min(_1, rate / weights[y, slot, x])
    for c in range(image.shape[2]):
        off = np.float32(image[y, x, c]) - means[y, slot, c, x]
        means[y, slot, c, x] += share * off
        off *= _1 - share
        spread = variances[y, slot, c, x]
        variances[y, slot, c, x] = max(spread + share * (off * off - spread), floor)


@kernel
def replace(image, weights, means, variances, y, x, rate, wide):
    """A new component in the slot of least weight; the weights then sum to 1. Returns the slot."""
    slot, rest = 0, _0
    for k in range(weights.shape[1]):
        if weights[y, k, x] < weights[y, slot, x]:
            slot = k
    weights[y, slot, x] = _0
    for k in range(weights.shape[1]):
        rest += weights[y, k, x]
    first = rest == _0
    for k in range(weights.shape[1]):
        weights[y, k, x] *= _0 if first else (_1 - rate) / rest
    weights[y, slot, x] = _1 if first else rate
    for c in range(image.shape[2]):
        means[y, slot, c, x] = np.float32(image[y, x, c])
        variances[y, slot, c, x] = wide
    return slot


@vector_kernel
def _rank(weights, variances, out):
    """Squared weight over summed variances (C, W), of one slot; -1 where it is empty."""
    out[:] = _0
    for c in range(variances.shape[0]):
        out += variances[c]
    for x in range(out.shape[0]):
        out[x] = weights[x] * weights[x] / out[x] if weights[x] > _0 else -_1


@vector_kernel
def _add_before(weights, ranks, own, comes_first, held):
    for x in range(held.shape[0]):
        before = ranks[x] > own[x] or (comes_first and ranks[x] == own[x])
        held[x] += weights[x] if before else _0


@vector_kernel
def _set_bit(ranks, held, portion, k, bits):
    for x in range(bits.shape[0]):
        bits[x] |= np.uint8(np.uint8(1) << np.uint8(k)) if ranks[x] >= _0 and held[x] < portion else np.uint8(0)


@vector_kernel
def background_slots(weights, variances, portion, ranks, held, bits):
    """Bits of the components that make up the background: the first by weight over deviation that hold `portion`.

    weights (K, W), variances (K, C, W); ranks (K, W) and held (W,), written over; bits (W,) uint8, filled
    """
    bits[:] = 0
    for k in range(weights.shape[0]):
        _rank(weights[k], variances[k], ranks[k])
    for k in range(weights.shape[0]):
        held[:] = _0
        for other in range(weights.shape[0]):
            if other != k:
                _add_before(weights[other], ranks[other], ranks[k], other < k, held)
        _set_bit(ranks[k], held, portion, k, bits)


@parallel_kernel
def _over_rows_update(image, learnt, nearest, weights, means, variances, kept, numbers, matched, fresh, background):
    rate, floor, wide, portion = numbers[0], numbers[1], numbers[2], numbers[3]
    height, slots, width = weights.shape
    for row in numba.prange(height):
        y = np.int64(row)
        ranks, held = np.empty((slots, width), np.float32), np.empty(width, np.float32)
        for x in range(width):
            matched[y, x] = nearest[y, x] if learnt[y, x] else -1
            background[y, x] = matched[y, x] >= 0 and (kept[y, x] >> matched[y, x] & 1) == 1
        for k in range(slots):
            _decay(weights[y, k], matched[y], rate)
        for x in range(width):
            fresh[y, x] = -1
            if matched[y, x] >= 0:
                follow(image, weights, means, variances, y, x, np.int64(matched[y, x]), rate, floor)
            elif learnt[y, x]:
                fresh[y, x] = replace(image, weights, means, variances, y, x, rate, wide)
        background_slots(weights[y], variances[y], portion, ranks, held, kept[y])


def mixture_nearest(image, weights, means, variances, limit, nearest):
    """The component nearest to each pixel's colour by Mahalanobis distance (3.4).

    Parameters
    ----------
    image : (H, W, C) uint8
    weights : (H, K, W) float32; 0 in an empty slot
    means, variances : (H, K, C, W) float32, grey values and their squares
    limit : squared Mahalanobis distance up to which a component matches
    nearest : (H, W) int8, filled; -1 where all are beyond `limit`
    """
    _over_rows_nearest(image, weights, means, variances, np.float32(limit), nearest)


def mixture_look(image, weights, means, variances, kept, limit, nearest, squares, heights, densities, alone):
    """The same, and densities of the background's components over that of colours spread evenly over 0..255.

    Parameters
    ----------
    kept : (H, W) uint8, bits of the components that count
    squares : (H, K, W) float32, filled: squared Mahalanobis distances
    heights : (H, K, W) float32, filled: densities at the means; 0 where a component does not count
    densities : (H, K, W) float32, filled; 0 where a component does not count
    alone : (H, W) float32, filled: the density (2.1) of the mixture
    """
    _over_rows_look(
        image, weights, means, variances, kept, np.float32(limit), nearest, squares, heights, densities, alone
    )


def mixture_scores(image, weights, means, variances, kept, out):
    """-log of (2.1) over evenly spread colours, nats, into out (H, W) float32; the rest as for `mixture_look`."""
    _over_rows_scores(image, weights, means, variances, kept, out)


def calm_deviations(image, weights, means, variances, calm, floor, out):
    """Deviation from each pixel's heaviest component, the largest over the channels; 0 where that has less weight than
    `calm`.

    floor : least variance
    out : (H, W) float32, filled; the rest as for `mixture_nearest`
    """
    _over_rows_deviations(image, weights, means, variances, np.float32(calm), np.float32(floor), out)


def mixture_update(
    image, learnt, nearest, weights, means, variances, kept, *, rate, floor, wide, portion, matched, fresh, background
):
    """Learn one picture where `learnt` (H, W) bool says so; arrays as `mixture_look` takes and fills them, changed in
    place.

    Parameters
    ----------
    rate : alpha of (2.5)
    floor, wide : least variance, and that of a new component, squared grey values
    portion : share of the weight that the background's components hold
    matched, fresh : (H, W) int8, filled: the component that matched, the slot of a new one; -1 for none
    background : (H, W) bool, filled: what matched counted as background, before this picture
    """
    numbers = np.array([rate, floor, wide, portion], np.float32)
    _over_rows_update(image, learnt, nearest, weights, means, variances, kept, numbers, matched, fresh, background)
