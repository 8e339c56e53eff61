"""Which frames and joints two series share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from muybridge.errors import InputError
from muybridge.io.run_folder import JointSeries

MatchBy = Literal["frame", "time"]


@dataclass(frozen=True)
class Overlap:
    """What two series share, and what was left out of the comparison."""

    by: str
    frames: int
    estimate_frames: int
    truth_frames: int
    joints: tuple[str, ...]
    estimate_only: tuple[str, ...]
    truth_only: tuple[str, ...]

    @property
    def is_partial(self) -> bool:
        """True where frames of either series had no partner."""
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
    estimate: JointSeries,
    truth: JointSeries,
    by: MatchBy = "frame",
    *,
    offset: float = 0.0,
    tolerance_s: float | None = None,
) -> tuple[JointSeries, JointSeries, Overlap]:
    """The frames and joints that both series have, in the same order.

    Parameters
    ----------
    estimate, truth : JointSeries
    by : {"frame", "time"}
        Equal frame numbers, or nearest times.
    offset : float
        Added to the truth's frame numbers (frames) or times (seconds) first.
    tolerance_s : float, optional
        Largest difference of two times that match; default half the truth's median step.

    Returns
    -------
    estimate, truth : JointSeries
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
    return take(estimate, rows[0], names), take(truth, rows[1], names), overlap


def take(series: JointSeries, rows: np.ndarray, names: tuple[str, ...]) -> JointSeries:
    """The given rows and joints alone."""
    cells = np.ix_(rows, np.array([series.names.index(name) for name in names], dtype=np.int64))
    return JointSeries(names, series.frames[rows], series.times[rows], series.positions[cells], series.sd[cells])


def _rows_by_frame(estimate: JointSeries, truth: JointSeries, offset: float) -> tuple[np.ndarray, np.ndarray]:
    _, rows, true_rows = np.intersect1d(estimate.frames, truth.frames + int(offset), return_indices=True)
    return rows, true_rows


def _rows_by_time(
    estimate: JointSeries, truth: JointSeries, offset: float, tolerance_s: float | None
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


def _advice(estimate: JointSeries, truth: JointSeries, by: MatchBy) -> str:
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
