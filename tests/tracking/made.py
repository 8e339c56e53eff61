"""A person of the catalogue's cones on a ring of cameras, and the masks that exactly those cones would make."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from muybridge.body import Body
from muybridge.cameras.model import Rig
from muybridge.likelihood.observation import ImageLikelihood
from muybridge.likelihood.pictures import camera_rows
from reference.scene import camera, standing
from reference.silhouette import model_mask

SIZE, DISTANCE = (192, 144), 4.0  # pixels; metres
ANGLES = (0.2, 1.4, 3.0, 4.5)  # radians round the vertical
INTERVAL = 1 / 30  # seconds
#: Metres that a pixel covers at the person.
PIXEL = 1.8 / (0.85 * SIZE[1])


def ring(angles: Sequence[float] = ANGLES) -> Rig:
    """Level cameras round the origin."""
    return Rig(tuple(replace(camera(angle, SIZE, DISTANCE), name=f"c{i}") for i, angle in enumerate(angles)))


def exact_masks(body: Body, pose: np.ndarray, rig: Rig) -> list[np.ndarray]:
    """The body's own masks, C times (H, W) bool."""
    return [model_mask(pose, body.arrays, row) for row in camera_rows(rig)]


def empty_masks(rig: Rig) -> list[np.ndarray]:
    return [np.zeros(camera.size[::-1], bool) for camera in rig]


def likelihood(body: Body, rig: Rig) -> ImageLikelihood:
    return ImageLikelihood(body, rig, (1,) * len(rig))


def walking(frames: int) -> tuple[Body, np.ndarray]:
    """The person, and poses (T, D) of two steps a second: 1 cm a frame, limbs that swing up to 30 degrees."""
    body, rest = standing()
    poses = np.repeat(rest[None], frames, axis=0)
    swing = np.sin(2 * np.pi * np.arange(frames) / 30)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        for name, degrees in (("hip_flexion", 25), ("shoulder_flexion", -30)):
            poses[:, body.dof_names.index(f"{side}_{name}")] += sign * np.radians(degrees) * swing
        poses[:, body.dof_names.index(f"{side}_elbow_flexion")] += np.radians(25)
        poses[:, body.dof_names.index(f"{side}_shoulder_abduction")] += np.radians(15)
        poses[:, body.dof_names.index(f"{side}_knee_flexion")] += np.radians(15) * (1 - sign * swing)
    poses[:, 0] += 0.01 * np.arange(frames)
    return body, np.clip(poses, body.lower, body.upper)


def errors(body: Body, found: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """(J,) metres between the joints of two poses."""
    return np.linalg.norm(body.joints(found) - body.joints(truth), axis=-1)
