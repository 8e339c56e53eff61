"""The bodytrack body for another person: its 58 shape numbers and its 31-number poses, in our conventions.

Its files are in millimetres and in an order of their own; `datasets.bodytrack` reads them and hands arrays to this
module.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from muybridge.body.load import named_body
from muybridge.body.model import Body, Segment

#: Their ten segments, in the order of the file.
_SEGMENTS = (
    *("torso", "left_thigh", "left_calf", "right_thigh", "right_calf"),
    *("left_upper_arm", "left_forearm", "right_upper_arm", "right_forearm", "head"),
)
#: Index in the file's 18 lengths, by segment; arms hang along minus z of their frames.
_LENGTH = {
    "torso": 0,
    "left_thigh": 2,
    "left_calf": 3,
    "right_thigh": 6,
    "right_calf": 7,
    "left_upper_arm": 10,
    "left_forearm": 11,
    "right_upper_arm": 14,
    "right_forearm": 15,
    "head": 17,
}
#: Joint offsets (x, y, z) as (length index, sign) on one axis, by segment.
_OFFSET = {
    "left_thigh": (1, 1, 1.0),
    "right_thigh": (1, 5, -1.0),
    "left_upper_arm": (2, 9, -1.0),
    "right_upper_arm": (2, 13, -1.0),
    "left_clavicle": (2, 0, -1.0),
    "right_clavicle": (2, 0, -1.0),
    "head": (2, 0, -1.0),
}
#: The file's 31 numbers by name.
POSE_ORDER = (
    *("root_pitch", "root_roll", "root_yaw", "root_x", "root_y", "root_z"),
    *("left_hip_x", "left_hip_y", "left_hip_z", "left_knee"),
    *("right_hip_x", "right_hip_y", "right_hip_z", "right_knee"),
    *("left_clavicle_x", "left_clavicle_y", "left_shoulder_x", "left_shoulder_y", "left_shoulder_z", "left_elbow"),
    *(
        "right_clavicle_x",
        "right_clavicle_y",
        "right_shoulder_x",
        "right_shoulder_y",
        "right_shoulder_z",
        "right_elbow",
    ),
    *("thorax_y", "thorax_z", "head_x", "head_y", "head_z"),
)


def bodytrack_body(radii: np.ndarray, lengths: np.ndarray) -> Body:
    """The catalogue's bodytrack body with another person's measures.

    Parameters
    ----------
    radii : (10, 4) float64
        r_proximal, r_distal (metres), scale_x, scale_y (ratios) by segment.
    lengths : (18,) float64, metres
        In the order of BodyShapeParameters.txt.
    """
    body = named_body("bodytrack")
    segments = tuple(_measured(segment, radii, lengths) for segment in body.segments)
    return replace(body, segments=segments)


def _measured(segment: Segment, radii: np.ndarray, lengths: np.ndarray) -> Segment:
    if segment.name in _OFFSET:
        axis, index, sign = _OFFSET[segment.name]
        offset = [0.0, 0.0, 0.0]
        offset[axis] = sign * float(lengths[index])
        segment = replace(segment, offset=(offset[0], offset[1], offset[2]))
    if segment.shape is None:
        return segment
    row = radii[_SEGMENTS.index(segment.name)]
    length = float(np.copysign(lengths[_LENGTH[segment.name]], segment.shape.tip[2]))
    shape = replace(
        segment.shape,
        tip=(0.0, 0.0, length),
        radii=(float(row[0]), float(row[1])),
        scale=(float(row[2]), float(row[3])),
    )
    return replace(segment, shape=shape)


def bodytrack_pose(values: np.ndarray) -> np.ndarray:
    """Poses of the file (..., 31), radians and metres, in this body's order of degrees of freedom (..., 31)."""
    names = named_body("bodytrack").dof_names
    return np.asarray(values, float)[..., [POSE_ORDER.index(name) for name in names]]
