"""What the numbers of a pose vector are: names, which of them wrap around, which one is the person's heading."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray


@dataclass(frozen=True)
class PoseComponents:
    """The D numbers that are regressed, all of them angles in radians.

    Parameters
    ----------
    names : D names, each once
    circular : indices of those that may take any angle, so that pi and -pi are the same
    heading : index of the turn about the vertical, which changes when the camera goes round; it is circular
    """

    names: tuple[str, ...]
    circular: tuple[int, ...] = ()
    heading: int | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "names", tuple(self.names))
        object.__setattr__(self, "circular", tuple(sorted(int(index) for index in self.circular)))
        count = len(self.names)
        if count == 0 or len(set(self.names)) < count:
            raise InputError("pose components", expected="at least one name, each once", got=repr(self.names))
        if not all(0 <= index < count for index in self.circular):
            raise InputError("circular components", expected=f"indices 0 to {count - 1}", got=str(self.circular))
        if self.heading is not None and self.heading not in self.circular:
            raise InputError("heading", expected="one of the circular components", got=str(self.heading))

    def __len__(self) -> int:
        return len(self.names)

    @cached_property
    def _wraps(self) -> np.ndarray:
        wraps = np.zeros(len(self.names), bool)
        wraps[list(self.circular)] = True
        return wraps

    def wrapped(self, values: FloatArray) -> FloatArray:
        """The same poses, or differences of poses, (..., D), with what is circular in [-pi, pi)."""
        out: FloatArray = np.where(self._wraps, np.mod(values + np.pi, 2 * np.pi) - np.pi, values)
        return out

    def middle(self, poses: FloatArray) -> FloatArray:
        """(D,) mean of poses (N, D): of what is circular the mean direction."""
        turning = np.arctan2(np.sin(poses).mean(axis=0), np.cos(poses).mean(axis=0))
        out: FloatArray = np.where(self._wraps, turning, poses.mean(axis=0))
        return out

    def on_circles(self, poses: FloatArray) -> FloatArray:
        """(N, D + circular): poses with cosine and sine in place of what is circular, so that distances make sense."""
        turning = poses[:, self._wraps]
        return np.concatenate([np.cos(turning), np.sin(turning), poses[:, ~self._wraps]], axis=1)

    def checked(self, what: str, poses: Sequence | FloatArray) -> FloatArray:
        """Poses as an (N, D) float64 array, finite."""
        array = np.asarray(poses, dtype=np.float64)
        if array.ndim != 2 or array.shape[1] != len(self) or not np.isfinite(array).all():
            got = f"shape {array.shape}{'' if np.isfinite(array).all() else ', nan or infinity'}"
            raise InputError(what, expected=f"shape (N, {len(self)}), finite", got=got)
        return array
