"""How good a mask is, where the truth is known."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def mask_scores(mask: NDArray, truth: NDArray) -> dict[str, float]:
    """Recall, precision and intersection over union of one mask against another, both (H, W) bool.

    An empty truth has recall 1, an empty mask precision 1, and two empty masks IoU 1.
    """
    both, either = np.count_nonzero(mask & truth), np.count_nonzero(mask | truth)
    found, there = np.count_nonzero(mask), np.count_nonzero(truth)
    return {
        "recall": both / there if there else 1.0,
        "precision": both / found if found else 1.0,
        "iou": both / either if either else 1.0,
    }
