"""Joint angles from joint positions, the same for every body model (Du 2005, Figs. 7.7 and 7.8).

Eight curves: shoulder, elbow, hip and knee of both sides. Zero is upright standing, positive is forward, the way the
person faces. Shoulder and hip are the turn of the upper limb about the trunk's left-right axis (the thesis' rotation
about x); elbow and knee are the angle between the two bones, so an elbow bends to the positive and a knee to the
negative side.
"""

from __future__ import annotations

import numpy as np

from muybridge.errors import InputError

ANGLES = tuple(f"{side}_{joint}" for joint in ("shoulder", "elbow", "hip", "knee") for side in ("left", "right"))
"""The order of the last axis of what `joint_angles` returns."""
BONES = {"shoulder": ("shoulder", "elbow"), "hip": ("hip", "knee")}
HINGES = {"elbow": ("shoulder", "elbow", "wrist", 1.0), "knee": ("hip", "knee", "ankle", -1.0)}
STEP_M = 1e-4
"""Step of the central differences in `angle_deviations`: the curvature over 0.1 mm is far below any joint's error."""


def joint_angles(positions: np.ndarray, names: tuple[str, ...]) -> np.ndarray:
    """The eight angles of each frame.

    Parameters
    ----------
    positions : (..., J, 3) float64, metres, world
    names : tuple of str
        The J joints; thorax and both sides' shoulder, elbow, wrist, hip, knee and ankle are needed.

    Returns
    -------
    (..., 8) float64, radians
        In the order of `ANGLES`; NaN where a joint is missing.

    Notes
    -----
    Trunk frame: up is from the middle of the hips to the thorax; left is from the right hip to the left hip, made
    perpendicular to up for the hips, and likewise from shoulder to shoulder for the shoulders, so that a twisted spine
    does not swing the arms; forward = left x up.
    """
    at = _columns(positions, names)
    up = _unit(at["thorax"] - (at["left_hip"] + at["right_hip"]) / 2)
    found = []
    for name in ANGLES:
        side, joint = name.split("_")
        if joint in BONES:
            upper, lower = (at[f"{side}_{part}"] for part in BONES[joint])
            forward = _unit(np.cross(at[f"left_{joint}"] - at[f"right_{joint}"], up))
            found.append(np.arctan2(_dot(lower - upper, forward), -_dot(lower - upper, up)))
        else:
            *parts, sign = HINGES[joint]
            first, middle, last = (at[f"{side}_{part}"] for part in parts)
            found.append(sign * _angle_between(middle - first, last - middle))
    return np.stack(found, axis=-1)


def angle_deviations(positions: np.ndarray, deviations: np.ndarray, names: tuple[str, ...]) -> np.ndarray:
    """Standard deviations of the angles that follow from those of the joints, to first order.

    Parameters
    ----------
    positions : (T, J, 3) float64, metres, world
    deviations : (T, J) float64, metres
        Isotropic; the joints' errors are taken as independent. Neighbouring joints err together, so this is on the
        large side.
    names : tuple of str

    Returns
    -------
    (T, 8) float64, radians
    """
    variance = np.zeros((*positions.shape[:-2], len(ANGLES)))
    for joint in range(positions.shape[-2]):
        for axis in range(3):
            ahead, behind = positions.copy(), positions.copy()
            ahead[..., joint, axis] += STEP_M
            behind[..., joint, axis] -= STEP_M
            change = joint_angles(ahead, names) - joint_angles(behind, names)
            slope = np.mod(change + np.pi, 2 * np.pi) - np.pi
            variance += (slope / (2 * STEP_M) * deviations[..., joint, None]) ** 2
    return np.sqrt(variance)


def _columns(positions: np.ndarray, names: tuple[str, ...]) -> dict[str, np.ndarray]:
    needed = [
        "thorax",
        *(
            f"{side}_{part}"
            for side in ("left", "right")
            for part in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")
        ),
    ]
    missing = [name for name in needed if name not in names]
    if missing:
        raise InputError("joints for the angles", expected="thorax and all limbs", got=f"no {', '.join(missing)}")
    return {name: positions[..., names.index(name), :] for name in needed}


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return (a * b).sum(axis=-1)


def _unit(vector: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(vector, axis=-1, keepdims=True)
    return vector / np.where(length > 0, length, np.nan)


def _angle_between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The angle of two vectors, exact near 0 too, where the arc cosine is not."""
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), _dot(a, b))
