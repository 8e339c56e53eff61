"""Joint colours of pairs of pixels: weights over the combinations of their components (Zhao 2009, 3.1 to 3.8).

A pair (p, p + offset) is kept once, at p, as counts (K, K) over combinations and their sum; a pixel's partners are
numbered 2 d (the one at +offset d) and 2 d + 1 (at -offset d, whose counts are read across). Combinations share the
blocks of their covariance with the pixels' own components, so a joint density is a product of two.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from muybridge._kernels._jit import kernel, parallel_kernel

LEAST = 1e-37
"""Densities below this are as good as nought; its logarithm is what an impossible colour costs."""
_FULL = np.float32(1e30)


@kernel
def inside(y, x, height, width):
    return 0 <= y < height and 0 <= x < width


@kernel
def joint_density(counts, total, first, second, across):
    """(3.2): densities (K,) of the two pixels' components, weighed by the pair's counts (K, K)."""
    joint = 0.0
    for i in range(first.shape[0]):
        if first[i] > np.float32(0.0):
            row = 0.0
            for j in range(second.shape[0]):
                count = counts[j, i] if across else counts[i, j]
                row += count * second[j]
            joint += row * first[i]
    return joint / total


@kernel
def marginal_density(counts, total, densities, across):
    """The density of one pixel alone, by the pair's own counts."""
    alone = 0.0
    for i in range(densities.shape[0]):
        if densities[i] > np.float32(0.0):
            row = 0.0
            for j in range(densities.shape[0]):
                row += counts[j, i] if across else counts[i, j]
            alone += row * densities[i]
    return alone / total


@kernel
def logarithm(density):
    return math.log(max(density, LEAST))


@parallel_kernel
def _over_rows_scores(weights, densities, counts, totals, offsets, partners, kind, out):
    height, width = weights.shape[:2]
    for row in numba.prange(height):
        y = np.int64(row)
        for x in range(width):
            own = densities[y, x]
            alone = 0.0
            for k in range(own.shape[0]):
                alone += weights[y, x, k] * own[k]
            score = -logarithm(alone)
            for n in range(partners.shape[2]):
                partner = partners[y, x, n]
                if partner < 0:
                    continue
                d, across = partner >> 1, (partner & 1) == 1
                qy = y - offsets[d, 0] if across else y + offsets[d, 0]
                qx = x - offsets[d, 1] if across else x + offsets[d, 1]
                py, px = (qy, qx) if across else (y, x)
                total = totals[d, py, px]
                if total <= np.float32(0.0):
                    continue
                other = densities[qy, qx]
                matrix = counts[d, py, px]
                score -= logarithm(joint_density(matrix, total, own, other, across))
                if kind >= 1:
                    score += logarithm(marginal_density(matrix, total, other, not across))
                if kind >= 2:
                    score += logarithm(marginal_density(matrix, total, own, across))
            out[y, x] = score


@kernel
def forget_slot(counts, slot, by_row):
    """A component has been replaced: its combinations start again. Returns the counts' sum."""
    for k in range(counts.shape[0]):
        if by_row:
            counts[slot, k] = np.float32(0.0)
        else:
            counts[k, slot] = np.float32(0.0)
    return counts.sum()


@parallel_kernel
def _over_rows_update(counts, totals, offsets, matched, fresh, learnt, rate):
    height, width = matched.shape
    growth = rate / (np.float32(1.0) - rate)
    for row in numba.prange(height):
        y = np.int64(row)
        for d in range(offsets.shape[0]):
            qy = y + offsets[d, 0]
            if not 0 <= qy < height:
                continue
            for x in range(width):
                qx = x + offsets[d, 1]
                if not 0 <= qx < width:
                    continue
                if fresh[y, x] >= 0:
                    totals[d, y, x] = forget_slot(counts[d, y, x], fresh[y, x], True)
                if fresh[qy, qx] >= 0:
                    totals[d, y, x] = forget_slot(counts[d, y, x], fresh[qy, qx], False)
                i, j = matched[y, x], matched[qy, qx]
                if i < 0 or j < 0 or not (learnt[y, x] and learnt[qy, qx]):
                    continue
                # The share of the newest picture is 1 over the number seen, later `rate`.
                gain = max(np.float32(1.0), totals[d, y, x] * growth)
                counts[d, y, x, i, j] += gain
                totals[d, y, x] += gain
                if totals[d, y, x] > _FULL:
                    for a in range(counts.shape[3]):
                        for b in range(counts.shape[4]):
                            counts[d, y, x, a, b] /= totals[d, y, x]
                    totals[d, y, x] = np.float32(1.0)


@kernel
def mutual_information(counts, total):
    """(3.8), in nats; 0 where nothing is known."""
    size = counts.shape[0]
    information = 0.0
    if total <= np.float32(0.0):
        return information
    for i in range(size):
        row = 0.0
        for n in range(size):
            row += counts[i, n]
        for j in range(size):
            if counts[i, j] > np.float32(0.0):
                column = 0.0
                for m in range(size):
                    column += counts[m, j]
                information += counts[i, j] / total * math.log(counts[i, j] * total / (row * column))
    return information


@parallel_kernel
def _over_rows_information(counts, totals, first, step, out):
    height = out.shape[1]
    for r in numba.prange((height - first + step - 1) // step):
        y = first + np.int64(r) * step
        for d in range(out.shape[0]):
            for x in range(out.shape[2]):
                out[d, y, x] = mutual_information(counts[d, y, x], totals[d, y, x])


@parallel_kernel
def _over_rows_choice(information, offsets, first, step, partners):
    height, width = partners.shape[:2]
    for r in numba.prange((height - first + step - 1) // step):
        y = first + np.int64(r) * step
        for x in range(width):
            for n in range(partners.shape[2]):
                best, most = -1, -1.0
                for candidate in range(2 * offsets.shape[0]):
                    d, sign = candidate >> 1, 1 - 2 * (candidate & 1)
                    qy, qx = y + sign * offsets[d, 0], x + sign * offsets[d, 1]
                    taken = False
                    for m in range(n):
                        taken = taken or partners[y, x, m] == candidate
                    if taken or not inside(qy, qx, height, width):
                        continue
                    value = information[d, y, x] if sign > 0 else information[d, qy, qx]
                    if value > most:
                        best, most = candidate, value
                partners[y, x, n] = best


def pair_scores(weights, densities, counts, totals, offsets, partners, kind, out):
    _over_rows_scores(weights, densities, counts, totals, offsets, partners, kind, out)


def pair_update(counts, totals, offsets, matched, fresh, learnt, rate):
    _over_rows_update(counts, totals, offsets, matched, fresh, learnt, np.float32(rate))


def pair_information(counts, totals, first, step, out):
    _over_rows_information(counts, totals, first, step, out)


def choose_partners(information, offsets, first, step, partners):
    _over_rows_choice(information, offsets, first, step, partners)
