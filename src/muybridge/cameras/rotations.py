"""The two ways in which calibration files write a rotation, and how few digits they may spend on it."""

from __future__ import annotations

import numpy as np

from muybridge.errors import InputError

FILE_TOLERANCE = 5e-3  # of R R^T - 1: three digits, the fewest that a file in use was seen to keep


def rotation_from_vector(vector: np.ndarray) -> np.ndarray:
    """Rodrigues' formula: (3,) radians, axis times angle -> (3, 3).

    R = cos(a) 1 + (1 - cos(a)) n n^T + sin(a) [n]x
    """
    vector = np.asarray(vector, dtype=np.float64)
    angle = float(np.linalg.norm(vector))
    if angle == 0:
        return np.eye(3)
    x, y, z = axis = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.cos(angle) * np.eye(3) + (1 - np.cos(angle)) * np.outer(axis, axis) + np.sin(angle) * cross


def nearest_rotation(what: str, matrix: np.ndarray) -> np.ndarray:
    """The orthonormal matrix nearest to one written with few digits; a reflection stays one, for `Camera` to refuse.

    Parameters
    ----------
    what : str
        Named in the error when the matrix is no rounded rotation.
    matrix : (3, 3) float64
    """
    if not np.isfinite(matrix).all():
        raise InputError(what, expected="finite numbers", got="nan or infinity")
    off = float(np.abs(matrix @ matrix.T - np.eye(3)).max())
    if off > FILE_TOLERANCE:
        raise InputError(what, expected="an orthonormal matrix", got=f"R R^T off by {off:.2g}")
    u, _, vt = np.linalg.svd(matrix)
    return u @ vt
