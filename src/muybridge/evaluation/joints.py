"""Errors of estimated joints against true ones: millimetres, per joint and frame, with the alignment named.

A mean hides the event (a limb lost for thirty frames, legs swapped), so the events are counted beside it.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from muybridge.errors import InputError
from muybridge.evaluation.alignment import Alignment, align
from muybridge.evaluation.calibration import DeviationCalibration, calibrate_deviations
from muybridge.evaluation.matching import MatchBy, Overlap, match
from muybridge.evaluation.names import mirrored, root_joints
from muybridge.io.run_folder import JointSeries

LOST_FRAME_MM = 200.0
"""A frame whose mean error is above this has lost the person."""
LOST_WRIST_MM = 200.0
"""A wrist farther off than this is a lost arm."""
SWAP_MARGIN_MM = 50.0
"""Legs count as swapped where exchanging their names lowers the mean error of knees and ankles by more than this: legs
that pass each other are a few centimetres apart, and noise alone would exchange them in half of those frames."""
SWAP_JOINTS = ("left_knee", "left_ankle", "right_knee", "right_ankle")


@dataclass(frozen=True)
class JointStatistics:
    """One joint's error over the frames: millimetres; `bias_mm` is the mean of estimate - truth along world x, y, z."""

    joint: str
    count: int
    mean_mm: float
    median_mm: float
    p95_mm: float
    worst_mm: float
    worst_frame: int
    bias_mm: tuple[float, float, float]


@dataclass(frozen=True)
class JointErrors:
    """How far a track is from the truth.

    Attributes
    ----------
    alignment : str
        What was forgiven before distances were taken: none, root, rigid or similarity.
    overlap : Overlap
        Which frames and joints were compared.
    frames : (T,) int64
    times : (T,) float64, seconds
    errors_mm : (T, J) float64
        Distances; NaN where either joint is missing.
    joints : tuple of JointStatistics
    mean_mm, median_mm, p95_mm : float
        Over all joints and frames.
    worst_frame, worst_frame_mm : int, float
        The frame with the largest mean error.
    worst_joint_mm : float
        The largest single error.
    missing : int
        Joints of compared frames that the estimate or the truth leaves out.
    lost_share : float
        Share of frames with a mean error above 200 mm.
    lost_wrists : dict
        Share of frames in which each wrist is more than 200 mm off.
    swapped_frames : tuple of int
        Frames in which left and right leg fit better exchanged.
    calibration : DeviationCalibration or None
        None where the estimate states no deviations.
    """

    alignment: str
    overlap: Overlap
    frames: np.ndarray
    times: np.ndarray
    errors_mm: np.ndarray
    joints: tuple[JointStatistics, ...]
    mean_mm: float
    median_mm: float
    p95_mm: float
    worst_frame: int
    worst_frame_mm: float
    worst_joint_mm: float
    missing: int
    lost_share: float
    lost_wrists: dict[str, float]
    swapped_frames: tuple[int, ...]
    calibration: DeviationCalibration | None

    @property
    def frame_means_mm(self) -> np.ndarray:
        """Mean error of each frame (T,), millimetres; NaN where a frame has no joint."""
        return _row_means(self.errors_mm)

    def to_table(self) -> str:
        """Everything as plain text, one joint a line."""
        from muybridge.evaluation.table import error_table

        return error_table(self)

    def to_dict(self) -> dict:
        """Everything but the single distances, for JSON."""
        skipped = ("frames", "times", "errors_mm", "joints", "overlap", "calibration")
        plain = {name: value for name, value in vars(self).items() if name not in skipped}
        plain["swapped_frames"] = list(self.swapped_frames)
        plain["joints"] = {
            joint.joint: {k: v for k, v in asdict(joint).items() if k != "joint"} for joint in self.joints
        }
        plain["overlap"] = asdict(self.overlap)
        plain["calibration"] = asdict(self.calibration) if self.calibration else None
        return plain


