"""Articulated bodies: a tree of rigid segments with named rotations and simple shapes (Du 2005, section 4.5).

A `Body` is fixed while a person is tracked; a pose `(D,)` is what moves. The first three numbers of a pose are the root's
place in the world (metres), the others are joint angles (radians) in the order of `dof_names`.

Local frames
    Each segment has a frame at the joint to its parent. At the zero pose of a person in the catalogue that is not taken
    from elsewhere, every frame is parallel to the world's: x to the person's right, y forward, z up. Rotations are applied
    in the order in which they are listed, each about an axis of the frame that the ones before it have turned.
Shapes
    A truncated cone from `base` to `tip` with elliptical ends, flat (Du) or round; a sphere is a cone of no length.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from muybridge._kernels.chain import segment_frames
from muybridge.errors import InputError

#: Codes of rotation axes in the kernels: sign times (1, 2, 3) for x, y, z; 0 for no rotation.
AXIS_CODES = {"x": 1, "y": 2, "z": 3, "-x": -1, "-y": -2, "-z": -3}


@dataclass(frozen=True)
class Rotation:
    """One named degree of freedom: a turn about an axis of the segment's frame."""

    name: str
    axis: str
    lower: float = -np.inf  # radians
    upper: float = np.inf  # radians

    def __post_init__(self) -> None:
        if self.axis not in AXIS_CODES:
            raise InputError(f"rotation {self.name!r}: axis", expected=f"one of {', '.join(AXIS_CODES)}", got=repr(self.axis))
        if not self.lower <= self.upper:
            degrees = f"[{np.degrees(self.lower):g}, {np.degrees(self.upper):g}] degrees"
            raise InputError(f"rotation {self.name!r}: limits", expected="lower below upper", got=degrees, remedy="swap them")


@dataclass(frozen=True)
class Shape:
    """A truncated cone in the segment's frame.

    Parameters
    ----------
    base, tip : (3,) float, metres
        Centres of the two ends; equal for a sphere.
    radii : (2,) float, metres
        At the base and at the tip.
    scale : (2,) float
        The ellipse's half axes as multiples of the radius, along `side` and along the third direction.
    side : (3,) float
        Unit vector at right angles to the axis: the direction of the first half axis.
    round_ends : bool
        Ends are half ellipsoids (True) or flat discs (False).
    """

    base: tuple[float, float, float]
    tip: tuple[float, float, float]
    radii: tuple[float, float]
    scale: tuple[float, float] = (1.0, 1.0)
    side: tuple[float, float, float] = (1.0, 0.0, 0.0)
    round_ends: bool = True


@dataclass(frozen=True)
class Segment:
    """One rigid part: how it hangs on its parent, how it turns, and its shape.

    Parameters
    ----------
    name : str
    parent : str
        Name of the parent segment; empty for the root.
    offset : (3,) float, metres
        From the parent's attachment point (its origin, or its shape's tip when `at_tip`) to this segment's joint.
    orientation : (3, 3) float
        Fixed rotation from this frame (before its own rotations) to the parent's frame.
    rotations : up to three Rotation, in the order applied.
    length_group, offset_group, radius_group : str
        Measures that are fitted together (left and right pooled).
    """

    name: str
    parent: str = ""
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    at_tip: bool = False
    orientation: tuple[tuple[float, float, float], ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    rotations: tuple[Rotation, ...] = ()
    shape: Shape | None = None
    length_group: str = ""
    offset_group: str = ""
    radius_group: str = ""
    block: str = "root"


@dataclass(frozen=True)
class Landmark:
    """A reported joint: a point fixed to a segment, in the segment's frame (metres)."""

    segment: str
    at_tip: bool = False
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)


class BodyArrays(NamedTuple):
    """What the kernels take. S segments, D degrees of freedom; metres, radians.

    parent (S,) int64; fixed (S, 3, 4) float64, this frame in the parent's; axis (S, 3) int64 codes; dof (S, 3) int64, -1 for
    none; shaped (K,) int64, segments that have a shape; ends (S, 2, 3) float64, base and tip in the segment's frame; half_axes
    (S, 2, 3, 3) float64, rows are the three half axes of each end's ellipsoid (the third is zero for a flat end).
    """

    parent: np.ndarray
    fixed: np.ndarray
    axis: np.ndarray
    dof: np.ndarray
    shaped: np.ndarray
    ends: np.ndarray
    half_axes: np.ndarray


