from __future__ import annotations

import numpy as np

from muybridge._kernels.occupancy import fill_sums, silhouette_scores
from muybridge.people.evidence import core

SHOWN = 0.4  # share of a box that must be visible
_GRID = {}

def grid(shape, ground, step, smallest):
    key = shape, ground, step, smallest
    if key not in _GRID:
        height, width = shape
        states = []
        for foot in np.arange(step, height + step, step) - 0.5:
            h = float(ground.height(np.array([foot]))[0])
            if h < smallest:
                continue
            w = ground.aspect * h
            xs = np.arange(0, width, step, dtype=float)
            states.append(np.column_stack([xs, np.full(len(xs), foot - h / 2), np.full(len(xs), w), np.full(len(xs), h)]))
        states = np.concatenate(states)
        _GRID[key] = states, states[:, 2] * states[:, 3]
    return _GRID[key]


def detect(mask, weights, silhouette, outside, ground, least: float, step: int = 3, most: int = 20, smallest=40.0):
    """Boxes (6,) with their mean evidence per visible pixel, best first."""
    found = []
    mask = mask & (weights > 0)
    if mask.sum() < 100:
        return found
    weights = weights.copy()
    height, width = mask.shape
    states, area = grid(mask.shape, ground, step, smallest)
    table = np.empty((height + 1, width + 1, 2))
    one = np.ones((1, 1))
    gain, cost = silhouette.gains(outside)
    for _ in range(most):
        fill_sums(mask, weights, table)
        full, empty = np.empty(len(states)), np.empty(len(states))
        silhouette_scores(table, 0, 0, states, one, 0 * one, full)
        k = np.flatnonzero(full > 0.2 * area * SHOWN)
        if not len(k): break
        s = np.ascontiguousarray(states[k])
        silhouette_scores(table, 0, 0, s, 0 * one, one, empty[k])
        e = np.empty(len(k)); silhouette_scores(table, 0, 0, s, 0 * one, one, e)
        score = np.empty(len(k)); silhouette_scores(table, 0, 0, s, gain, cost, score)
        shown = full[k] + e
        score /= np.maximum(shown, SHOWN * area[k])
        rank = np.minimum(score, 1.0) + 0.3 * np.minimum(1, shown / area[k])
        best = int(np.argmax(np.where(score >= least, rank, -9)))
        if score[best] < least:
            break
        state = np.r_[s[best], 0.0, 0.0]
        found.append((state, float(score[best])))
        weights[core(state, 1.0)] = 0
        mask = mask & (weights > 0)
    return found
