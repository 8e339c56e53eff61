"""Figures that need no statistics: the likelihood over two degrees of freedom (Fig. 5.4), distances between Fourier
descriptors of poses (Fig. 5.3), joint angles of a walk against the truth (Fig. 7.7).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from muybridge.evaluation.angles import angle_deviations, joint_angles
from muybridge.experiments.bodies import start_pose
from muybridge.experiments.clips import Evidence, evidence_of
from muybridge.experiments.du_2005.conditions import THREE_CUES, at_shape, working
from muybridge.experiments.experiment import Case, Outcome, Part, Report, Scale
from muybridge.experiments.scenes import right_body
from muybridge.experiments.tables import Cell, Column, Table
from muybridge.experiments.trial import EVIDENCE, Clip
from muybridge.io.run_folder import read_joints
from muybridge.likelihood.cues import CueWeights
from muybridge.likelihood.observation import ImageLikelihood
from muybridge.plotting.angles import plot_joint_angles
from muybridge.plotting.experiments import plot_distance_matrix, plot_surface
from muybridge.plotting.style import new_figure

STEPS, REACH_DEG = 41, 60.0
QUICK_STEPS = 21
#: Degrees of freedom that are turned: a pair that a side view sees well.
TURNED = ("right_hip_flexion", "right_knee_flexion")
POSES = 6  # of Fig. 5.3, evenly over the clip
SHOWN: dict[str, CueWeights] = {
    "silhouette": CueWeights(silhouette_kind="iou"),
    "colour": CueWeights(silhouette=0.0, colour=1.0),
    "boundary": CueWeights(silhouette=0.0, boundary=1.0),
    "three cues fused": THREE_CUES,
}


def side_walk(scale: Scale) -> Clip:
    """The first walk seen from the side, with pictures."""
    return scale.walks(view="side", seeds=1)[0]


def surface_report(outcome: Outcome) -> Report:
    """p over hip and knee of one leg, the others being true, for each cue and their fusion."""
    evidence = evidence_of(side_walk(outcome.scale), outcome.folder / EVIDENCE, pictures=True)
    degrees = np.linspace(-REACH_DEG, REACH_DEG, QUICK_STEPS if outcome.scale.quick else STEPS)
    figure, axes = new_figure(2, 2, width=9.0, height=7.4)
    rows: list[tuple[Cell, ...]] = []
    for ax, (label, cues) in zip(np.ravel(axes), SHOWN.items(), strict=True):
        values = likelihood_surface(evidence, cues, degrees)
        plot_surface(ax, degrees, degrees, values, (named(TURNED[0]), named(TURNED[1])), label.capitalize())
        best = np.unravel_index(int(np.argmax(values)), values.shape)
        rows.append((label, degrees[best[0]], degrees[best[1]], float(values.max()), _hills(values)))
    columns = (
        Column("cue"),
        Column(f"highest: {named(TURNED[0])}, deg", 0),
        Column(f"highest: {named(TURNED[1])}, deg", 0),
        Column("p there", 3),
        Column("local maxima", 0),
    )
    note = "Side view, first frame, right body, own mask; 0 is the truth."
    table = Table("surface", "Likelihood over two degrees of freedom (Fig. 5.4)", columns, tuple(rows), (note,))
    return Report((table,), {"surface": figure})


def likelihood_surface(evidence: Evidence, cues: CueWeights, degrees: np.ndarray) -> np.ndarray:
    """p (n, n) of the first frame with `TURNED` off by degrees (n,) each; beyond a joint's limits as well."""
    body = right_body(evidence.clip)
    model = ImageLikelihood(body, evidence.rig, evidence.reductions, cues=cues)
    true = start_pose(body, evidence)
    observation = model.observe([view[0] for view in evidence.own], [view[0] for view in evidence.pictures])
    if cues.colour:
        observation = replace(observation, reference=observation.first_reference(true))
    poses = np.tile(true, (len(degrees) ** 2, 1))
    first, second = np.meshgrid(np.radians(degrees), np.radians(degrees), indexing="ij")
    for name, turned in zip(TURNED, (first, second), strict=True):
        poses[:, body.dof_names.index(name)] += turned.ravel()
    return np.exp(observation.log_prob(poses)).reshape(first.shape)


def _hills(values: np.ndarray) -> int:
    """Strict local maxima (n, n) among the eight neighbours."""
    from scipy.ndimage import maximum_filter

    ring = np.ones((3, 3), bool)
    ring[1, 1] = False
    return int(np.count_nonzero(values > maximum_filter(values, footprint=ring, mode="nearest")))


