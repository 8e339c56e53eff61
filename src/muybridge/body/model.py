"""Articulated bodies: a tree of rigid segments with named rotations and simple shapes (Du 2005, section 4.5).

A `Body` is fixed while a person is tracked; a pose `(D,)` is what moves. The first three numbers of a pose are the
root's place in the world (metres), the others are joint angles (radians) in the order of `dof_names`.

Local frames
    Each segment has a frame at the joint to its parent. At the zero pose of a person in the catalogue that is not
    taken from elsewhere, every frame is parallel to the world's: x to the person's right, y forward, z up. Rotations
    are applied in the order in which they are listed, each about an axis of the frame that the ones before it have
    turned.
Shapes
    A truncated cone from `base` to `tip` with elliptical ends, flat (Du) or round; a sphere is a cone of no length.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from muybridge._kernels.chain import segment_frames
from muybridge.body.arrays import BodyArrays, arrays_of
from muybridge.body.parts import AXIS_CODES, Landmark, Rotation, Segment, Shape, times
from muybridge.errors import InputError

__all__ = ["AXIS_CODES", "Body", "BodyArrays", "Landmark", "Rotation", "Segment", "Shape"]


@dataclass(frozen=True)
class Body:
    """A tree of segments, parents before children.

    Raises
    ------
    InputError
        A cycle or an unknown parent, two roots, a name used twice, a joint on no segment, a height that is none.
    """

    name: str
    segments: tuple[Segment, ...]
    landmarks: Mapping[str, Landmark] = field(default_factory=dict)
    height: float = 1.75  # metres, of the person these measures describe
    source: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "segments", _ordered(self.name, self.segments))
        _check_unique(f"body {self.name!r}", "degree of freedom", self.dof_names)
        _check_height(self.height)
        for name, mark in self.landmarks.items():
            if mark.segment not in self.segment_names:
                what = f"body {self.name!r}: joint {name!r}"
                raise InputError(what, expected="a segment of the body", got=repr(mark.segment))

    @cached_property
    def segment_names(self) -> tuple[str, ...]:
        """The S names, parents before children."""
        return tuple(segment.name for segment in self.segments)

    @cached_property
    def dof_names(self) -> tuple[str, ...]:
        """The D names: root_x, root_y, root_z, then every rotation in tree order."""
        turns = tuple(rotation.name for segment in self.segments for rotation in segment.rotations)
        return ("root_x", "root_y", "root_z", *turns)

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        """The J names of the joints that are reported."""
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
    def usual(self) -> np.ndarray:
        """(2, D) float64: where each angle mostly is, and its deviation; infinite where nothing is known."""
        turns = [(r.usual, r.usual_sd) for s in self.segments for r in s.rotations]
        return np.array([(0.0, np.inf)] * 3 + turns).T

    @cached_property
    def blocks(self) -> dict[str, np.ndarray]:
        """Degrees of freedom by limb block (root, left_arm ...), as index arrays."""
        owner = ["root"] * 3 + [s.block for s in self.segments for _ in s.rotations]
        return {name: np.flatnonzero([o == name for o in owner]) for name in dict.fromkeys(owner)}

    @cached_property
    def arrays(self) -> BodyArrays:
        """The tree as the kernels take it."""
        return arrays_of(self.segments)

    @cached_property
    def moved_by(self) -> np.ndarray:
        """(S, D) bool: whether a degree of freedom moves a segment."""
        arrays = self.arrays
        moved = np.zeros((len(self.segments), len(self.dof_names)), bool)
        moved[:, :3] = True
        for segment, parent in enumerate(arrays.parent):
            if parent >= 0:
                moved[segment] |= moved[parent]
            own = arrays.dof[segment]
            moved[segment, own[own >= 0]] = True
        return moved

    @cached_property
    def parts_below(self) -> np.ndarray:
        """(S,) int64: how many segments that have a shape hang on a segment, directly or not."""
        below = np.zeros(len(self.segments), np.int64)
        for segment in self.arrays.shaped:
            ancestor = self.arrays.parent[segment]
            while ancestor >= 0:
                below[ancestor] += 1
                ancestor = self.arrays.parent[ancestor]
        return below

    def frames(self, poses: np.ndarray) -> np.ndarray:
        """Segment frames in the world.

        Parameters
        ----------
        poses : (N, D) or (D,) float64, metres and radians

        Returns
        -------
        (N, S, 3, 4) float64: rotation and origin of every segment, `X_world = R X_local + t`, metres.
        """
        poses = np.ascontiguousarray(np.atleast_2d(poses), dtype=np.float64)
        if poses.ndim != 2 or poses.shape[1] != len(self.dof_names):
            expected = f"{len(self.dof_names)} numbers"
            raise InputError(f"pose of body {self.name!r}", expected=expected, got=str(poses.shape[-1]))
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
        tips = self.arrays.ends[self._landmark_segments, 1]
        marks = zip(self.landmarks.values(), tips, strict=True)
        rows = [np.array(mark.offset) + (tip if mark.at_tip else 0.0) for mark, tip in marks]
        return np.array(rows).reshape(-1, 3)

    @cached_property
    def length_groups(self) -> tuple[str, ...]:
        """Names of the lengths that can be scaled: segments' own lengths and offsets between joints."""
        groups = [s.length_group for s in self.segments] + [s.offset_group for s in self.segments]
        return tuple(dict.fromkeys(g for g in groups if g))

    @cached_property
    def radius_groups(self) -> tuple[str, ...]:
        """Names of the widths and depths that can be scaled."""
        return tuple(dict.fromkeys(s.radius_group for s in self.segments if s.radius_group))

    def scaled(
        self,
        lengths: Mapping[str, float] | None = None,
        widths: Mapping[str, float] | None = None,
        depths: Mapping[str, float] | None = None,
    ) -> Body:
        """The same body with its measures multiplied by a factor per group.

        `widths` are the half axes along each shape's `side`, `depths` the ones across; landmark offsets move with
        their segment's length.
        """
        lengths, widths, depths = dict(lengths or {}), dict(widths or {}), dict(depths or {})
        _check_groups(self.name, "length", lengths, self.length_groups)
        _check_groups(self.name, "width", widths, self.radius_groups)
        _check_groups(self.name, "depth", depths, self.radius_groups)
        along = {s.name: lengths.get(s.length_group, 1.0) for s in self.segments}
        segments = tuple(
            _resized(
                s,
                lengths.get(s.offset_group, 1.0),
                (along[s.name], widths.get(s.radius_group, 1.0), depths.get(s.radius_group, 1.0)),
            )
            for s in self.segments
        )
        marks = {name: _moved(mark, along[mark.segment]) for name, mark in self.landmarks.items()}
        return replace(self, segments=segments, landmarks=marks)

    def with_height(self, height: float) -> Body:
        """The same person made `height` metres tall, everything in proportion."""
        _check_height(height)
        return replace(self.resized(height / self.height), height=float(height))

    def resized(self, factor: float) -> Body:
        """Every length, offset and radius multiplied by one factor."""
        segments = tuple(_resized(segment, factor, (factor, factor, factor)) for segment in self.segments)
        marks = {name: _moved(mark, factor) for name, mark in self.landmarks.items()}
        return replace(self, segments=segments, landmarks=marks, height=self.height * factor)


