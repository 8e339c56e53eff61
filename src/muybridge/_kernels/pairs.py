"""Joint colours of pairs of pixels: weights over the combinations of their components (Zhao 2009, 3.1 to 3.8).

A pair (p, p + offset) is kept once, at p: counts (K, K) over combinations, and their sum, so that a weight of (3.2)
is a count over the sum. A pixel's partners are numbered 2 d for the one at offset d and 2 d + 1 for the one at the
negative offset, whose counts are read across; -1 is none. Where a pair has shown one combination alone, `only` says
which, and its counts need neither be read nor changed: all counts together fit no cache. A joint covariance has the
blocks of the two pixels' own components, so a joint density is a product of two. Scores only read, and an update writes
to its own pixel's pairs only: rows are shared out over threads, and threads change nothing.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from muybridge._kernels._jit import kernel, parallel_kernel, vector_kernel
from muybridge._kernels.mixture import LEAST

_FULL = np.float32(1e30)
_0, _1, _2 = np.float32(0.0), np.float32(1.0), np.float32(2.0)
NONE, SEVERAL = -2, -1
"""What `only` says of a pair of which no combination was seen, or more than one."""


@vector_kernel
def _alone(only, size, across):
    """Own and the partner's component of the one combination `only` = first * K + second."""
    first, second = only // size, only % size
    return (second, first) if across else (first, second)


@vector_kernel
def _joint(counts, d, py, px, densities, y, x, qy, qx, across):
    """Sum over combinations of count times both densities; the partner's density alone, by the same counts, second."""
    joint, alone = 0.0, 0.0
    size = densities.shape[2]
    for j in range(size):
        if densities[qy, qx, j] == _0:
            continue
        column, weight = _0, _0
        for i in range(size):
            count = counts[d, py, px, j, i] if across else counts[d, py, px, i, j]
            column += count * densities[y, x, i]
            weight += count
        joint += densities[qy, qx, j] * column
        alone += densities[qy, qx, j] * weight
    return joint, alone


@vector_kernel
def _place(partner, offsets, y, x):
    """The pair's number, whether it is read across, and the partner's place."""
    d, across = np.int64(partner >> 1), (partner & 1) == 1
    sign = -1 if across else 1
    return d, across, y + sign * offsets[d, 0], x + sign * offsets[d, 1]


@vector_kernel
def _partner_density(partner, y, x, densities, counts, totals, only, offsets, least):
    """P(c0, ci) = P(c0 | ci) P(ci), in which P(ci) is at least `least`; 1 where nothing is known."""
    d, across, qy, qx = _place(partner, offsets, y, x)
    py, px = (qy, qx) if across else (y, x)
    single = np.int64(only[d, py, px])
    if single == NONE:
        return 1.0
    if single >= 0:
        i, j = _alone(single, densities.shape[2], across)
        rare = float(densities[qy, qx, j])
        joint = rare * densities[y, x, i]
    else:
        joint, rare = _joint(counts, d, py, px, densities, y, x, qy, qx, across)
        share = 1.0 / totals[d, py, px]
        joint *= share
        rare *= share
    rare = max(rare, LEAST)
    return max(joint, LEAST) * (least / rare if rare < least else 1.0)


@parallel_kernel
def _over_rows_scores(weights, densities, counts, totals, only, offsets, partners, least, out):
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
                        partners[y, x, n], y, x, densities, counts, totals, only, offsets, least
                    )
                    if n % 4 == 3:  # so that a product of many stays above nought
                        score -= math.log(product)
                        product = 1.0
            out[y, x] = score - math.log(product)


