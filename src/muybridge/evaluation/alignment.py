"""Alignment of estimated to true joints before their distance is taken.

Four kinds, and a result always names its own: `none` (what a laboratory needs), `root` (place forgiven), `rigid` (place
and turn forgiven, Kabsch), `similarity` (place, turn and size forgiven, Umeyama 1991; the literature's PA-MPJPE). Each
frame is aligned on its own.

Umeyama, S. (1991): Least-squares estimation of transformation parameters between two point patterns. PAMI 13(4),
376-380.
"""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np

from muybridge.errors import InputError

Alignment = Literal["none", "root", "rigid", "similarity"]
ALIGNMENTS: tuple[Alignment, ...] = get_args(Alignment)


def align(
    estimate: np.ndarray, truth: np.ndarray, alignment: Alignment = "none", root: tuple[int, ...] = (0,)
) -> np.ndarray:
    """The estimate moved onto the truth, frame by frame.

    Parameters
    ----------
    estimate, truth : (T, J, 3) float64, metres, world
        NaN marks a missing joint; it takes no part in the fit.
    alignment : {"none", "root", "rigid", "similarity"}
    root : tuple of int
        The joints whose mean is the root (one pelvis, or two hips); used by `"root"` alone.

    Returns
    -------
    (T, J, 3) float64, metres, world
        NaN in frames with fewer joints than the fit needs (1 for `root`, 3 for `rigid` and `similarity`).
    """
    if alignment not in ALIGNMENTS:
        raise InputError("alignment", expected=" or ".join(ALIGNMENTS), got=repr(alignment))
    estimate, truth = np.asarray(estimate, float), np.asarray(truth, float)
    if estimate.shape != truth.shape or estimate.ndim != 3 or estimate.shape[-1] != 3:
        raise InputError(
            "joints to compare", expected="two arrays of one shape (T, J, 3)", got=f"{estimate.shape} and {truth.shape}"
        )
    if alignment == "none":
        return estimate.copy()
    if alignment == "root":
        offset = truth[:, list(root)].mean(axis=1) - estimate[:, list(root)].mean(axis=1)
        return estimate + offset[:, None]
    rotation, scale, translation = fit_similarity(estimate, truth, with_scale=alignment == "similarity")
    return scale[:, None, None] * np.einsum("tij,tnj->tni", rotation, estimate) + translation[:, None]


def fit_similarity(
    source: np.ndarray, target: np.ndarray, *, with_scale: bool = True
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    r"""The turn, size and shift that bring each frame's source points nearest to its target points.

    Parameters
    ----------
    source, target : (T, J, 3) float64
        Pairs with a NaN in either are left out.
    with_scale : bool
        False fixes the size at 1 (Kabsch).

    Returns
    -------
    rotation : (T, 3, 3) float64
        Proper rotations: a mirror image is never taken for a turn.
    scale : (T,) float64
    translation : (T, 3) float64

    Notes
    -----
    With :math:`\Sigma = U D V^T` the covariance of target and source, :math:`R = U S V^T`, :math:`c = \mathrm{tr}(D S)
    / \sigma_x^2` and :math:`t = \mu_y - c R \mu_x` (Umeyama, eqs. 40-42), where S flips the last axis if that makes R
    proper.
    """
    known = np.isfinite(source).all(axis=-1) & np.isfinite(target).all(axis=-1)
    weights = known[..., None] / np.maximum(known.sum(axis=1), 1)[:, None, None]
    x, y = np.where(known[..., None], source, 0.0), np.where(known[..., None], target, 0.0)
    mean_x, mean_y = (weights * x).sum(axis=1), (weights * y).sum(axis=1)
    x, y = x - mean_x[:, None], y - mean_y[:, None]
    left, stretch, right = np.linalg.svd(np.einsum("tni,tnj->tij", weights * y, x))
    sign = np.ones_like(stretch)
    sign[:, 2] = np.where(np.linalg.det(left) * np.linalg.det(right) < 0, -1.0, 1.0)
    rotation = np.einsum("tij,tj,tjk->tik", left, sign, right)
    spread = (weights * x**2).sum(axis=(1, 2))
    scale = (stretch * sign).sum(axis=1) / np.where(spread > 0, spread, np.nan) if with_scale else np.ones(len(x))
    translation = mean_y - scale[:, None] * np.einsum("tij,tj->ti", rotation, mean_x)
    translation[known.sum(axis=1) < 3] = np.nan
    return rotation, scale, translation
