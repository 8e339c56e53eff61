"""Which way the person is thought to face with one camera, and for how long wrongly: what memory costs, and gives.

A silhouette from ahead is nearly one from behind. Detection alone (AGP) chooses anew in every frame; a filter goes on
with what it chose.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from muybridge.evaluation.joints import joint_errors
from muybridge.experiments.clips import evidence_of
from muybridge.experiments.experiment import Case, Outcome, Part, Report, Row, Scale
from muybridge.experiments.sedai_2013.conditions import one_camera, over, working
from muybridge.experiments.tables import Cell, Column, Table
from muybridge.experiments.trial import EVIDENCE
from muybridge.io.run_folder import JointSeries, read_joints

SEEDS = 3
TURNED = 90.0  # degrees from the true direction, seen from above


def cases(scale: Scale) -> Iterator[Case]:
    """Detection alone, tracking alone and both, one camera; tracks are kept."""
    clips = one_camera(scale.clips(seeds=scale.few(SEEDS)))
    for name in ("AGP-PF", "AGP", "APF"):
        yield from over(clips, name, replace(working(name, scale, clips[0]), keep_track=True))


def report(outcome: Outcome) -> Report:
    """Shares of turned frames, how long they last, and the error in them and in the others; by motion."""
    columns = (Column("filter"), Column("motion"), Column("turned", 1, percent=True), Column("frames at a time", 1),
               Column("root error turned, mm"), Column("root error else, mm"), Column("runs", 0))  # fmt: skip
    rows: list[tuple[Cell, ...]] = []
    for label, group in outcome.groups().items():
        for motion in sorted({row.case.trial.clip.motion for row in group}):
            rows.append((label, motion, *_summary(outcome, [r for r in group if r.case.trial.clip.motion == motion])))
    notes = (f"Turned: the estimate faces more than {TURNED:g} degrees from the true direction. A time begins and ends "
             "where that changes; frames are of 60 Hz. Errors are of all joints, alignment root.",)  # fmt: skip
    return Report((Table("facing", "Which way the person faces, one camera", columns, tuple(rows), notes),))


def _summary(outcome: Outcome, rows: Sequence[Row]) -> tuple[Cell, ...]:
    turned, errors = zip(*(_judged(outcome, row) for row in rows), strict=True)
    begun = sum(np.count_nonzero(np.diff(flags.astype(int), prepend=0) > 0) for flags in turned)
    every, error = np.concatenate(turned), np.concatenate(errors)
    spell = float(every.sum() / begun) if begun else float("nan")
    means = [float(error[flags].mean()) if flags.any() else float("nan") for flags in (every, ~every)]
    return float(every.mean()), spell, *means, len(rows)


def _judged(outcome: Outcome, row: Row) -> tuple[np.ndarray, np.ndarray]:
    """Of each frame (T,): whether the estimate is turned, and its root-aligned error in mm."""
    series = read_joints(row.case.trial.track_file(outcome.folder))
    truth = evidence_of(row.case.trial.clip, outcome.folder / EVIDENCE).truth
    return turned_frames(series, truth), joint_errors(series, truth, "root").frame_means_mm


def turned_frames(series: JointSeries, truth: JointSeries) -> np.ndarray:
    """(T,) bool: the estimate faces more than `TURNED` degrees from the truth; both of the same frames."""
    cosine = (_facing(series) * _facing(truth)).sum(axis=1)
    return cosine < np.cos(np.radians(TURNED))


def _facing(series: JointSeries) -> np.ndarray:
    """(T, 2) unit vectors in the floor from the right hip to the left: square to where the person faces."""
    left, right = (series.positions[:, series.names.index(f"{side}_hip"), :2] for side in ("left", "right"))
    across = left - right
    return across / np.linalg.norm(across, axis=1, keepdims=True)


FACING = Part("facing", "Which way the person is thought to face, one camera", report, cases)