@kernel
def forget(counts, totals, only, d, y, x, first, second):
    """Components were made anew, -1 for none: their combinations start at nought."""
    size, single = counts.shape[3], np.int64(only[d, y, x])
    if single == NONE or (single >= 0 and single // size != first and single % size != second):
        return
    total = _0
    for i in range(size):
        for j in range(size):
            if i == first or j == second:
                counts[d, y, x, i, j] = _0
            total += counts[d, y, x, i, j]
    totals[d, y, x] = total
    if total == _0:
        only[d, y, x] = NONE


@vector_kernel
def add(counts, totals, only, d, y, x, i, j, growth):
    """(3.5) for the combination that matched; the newest picture's share is one in all, later the rate.

    Where it is the only one, its weight is 1 whatever is added: from 1 / growth on nothing is.
    """
    single, code = np.int64(only[d, y, x]), i * counts.shape[3] + j
    total = totals[d, y, x]
    if single == code and total * growth >= _1:
        return
    if single != code:
        only[d, y, x] = code if single == NONE else SEVERAL
    gain = max(_1, total * growth)
    counts[d, y, x, i, j] += gain
    total += gain
    if total > _FULL:
        for a in range(counts.shape[3]):
            for b in range(counts.shape[4]):
                counts[d, y, x, a, b] /= total
        total = _1
    totals[d, y, x] = total


@parallel_kernel
def _over_rows_update(counts, totals, only, offsets, matched, fresh, growth):
    height, width = matched.shape
    for row in numba.prange(height):
        y = np.int64(row)
        for d in range(offsets.shape[0]):
            qy = y + offsets[d, 0]
            if not 0 <= qy < height:
                continue
            for x in range(max(0, -offsets[d, 1]), min(width, width - offsets[d, 1])):
                qx = x + offsets[d, 1]
                first, second = np.int64(fresh[y, x]), np.int64(fresh[qy, qx])
                if first >= 0 or second >= 0:
                    forget(counts, totals, only, d, y, x, first, second)
                i, j = np.int64(matched[y, x]), np.int64(matched[qy, qx])
                if i >= 0 and j >= 0:
                    add(counts, totals, only, d, y, x, i, j, growth)


@kernel
def mutual_information(counts, d, y, x):
    """(3.8) of counts (K, K) over their sum, nats; 0 where there are none."""
    size, total, information = counts.shape[3], 0.0, 0.0
    for i in range(size):
        for j in range(size):
            total += counts[d, y, x, i, j]
    for i in range(size):
        row = 0.0
        for n in range(size):
            row += counts[d, y, x, i, n]
        for j in range(size):
            count = counts[d, y, x, i, j]
            if count > _0:
                column = 0.0
                for m in range(size):
                    column += counts[d, y, x, m, j]
                information += count / total * math.log(count * total / (row * column))
    return information


@parallel_kernel
def _over_rows_information(counts, only, first, step, out):
    for r in numba.prange((out.shape[1] - first + step - 1) // step):
        y = first + np.int64(r) * step
        for d in range(out.shape[0]):
            for x in range(out.shape[2]):
                out[d, y, x] = mutual_information(counts, d, y, x) if only[d, y, x] == SEVERAL else _0


@kernel
def _most_informative(information, offsets, y, x, partners, n):
    """The partner inside the picture that is not among the first n chosen and has most information; -1 for none."""
    best, most = -1, -1.0
    for candidate in range(2 * offsets.shape[0]):
        d, _, qy, qx = _place(candidate, offsets, y, x)
        open_ = 0 <= qy < information.shape[1] and 0 <= qx < information.shape[2]
        for m in range(n):
            open_ = open_ and partners[y, x, m] != candidate
        if open_:
            value = information[d, qy, qx] if candidate & 1 else information[d, y, x]
            if value > most:
                best, most = candidate, value
    return best


@parallel_kernel
def _over_rows_choice(information, offsets, first, step, partners):
    for r in numba.prange((partners.shape[0] - first + step - 1) // step):
        y = first + np.int64(r) * step
        for x in range(partners.shape[1]):
            for n in range(partners.shape[2]):
                partners[y, x, n] = _most_informative(information, offsets, y, x, partners, n)


@vector_kernel
def _heaviest(weights, y, x):
    """The component of most weight."""
    best = 0
    for k in range(1, weights.shape[2]):
        if weights[y, x, k] > weights[y, x, best]:
            best = k
    return best


@parallel_kernel
def _over_rows_deviations(image, weights, means, variances, kept, floor, out):
    for row in numba.prange(image.shape[0]):
        y = np.int64(row)
        for x in range(image.shape[1]):
            known = _heaviest(weights, y, x)
            for k in range(out.shape[2]):
                largest = np.float32(np.inf)
                if kept[y, x] >> k & 1:
                    largest = _0
                    for c in range(image.shape[2]):
                        off = np.float32(image[y, x, c]) - means[y, x, k, c]
                        variance = max(min(variances[y, x, k, c], variances[y, x, known, c]), floor)
                        largest = max(largest, off * off / variance)
                out[y, x, k] = largest


@vector_kernel
def _nearest(deviations, y, x):
    """The component of least deviation."""
    best = 0
    for k in range(1, deviations.shape[2]):
        if deviations[y, x, k] < deviations[y, x, best]:
            best = k
    return best


@vector_kernel
def _surprise(counts, totals, only, offsets, partner, deviations, match, limit, y, x, k):
    """-log of how often component k was seen with the one the partner shows now, nats, at most `limit`; 0 where the
    partner shows none or nothing is known."""
    d, across, qy, qx = _place(partner, offsets, y, x)
    py, px = (qy, qx) if across else (y, x)
    single = np.int64(only[d, py, px])
    shown = _nearest(deviations, qy, qx)
    if single == NONE or deviations[qy, qx, shown] > match:
        return _0
    if single >= 0:
        i, j = _alone(single, deviations.shape[2], across)
        return limit if j == shown and i != k else _0
    together, times = _0, _0
    for i in range(deviations.shape[2]):
        count = counts[d, py, px, shown, i] if across else counts[d, py, px, i, shown]
        times += count
        if i == k:
            together = count
    if times == _0 or together >= times:
        return _0
    return limit if together == _0 else min(limit, np.float32(math.log(times / together)))


@parallel_kernel
def _over_rows_pooled(deviations, kept, counts, totals, only, offsets, partners, match, limit, out):
    for row in numba.prange(out.shape[0]):
        y = np.int64(row)
        for x in range(out.shape[1]):
            least = deviations[y, x, _nearest(deviations, y, x)]
            if kept[y, x] & (kept[y, x] - 1):  # more than one
                least = np.float32(np.inf)
                for k in range(deviations.shape[2]):
                    cost = deviations[y, x, k]
                    if cost < least:
                        for n in range(partners.shape[2]):
                            if partners[y, x, n] >= 0:
                                cost += _2 * _surprise(
                                    counts, totals, only, offsets, partners[y, x, n], deviations, match, limit, y, x, k
                                )
                        least = min(least, cost)
            out[y, x] = math.sqrt(least)


def pair_scores(weights, densities, counts, totals, only, offsets, partners, limit, out):
    """-log of (3.1) over evenly spread colours, nats.

    Parameters
    ----------
    weights, densities : (H, W, K) float32, of `_kernels.mixture`
    counts : (D, H, W, K, K) float32, and their sums totals (D, H, W) float32: one matrix for each pair
    only : (D, H, W) int8: the one combination i * K + j that was seen, or NONE, or SEVERAL
    offsets : (D, 2) int64, (rows, columns) from a pixel to the second one of its pair d
    partners : (H, W, M) int8: numbers of each pixel's partners, -1 for none
    limit : nats: the most that the partner's own colour may cost
    out : (H, W) float32, filled
    """
    _over_rows_scores(weights, densities, counts, totals, only, offsets, partners, math.exp(-limit), out)


def slot_deviations(image, weights, means, variances, kept, floor, out):
    """Squared deviations from each background component, the largest over the channels; infinite for others.

    A pixel's noise is about the same whatever it shows: no component is judged by more than the heaviest one's
    variance, however wide it was made.

    Parameters
    ----------
    image, weights, means, variances, kept : as for `_kernels.mixture.mixture_scores`
    floor : least variance
    out : (H, W, K) float32, filled
    """
    _over_rows_deviations(image, weights, means, variances, kept, np.float32(floor), out)


def pooled_scores(deviations, kept, counts, totals, only, offsets, partners, match, limit, out):
    """Deviations from the nearest component, where components that do not go with what the partners show lie further.

    Parameters
    ----------
    deviations : (H, W, K) float32 of `slot_deviations`
    kept, counts, totals, only, offsets, partners : as above
    match : squared deviations up to which a partner shows its nearest component
    limit : nats: the most that one partner may add
    out : (H, W) float32, filled: the root of the least sum of a squared deviation and twice the partners' nats
    """
    _over_rows_pooled(
        deviations, kept, counts, totals, only, offsets, partners, np.float32(match), np.float32(limit), out
    )


def pair_update(counts, totals, only, offsets, matched, fresh, rate):
    """Learn which components matched together; matched and fresh (H, W) int8 as `mixture_update` fills them."""
    _over_rows_update(counts, totals, only, offsets, matched, fresh, np.float32(rate / (1.0 - rate)))


def choose_partners(counts, only, offsets, first, step, information, partners):
    """Measure the pairs of rows first, first + step ... anew, and choose those rows' partners by it.

    information : (D, H, W) float32, nats, kept from call to call: a partner's row may have been measured earlier
    """
    _over_rows_information(counts, only, first, step, information)
    _over_rows_choice(information, offsets, first, step, partners)
