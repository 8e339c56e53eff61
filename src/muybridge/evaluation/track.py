"""Joints over time, and which frames and joints two such tracks share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from muybridge.errors import InputError

MatchBy = Literal["frame", "time"]


@dataclass(frozen=True)
class JointTrack:
    """Joints of one person over time.

    Attributes
    ----------
    names : tuple of str
        J joints.
    frames : (T,) int64
        Frame numbers from 0, rising.
    times : (T,) float64, seconds
        NaN where the source knows no times.
    positions : (T, J, 3) float64, metres, world
        NaN where missing.
    deviations : (T, J) float64, metres, or None
        One isotropic standard deviation a joint, the same along each axis.
    """

    names: tuple[str, ...]
    frames: np.ndarray
    times: np.ndarray
    positions: np.ndarray
    deviations: np.ndarray | None = None

    def __post_init__(self) -> None:
        shape = (len(self.frames), len(self.names), 3)
        if self.positions.shape != shape or len(self.times) != shape[0]:
            raise InputError("joint positions", expected=f"shape {shape}", got=f"{self.positions.shape}")
        if self.deviations is not None and self.deviations.shape != shape[:2]:
            raise InputError("joint deviations", expected=f"shape {shape[:2]}", got=f"{self.deviations.shape}")
        if np.any(np.diff(self.frames) <= 0):
            raise InputError(
                "frames of a joint track", expected="rising frame numbers", got="repeated or unordered ones"
            )

    def take(self, rows: np.ndarray, names: tuple[str, ...]) -> JointTrack:
        """The given rows and joints alone."""
        columns = np.array([self.names.index(name) for name in names], dtype=np.int64)
        deviations = None if self.deviations is None else self.deviations[np.ix_(rows, columns)]
        return JointTrack(names, self.frames[rows], self.times[rows], self.positions[np.ix_(rows, columns)], deviations)


@dataclass(frozen=True)
class Overlap:
    """What two tracks share, and what was left out of the comparison."""

    by: str
    frames: int
    estimate_frames: int
    truth_frames: int
    joints: tuple[str, ...]
    estimate_only: tuple[str, ...]
    truth_only: tuple[str, ...]

    @property
    def is_partial(self) -> bool:
        """True where frames of either track had no partner."""
        return self.frames < max(self.estimate_frames, self.truth_frames)

    def describe(self) -> str:
        """One line: how many frames and joints were compared, and what was not."""
        text = (
            f"{'partial overlap: ' if self.is_partial else ''}{self.frames} frames matched by {self.by} "
            f"(of {self.estimate_frames} estimated and {self.truth_frames} true), {len(self.joints)} joints"
        )
        for label, names in (("not in the truth", self.estimate_only), ("not estimated", self.truth_only)):
            text += f"; {label}: {', '.join(names)}" if names else ""
        return text


def match(
    estimate: JointTrack,
    truth: JointTrack,
    by: MatchBy = "frame",
    *,
    offset: float = 0.0,
    tolerance_s: float | None = None,
) -> tuple[JointTrack, JointTrack, Overlap]:
    """The frames and joints that both tracks have, in the same order.

    Parameters
    ----------
    estimate, truth : JointTrack
    by : {"frame", "time"}
        Equal frame numbers, or nearest times.
    offset : float
        Added to the truth's frame numbers (frames) or times (seconds) first.
    tolerance_s : float, optional
        Largest difference of two times that match; default half the truth's median step.

    Returns
    -------
    estimate, truth : JointTrack
        Of equal shape.
    overlap : Overlap

    Raises
    ------
    InputError
        If they share no frame or no joint.
    """
    names = tuple(name for name in estimate.names if name in truth.names)
    rows = (
        _rows_by_frame(estimate, truth, offset)
        if by == "frame"
        else _rows_by_time(estimate, truth, offset, tolerance_s)
    )
    if not names or not len(rows[0]):
        raise InputError(
            "estimate and truth",
            expected="frames and joints in common",
            got=f"{len(rows[0])} frames and {len(names)} joints",
            remedy=_advice(estimate, truth, by),
        )
    overlap = Overlap(
        by,
        len(rows[0]),
        len(estimate.frames),
        len(truth.frames),
        names,
        tuple(name for name in estimate.names if name not in names),
        tuple(name for name in truth.names if name not in names),
    )
    return estimate.take(rows[0], names), truth.take(rows[1], names), overlap


def _rows_by_frame(estimate: JointTrack, truth: JointTrack, offset: float) -> tuple[np.ndarray, np.ndarray]:
    _, rows, true_rows = np.intersect1d(estimate.frames, truth.frames + int(offset), return_indices=True)
    return rows, true_rows


def _rows_by_time(
    estimate: JointTrack, truth: JointTrack, offset: float, tolerance_s: float | None
) -> tuple[np.ndarray, np.ndarray]:
    """Each true frame with the estimated frame nearest in time, where both choose each other."""
    if np.isnan(estimate.times).any() or np.isnan(truth.times).any():
        raise InputError("matching by time", expected="times in both files", got="none in one", remedy="match by frame")
    times = truth.times + offset
    gaps = np.abs(times[:, None] - estimate.times[None])
    step = np.median(np.diff(times)) if len(times) > 1 else np.inf
    nearest, back = gaps.argmin(axis=1), gaps.argmin(axis=0)
    true_rows = np.arange(len(times))
    limit = step / 2 if tolerance_s is None else tolerance_s
    keep = (back[nearest] == true_rows) & (gaps[true_rows, nearest] <= limit + 1e-9)
    return nearest[keep], true_rows[keep]


def _advice(estimate: JointTrack, truth: JointTrack, by: MatchBy) -> str:
    if not len(estimate.frames) or not len(truth.frames):
        return "one of them is empty"
    if not set(estimate.names) & set(truth.names):
        return f"the truth's joints are {', '.join(truth.names[:6])}"
    if by == "frame":
        estimated, true = estimate.frames[[0, -1]], truth.frames[[0, -1]]
        return f"frames are {estimated[0]}-{estimated[1]} and {true[0]}-{true[1]}; give an offset"
    return (
        f"times are {estimate.times[0]:.3f}-{estimate.times[-1]:.3f} s and "
        f"{truth.times[0]:.3f}-{truth.times[-1]:.3f} s; give an offset"
    )
