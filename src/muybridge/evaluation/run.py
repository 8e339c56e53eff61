"""Evaluate a run folder, or any joints file, against the truth."""

from __future__ import annotations

from pathlib import Path

from muybridge.errors import InputError
from muybridge.evaluation.alignment import Alignment
from muybridge.evaluation.joints import JointErrors, joint_errors
from muybridge.evaluation.matching import MatchBy
from muybridge.evaluation.truth import read_truth


def evaluate(
    run: str | Path,
    truth: str | Path,
    alignment: Alignment = "none",
    *,
    match_by: MatchBy = "frame",
    offset: float = 0.0,
    axes: str | None = None,
) -> JointErrors:
    """How far a run's joints are from the truth.

    Parameters
    ----------
    run : str or Path
        A run folder with joints.csv, or such a file.
    truth : str or Path
        joints.csv, an office scene's truth_joints.csv (or its folder), or a .trc file.
    alignment : {"none", "root", "rigid", "similarity"}
        What is forgiven; the result names it.
    match_by : {"frame", "time"}
        How frames find each other.
    offset : float
        Added to the truth's frame numbers or times before matching.
    axes : str, optional
        For TRC truth: the world axis of file X, Y and Z, e.g. "yzx".

    Returns
    -------
    JointErrors
    """
    run = Path(run)
    joints = run / "joints.csv" if run.is_dir() else run
    if not joints.is_file():
        raise InputError(f"run {run}", expected="a folder with joints.csv", got="none", remedy="did the run finish?")
    return joint_errors(read_truth(joints), read_truth(truth, axes=axes), alignment, match_by=match_by, offset=offset)
