"""What every motion file holds: a tree of bones, and how they turn over time.

A file's own ways (units, axes, orders of angles, local axes of bones) end in its reader. Here every bone has a frame
that is parallel to the world's in the file's *rest posture*, so that rotations of one are all the orientation there is:
the identity is the rest posture, whichever that is (a T-pose in most files).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from muybridge.errors import InputError
from muybridge.io.trc import columns_to_world

#: Metres in the units that motion files come in; CMU's files count in inches over 0.45.
METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001, "inch": 0.0254, "inch / 0.45": 0.0254 / 0.45}
#: Metres: how large a person in the rest posture may be, from feet to head or from hand to hand.
EXTENT = (1.2, 2.35)


@dataclass(frozen=True, eq=False)
class Skeleton:
    """A tree of bones in its rest posture.

    Parameters
    ----------
    names : tuple of str, as the file has them
    parents : (B,) int64, parents come first, -1 for the root
    offsets : (B, 3) float64, metres, axes of the world: from the parent's head to the bone's; zero for the root
    tips : (B, 3) float64, metres, axes of the world: from the bone's head to its end; zero where the file has none
    """

    names: tuple[str, ...]
    parents: np.ndarray
    offsets: np.ndarray
    tips: np.ndarray

    @property
    def rest_places(self) -> np.ndarray:
        """(B, 3) metres: where bones begin in the rest posture, the root at the origin."""
        places = np.zeros_like(self.offsets)
        for bone in range(1, len(self.names)):
            places[bone] = places[self.parents[bone]] + self.offsets[bone]
        return places


@dataclass(frozen=True, eq=False)
class Recording:
    """A skeleton that moves.

    Parameters
    ----------
    skeleton : Skeleton
    times : (T,) float64, seconds, from 0
    rotations : (T, B, 3, 3) float64: each bone's turn from rest, relative to its parent; the root's to the world
    root_places : (T, 3) float64, metres, world
    """

    skeleton: Skeleton
    times: np.ndarray
    rotations: np.ndarray
    root_places: np.ndarray

    def posed(self) -> tuple[np.ndarray, np.ndarray]:
        """(T, B, 3, 3) and (T, B, 3) metres: world rotations, and where bones begin."""
        worlds, places = self.rotations.copy(), np.repeat(self.root_places[:, None], len(self.skeleton.names), axis=1)
        for bone in range(1, len(self.skeleton.names)):
            parent = self.skeleton.parents[bone]
            worlds[:, bone] = worlds[:, parent] @ self.rotations[:, bone]
            places[:, bone] = places[:, parent] + worlds[:, parent] @ self.skeleton.offsets[bone]
        return worlds, places


def to_world(recording: Recording, axes: str, metres: float) -> Recording:
    """A recording in a file's axes and unit, brought to the world's.

    Parameters
    ----------
    axes : the world axis of the file's X, Y and Z: "yzx" for Y up
    metres : length of the file's unit
    """
    turn = columns_to_world(np.eye(3), axes).T
    if np.linalg.det(turn) < 0:
        raise InputError("axes", expected="a cyclic order (xyz, yzx or zxy): others mirror the body", got=repr(axes))
    old = recording.skeleton
    skeleton = Skeleton(old.names, old.parents, metres * old.offsets @ turn.T, metres * old.tips @ turn.T)
    rotations = turn @ recording.rotations @ turn.T
    return Recording(skeleton, recording.times, rotations, metres * recording.root_places @ turn.T)


def guess_metres(skeleton: Skeleton, path: str | Path) -> float:
    """The length of a file's unit: that of `METRES` in which the rest posture is as large as a person.

    Parameters
    ----------
    skeleton : Skeleton, in the file's unit
    path : named in the error
    """
    ends = np.concatenate([skeleton.rest_places, skeleton.rest_places + skeleton.tips])
    extent = float(np.ptp(ends, axis=0).max())
    for metres in METRES.values():
        if EXTENT[0] <= metres * extent <= EXTENT[1]:
            return metres
    raise InputError(
        f"unit of {path}",
        expected=f"a person of {EXTENT[0]:g} to {EXTENT[1]:g} m in one of {', '.join(METRES)}",
        got=f"a rest posture {extent:g} units large",
        remedy="give the unit's length in metres as `scale`",
    )


def turns(axes: Sequence[int], angles: np.ndarray) -> np.ndarray:
    """Rotations about coordinate axes, multiplied from left to right.

    Parameters
    ----------
    axes : k of 0, 1, 2
    angles : (..., k) radians

    Returns
    -------
    (..., 3, 3)
    """
    product = np.broadcast_to(np.eye(3), (*angles.shape[:-1], 3, 3)).copy()
    for column, axis in enumerate(axes):
        product = product @ _about(axis, angles[..., column])
    return product


def read_lines(path: str | Path) -> list[str]:
    """The lines of a text file, without their ends."""
    try:
        return Path(path).read_text(encoding="utf-8-sig", errors="replace").splitlines()
    except OSError as error:
        raise InputError(f"motion file {path}", expected="a readable file", got=error.strerror or "an error") from error


def numbers(words: Sequence[str], where: str, count: int | None = None) -> list[float]:
    """Words as finite numbers, `count` of them; `where` names them in the error."""
    if count is not None and len(words) != count:
        raise InputError(where, expected=f"{count} number{'s' * (count != 1)}", got=f"{len(words)}")
    try:
        values = [float(word) for word in words]
    except ValueError as error:
        raise InputError(where, expected="numbers", got=repr(" ".join(words)[:40])) from error
    if not np.isfinite(values).all():
        raise InputError(where, expected="finite numbers", got=repr(" ".join(words)[:40]), remedy="fill the gap first")
    return values


def _about(axis: int, angle: np.ndarray) -> np.ndarray:
    """(..., 3, 3): right-handed turns about a coordinate axis."""
    first, second = (axis + 1) % 3, (axis + 2) % 3
    out = np.zeros((*angle.shape, 3, 3))
    out[..., axis, axis] = 1.0
    out[..., first, first] = out[..., second, second] = np.cos(angle)
    out[..., second, first] = np.sin(angle)
    out[..., first, second] = -out[..., second, first]
    return out
