"""The pose space in clusters, so that poses of one silhouette fall into different ones (Sedai 2013, III-B.1).

First clusters by where the person faces, then each of them is split by pose. Silhouettes hide which leg is the nearer
one and whether the person comes or goes: what they confuse must lie in different clusters, because each cluster's
regression gives one answer.

`PRINTED` is the paper's hierarchical k-means: poses are clustered from seeds that face forward, backward, right and
left, then right and left are split in two. A cluster that faces sideways holds the mirror images of its own poses (80
and 100 degrees look alike). `WORKING` begins with the four quarters between those directions: a heading and its mirror
image are never in the same.

Differences from the paper
    Angles that wrap enter distances as cosine and sine; the heading at the first level on a circle of radius
    pi / sqrt(3), on which headings all around have the variance that they have as plain angles. The seeds of the second
    level, which the paper does not give, are means of equal shares along the first principal axis of the cluster:
    nothing is drawn at random.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.regression.components import PoseComponents

RADIUS = np.pi / np.sqrt(3)  # of the circle on which headings lie at the first level
FEWEST = 10  # frames of a cluster from which something can be learnt
ROUNDS = 100
_QUARTER = 0.5 * np.pi

Labels = NDArray[np.int64]


@dataclass(frozen=True)
class ClusterConfig:
    """Settings of the clusters.

    Parameters
    ----------
    facing : radians
        Where the first clusters' seeds face: 0 to the camera, pi / 2 to the picture's right.
    splits : one number for each of `facing`
        Into how many it is split; K is the sum.
    first : "k-means", of poses, or "sectors": to whichever of `facing` the heading is nearest
    """

    facing: tuple[float, ...] = (0.0, np.pi, _QUARTER, -_QUARTER)
    splits: tuple[int, ...] = (1, 1, 2, 2)
    first: Literal["k-means", "sectors"] = "k-means"

    def __post_init__(self) -> None:
        if not self.facing or not np.isfinite(self.facing).all():
            raise InputError("clusters: facing", expected="at least one angle in radians", got=str(self.facing))
        whole = all(isinstance(number, int) and number >= 1 for number in self.splits)
        if len(self.splits) != len(self.facing) or not whole:
            expected = f"{len(self.facing)} whole numbers above 0, one a direction"
            raise InputError("clusters: splits", expected=expected, got=str(self.splits))
        if self.first not in ("k-means", "sectors"):
            raise InputError("clusters: first", expected="k-means | sectors", got=repr(self.first))

    @property
    def count(self) -> int:
        """K."""
        return sum(self.splits)


PRINTED = ClusterConfig()
WORKING = ClusterConfig((-0.5 * _QUARTER, 0.5 * _QUARTER, 1.5 * _QUARTER, -1.5 * _QUARTER), (3, 3, 3, 3), "sectors")


def cluster_poses(
    poses: FloatArray, facing: FloatArray, components: PoseComponents, config: ClusterConfig = WORKING
) -> Labels:
    """The cluster of each pose, 0 to K - 1.

    Parameters
    ----------
    poses : (N, D) float64, radians
    facing : (N,) float64, radians
        Where the person faces: 0 to the camera, counter-clockwise seen from above, so that pi / 2 is the picture's
        right.

    Returns
    -------
    (N,) int64

    Raises
    ------
    InputError
        Fewer frames than clusters, none that face one of the directions, or fewer than `FEWEST` in a cluster.
    """
    if len(poses) < config.count:
        raise InputError(
            "frames to learn from", expected=f"at least one a cluster, {config.count}", got=f"{len(poses)}"
        )
    first = FIRST[config.first](poses, facing, components, config)
    points = components.on_circles(poses)
    labels, count = np.zeros(len(poses), np.int64), 0
    for index, (angle, split) in enumerate(zip(config.facing, config.splits, strict=True)):
        members = np.flatnonzero(first == index)
        if len(members) < split:
            raise InputError(f"frames that face {_named(angle)}", expected=f"{split} or more", got=str(len(members)))
        labels[members] = count + split_cluster(points[members], split)
        count += split
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


def split_cluster(points: FloatArray, count: int) -> Labels:
    """Labels (N,) of points (N, E) split into `count` by k-means from equal shares along the principal axis."""
    centred = points - points.mean(axis=0)
    axis = np.linalg.eigh(centred.T @ centred)[1][:, -1]
    axis = axis * np.sign(axis[np.argmax(np.abs(axis))])  # an eigenvector's sign means nothing: take one
    order = np.argsort(centred @ axis, kind="stable")
    return k_means(points, np.array([points[share].mean(axis=0) for share in np.array_split(order, count)]))


def _sectors(poses: FloatArray, facing: FloatArray, components: PoseComponents, config: ClusterConfig) -> Labels:
    """(N,) index of the nearest of the directions; every one must be faced by somebody."""
    away = facing[:, None] - np.array(config.facing)
    nearest = np.argmin(np.abs(np.mod(away + np.pi, 2 * np.pi) - np.pi), axis=1)
    for index, angle in enumerate(config.facing):
        if not (nearest == index).any():
            expected = f"some that face {_named(angle)}"
            remedy = "add such frames, or leave that direction out of the clusters"
            raise InputError("frames to learn from", expected=expected, got="none", remedy=remedy)
    return nearest


def _from_seeds(poses: FloatArray, facing: FloatArray, components: PoseComponents, config: ClusterConfig) -> Labels:
    """(N,) clusters of poses, seeded with the mean pose of each direction."""
    others = components.on_circles(poses)
    if components.heading is not None:  # on its own circle, in place of that of radius 1
        index = components.circular.index(components.heading)
        others = np.delete(others, [index, index + len(components.circular)], axis=1)
    points = np.column_stack([RADIUS * np.cos(facing), RADIUS * np.sin(facing), others])
    sector = _sectors(poses, facing, components, config)
    return k_means(points, np.array([points[sector == index].mean(axis=0) for index in range(len(config.facing))]))


FIRST = {"k-means": _from_seeds, "sectors": _sectors}


def _named(angle: float) -> str:
    """A direction as people say it."""
    names = {0: "the camera", 90: "the picture's right", 180: "away from the camera", 270: "the picture's left"}
    degrees = round(np.degrees(angle)) % 360
    return names.get(degrees, f"{degrees if degrees <= 180 else degrees - 360} degrees from the camera")