def named(dof: str) -> str:
    """A degree of freedom as people say it."""
    return dof.replace("_", " ")


def distance_report(outcome: Outcome) -> Report:
    """Distances between the Fourier descriptors of observed silhouettes and of drawn poses."""
    evidence = evidence_of(side_walk(outcome.scale), outcome.folder / EVIDENCE)
    frames = np.linspace(0, len(evidence.joints) - 1, POSES).round().astype(int)
    distances = descriptor_distances(evidence, frames)
    labels = [str(frame) for frame in frames]
    figure, axes = new_figure(width=4.6, height=4.4)
    plot_distance_matrix(axes[0, 0], distances, labels, "Fourier descriptors (Fig. 5.3)")
    columns = (Column("drawn \\ observed"), *(Column(f"frame {label}", 1) for label in labels))
    rows: list[tuple[Cell, ...]] = [
        (f"frame {label}", *(float(v) for v in row)) for label, row in zip(labels, distances, strict=True)
    ]
    right = int(np.sum(distances.argmin(axis=0) == np.arange(len(frames))))
    notes = (
        "Own masks against the right body drawn at the true joints.",
        f"{right} of {len(frames)} observed silhouettes are nearest to their own pose.",
    )
    table = Table("descriptors", "Distances between Fourier descriptors, pixels", columns, tuple(rows), notes)
    return Report((table,), {"descriptors": figure})


def descriptor_distances(evidence: Evidence, frames: np.ndarray) -> np.ndarray:
    """(n, n) pixels, ||FD - FD'|| of (5.11): row the body drawn at a frame's true joints, column the mask observed."""
    body = right_body(evidence.clip)
    model = ImageLikelihood(body, evidence.rig, evidence.reductions, cues=CueWeights(silhouette=0, boundary=1))
    poses = np.array([pose_at(evidence, frame) for frame in frames])
    columns = []
    for frame in frames:
        observation = model.observe([view[frame] for view in evidence.own])
        (cue,) = observation.fusion.cues
        columns.append(-cue.log_prob(poses) / cue.rho)  # type: ignore[attr-defined]
    return np.array(columns).T


def pose_at(evidence: Evidence, frame: int) -> np.ndarray:
    """The right body's pose (D,) nearest to a frame's true joints."""
    later = replace(evidence, joints=evidence.joints[frame:])
    return start_pose(right_body(evidence.clip), later)


def angle_cases(scale: Scale) -> Iterator[Case]:
    """Walking seen from the side by DE-MC 500 x 7 and the default filter; the same walk by three cameras."""
    side, ring = side_walk(scale), scale.walks(seeds=1)[0]
    for seen, clip, default in (
        ("one camera", side, at_shape("annealed", side)),
        ("three cameras", ring, working("guided", ring)),
    ):
        for label, trial in (("DE-MC 500 x 7", at_shape("demc", clip)), ("default filter", default)):
            yield Case(f"{label}, {seen}", replace(trial, clip=clip, seed=clip.seed, keep_track=True))


def angle_report(outcome: Outcome) -> Report:
    """Eight curves with two standard deviations, the truth dashed, for each filter."""
    figures, rows = {}, []
    for row in outcome.rows:
        trial = row.case.trial
        series = read_joints(trial.track_file(outcome.folder))
        truth = evidence_of(trial.clip, outcome.folder / EVIDENCE).truth
        found = joint_angles(series.positions, series.names)
        spread = angle_deviations(series.positions, series.sd, series.names)
        true = joint_angles(truth.positions, truth.names)
        figure, axes = new_figure(2, 2, width=9.0, height=5.6)
        plot_joint_angles(axes, series.times, found, spread, (truth.times, true))
        figure.suptitle(row.case.label, x=0.01, ha="left", fontsize=10)
        figures["angles-" + row.case.label.replace(" ", "-").replace(",", "")] = figure
        inside = np.abs(np.mod(found - true + np.pi, 2 * np.pi) - np.pi) <= 2 * spread
        rows.append((row.case.label, row.result.angle_deg, float(np.mean(inside))))
    columns = (Column("run"), Column("angle error, deg"), Column("truth within 2 sd", 0, percent=True))
    return Report((Table("angles", "Joint angles of a walk (Fig. 7.7)", columns, tuple(rows)),), figures)


SURFACE = Part("surface", "The likelihood over two degrees of freedom (Fig. 5.4)", surface_report)
DESCRIPTORS = Part("descriptors", "Fourier descriptors of poses (Fig. 5.3)", distance_report)
ANGLES = Part("angles", "Joint angles against the truth (Fig. 7.7)", angle_report, angle_cases)
