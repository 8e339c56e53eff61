"""A body before cameras, for tests: small pictures, random poses round standing upright."""

from __future__ import annotations

import os

import numpy as np

from muybridge.body import Body, named_body
from muybridge.cameras.model import Camera
from muybridge.likelihood.pictures import camera_rows

#: Without the compiler every pixel costs a microsecond and more: fewer poses, the same claims.
SLOW = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")
WIDE = (0.15, -0.04, 0.001, -0.001, 0.01)  # a visible barrel


def count(poses: int) -> int:
    """How many poses to try: a quarter, at least two, where nothing is compiled."""
    return max(2, poses // 4) if SLOW else poses


def standing(name: str = "person") -> tuple[Body, np.ndarray]:
    """A body of the catalogue and a pose (D,) in which it stands upright with its middle at the origin."""
    body = named_body(name)
    pose = np.zeros(len(body.dof_names))
    if np.ptp(body.joints(pose)[:, 2]) < 1.0:
        pose[3] = np.pi / 2
    joints = body.joints(pose)
    pose[:3] -= (joints.min(axis=0) + joints.max(axis=0)) / 2
    return body, pose


def camera(
    angle: float,
    size: tuple[int, int] = (96, 72),
    distance: float = 4.0,
    fill: float = 0.85,
    distortion: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0, 0.0),
) -> Camera:
    """A camera on a circle round the origin, level, that sees 1.8 m as `fill` of its height; `angle` in radians."""
    width, height = size
    focal = fill * height * distance / 1.8
    forward = -np.array([np.cos(angle), np.sin(angle), 0.0])
    rotation = np.array([np.cross(forward, [0.0, 0.0, 1.0]), [0.0, 0.0, -1.0], forward])
    matrix = np.array([[focal, 0.0, (width - 1) / 2], [0.0, focal, (height - 1) / 2], [0.0, 0.0, 1.0]])
    return Camera("ring", size, matrix, np.array(distortion), rotation, np.array([0.0, 0.0, distance]))


def rows(*cameras: Camera) -> np.ndarray:
    """(C, CAMERA_COLUMNS)"""
    return camera_rows(cameras)


def random_poses(
    rng: np.random.Generator, pose: np.ndarray, poses: int, metres: float = 0.05, radians: float = 0.3
) -> np.ndarray:
    """(N, D): normal steps round a pose."""
    return pose + rng.normal(size=(poses, len(pose))) * np.r_[np.full(3, metres), np.full(len(pose) - 3, radians)]
