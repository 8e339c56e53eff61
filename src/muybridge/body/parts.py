"""What a body is made of: rotations, shapes, segments, reported points; values that check themselves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from muybridge.errors import InputError

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]
#: Codes of rotation axes in the kernels: sign times (1, 2, 3) for x, y, z; 0 for no rotation.
AXIS_CODES = {"x": 1, "y": 2, "z": 3, "-x": -1, "-y": -2, "-z": -3}
MOST_ROTATIONS = 3
UNTURNED: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True)
class Rotation:
    """One named degree of freedom: a turn about an axis of the segment's frame."""

    name: str
    axis: str
    lower: float = -np.inf  # radians
    upper: float = np.inf  # radians
    usual: float = 0.0  # radians; where the angle mostly is
    usual_sd: float = np.inf  # radians; how far from there it mostly is; infinite: nothing is known

    def __post_init__(self) -> None:
        what = f"rotation {self.name!r}"
        if self.axis not in AXIS_CODES:
            raise InputError(f"{what}: axis", expected=f"one of {', '.join(AXIS_CODES)}", got=repr(self.axis))
        if not self.lower <= self.upper:
            degrees = f"[{np.degrees(self.lower):g}, {np.degrees(self.upper):g}] degrees"
            raise InputError(f"{what}: limits", expected="lower below upper", got=degrees, remedy="swap them")
        if not (np.isfinite(self.usual) and self.usual_sd > 0):
            got = f"[{np.degrees(self.usual):g}, {np.degrees(self.usual_sd):g}] degrees"
            raise InputError(f"{what}: usual", expected="an angle and a positive deviation", got=got)


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

    base: Vector
    tip: Vector
    radii: tuple[float, float]
    scale: tuple[float, float] = (1.0, 1.0)
    side: Vector = (1.0, 0.0, 0.0)
    round_ends: bool = True

    def __post_init__(self) -> None:
        for name in ("base", "tip", "side"):
            _check_finite(f"shape: {name}", getattr(self, name))
        for name in ("radii", "scale"):
            sizes = getattr(self, name)
            if not all(math.isfinite(v) and v > 0 for v in sizes):
                raise InputError(f"shape: {name}", expected="positive numbers", got=str(tuple(sizes)))

    @property
    def length(self) -> float:
        """Metres between the centres of the ends."""
        return float(np.linalg.norm(np.subtract(self.tip, self.base)))

    def resized(self, length: float, width: float, depth: float) -> Shape:
        """Multiplied by one factor along its axis, one along `side` and one across."""
        scale = (self.scale[0] * width, self.scale[1] * depth)
        return replace(self, base=times(self.base, length), tip=times(self.tip, length), scale=scale)


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
    block : str
        The limb whose degrees of freedom are tried together (root, left_arm ...).
    """

    name: str
    parent: str = ""
    offset: Vector = (0.0, 0.0, 0.0)
    at_tip: bool = False
    orientation: Matrix = UNTURNED
    rotations: tuple[Rotation, ...] = ()
    shape: Shape | None = None
    length_group: str = ""
    offset_group: str = ""
    radius_group: str = ""
    block: str = "root"

    def __post_init__(self) -> None:
        what = f"segment {self.name!r}"
        _check_finite(f"{what}: offset", self.offset)
        if len(self.rotations) > MOST_ROTATIONS:
            raise InputError(what, expected=f"at most {MOST_ROTATIONS} rotations", got=str(len(self.rotations)))
        if self.orientation == UNTURNED:
            return
        turn = np.array(self.orientation, float)
        if not (np.abs(turn @ turn.T - np.eye(3)).max() < 1e-6 and np.linalg.det(turn) > 0):
            rows = repr([list(row) for row in self.orientation])
            raise InputError(f"{what}: orientation", expected="a right-handed rotation matrix", got=rows)


@dataclass(frozen=True)
class Landmark:
    """A reported joint: a point fixed to a segment, in the segment's frame (metres)."""

    segment: str
    at_tip: bool = False
    offset: Vector = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        _check_finite(f"joint on {self.segment!r}: offset", self.offset)


def times(vector: Sequence[float], factor: float) -> Vector:
    """A vector (3,) multiplied by a factor."""
    x, y, z = (float(v) * factor for v in vector)
    return x, y, z


def _check_finite(what: str, numbers: Sequence[float]) -> None:
    if len(numbers) != 3 or not all(math.isfinite(v) for v in numbers):
        raise InputError(what, expected="3 finite numbers", got=str(tuple(numbers)))
