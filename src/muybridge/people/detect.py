"""People where nobody is followed yet: the box of expected size that explains most foreground, then the next."""

from __future__ import annotations

import numpy as np

from muybridge._kernels.occupancy import box_sums, fill_sums
from muybridge.filters.particles import FloatArray
from muybridge.people.colour_likelihood import pixel_boxes
from muybridge.people.evidence import core
from muybridge.people.ground import GroundScale


def detect(values, visible, ground: GroundScale, least: float, step: int = 3, most: int = 20) -> list[tuple[FloatArray, float]]:
    """Boxes (6,) with their mean evidence per visible pixel, best first."""
    values = values.copy()
    height, width = values.shape
    feet = np.arange(step, height + step, step) - 0.5
    tall = ground.height(feet)
    found = []
    if not (values > 0).any():
        return found
    boxes, states = [], []
    for foot, h in zip(feet, tall):
        w = ground.aspect * h
        xs = np.arange(0, width, step, dtype=float)
        states.append(np.column_stack([xs, np.full(len(xs), foot - h / 2), np.full(len(xs), w), np.full(len(xs), h)]))
    states = np.concatenate(states)
    # only where there is foreground at the middle
    boxes, _ = pixel_boxes(states)
    table = np.empty((height + 1, width + 1))
    sums = np.empty(len(boxes))
    area = states[:, 2] * states[:, 3]
    for _ in range(most):
        fill_sums(values, table)
        box_sums(table, 0, 0, boxes, sums)
        score = sums / area
        best = int(np.argmax(score))
        if score[best] < least:
            break
        state = np.r_[states[best], 0.0, 0.0]
        found.append((state, float(score[best])))
        values[core(state, 1.0)] = 0
    return found
