"""Where cameras stand."""

from __future__ import annotations

import numpy as np

from muybridge.cameras.model import Camera, Rig


def ring(rng: np.random.Generator, count: int, *, radius: float = 3.9, size: tuple[int, int] = (640, 480)) -> Rig:
    """Cameras on a circle around the origin, at the height of eyes or above, all looking at the middle of a person."""
    cameras = []
    for index in range(count):
        azimuth = 2 * np.pi * index / count + rng.uniform(-0.25, 0.25)
        distance = radius * rng.uniform(0.95, 1.05)
        place = np.array([distance * np.cos(azimuth), distance * np.sin(azimuth), rng.uniform(1.5, 2.3)])
        lens = np.array([-0.12, 0.06, 0.0, 0.0, 0.0]) * rng.uniform(0.7, 1.1) + (0, 0, *rng.normal(0, 3e-4, 2), 0)
        aim = np.array([0.0, 0.0, 0.88]) + rng.uniform(-0.05, 0.05, 3)
        focal = rng.uniform(0.88, 0.94) * size[0]
        cameras.append(looking_at(f"cam{index + 1}", place, aim, focal=focal, size=size, distortion=lens))
    return Rig(tuple(cameras))


def looking_at(
    name: str,
    place: np.ndarray,
    target: np.ndarray,
    *,
    focal: float,
    size: tuple[int, int] = (640, 480),
    distortion: np.ndarray | None = None,
) -> Camera:
    """An upright camera at `place` with `target` in the middle of its picture; metres, pixels."""
    forward = np.asarray(target, dtype=np.float64) - place
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(forward, right), forward])
    matrix = np.array([[focal, 0, (size[0] - 1) / 2], [0, focal, (size[1] - 1) / 2], [0, 0, 1]])
    lens = np.zeros(5) if distortion is None else distortion
    return Camera(name, size, matrix, lens, rotation, -rotation @ np.asarray(place, dtype=np.float64))
