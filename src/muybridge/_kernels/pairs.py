"""Joint colours of pairs of pixels: weights over the combinations of their components (Zhao 2009, 3.1 to 3.8).

A pair (p, p + offset) is kept once, at p: counts over combinations, and their sum, so that a weight of (3.2) is a count
over the sum. A pixel's partners are numbered 2 d for the one at offset d, and 2 d + 1 for the one at the negative
offset, of whose pair this pixel is the second; -1 is none. A joint covariance has the blocks of the two pixels' own
components, so a joint density is a product of two, but for its tail: it falls slower from twice the squared distance of
both together on, not of each (`_together`).

counts (H, W, K, D, S) are those of p's component, of all its pairs, and of the other pixel's component: as all counts
together fit no cache, what one picture adds at a pixel lies together. S = MOST_SLOTS, so that sums are vector code.
Scores only read, and an update writes to its own pixel's pairs only: rows are shared out over threads, and threads
change nothing. Where scores are made, pixels have one number, y W + x, and both places of a pair are found from one.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from muybridge._kernels._jit import kernel, parallel_kernel, vector_kernel
from muybridge._kernels.mixture import LEAST, MOST_SLOTS, TAIL

NEGLIGIBLE = np.float32(1e-4)
"""Combinations that can change a joint density by no larger a share are left out: it is as many nats."""
_FULL = np.float32(1e30)
_0, _1, _TAIL = np.float32(0.0), np.float32(1.0), np.float32(TAIL)


@vector_kernel
def _together(one, other):
    """A joint density over the product of two, whose squared distances are these; 1 where neither is in its tail.

    The joint one is exp(-s / 2) of their sum s up to 2 TAIL, and falls with the 16th power of s from there on.
    """
    near, far = min(one, other), max(one, other)
    if far <= _TAIL:
        return 1.0
    both, fall = float(near) + float(far), 1.0
    if near >= _TAIL:
        ratio = 4.0 * near * far / (both * both)
    elif both > 2.0 * TAIL:
        ratio, fall = 4.0 * TAIL * far / (both * both), math.exp(0.5 * (near - TAIL))
    else:
        ratio, fall = far / TAIL, math.exp(0.5 * (TAIL - far))
    ratio *= ratio
    ratio *= ratio
    return fall * ratio * ratio


@vector_kernel
def _with_all(counts, a, i, d, densities, squares, b):
    """Sum over the second pixel's components of count times density, for component i of the first."""
    column = 0.0
    for j in range(MOST_SLOTS):
        if counts[a, i, d, j] > _0 and densities[b, j] > _0:
            column += counts[a, i, d, j] * densities[b, j] * _together(squares[a, i], squares[b, j])
    return column


@vector_kernel
def _joint(counts, total, d, a, b, densities, squares, shown, largest):
    """Sum over combinations of count times their joint density.

    Products of densities are float64: those of two far colours are below what float32 holds, and slow there.
    The component that the first pixel shows comes first, and none that is negligible after it; `largest` is that of
    the second pixel's densities.
    """
    both = float(densities[a, shown]) * _with_all(counts, a, shown, d, densities, squares, b)
    for i in range(counts.shape[1]):
        if i != shown and float(densities[a, i]) * largest * total > both * NEGLIGIBLE:
            both += float(densities[a, i]) * _with_all(counts, a, i, d, densities, squares, b)
    return both


@vector_kernel
def _alone(counts, d, a, densities, q, is_first):
    """Sum over combinations of count times the density of q, the pair's first or second pixel."""
    alone = _0
    for i in range(counts.shape[1]):
        for j in range(MOST_SLOTS):
            alone += counts[a, i, d, j] * (densities[q, i] if is_first else densities[q, j])
    return alone


@vector_kernel
def _partner_density(counts, totals, d, a, b, q, densities, squares, peaks, shown, least):
    """P(c0, ci) = P(c0 | ci) P(ci), in which P(ci) is at least `least`; 1 where nothing is known.

    The pair's pixels are a and b, and q that of ci; `shown` is a's component. P(ci) is at least P(c0, ci) over the
    largest density of c0: often that is enough to know.
    """
    total = totals[d, a]
    if total == _0:
        return 1.0
    both = _joint(counts, total, d, a, b, densities, squares, shown, float(peaks[0, b])) / total
    if both >= least * float(peaks[0, a + b - q]):
        return max(both, LEAST)
    rare = max(float(_alone(counts, d, a, densities, q, q == a) / total), LEAST)
    return max(both, LEAST) * (least / rare if rare < least else 1.0)


@vector_kernel
def _product(p, densities, squares, peaks, shows, counts, totals, steps, partners, least, begin, end):
    """Of the joint densities with partners begin to end of pixel p.

    Mostly both pixels show one component much better than any other, and have been seen in that combination: then no
    other need be looked at.
    """
    product = 1.0
    for n in range(begin, end):
        partner = np.int64(partners[p, n])
        if partner >= 0:
            d, q = partner >> 1, p + steps[partner]
            a, b = min(p, q), max(p, q)
            first, second = float(peaks[0, a]), float(peaks[0, b])
            shown, other = np.int64(shows[a]), np.int64(shows[b])
            usual = counts[a, shown, d, other] / totals[d, a]
            joint = usual * first * second * _together(squares[a, shown], squares[b, other])
            others = max(first * float(peaks[1, b]), float(peaks[1, a]) * second)
            if others <= joint * NEGLIGIBLE and usual * peaks[0, q] >= least and joint >= LEAST:
                product *= joint
            else:
                product *= _partner_density(counts, totals, d, a, b, q, densities, squares, peaks, shown, least)
    return product


