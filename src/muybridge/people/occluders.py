"""What stands before people and never moves: a pillar, a sign. Found where nobody ever is while all around are people.

Count how often each pixel was foreground: a pole is a dark gap in a well-trodden band. Row by row, a gap narrower than
a part of a person's height is filled by closing; what is filled, and was hardly ever foreground itself, is an occluder.

Differences from Zhao (2009), 5.4.2: there such masks are drawn by hand; they may be here too, and are added.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from muybridge.people.blobs import Mask
from muybridge.people.ground import GroundScale

LEAST = 6.0  # pictures that show somebody on both sides; fewer are chance
SHARE = 0.12  # of those: what an occluder may have been foreground itself, by noise at its edges
REACH = 0.6  # of a person's height: wider gaps are where nobody goes


def find_occluders(masks: Sequence[Mask], ground: GroundScale) -> Mask:
    """(H, W) bool from masks (H, W) bool of many moments, far enough apart that people have moved."""
    import cv2

    heat = cv2.blur(np.sum(masks, axis=0, dtype=np.float32), (3, 3))
    hidden = np.zeros(heat.shape, np.uint8)
    for row, line in enumerate(heat):
        # The row crosses people at the middle of their height: their feet are half a height below.
        gap = int(REACH * ground.height(row + float(ground.height(row)) / 2)) | 1
        # Zeros beyond the sides, so that the picture's edge does not stand for people on that side.
        beyond = np.pad(line, gap)[None]
        around = cv2.morphologyEx(beyond, cv2.MORPH_CLOSE, np.ones((1, gap), np.uint8))[0, gap:-gap]
        hidden[row] = (around >= LEAST) & (line <= SHARE * around)
    return cv2.morphologyEx(hidden, cv2.MORPH_OPEN, np.ones((3, 3), np.uint8)).astype(bool)