def joint_errors(
    estimate: JointSeries,
    truth: JointSeries,
    alignment: Alignment = "none",
    *,
    match_by: MatchBy = "frame",
    offset: float = 0.0,
) -> JointErrors:
    """Compare two series over the frames and joints they share.

    Parameters
    ----------
    estimate, truth : JointSeries
    alignment : {"none", "root", "rigid", "similarity"}
    match_by : {"frame", "time"}
    offset : float
        Added to the truth's frame numbers or times before matching.

    Returns
    -------
    JointErrors

    Raises
    ------
    InputError
        If nothing is shared, or the alignment needs joints that are not there.
    """
    estimate, truth, overlap = match(estimate, truth, match_by, offset=offset)
    root = root_joints(estimate.names)
    if alignment == "root" and not root:
        raise InputError(
            "root alignment", expected="a pelvis or both hips among the joints compared", got=", ".join(estimate.names)
        )
    aligned = align(estimate.positions, truth.positions, alignment, root)
    differences = 1000.0 * (aligned - truth.positions)
    errors = np.linalg.norm(differences, axis=-1)
    if not np.isfinite(errors).any():
        raise InputError("estimate and truth", expected="at least one joint known in both", got="none after alignment")
    return _summary(estimate, truth, overlap, alignment, aligned, differences, errors)


def _summary(
    estimate: JointSeries,
    truth: JointSeries,
    overlap: Overlap,
    alignment: str,
    aligned: np.ndarray,
    differences: np.ndarray,
    errors: np.ndarray,
) -> JointErrors:
    frame_means = _row_means(errors)
    worst = int(np.nanargmax(frame_means))
    known = errors[np.isfinite(errors)]
    return JointErrors(
        alignment=alignment,
        overlap=overlap,
        frames=estimate.frames,
        times=estimate.times,
        errors_mm=errors,
        joints=tuple(
            _statistics(name, estimate.frames, errors[:, j], differences[:, j]) for j, name in enumerate(estimate.names)
        ),
        mean_mm=float(known.mean()),
        median_mm=float(np.median(known)),
        p95_mm=float(np.percentile(known, 95)),
        worst_frame=int(estimate.frames[worst]),
        worst_frame_mm=float(frame_means[worst]),
        worst_joint_mm=float(known.max()),
        missing=int(errors.size - known.size),
        lost_share=_share_above(frame_means, LOST_FRAME_MM),
        lost_wrists={
            name: _share_above(errors[:, estimate.names.index(name)], LOST_WRIST_MM)
            for name in ("left_wrist", "right_wrist")
            if name in estimate.names
        },
        swapped_frames=tuple(
            int(frame) for frame in estimate.frames[swapped_legs(aligned, truth.positions, estimate.names)]
        ),
        calibration=calibrate_deviations(errors, 1000.0 * estimate.sd),
    )


def swapped_legs(
    estimate: np.ndarray, truth: np.ndarray, names: tuple[str, ...], margin_mm: float = SWAP_MARGIN_MM
) -> np.ndarray:
    """The frames in which the left leg was taken for the right one.

    Parameters
    ----------
    estimate, truth : (T, J, 3) float64, metres
    names : tuple of str
    margin_mm : float
        By how much the exchanged names must fit better.

    Returns
    -------
    (T,) bool
        All False where knees or ankles of a side are not compared.
    """
    pairs = [name for name in SWAP_JOINTS if name in names and mirrored(name) in names]
    if not pairs:
        return np.zeros(len(estimate), bool)
    own = [names.index(name) for name in pairs]
    other = [names.index(mirrored(name)) for name in pairs]
    straight = np.linalg.norm(estimate[:, own] - truth[:, own], axis=-1)
    crossed = np.linalg.norm(estimate[:, own] - truth[:, other], axis=-1)
    return np.nan_to_num(1000.0 * _row_means(straight - crossed), nan=0.0) > margin_mm


def _statistics(name: str, frames: np.ndarray, errors: np.ndarray, differences: np.ndarray) -> JointStatistics:
    known = np.isfinite(errors)
    if not known.any():
        nan = float("nan")
        return JointStatistics(name, 0, nan, nan, nan, nan, -1, (nan, nan, nan))
    found, worst = errors[known], int(np.nanargmax(errors))
    bias = differences[known].mean(axis=0)
    return JointStatistics(
        name,
        int(known.sum()),
        float(found.mean()),
        float(np.median(found)),
        float(np.percentile(found, 95)),
        float(errors[worst]),
        int(frames[worst]),
        (float(bias[0]), float(bias[1]), float(bias[2])),
    )


def _row_means(values: np.ndarray) -> np.ndarray:
    """Mean of each row over what is known in it; NaN where nothing is."""
    known = np.isfinite(values)
    return np.where(known, values, 0.0).sum(axis=1) / np.where(known.any(axis=1), known.sum(axis=1), np.nan)


def _share_above(values: np.ndarray, limit: float) -> float:
    known = values[np.isfinite(values)]
    return float(np.mean(known > limit)) if len(known) else float("nan")
