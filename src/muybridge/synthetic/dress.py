"""Loose clothes: cloth that hangs off the skin and moves later than the skin does.

Where cloth is loose (`Figure.looseness`, 0 at collar and waistband, 1 at the ends of sleeves and legs) it stands off
along the skin's normal by about `looseness` metres, in folds, and is drawn towards where the skin was a moment ago. The
delay is bounded so that cloth never enters the skin: the shift is f (L (1 + w k) n + v), |v| < (1 - k) L, with f the
field, n the normal and w in [-1, 1] the folds, so its part along n is never negative.

Everything is a function of the track around the frame, so frames may be drawn in any order. The joints do not move.
"""

from __future__ import annotations

import numpy as np

FOLDS = 0.35  # k: how deep folds are, as a share of the looseness
FOLD_LENGTHS = (0.11, 0.19, 0.31)  # metres


def hang(
    skin: np.ndarray, normals: np.ndarray, before: np.ndarray, looseness: np.ndarray, folds: np.ndarray
) -> np.ndarray:
    """Where loose cloth is.

    Parameters
    ----------
    skin, normals : (V, 3) float64, metres and unit vectors, world: the skin now
    before : (V, 3) float64, metres, world: the skin a moment ago, but with the pelvis where it is now
    looseness : (V,) float64, metres
    folds : (V,) float64 in -1 to 1

    Returns
    -------
    (V, 3) float64, metres, world
    """
    late = before - skin
    bound = (1.0 - FOLDS) * looseness[:, None]
    length = np.linalg.norm(late, axis=1, keepdims=True)
    late *= bound / np.maximum(length + bound, 1e-12)
    return skin + (looseness * (1.0 + FOLDS * folds))[:, None] * normals + late


def folds(material: np.ndarray) -> np.ndarray:
    """(V,) in -1 to 1: a few waves across the cloth, at places (V, 3) in metres; they run mostly up and down."""
    total = np.zeros(len(material))
    for number, length in enumerate(FOLD_LENGTHS):
        turn = 2.4 * number
        direction = np.array([np.cos(turn), np.sin(turn), 0.35 * (-1) ** number])
        total += np.sin(2 * np.pi * (material @ direction) / length + number)
    return total / len(FOLD_LENGTHS)
