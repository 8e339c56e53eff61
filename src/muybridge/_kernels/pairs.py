"""Joint colours of pairs of pixels: weights over the combinations of their components (Zhao 2009, 3.1 to 3.8).

A pair (p, p + offset) is kept once, at p: counts (K, K) over combinations, and their sum, so that a weight of (3.2)
is a count over the sum. A pixel's partners are numbered 2 d for the one at offset d and 2 d + 1 for the one at the
negative offset, whose counts are read across; -1 is none. A joint covariance has the blocks of the two pixels' own
components, so a joint density is a product of two. Scores only read, and an update writes to its own pixel's pairs
only: rows are shared out over threads, and threads change nothing.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from muybridge._kernels._jit import kernel, parallel_kernel
from muybridge._kernels.mixture import LEAST

_FULL = np.float32(1e30)
_0, _1 = np.float32(0.0), np.float32(1.0)


@kernel
def _joint(counts, first, second, across):
    """Sum over combinations of count times both densities; the partner's density alone, by the same counts, second."""
    joint, alone = 0.0, 0.0
    size = first.shape[0]
    for j in range(size):
        if second[j] == _0:
            continue
        column, weight = 0.0, 0.0
        for i in range(size):
            count = counts[j, i] if across else counts[i, j]
            column += count * first[i]
            weight += count
        joint += second[j] * column
        alone += second[j] * weight
    return joint, alone


@kernel
def _partner_density(partner, y, x, own, densities, counts, totals, offsets, least):
    """P(c0, ci) = P(c0 | ci) P(ci), in which P(ci) is at least `least`; 1 where nothing is known."""
    d, across = partner >> 1, (partner & 1) == 1
    sign = -1 if across else 1
    qy, qx = y + sign * offsets[d, 0], x + sign * offsets[d, 1]
    py, px = (qy, qx) if across else (y, x)
    total = totals[d, py, px]
    if total <= _0:
        return 1.0
    joint, alone = _joint(counts[d, py, px], own, densities[qy, qx], across)
    rare = max(alone / total, LEAST)
    return max(joint / total, LEAST) * (least / rare if rare < least else 1.0)


@parallel_kernel
def _over_rows_scores(weights, densities, counts, totals, offsets, partners, least, out):
    for row in numba.prange(out.shape[0]):
        y = np.int64(row)
        for x in range(out.shape[1]):
            alone = 0.0
            for k in range(weights.shape[2]):
                alone += weights[y, x, k] * densities[y, x, k]
            score, product = 0.0, max(alone, LEAST)
            for n in range(partners.shape[2]):
                if partners[y, x, n] >= 0:
                    product *= _partner_density(
                        partners[y, x, n], y, x, densities[y, x], densities, counts, totals, offsets, least
                    )
                    if n % 4 == 3:  # so that a product of many stays above nought
                        score -= math.log(product)
                        product = 1.0
            out[y, x] = score - math.log(product)


@kernel
def heaviest(weight, kept):
    """The background component of most weight; -1 where there is none."""
    best = -1
    for k in range(weight.shape[0]):
        if kept >> k & 1 and (best < 0 or weight[k] > weight[best]):
            best = k
    return best


@parallel_kernel
def _over_rows_calm(weights, kept, densities, calm, colours, scores):
    for y in numba.prange(scores.shape[0]):
        for x in range(scores.shape[1]):
            slot = heaviest(weights[y, x], kept[y, x])
            if slot >= 0 and weights[y, x, slot] >= calm:
                scores[y, x] = -math.log(max(densities[y, x, slot], LEAST))
            else:
                scores[y, x] /= colours


@kernel
def forget(counts, slot, first):
    """A component was made anew: its combinations start at nought. Returns the sum of all counts."""
    total = _0
    for i in range(counts.shape[0]):
        if first:
            counts[slot, i] = _0
        else:
            counts[i, slot] = _0
    for i in range(counts.shape[0]):
        for j in range(counts.shape[1]):
            total += counts[i, j]
    return total


@kernel
def add(counts, total, i, j, growth):
    """(3.5) for the combination that matched; the newest picture's share is one in all, later the rate. New total."""
    gain = max(_1, total * growth)
    counts[i, j] += gain
    total += gain
    if total > _FULL:
        for a in range(counts.shape[0]):
            for b in range(counts.shape[1]):
                counts[a, b] /= total
        return _1
    return total


