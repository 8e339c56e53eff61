"""Two people over four frames, with two parts each, for tests of what is drawn and written."""

from __future__ import annotations

import numpy as np

from muybridge.io.boxes import BoxSeries
from muybridge.io.parts import PartSeries


def two_people() -> tuple[BoxSeries, PartSeries]:
    """Boxes of 30 x 70 pixels that move by 2 a frame."""
    frames, ids = np.repeat(np.arange(4), 2), np.tile([1, 2], 4)
    boxes = np.column_stack([20 + 60 * (ids - 1) + 2 * frames, np.full(8, 40), np.full(8, 30), np.full(8, 70)])
    names = np.tile(["head", "torso"], 8)
    inner = np.repeat(boxes, 2, axis=0) + np.tile([[10, 2, -20, -60], [8, 14, -16, -50]], (8, 1))
    parts = PartSeries(np.repeat(frames, 2), np.repeat(ids, 2), names, inner.astype(float), np.full(16, 0.5))
    return BoxSeries(frames, ids, boxes.astype(float), np.ones(8)), parts
