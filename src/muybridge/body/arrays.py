"""A body's tree as arrays, which is what compiled code takes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from muybridge.body.parts import AXIS_CODES, MOST_ROTATIONS, Segment, Shape


class BodyArrays(NamedTuple):
    """What the kernels take. S segments, K of them with a shape, D degrees of freedom; metres, radians.

    parent : (S,) int64, -1 for the root
    fixed : (S, 3, 4) float64, this frame in the parent's
    axis : (S, 3) int64, codes of `AXIS_CODES`
    dof : (S, 3) int64, -1 for none
    shaped : (K,) int64, segments that have a shape
    ends : (S, 2, 3) float64, base and tip in the segment's frame
    half_axes : (S, 2, 3, 3) float64, rows are each end's three half axes; a flat end's third is zero
    """

    parent: np.ndarray
    fixed: np.ndarray
    axis: np.ndarray
    dof: np.ndarray
    shaped: np.ndarray
    ends: np.ndarray
    half_axes: np.ndarray


def arrays_of(segments: Sequence[Segment]) -> BodyArrays:
    """Bake a tree, parents before children, into arrays."""
    count, names = len(segments), [segment.name for segment in segments]
    parent, fixed = np.full(count, -1, np.int64), np.zeros((count, 3, 4))
    axis, dof = np.zeros((count, MOST_ROTATIONS), np.int64), np.full((count, MOST_ROTATIONS), -1, np.int64)
    ends, half_axes = np.zeros((count, 2, 3)), np.zeros((count, 2, 3, 3))
    next_dof = 3  # after the root's place
    for i, segment in enumerate(segments):
        offset = np.array(segment.offset, float)
        if segment.parent:
            parent[i] = names.index(segment.parent)
            offset = offset + (ends[parent[i], 1] if segment.at_tip else 0.0)
        fixed[i, :, :3], fixed[i, :, 3] = segment.orientation, offset
        for k, rotation in enumerate(segment.rotations):
            axis[i, k], dof[i, k] = AXIS_CODES[rotation.axis], next_dof
            next_dof += 1
        if segment.shape is not None:
            ends[i] = segment.shape.base, segment.shape.tip
            half_axes[i] = half_axes_of(segment.shape)
    shaped = np.array([i for i, s in enumerate(segments) if s.shape is not None], np.int64)
    return BodyArrays(parent, fixed, axis, dof, shaped, ends, half_axes)


def half_axes_of(shape: Shape) -> np.ndarray:
    """(2, 3, 3) float64, metres: half axes of the ellipsoid (round) or disc (flat) at base and tip."""
    along = np.subtract(shape.tip, shape.base)
    length = np.linalg.norm(along)
    along = along / length if length > 0 else np.array([0.0, 0.0, 1.0])
    side = np.array(shape.side, float) - np.dot(shape.side, along) * along
    if np.linalg.norm(side) < 1e-6:
        side = np.eye(3)[np.argmin(np.abs(along))]
        side = side - np.dot(side, along) * along
    side /= np.linalg.norm(side)
    third = np.cross(along, side)
    depth = np.sqrt(shape.scale[0] * shape.scale[1]) if shape.round_ends or length == 0 else 0.0
    return np.array([[r * shape.scale[0] * side, r * shape.scale[1] * third, r * depth * along] for r in shape.radii])