@parallel_kernel
def _over_rows_update(counts, totals, offsets, matched, fresh, growth):
    height, width = matched.shape
    for row in numba.prange(height):
        y = np.int64(row)
        for d in range(offsets.shape[0]):
            qy = y + offsets[d, 0]
            if not 0 <= qy < height:
                continue
            for x in range(max(0, -offsets[d, 1]), min(width, width - offsets[d, 1])):
                qx = x + offsets[d, 1]
                if fresh[y, x] >= 0:
                    totals[d, y, x] = forget(counts[d, y, x], fresh[y, x], True)
                if fresh[qy, qx] >= 0:
                    totals[d, y, x] = forget(counts[d, y, x], fresh[qy, qx], False)
                if matched[y, x] >= 0 and matched[qy, qx] >= 0:
                    totals[d, y, x] = add(counts[d, y, x], totals[d, y, x], matched[y, x], matched[qy, qx], growth)


@kernel
def mutual_information(counts):
    """(3.8) of counts (K, K) over their sum, nats; 0 where there are none."""
    size, total, information = counts.shape[0], 0.0, 0.0
    for i in range(size):
        for j in range(size):
            total += counts[i, j]
    for i in range(size):
        row = 0.0
        for n in range(size):
            row += counts[i, n]
        for j in range(size):
            if counts[i, j] > _0:
                column = 0.0
                for m in range(size):
                    column += counts[m, j]
                information += counts[i, j] / total * math.log(counts[i, j] * total / (row * column))
    return information


@parallel_kernel
def _over_rows_information(counts, first, step, out):
    for r in numba.prange((out.shape[1] - first + step - 1) // step):
        y = first + np.int64(r) * step
        for d in range(out.shape[0]):
            for x in range(out.shape[2]):
                out[d, y, x] = mutual_information(counts[d, y, x])


@kernel
def _most_informative(information, offsets, y, x, chosen, n):
    """The partner inside the picture that is not among the first n chosen and has most information; -1 for none."""
    best, most = -1, -1.0
    for candidate in range(2 * offsets.shape[0]):
        d, sign = candidate >> 1, 1 - 2 * (candidate & 1)
        qy, qx = y + sign * offsets[d, 0], x + sign * offsets[d, 1]
        open_ = 0 <= qy < information.shape[1] and 0 <= qx < information.shape[2]
        for m in range(n):
            open_ = open_ and chosen[m] != candidate
        if open_:
            value = information[d, y, x] if sign > 0 else information[d, qy, qx]
            if value > most:
                best, most = candidate, value
    return best


@parallel_kernel
def _over_rows_choice(information, offsets, first, step, partners):
    for r in numba.prange((partners.shape[0] - first + step - 1) // step):
        y = first + np.int64(r) * step
        for x in range(partners.shape[1]):
            for n in range(partners.shape[2]):
                partners[y, x, n] = _most_informative(information, offsets, y, x, partners[y, x], n)


def pair_scores(weights, densities, counts, totals, offsets, partners, limit, out):
    """-log of (3.1) over evenly spread colours, nats.

    Parameters
    ----------
    weights, densities : (H, W, K) float32, of `_kernels.mixture`
    counts : (D, H, W, K, K) float32, and their sums totals (D, H, W) float32: one matrix for each pair
    offsets : (D, 2) int64, (rows, columns) from a pixel to the second one of its pair d
    partners : (H, W, M) int8: numbers of each pixel's partners, -1 for none
    limit : nats: the most that the partner's own colour may cost
    out : (H, W) float32, filled
    """
    _over_rows_scores(weights, densities, counts, totals, offsets, partners, math.exp(-limit), out)


def calm_scores(weights, kept, densities, calm, colours, scores):
    """Put single Gaussians in the place of `pair_scores` where a pixel is calm; make the others' a mean over colours.

    Parameters
    ----------
    weights, densities : (H, W, K) float32 and kept (H, W) uint8, as `_kernels.mixture` has them
    calm : weight of the heaviest component from which a pixel is calm
    colours : how many colours enter a score of `pair_scores`: 1 + 2 M
    scores : (H, W) float32, changed: nats per colour
    """
    _over_rows_calm(weights, kept, densities, np.float32(calm), np.float32(colours), scores)


def pair_update(counts, totals, offsets, matched, fresh, rate):
    """Learn which components matched together; matched and fresh (H, W) int8 as `mixture_update` fills them."""
    _over_rows_update(counts, totals, offsets, matched, fresh, np.float32(rate / (1.0 - rate)))


def choose_partners(counts, offsets, first, step, information, partners):
    """Measure the pairs of rows first, first + step ... anew, and choose those rows' partners by it.

    information : (D, H, W) float32, nats, kept from call to call: a partner's row may have been measured earlier
    """
    _over_rows_information(counts, first, step, information)
    _over_rows_choice(information, offsets, first, step, partners)
