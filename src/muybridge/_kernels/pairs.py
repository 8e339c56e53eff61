"""Joint colours of pairs of pixels: weights over the combinations of their components (Zhao 2009, 3.1 to 3.8).

A pair (p, p + offset) is kept once, at p: counts over combinations, and their sum, so that a weight of (3.2) is a count
over the sum. A pixel's partners are numbered 2 d for the one at offset d, and 2 d + 1 for the one at the negative
offset, of whose pair this pixel is the second; -1 is none. A joint covariance has the blocks of the two pixels' own
components, so a joint density is a product of two, but for its tail: it falls slower from twice the squared distance of
both together on, not of each (`fall_together`).

counts (H, D, K, K, W) are those of the pair, of p's component, and of the other pixel's, so that what is done at all
pairs alike is vector code along the row. Scores only read, and an update writes to its own pixel's pairs only: rows are
shared out over threads, and threads change nothing.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from muybridge._kernels._jit import kernel, parallel_kernel, vector_kernel
from muybridge._kernels.mixture import LEAST, fall_together

_FULL = np.float32(1e30)
_0, _1, _SCALE, _LEAST = np.float32(0.0), np.float32(1.0), np.float32(2.0**40), np.float32(LEAST)
"""Sums over combinations are kept times _SCALE: single ones would be below what float32 holds, and slow there."""


@vector_kernel
def _shares(totals, shares, both, first_alone, second_alone):
    """What a count is of its pair's, and sums of nought; all (N,)."""
    for x in range(totals.shape[0]):
        shares[x] = _SCALE / totals[x] if totals[x] > _0 else _0
        both[x] = first_alone[x] = second_alone[x] = _0


@vector_kernel
def _add_combination(counts, shares, first, second, both, first_alone, second_alone):
    """One combination's part in the joint densities of pairs, and in those of either pixel.

    counts, shares, and what is added to (N,); first, second : squared distances, heights and densities, (N,) each
    """
    for x in range(both.shape[0]):
        weight = counts[x] * shares[x]
        both[x] += weight * first[1][x] * second[1][x] * fall_together(first[0][x] + second[0][x])
        first_alone[x] += weight * first[2][x]
        second_alone[x] += weight * second[2][x]


@vector_kernel
def _given(totals, both, alone, least, out):
    """P(c0, ci) = P(c0 | ci) P(ci), in which P(ci), `alone`, is at least `least`; 1 where nothing is known."""
    for x in range(out.shape[0]):
        joint = min(max(both[x] / _SCALE, _LEAST), _FULL)
        rare = max(alone[x] / _SCALE, _LEAST)
        out[x] = joint * max(least / rare, _1) if totals[x] > _0 else _1


@vector_kernel
def _counting(kept):
    """Bits of the components that count at any pixel of a row."""
    bits = np.uint8(0)
    for x in range(kept.shape[0]):
        bits |= kept[x]
    return bits


@parallel_kernel
def _over_rows_pairs(squares, heights, densities, kept, counts, totals, offsets, least, firsts, seconds):
    height, slots, width = squares.shape
    for row in numba.prange(height):
        y, sums = np.int64(row), np.empty((4, width), np.float32)
        for d in range(offsets.shape[0]):
            below, right = y + offsets[d, 0], offsets[d, 1]
            if below >= height or abs(right) >= width:
                continue
            here, there = slice(max(0, -right), width - max(0, right)), slice(max(0, right), width - max(0, -right))
            shares, both, first_alone, second_alone = sums[:, : width - abs(right)]
            _shares(totals[d, y, here], shares, both, first_alone, second_alone)
            for i in range(slots):
                for j in range(slots):
                    if _counting(kept[y]) >> i & _counting(kept[below]) >> j & 1:
                        first = squares[y, i, here], heights[y, i, here], densities[y, i, here]
                        second = squares[below, j, there], heights[below, j, there], densities[below, j, there]
                        _add_combination(
                            counts[y, d, i, j, here], shares, first, second, both, first_alone, second_alone
                        )
            _given(totals[d, y, here], both, second_alone, least, firsts[d, y, here])
            _given(totals[d, y, here], both, first_alone, least, seconds[d, y, here])


@vector_kernel
def _product(firsts, seconds, offsets, partners, y, x, begin, end):
    """Of the joint densities with partners begin to end of a pixel."""
    product = 1.0
    for n in range(begin, end):
        partner = np.int64(partners[y, x, n])
        if partner >= 0:
            d = partner >> 1
            joint = seconds[d, y - offsets[d, 0], x - offsets[d, 1]] if partner & 1 else firsts[d, y, x]
            product *= float(joint)
    return product


@parallel_kernel
def _over_rows_scores(alone, firsts, seconds, offsets, partners, out):
    most = partners.shape[2]
    for row in numba.prange(out.shape[0]):
        y = np.int64(row)
        for x in range(out.shape[1]):
            product = _product(firsts, seconds, offsets, partners, y, x, 0, min(most, 3))
            score = -math.log(product * max(float(alone[y, x]), LEAST))
            for begin in range(3, most, 4):  # a product of more might reach nought
                score -= math.log(_product(firsts, seconds, offsets, partners, y, x, begin, min(most, begin + 4)))
            out[y, x] = score


@vector_kernel
def _is_any(fresh):
    found = False
    for x in range(fresh.shape[0]):
        found |= fresh[x] >= 0
    return found


