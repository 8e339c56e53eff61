"""What `_kernels.lasting` means, one pixel at a time."""

from __future__ import annotations

import numpy as np


def lasting(
    colours: np.ndarray, step: int, tolerance: int, fewest: int, weight: float, passing: float, ended: bool
) -> np.ndarray:
    """(T,) bool: which of the moments (T, C) are like the best of every `step`-th."""
    best, kept = -2.0, None
    for colour in colours[::step].astype(int):
        if kept is not None and (np.abs(colour - kept) <= tolerance).all():
            continue
        like = np.flatnonzero((np.abs(colours.astype(int) - colour) <= tolerance).all(axis=1))
        score = -1.0
        if len(like) >= fewest:
            ends = 2 + len(colours) // 20
            inner = like[1] > ends and (not ended or like[-2] < len(colours) - 1 - ends)
            score = (passing if inner else 1.0) * (like[-2] - like[1] + weight * len(like)) / len(colours)
        if score > best:
            best, kept = score, colour
    return (np.abs(colours.astype(int) - kept) <= tolerance).all(axis=1)