@dataclass(frozen=True)
class Body:
    """A tree of segments, parents before children.

    Raises
    ------
    InputError
        A cycle or an unknown parent, two roots, a name used twice, inverted limits, a size that is not positive.
    """

    name: str
    segments: tuple[Segment, ...]
    landmarks: Mapping[str, Landmark] = field(default_factory=dict)
    height: float = 1.75  # metres, of the person these measures describe
    source: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "segments", _ordered(self.name, self.segments))
        names = self.dof_names
        repeated = {name for name in names if names.count(name) > 1}
        if repeated:
            raise InputError(f"body {self.name!r}", expected="every degree of freedom named once", got=", ".join(sorted(repeated)))
        for name, mark in self.landmarks.items():
            if mark.segment not in self.segment_names:
                raise InputError(f"body {self.name!r}: joint {name!r}", expected="a segment of the body", got=repr(mark.segment))
        for segment in self.segments:
            _check_shape(self.name, segment)

    @cached_property
    def segment_names(self) -> tuple[str, ...]:
        return tuple(segment.name for segment in self.segments)

    @cached_property
    def dof_names(self) -> tuple[str, ...]:
        """The D names: root_x, root_y, root_z, then every rotation in tree order."""
        turns = tuple(rotation.name for segment in self.segments for rotation in segment.rotations)
        return ("root_x", "root_y", "root_z", *turns)

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        return tuple(self.landmarks)

    @cached_property
    def lower(self) -> np.ndarray:
        """(D,) float64: lower limits, metres and radians; -inf where free."""
        return np.array([-np.inf] * 3 + [r.lower for s in self.segments for r in s.rotations])

    @cached_property
    def upper(self) -> np.ndarray:
        """(D,) float64: upper limits, metres and radians; inf where free."""
        return np.array([np.inf] * 3 + [r.upper for s in self.segments for r in s.rotations])

    @cached_property
    def blocks(self) -> dict[str, np.ndarray]:
        """Degrees of freedom by limb block (root, left_arm ...), as index arrays."""
        owner = ["root"] * 3 + [s.block for s in self.segments for _ in s.rotations]
        return {name: np.flatnonzero([o == name for o in owner]) for name in dict.fromkeys(owner)}

    @cached_property
    def arrays(self) -> BodyArrays:
        return _arrays(self)

    def frames(self, poses: np.ndarray) -> np.ndarray:
        """Segment frames in the world.

        Parameters
        ----------
        poses : (N, D) float64, metres and radians

        Returns
        -------
        (N, S, 3, 4) float64: rotation and origin of every segment, `X_world = R X_local + t`, metres.
        """
        poses = np.ascontiguousarray(np.atleast_2d(poses), dtype=np.float64)
        if poses.shape[1] != len(self.dof_names):
            raise InputError(f"pose of body {self.name!r}", expected=f"{len(self.dof_names)} numbers", got=str(poses.shape[1]))
        a = self.arrays
        return segment_frames(poses, a.parent, a.fixed, a.axis, a.dof)

    def joints(self, poses: np.ndarray) -> np.ndarray:
        """Reported joints in the world: (N, D) or (D,) poses -> (N, J, 3) or (J, 3) float64, metres."""
        frames = self.frames(poses)[:, self._landmark_segments]
        points = np.einsum("njab,jb->nja", frames[..., :3], self._landmark_points) + frames[..., 3]
        return points if np.ndim(poses) == 2 else points[0]

    @cached_property
    def _landmark_segments(self) -> np.ndarray:
        return np.array([self.segment_names.index(mark.segment) for mark in self.landmarks.values()], dtype=np.int64)

    @cached_property
    def _landmark_points(self) -> np.ndarray:
        tips = self.arrays.ends[:, 1]
        rows = [np.array(m.offset) + (tips[s] if m.at_tip else 0.0)
                for m, s in zip(self.landmarks.values(), self._landmark_segments, strict=True)]
        return np.array(rows).reshape(-1, 3)

    @cached_property
    def length_groups(self) -> tuple[str, ...]:
        """Names of the lengths that can be scaled: segments' own lengths and offsets between joints."""
        groups = [s.length_group for s in self.segments] + [s.offset_group for s in self.segments]
        return tuple(dict.fromkeys(g for g in groups if g))

    @cached_property
    def radius_groups(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(s.radius_group for s in self.segments if s.radius_group))

    def scaled(self, lengths: Mapping[str, float] | None = None, widths: Mapping[str, float] | None = None,
               depths: Mapping[str, float] | None = None) -> Body:
        """The same body with its measures multiplied by a factor per group.

        `widths` are the half axes along each shape's `side`, `depths` the ones across; landmark offsets move with their
        segment's length.
        """
        lengths, widths, depths = dict(lengths or {}), dict(widths or {}), dict(depths or {})
        _check_groups(self.name, "length", lengths, self.length_groups)
        _check_groups(self.name, "width", widths, self.radius_groups)
        _check_groups(self.name, "depth", depths, self.radius_groups)
        segments = tuple(_scale_segment(s, lengths, widths, depths) for s in self.segments)
        by_name = {s.name: s for s in self.segments}
        marks = {name: replace(m, offset=_times(m.offset, lengths.get(by_name[m.segment].length_group, 1.0)))
                 for name, m in self.landmarks.items()}
        return replace(self, segments=segments, landmarks=marks)

    def with_height(self, height: float) -> Body:
        """The same person made `height` metres tall, everything in proportion."""
        if not (np.isfinite(height) and height > 0):
            raise InputError("height", expected="a positive number of metres", got=repr(height))
        k = height / self.height
        return replace(self.resized(k), height=height)

    def resized(self, factor: float) -> Body:
        """Every length, offset and radius multiplied by one factor."""
        segments = tuple(replace(s, offset=_times(s.offset, factor), shape=s.shape and _resize_shape(s.shape, factor, factor, factor))
                         for s in self.segments)
        marks = {name: replace(m, offset=_times(m.offset, factor)) for name, m in self.landmarks.items()}
        return replace(self, segments=segments, landmarks=marks, height=self.height * factor)