@parallel_kernel
def _over_rows_scores(alone, densities, squares, peaks, shown, counts, totals, steps, partners, least, width, out):
    most = partners.shape[1]
    for row in numba.prange(out.shape[0] // width):
        start = np.int64(row) * width
        for p in range(start, start + width):
            product = max(float(alone[p]), LEAST) * _product(
                p, densities, squares, peaks, shown, counts, totals, steps, partners, least, 0, min(most, 3)
            )
            score = -math.log(product)
            for begin in range(3, most, 4):  # a product of more might reach nought
                score -= math.log(
                    _product(p, densities, squares, peaks, shown, counts, totals, steps, partners, least, begin,
                             min(most, begin + 4))
                )  # fmt: skip
            out[p] = score


@vector_kernel
def _is_any(fresh):
    found = False
    for x in range(fresh.shape[0]):
        found |= fresh[x] >= 0
    return found


@kernel
def _forget(counts, totals, d, first, second):
    """Where components were made anew, their combinations start at nought; arguments as of `_learn_row`."""
    for x in range(totals.shape[0]):
        if totals[x] > _0 and (first[x] >= 0 or second[x] >= 0):
            total = _0
            for i in range(counts.shape[1]):
                for j in range(MOST_SLOTS):
                    if i == first[x] or j == second[x]:
                        counts[x, i, d, j] = _0
                    total += counts[x, i, d, j]
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
def _add(counts, first, second, gains, d):
    for x in range(first.shape[0]):
        counts[x, max(np.int64(first[x]), 0), d, max(np.int64(second[x]), 0)] += gains[x]


@kernel
def _rescale(counts, totals, d):
    """Counts grow as long as pictures come: only their shares mean something."""
    for x in range(totals.shape[0]):
        if totals[x] > _FULL:
            for i in range(counts.shape[1]):
                for j in range(MOST_SLOTS):
                    counts[x, i, d, j] /= totals[x]
            totals[x] = _1


@vector_kernel
def _learn_row(counts, totals, d, matched, fresh, growth, gains):
    """Pairs d of a row: counts (N, K, D, S), totals and gains (N,); matched and fresh, two of (N,) each."""
    if _is_any(fresh[0]) or _is_any(fresh[1]):
        _forget(counts, totals, d, fresh[0], fresh[1])
    largest = _gain(totals, matched[0], matched[1], growth, gains)
    _add(counts, matched[0], matched[1], gains, d)
    if largest > _FULL:
        _rescale(counts, totals, d)


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
                    counts[y, a : a + pairs], totals[d, y, a : a + pairs], d,
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
            columns[j] += counts[y, x, i, d, j]
    for j in range(counts.shape[2]):
        total += columns[j]
    for i in range(counts.shape[2]):
        line = 0.0
        for j in range(counts.shape[2]):
            line += counts[y, x, i, d, j]
        for j in range(counts.shape[2]):
            count = counts[y, x, i, d, j]
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


def partner_steps(offsets, width):
    """(2 D,) int64: from a pixel's number to that of its partner 2 d, and 2 d + 1, in rows of `width`."""
    forward = offsets[:, 0] * width + offsets[:, 1]
    return np.stack([forward, -forward], axis=1).ravel()


def numbered(array, at):
    """An array of pixels (..., H, W, ...) with one number for each pixel; `at`: the axis of the rows."""
    return array.reshape(array.shape[:at] + (-1,) + array.shape[at + 2 :])


def pair_scores(alone, densities, squares, peaks, shown, counts, totals, offsets, partners, limit, out):
    """-log of (3.1) over evenly spread colours, nats.

    Parameters
    ----------
    alone (H, W), densities, squares (H, W, S), peaks (2, H, W) float32, shown (H, W) int8: as `mixture_look` fills them
    counts : (H, W, K, D, S) float32, own component, pair, the other's, and their sums totals (D, H, W) float32
    offsets : (D, 2) int64, (rows, columns) from a pixel to the second one of its pair d: that comes later by rows
    partners : (H, W, M) int8: numbers of each pixel's partners, -1 for none
    limit : nats: the most that the partner's own colour may cost
    out : (H, W) float32, filled
    """
    width = out.shape[1]
    _over_rows_scores(
        alone.ravel(), numbered(densities, 0), numbered(squares, 0), numbered(peaks, 1), shown.ravel(),
        numbered(counts, 0), numbered(totals, 1), partner_steps(offsets, width), numbered(partners, 0),
        np.float32(math.exp(-limit)), width, out.ravel(),
    )  # fmt: skip


def pair_update(counts, totals, offsets, matched, fresh, rate):
    """Learn which components matched together; matched and fresh (H, W) int8 as `mixture_update` fills them."""
    _over_rows_update(counts, totals, offsets, matched, fresh, np.float32(rate / (1.0 - rate)))


def choose_partners(counts, offsets, first, step, information, partners):
    """Measure the pairs of rows first, first + step ... anew, and choose those rows' partners by it.

    information : (D, H, W) float32, nats, kept from call to call: a partner's row may have been measured earlier
    """
    _over_rows_information(counts, first, step, information)
    _over_rows_choice(information, offsets, first, step, partners)
