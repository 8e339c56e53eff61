"""What `_kernels.mixture` and `_kernels.pairs` mean, one pixel at a time: Zhao (2009), (2.1) to (2.5), (3.1) to (3.8).

A mixture is weights (K,), means and variances (K, C); a weight of 0 is an empty slot. Densities are over those of
colours spread evenly over 0..255.
"""

from __future__ import annotations

import numpy as np

TAIL, FARTHEST, LEAST = 16.0, 2500.0, 1e-37


def distances(colour: np.ndarray, means: np.ndarray, variances: np.ndarray) -> np.ndarray:
    """(K,): squared Mahalanobis distances."""
    return ((colour - means) ** 2 / variances).sum(axis=1)


def densities(colour: np.ndarray, means: np.ndarray, variances: np.ndarray) -> np.ndarray:
    """(K,): (2.2), with a tail that falls more slowly."""
    return heights(variances) * np.exp(-fallen(distances(colour, means, variances), TAIL) / 2)


def heights(variances: np.ndarray) -> np.ndarray:
    """(K,): the same at the means."""
    return np.prod(256 / np.sqrt(2 * np.pi * variances), axis=1)


def background_slots(weights: np.ndarray, variances: np.ndarray, portion: float) -> set[int]:
    """The first by weight over deviation, until they hold `portion`."""
    rank = np.where(weights > 0, weights / np.sqrt(variances.sum(axis=1)), -1.0)
    kept, held = set(), 0.0
    for k in np.argsort(-rank):
        if weights[k] > 0 and held < portion:
            kept.add(int(k))
        held += weights[k]
    return kept


def learn(
    colour: np.ndarray, weights: np.ndarray, means: np.ndarray, variances: np.ndarray, limit: float, rate: float,
    floor: float, wide: float,
) -> tuple[int, int]:  # fmt: skip
    """Update in place; the slot that matched and that of a new component, -1 for none."""
    squared = np.where(weights > 0, distances(colour, means, variances), np.inf)
    best = int(squared.argmin())
    if squared[best] < limit:
        weights *= 1 - rate
        weights[best] += rate
        share = min(1.0, rate / weights[best])
        off = colour - means[best]
        means[best] += share * off
        variances[best] += share * (((1 - share) * off) ** 2 - variances[best])
        variances[best] = np.maximum(variances[best], floor)
        return best, -1
    lightest = int(weights.argmin())
    first = not weights.any()
    weights[lightest] = 0
    if first:
        weights[lightest] = 1
    else:
        weights *= (1 - rate) / weights.sum()
        weights[lightest] = rate
    means[lightest], variances[lightest] = colour, wide
    return -1, lightest


def fallen(squared: np.ndarray, tail: float) -> np.ndarray:
    """What -2 log of a density falls by: a squared distance, beyond `tail` its logarithm."""
    return np.where(squared > tail, tail * (1 + np.log(np.maximum(squared, tail) / tail)), squared)


Side = tuple[np.ndarray, np.ndarray]
"""How far (K,) components are from a colour, squared, and their densities at the means; 0 of what is no background."""


def joint(counts: np.ndarray, own: Side, other: Side, limit: float) -> float:
    """-log of P(c0, ci) (3.2), -log P(ci) counting at most `limit`; counts (K, K): own component, the other's.

    The tail of a joint density begins where both pixels together are 2 TAIL away.
    """
    weights = counts / counts.sum()
    away = np.minimum(np.add.outer(own[0], other[0]), FARTHEST)
    both = own[1] @ (weights * np.exp(-fallen(away, 2 * TAIL) / 2)) @ other[1]
    alone = weights.sum(axis=0) @ (other[1] * np.exp(-fallen(other[0], TAIL) / 2))
    excess = -np.log(max(alone, LEAST)) - limit
    return float(-np.log(max(both, LEAST)) - max(excess, 0.0))


def mutual_information(counts: np.ndarray) -> float:
    """(3.8), nats."""
    weights = counts / counts.sum()
    apart = np.outer(weights.sum(axis=1), weights.sum(axis=0))
    seen = weights > 0
    return float((weights[seen] * np.log(weights[seen] / apart[seen])).sum())


def light(field: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """(H, W, C): the gain of a field (6, C), a quadratic of the place, which goes from -1 to 1 over the picture."""
    y, x = np.meshgrid(np.linspace(-1, 1, shape[0]), np.linspace(-1, 1, shape[1]), indexing="ij")
    return np.exp(np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=-1) @ field)
