"""The pose space in clusters, so that poses of one silhouette fall into different ones (Sedai 2013, III-B.1).

Hierarchical k-means: first four clusters, seeded with the poses that face the camera, away from it, left and right;
then each of them is split again. Silhouettes hide which leg is the nearer one and, facing along the view, whether the
person comes or goes: poses so confused lie in different clusters, and each has its own regression.

Differences from the paper
    Angles that wrap enter distances as cosine and sine. The seeds of the second level, which the paper does not give,
    are means of equal shares along the first principal axis of the cluster, so that nothing is drawn at random. The
    paper splits left and right in two (`PRINTED_SPLITS`); the working setting splits all four.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.regression.components import PoseComponents

DIRECTIONS = ("forward", "backward", "right", "left")  # to the camera, away from it, and to the picture's sides
_FACING = np.array([0.0, np.pi, 0.5 * np.pi, -0.5 * np.pi])
PRINTED_SPLITS = (1, 1, 2, 2)  # K = 6
FEWEST = 10  # frames of a cluster from which something can be learnt
ROUNDS = 100

Labels = NDArray[np.int64]


def cluster_poses(
    poses: FloatArray, facing: FloatArray, components: PoseComponents, splits: tuple[int, ...] = PRINTED_SPLITS
) -> Labels:
    """The cluster of each pose, 0 to K - 1.

    Parameters
    ----------
    poses : (N, D) float64, radians
    facing : (N,) float64, radians
        Where the person faces: 0 to the camera, counter-clockwise seen from above, so that pi/2 is the picture's right.
    splits : (4,) int
        Into how many the clusters of `DIRECTIONS` are split; 0 has no cluster of that direction, whose poses go to
        their nearest. K is the sum.

    Returns
    -------
    (N,) int64

    Raises
    ------
    InputError
        Fewer than `FEWEST` frames in a cluster, none facing a direction, or fewer frames than clusters.
    """
    _check(len(poses), splits)
    points = components.on_circles(poses)
    first = np.flatnonzero(splits)
    sector = np.argmin(np.abs(_turned(facing[:, None] - _FACING[first])), axis=1)
    for index, direction in enumerate(first):
        if not (sector == index).any():
            remedy = f"add frames, or leave that cluster out with a 0 in splits {splits}"
            expected = f"some that face {DIRECTIONS[direction]}"
            raise InputError("frames to learn from", expected=expected, got="none", remedy=remedy)
    coarse = k_means(points, np.array([points[sector == index].mean(axis=0) for index in range(len(first))]))
    labels, count = np.zeros(len(poses), np.int64), 0
    for index, direction in enumerate(first):
        members = np.flatnonzero(coarse == index)
        labels[members] = count + _split(points[members], splits[direction], DIRECTIONS[direction])
        count += splits[direction]
    sizes = np.bincount(labels, minlength=count)
    if sizes.min() < FEWEST:
        got = f"{sizes.min()} of {len(poses)}"
        raise InputError("frames of a cluster", expected=f"{FEWEST} or more", got=got, remedy="split less, or add some")
    return labels


def k_means(points: FloatArray, centres: FloatArray) -> Labels:
    """(N,) nearest centre of each point (N, E) after Lloyd's iteration from `centres` (K, E).

    A centre that loses all its points stays where it was.
    """
    labels = np.full(len(points), -1)
    for _ in range(ROUNDS):
        nearest = np.argmin(np.sum((points[:, None] - centres) ** 2, axis=2), axis=1)
        if (nearest == labels).all():
            break
        labels = nearest
        members = [points[labels == index] for index in range(len(centres))]
        centres = np.array([own.mean(axis=0) if len(own) else old for own, old in zip(members, centres)])
    return labels


def _split(points: FloatArray, count: int, direction: str) -> Labels:
    """Labels (N,) of one cluster split into `count`."""
    if len(points) < count:
        raise InputError(f"frames that face {direction}", expected=f"{count} or more", got=str(len(points)))
    centred = points - points.mean(axis=0)
    axis = np.linalg.eigh(centred.T @ centred)[1][:, -1]
    axis = axis * np.sign(axis[np.argmax(np.abs(axis))])  # an eigenvector's sign means nothing: take one
    order = np.argsort(centred @ axis, kind="stable")
    return k_means(points, np.array([points[share].mean(axis=0) for share in np.array_split(order, count)]))


def _turned(angles: FloatArray) -> FloatArray:
    """Angles in [-pi, pi)."""
    return np.mod(angles + np.pi, 2 * np.pi) - np.pi


def _check(frames: int, splits: tuple[int, ...]) -> None:
    whole = all(isinstance(number, int) and number >= 0 for number in splits)
    if len(splits) != len(DIRECTIONS) or not whole or sum(splits) < 1:
        raise InputError("splits", expected=f"{len(DIRECTIONS)} whole numbers, not all 0", got=str(splits))
    if frames < sum(splits):
        raise InputError("frames to learn from", expected=f"at least one a cluster, {sum(splits)}", got=str(frames))
