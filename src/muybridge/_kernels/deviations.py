"""Deviations from a pixel's components, and what its partners say of each: scores of the rule between two models."""

from __future__ import annotations

import math

import numba
import numpy as np

from muybridge._kernels._jit import parallel_kernel, vector_kernel
from muybridge._kernels.mixture import row_colours

_0, _2 = np.float32(0.0), np.float32(2.0)
_FAR = np.float32(np.inf)


@vector_kernel
def _keep_heavier(weights, variances, heaviest, known):
    for c in range(known.shape[0]):
        for x in range(heaviest.shape[0]):
            known[c, x] = variances[c, x] if weights[x] > heaviest[x] else known[c, x]
    for x in range(heaviest.shape[0]):
        heaviest[x] = max(heaviest[x], weights[x])


@vector_kernel
def _keep_larger(colours, means, variances, known, floor, out):
    for x in range(out.shape[0]):
        off = colours[x] - means[x]
        out[x] = max(out[x], off * off / max(min(variances[x], known[x]), floor))


@vector_kernel
def _far_unless_kept(bits, k, out):
    for x in range(out.shape[0]):
        out[x] = out[x] if bits[x] >> np.uint8(k) & 1 else _FAR


@parallel_kernel
def _over_rows_deviations(image, weights, means, variances, kept, floor, out):
    for row in numba.prange(image.shape[0]):
        y = np.int64(row)
        colours = np.empty((image.shape[2], image.shape[1]), np.float32)
        known, heaviest = np.empty_like(colours), np.full(image.shape[1], np.float32(-1.0))
        row_colours(image, y, colours)
        for k in range(out.shape[1]):
            _keep_heavier(weights[y, k], variances[y, k], heaviest, known)
        for k in range(out.shape[1]):
            out[y, k, :] = _0
            for c in range(image.shape[2]):
                _keep_larger(colours[c], means[y, k, c], variances[y, k, c], known[c], floor, out[y, k])
            _far_unless_kept(kept[y], k, out[y, k])


@vector_kernel
def _nearest(deviations, y, x):
    """The component of least deviation."""
    best = 0
    for k in range(1, deviations.shape[1]):
        if deviations[y, k, x] < deviations[y, best, x]:
            best = k
    return best


@vector_kernel
def _surprise(counts, totals, offsets, partner, deviations, match, limit, y, x, k):
    """-log of how often component k was seen with the one the partner shows now, nats, at most `limit`; 0 where the
    partner shows none or nothing is known."""
    d, across = np.int64(partner >> 1), (partner & 1) == 1
    sign = -1 if across else 1
    qy, qx = y + sign * offsets[d, 0], x + sign * offsets[d, 1]
    known = totals[d, qy, qx] if across else totals[d, y, x]
    shown = _nearest(deviations, qy, qx)
    if known == _0 or deviations[qy, shown, qx] > match:
        return _0
    together, times = _0, _0
    for i in range(deviations.shape[1]):
        count = counts[qy, d, shown, i, qx] if across else counts[y, d, i, shown, x]
        times += count
        if i == k:
            together = count
    if times == _0 or together >= times:
        return _0
    return limit if together == _0 else min(limit, np.float32(math.log(times / together)))


@vector_kernel
def _pooled(deviations, counts, totals, offsets, partners, match, limit, y, x):
    """The least sum of a component's squared deviation and twice what the partners have against it."""
    least = _FAR
    for k in range(deviations.shape[1]):
        cost = deviations[y, k, x]
        if cost < least:
            for n in range(partners.shape[2]):
                partner = np.int64(partners[y, x, n])
                if partner >= 0:
                    cost += _2 * _surprise(counts, totals, offsets, partner, deviations, match, limit, y, x, k)
            least = min(least, cost)
    return least


@parallel_kernel
def _over_rows_pooled(deviations, kept, counts, totals, offsets, partners, match, limit, out):
    for row in numba.prange(out.shape[0]):
        y = np.int64(row)
        for x in range(out.shape[1]):
            if kept[y, x] & (kept[y, x] - 1):  # more than one
                least = _pooled(deviations, counts, totals, offsets, partners, match, limit, y, x)
            else:
                least = deviations[y, _nearest(deviations, y, x), x]
            out[y, x] = math.sqrt(least)


def slot_deviations(image, weights, means, variances, kept, floor, out):
    """Squared deviations from each background component, the largest over the channels; infinite for others.

    A pixel's noise is about the same whatever it shows: no component is judged by more than the heaviest one's
    variance, however wide it was made.

    Parameters
    ----------
    image, weights, means, variances, kept : as for `_kernels.mixture.mixture_look`
    floor : least variance
    out : (H, K, W) float32, filled
    """
    _over_rows_deviations(image, weights, means, variances, kept, np.float32(floor), out)


def pooled_scores(deviations, kept, counts, totals, offsets, partners, match, limit, out):
    """Deviations from the nearest component, where components that do not go with what the partners show lie further.

    Parameters
    ----------
    deviations : (H, K, W) float32 of `slot_deviations`
    kept, counts, totals, offsets, partners : as for `_kernels.pairs.pair_scores`
    match : squared deviations up to which a partner shows its nearest component
    limit : nats: the most that one partner may add
    out : (H, W) float32, filled: the root of the least sum of a squared deviation and twice the partners' nats
    """
    _over_rows_pooled(deviations, kept, counts, totals, offsets, partners, np.float32(match), np.float32(limit), out)