@kernel
def _forget(counts, totals, first, second):
    """Where components were made anew, their combinations start at nought; arguments as of `_learn_row`."""
    for x in range(totals.shape[0]):
        if totals[x] > _0 and (first[x] >= 0 or second[x] >= 0):
            total = _0
            for i in range(counts.shape[0]):
                for j in range(counts.shape[1]):
                    if i == first[x] or j == second[x]:
                        counts[i, j, x] = _0
                    total += counts[i, j, x]
            totals[x] = total


@vector_kernel
def _gain(totals, first, second, growth, gains):
    """What the combinations that matched gain (3.5): one in all at first, later the rate. Returns the largest total."""
    largest = _0
    for x in range(totals.shape[0]):
        gain = max(_1, totals[x] * growth) if first[x] >= 0 and second[x] >= 0 else _0
        gains[x] = gain
        totals[x] += gain
        largest = max(largest, totals[x])
    return largest


@vector_kernel
def _add(counts, first, second, gains):
    for x in range(first.shape[0]):
        counts[max(np.int64(first[x]), 0), max(np.int64(second[x]), 0), x] += gains[x]


@kernel
def _rescale(counts, totals):
    """Counts grow as long as pictures come: only their shares mean something."""
    for x in range(totals.shape[0]):
        if totals[x] > _FULL:
            counts[:, :, x] /= totals[x]
            totals[x] = _1


@vector_kernel
def _learn_row(counts, totals, matched, fresh, growth, gains):
    """Pairs of a row: counts (K, K, N), totals and gains (N,); matched and fresh, two of (N,) each."""
    if _is_any(fresh[0]) or _is_any(fresh[1]):
        _forget(counts, totals, fresh[0], fresh[1])
    largest = _gain(totals, matched[0], matched[1], growth, gains)
    _add(counts, matched[0], matched[1], gains)
    if largest > _FULL:
        _rescale(counts, totals)


@parallel_kernel
def _over_rows_update(counts, totals, offsets, matched, fresh, growth):
    height, width = matched.shape
    for row in numba.prange(height):
        y = np.int64(row)
        gains = np.empty(width, np.float32)
        for d in range(offsets.shape[0]):
            below, right = y + offsets[d, 0], offsets[d, 1]
            pairs = width - abs(right)
            if below < height and pairs > 0:
                a, b = max(0, -right), max(0, right)
                _learn_row(
                    counts[y, d, :, :, a : a + pairs], totals[d, y, a : a + pairs],
                    (matched[y, a : a + pairs], matched[below, b : b + pairs]),
                    (fresh[y, a : a + pairs], fresh[below, b : b + pairs]), growth, gains[:pairs],
                )  # fmt: skip


@kernel
def mutual_information(counts, y, x, d, columns):
    """(3.8) of counts over their sum, nats; 0 where there are none. columns (K,), written over."""
    total, information = 0.0, 0.0
    columns[:] = 0.0
    for i in range(counts.shape[2]):
        for j in range(counts.shape[2]):
            columns[j] += counts[y, d, i, j, x]
    for j in range(counts.shape[2]):
        total += columns[j]
    for i in range(counts.shape[2]):
        line = 0.0
        for j in range(counts.shape[2]):
            line += counts[y, d, i, j, x]
        for j in range(counts.shape[2]):
            count = counts[y, d, i, j, x]
            if count > _0:
                information += count / total * math.log(count * total / (line * columns[j]))
    return information


@parallel_kernel
def _over_rows_information(counts, first, step, out):
    for r in numba.prange((out.shape[1] - first + step - 1) // step):
        y = first + np.int64(r) * step
        columns = np.empty(counts.shape[2])
        for d in range(out.shape[0]):
            for x in range(out.shape[2]):
                out[d, y, x] = mutual_information(counts, y, x, d, columns)


@kernel
def _most_informative(information, offsets, y, x, partners, n):
    """The partner inside the picture that is not among the first n chosen and has most information; -1 for none."""
    best, most = -1, -1.0
    for candidate in range(2 * offsets.shape[0]):
        d, sign = candidate >> 1, -1 if candidate & 1 else 1
        qy, qx = y + sign * offsets[d, 0], x + sign * offsets[d, 1]
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


def pair_scores(alone, squares, heights, densities, kept, counts, totals, offsets, partners, limit, out):
    """-log of (3.1) over evenly spread colours, nats.

    Parameters
    ----------
    alone (H, W), squares, heights, densities (H, K, W) float32: as `mixture_look` fills them
    kept : (H, W) uint8, bits of the components that count
    counts : (H, D, K, K, W) float32, pair, own component, the other's, and their sums totals (D, H, W) float32
    offsets : (D, 2) int64, (rows, columns) from a pixel to the second one of its pair d: that comes later by rows
    partners : (H, W, M) int8: numbers of each pixel's partners, -1 for none
    limit : nats: the most that the partner's own colour may cost
    out : (H, W) float32, filled
    """
    firsts, seconds = np.empty((2, *totals.shape), np.float32)
    least = np.float32(math.exp(-limit))
    _over_rows_pairs(squares, heights, densities, kept, counts, totals, offsets, least, firsts, seconds)
    _over_rows_scores(alone, firsts, seconds, offsets, partners, out)


def pair_update(counts, totals, offsets, matched, fresh, rate):
    """Learn which components matched together; matched and fresh (H, W) int8 as `mixture_update` fills them."""
    _over_rows_update(counts, totals, offsets, matched, fresh, np.float32(rate / (1.0 - rate)))


def choose_partners(counts, offsets, first, step, information, partners):
    """Measure the pairs of rows first, first + step ... anew, and choose those rows' partners by it.

    information : (D, H, W) float32, nats, kept from call to call: a partner's row may have been measured earlier
    """
    _over_rows_information(counts, first, step, information)
    _over_rows_choice(information, offsets, first, step, partners)
