"""Clusters of poses: k-means against scikit-learn's, and planted groups that must be found."""

from __future__ import annotations

import numpy as np
import pytest
from sklearn.cluster import KMeans

from muybridge.errors import InputError
from muybridge.regression.clusters import FEWEST, PRINTED, WORKING, ClusterConfig, cluster_poses, k_means
from muybridge.regression.components import PoseComponents

COMPONENTS = PoseComponents(("yaw", "left_hip", "right_hip"), (0,), 0)
FOUR = ClusterConfig(splits=(2, 2, 2, 2))


def walkers(count=400, seed=0):
    """Poses (N, 3) of every heading with the legs in one of two well separated positions, and which of them (N,)."""
    rng = np.random.default_rng(seed)
    stride = rng.choice([-1, 1], count)
    poses = np.column_stack([rng.uniform(-np.pi, np.pi, count), 0.6 * stride, -0.6 * stride])
    poses[:, 1:] += rng.normal(0, 0.05, (count, 2))
    return poses, stride


def turn(angles):
    return np.abs(np.mod(angles + np.pi, 2 * np.pi) - np.pi)


def test_lloyd_is_scikit_learns():
    rng = np.random.default_rng(1)
    points = rng.normal(size=(300, 4))
    centres = points[:5]
    expected = KMeans(5, init=centres, n_init=1, max_iter=100, tol=0.0, algorithm="lloyd").fit(points).labels_
    np.testing.assert_array_equal(k_means(points, centres), expected)


def test_a_lost_centre_stays_and_takes_nothing():
    points = np.array([[0.0], [0.1], [1.0], [1.1]])
    labels = k_means(points, np.array([[0.0], [1.0], [50.0]]))
    np.testing.assert_array_equal(labels, [0, 0, 1, 1])


@pytest.mark.parametrize("first", ["k-means", "sectors"])
def test_four_directions_and_then_the_two_strides_of_each(first):
    """Sectors are 45 degrees to either side. K-means' borders lie between the means of about 100 headings each, known
    to 26 degrees / 10, and move on by as much in every round: 15 degrees more are allowed."""
    poses, _ = walkers()
    poses[:, 1:] /= 2  # headings count for more than strides
    labels = cluster_poses(poses, poses[:, 0], COMPONENTS, ClusterConfig(splits=(2, 2, 2, 2), first=first))
    assert set(labels) == set(range(8))
    for direction, facing in enumerate(FOUR.facing):
        own = poses[np.isin(labels, (2 * direction, 2 * direction + 1)), 0]
        assert turn(own - facing).max() < np.radians(45 if first == "sectors" else 60) + 1e-9


@pytest.mark.parametrize("config", [FOUR, PRINTED, ClusterConfig(splits=(1, 2, 3, 2), first="sectors")])
def test_a_cluster_that_is_split_in_two_has_one_stride_in_each(config):
    poses, stride = walkers()
    labels = cluster_poses(poses, poses[:, 0], COMPONENTS, config)
    assert set(labels) == set(range(config.count))
    ends = np.cumsum(config.splits)
    for split, end in zip(config.splits, ends):
        strides = [len(set(stride[labels == cluster])) for cluster in range(end - split, end)]
        assert strides == ([2] if split == 1 else [1] * split)  # where it is not split, both: the negative control


def test_mirrored_headings_are_never_in_one_quarter():
    """A heading h looks like 180 degrees - h. In the paper's clusters some share one, the negative control."""
    poses, _ = walkers()
    mirrored = poses.copy()
    mirrored[:, 0] = np.pi - poses[:, 0]
    both = np.concatenate([poses, COMPONENTS.wrapped(mirrored)])
    shared = {}
    for name, config in (("working", WORKING), ("printed", PRINTED)):
        first = ClusterConfig(config.facing, (1,) * len(config.facing), config.first)
        labels = cluster_poses(both, both[:, 0], COMPONENTS, first)
        shared[name] = np.mean(labels[: len(poses)] == labels[len(poses) :])
    assert shared["working"] == 0.0 and shared["printed"] > 0.2


def test_directions_that_are_wanted():
    poses, _ = walkers()
    sideways = poses[np.abs(np.sin(poses[:, 0])) > 0.8]
    config = ClusterConfig((0.5 * np.pi, -0.5 * np.pi), (1, 1))
    labels = cluster_poses(sideways, sideways[:, 0], COMPONENTS, config)
    np.testing.assert_array_equal(labels == 0, np.sin(sideways[:, 0]) > 0)


@pytest.mark.parametrize("first", ["k-means", "sectors"])
def test_nobody_faces_a_direction(first):
    poses, _ = walkers()
    forward = poses[np.cos(poses[:, 0]) > -0.5]
    with pytest.raises(InputError, match="face away from the camera, got none") as raised:
        cluster_poses(forward, forward[:, 0], COMPONENTS, ClusterConfig(first=first))
    assert "\n" not in str(raised.value)
    with pytest.raises(InputError, match="face -135 degrees from the camera"):
        right = poses[turn(poses[:, 0] - 1.0) < 1.0]  # -135 degrees are nearer than 1 from -3.82 to -0.68 only
        cluster_poses(right, right[:, 0], COMPONENTS, ClusterConfig((1.0, np.radians(-135)), (1, 1)))


def test_fewer_frames_than_clusters_or_than_can_teach():
    poses, _ = walkers(5)
    with pytest.raises(InputError, match="at least one a cluster, 6"):
        cluster_poses(poses, poses[:, 0], COMPONENTS, PRINTED)
    poses, _ = walkers(6 * FEWEST // 2)
    with pytest.raises(InputError, match=f"{FEWEST} or more"):
        cluster_poses(poses, poses[:, 0], COMPONENTS, PRINTED)
    poses = np.concatenate([np.tile([[0.0, 0.0, 0.0]], (20, 1)), [[np.pi, 0.0, 0.0]]])
    with pytest.raises(InputError, match="face away from the camera: expected 2 or more, got 1"):
        cluster_poses(poses, poses[:, 0], COMPONENTS, ClusterConfig((0.0, np.pi), (1, 2)))


@pytest.mark.parametrize(
    "wrong",
    [{"splits": (1, 1, 1)}, {"splits": (1, 1, 0, 1)}, {"splits": (1.5, 1, 1, 1)}, {"facing": ()}, {"first": "poses"}],
)
def test_settings_check_themselves(wrong):
    with pytest.raises(InputError, match="clusters: "):
        ClusterConfig(**wrong)