def _ordered(body: str, segments: Sequence[Segment]) -> tuple[Segment, ...]:
    """Parents before children, otherwise as given; the depth-first order that pose vectors follow."""
    names = [s.name for s in segments]
    if len(set(names)) < len(names):
        raise InputError(f"body {body!r}", expected="every segment named once", got=", ".join(sorted({n for n in names if names.count(n) > 1})))
    unknown = [s for s in segments if s.parent and s.parent not in names]
    if unknown:
        raise InputError(f"body {body!r}: parent of {unknown[0].name!r}", expected=f"one of {', '.join(names)}", got=repr(unknown[0].parent))
    roots = [s for s in segments if not s.parent]
    if len(roots) != 1:
        got = ", ".join(s.name for s in roots) or "none (the parents form a cycle)"
        raise InputError(f"body {body!r}", expected="exactly one root segment", got=got)
    ordered: list[Segment] = []
    while len(ordered) < len(segments):
        placed = {s.name for s in ordered}
        ready = [s for s in segments if s.name not in placed and (not s.parent or s.parent in placed)]
        if not ready:
            cycle = ", ".join(n for n in names if n not in placed)
            raise InputError(f"body {body!r}", expected="a tree", got=f"a cycle among {cycle}", remedy="mend the parents")
        ordered.append(ready[0])
    return tuple(ordered)


def _check_shape(body: str, segment: Segment) -> None:
    if len(segment.rotations) > 3:
        raise InputError(f"body {body!r}: segment {segment.name!r}", expected="at most 3 rotations", got=str(len(segment.rotations)))
    if segment.shape is None:
        return
    sizes = (*segment.shape.radii, *segment.shape.scale)
    if not all(np.isfinite(v) and v > 0 for v in sizes):
        raise InputError(f"body {body!r}: radii of {segment.name!r}", expected="positive numbers", got=str(sizes))


def _check_groups(body: str, kind: str, given: Mapping[str, float], known: Sequence[str]) -> None:
    for name, factor in given.items():
        if name not in known:
            raise InputError(f"body {body!r}: {kind} {name!r}", expected=f"one of {', '.join(known)}")
        if not (np.isfinite(factor) and factor > 0):
            raise InputError(f"body {body!r}: factor of {kind} {name!r}", expected="a positive number", got=repr(factor))


def _times(vector: Sequence[float], factor: float) -> tuple[float, float, float]:
    x, y, z = (float(v) * factor for v in vector)
    return x, y, z


def _resize_shape(shape: Shape, length: float, width: float, depth: float) -> Shape:
    return replace(shape, base=_times(shape.base, length), tip=_times(shape.tip, length),
                   scale=(shape.scale[0] * width, shape.scale[1] * depth))


def _scale_segment(segment: Segment, lengths: Mapping[str, float], widths: Mapping[str, float],
                   depths: Mapping[str, float]) -> Segment:
    length = lengths.get(segment.length_group, 1.0)
    width, depth = widths.get(segment.radius_group, 1.0), depths.get(segment.radius_group, 1.0)
    shape = segment.shape and _resize_shape(segment.shape, length, width, depth)
    return replace(segment, offset=_times(segment.offset, lengths.get(segment.offset_group, 1.0)), shape=shape)


def _arrays(body: Body) -> BodyArrays:
    """Bake the tree into the arrays that the kernels take."""
    count = len(body.segments)
    parent, fixed = np.full(count, -1, np.int64), np.zeros((count, 3, 4))
    axis, dof = np.zeros((count, 3), np.int64), np.full((count, 3), -1, np.int64)
    ends, half_axes = np.zeros((count, 2, 3)), np.zeros((count, 2, 3, 3))
    next_dof = 3
    for i, segment in enumerate(body.segments):
        offset = np.array(segment.offset, float)
        if segment.parent:
            parent[i] = body.segment_names.index(segment.parent)
            offset = offset + (ends[parent[i], 1] if segment.at_tip else 0.0)
        fixed[i, :, :3], fixed[i, :, 3] = segment.orientation, offset
        for k, rotation in enumerate(segment.rotations):
            axis[i, k], dof[i, k] = AXIS_CODES[rotation.axis], next_dof
            next_dof += 1
        if segment.shape is not None:
            ends[i] = segment.shape.base, segment.shape.tip
            half_axes[i] = _half_axes(segment.shape)
    shaped = np.array([i for i, s in enumerate(body.segments) if s.shape is not None], np.int64)
    return BodyArrays(parent, fixed, axis, dof, shaped, ends, half_axes)


def _half_axes(shape: Shape) -> np.ndarray:
    """(2, 3, 3): rows are the half axes of the ellipsoid (round) or disc (flat) at the base and at the tip."""
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