def _resized(segment: Segment, offset: float, size: tuple[float, float, float]) -> Segment:
    shape = segment.shape.resized(*size) if segment.shape is not None else None
    return replace(segment, offset=times(segment.offset, offset), shape=shape)


def _moved(mark: Landmark, factor: float) -> Landmark:
    return replace(mark, offset=times(mark.offset, factor))


def _ordered(body: str, segments: Sequence[Segment]) -> tuple[Segment, ...]:
    """Parents before children, otherwise as given: the order that pose vectors follow."""
    what, names = f"body {body!r}", [segment.name for segment in segments]
    _check_unique(what, "segment", names)
    for segment in segments:
        if segment.parent and segment.parent not in names:
            known = f"one of {', '.join(names)}"
            raise InputError(f"{what}: parent of {segment.name!r}", expected=known, got=repr(segment.parent))
    roots = [segment.name for segment in segments if not segment.parent]
    if len(roots) != 1:
        got = ", ".join(roots) or "none (the parents form a cycle)"
        raise InputError(what, expected="exactly one root segment", got=got)
    ordered: dict[str, Segment] = {}
    while len(ordered) < len(segments):
        left = [segment for segment in segments if segment.name not in ordered]
        ready = next((segment for segment in left if segment.parent in {"", *ordered}), None)
        if ready is None:
            cycle = ", ".join(segment.name for segment in left)
            raise InputError(what, expected="a tree", got=f"a cycle among {cycle}", remedy="mend the parents")
        ordered[ready.name] = ready
    return tuple(ordered.values())


def _check_unique(what: str, kind: str, names: Sequence[str]) -> None:
    repeated = sorted({name for name in names if names.count(name) > 1})
    if repeated:
        raise InputError(what, expected=f"every {kind} named once", got=", ".join(repeated))


def _check_height(height: float) -> None:
    if not (np.isfinite(height) and height > 0):
        raise InputError("height", expected="a positive number of metres", got=repr(height))


def _check_groups(body: str, kind: str, given: Mapping[str, float], known: Sequence[str]) -> None:
    for name, factor in given.items():
        if name not in known:
            raise InputError(f"body {body!r}: {kind} {name!r}", expected=f"one of {', '.join(known)}")
        if not (np.isfinite(factor) and factor > 0):
            what = f"body {body!r}: factor of {kind} {name!r}"
            raise InputError(what, expected="a positive number", got=repr(factor))
