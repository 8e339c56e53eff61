"""Table IV (AGP-PF, AGP, APF), Fig. 10 (particles), recovery, Fig. 14 (knee flexion)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from muybridge.evaluation.angles import angle_deviations, joint_angles
from muybridge.experiments.clips import evidence_of
from muybridge.experiments.experiment import LOST_MM, Case, Outcome, Part, Report, Row, Scale
from muybridge.experiments.sedai_2013.conditions import NAMES, guided, one_camera, over, printed, working
from muybridge.experiments.statistics import over_seeds
from muybridge.experiments.summaries import (
    SUMMARY_NOTES,
    coverage_table,
    difference_table,
    error,
    free_error,
    root_aligned,
    values,
)
from muybridge.experiments.tables import Cell, Column, Table
from muybridge.experiments.trial import EVIDENCE, Clip
from muybridge.io.run_folder import read_joints
from muybridge.plotting.angles import plot_joint_angles
from muybridge.plotting.experiments import plot_budgets, plot_intervals
from muybridge.plotting.style import new_figure

CAMERAS = {3: "three cameras", 1: "one camera"}
#: By cameras, what filters are judged by: one camera hardly tells how far away the person is.
JUDGED = {3: ("none", free_error), 1: ("root", root_aligned)}
REFERENCE = "AGP-PF"
DEFAULT = "guided with guesses"
PRINTED_SEEDS, CURVE_SEEDS, RECOVERY_SEEDS = 3, 3, 5
PARTICLES = (50, 100, 200, 300, 500, 1000)
GAP = (30, 89)  # one second at 60 Hz
RECOVERED, STAYS = 1.5, 3  # times the usual error, for so many frames in a row


def cases_of_table(scale: Scale) -> Iterator[Case]:
    """Everybody who was not learnt from, three cameras and one, no first pose."""
    for cameras in CAMERAS:
        clips = seen_by(cameras, scale.clips())
        for name in NAMES:
            yield from over(clips, name, working(name, scale, clips[0]))
        yield from over(clips, DEFAULT, guided(scale, clips[0]))


def cases_of_printed(scale: Scale) -> Iterator[Case]:
    """The same clips of the first seeds with the settings as printed: edges make a trial dear."""
    for cameras in CAMERAS:
        clips = seen_by(cameras, scale.clips(seeds=scale.few(PRINTED_SEEDS)))
        for name in NAMES:
            yield from over(clips, name, printed(name, scale, clips[0]))


def seen_by(cameras: int, clips: Sequence[Clip]) -> tuple[Clip, ...]:
    """The clips before three cameras or one."""
    return tuple(clips) if cameras == 3 else one_camera(clips)


def report_of_table(outcome: Outcome, prefix: str = "table4", title: str = "Table IV") -> Report:
    """Mean and spread of the error, alignment none and root; paired differences from AGP-PF; coverage."""
    tables: list[Table] = []
    figures = {}
    for cameras, seen in CAMERAS.items():
        rows = [row for row in outcome.rows if row.case.trial.clip.cameras == cameras]
        groups = outcome.groups(rows)
        name = f"{prefix}-{'three' if cameras == 3 else 'one'}"
        tables.append(error_table(name, f"{title}, {seen}", groups))
        alignment, value = JUDGED[cameras]
        heading = f"{title}, {seen}: differences, alignment {alignment}"
        tables.append(difference_table(f"{name}-paired", heading, groups, REFERENCE, value))
        tables.append(coverage_table(f"{name}-coverage", f"{title}, {seen}: is the stated spread true?", groups))
        if cameras == 1:
            tables.append(place_table(f"{name}-place", f"{title}, {seen}: where the place is wrong", groups))
        found = [over_seeds(values(group, value)) for group in groups.values()]
        figure, axes = new_figure(height=1.1 + 0.3 * len(groups))
        plot_intervals(axes[0, 0], list(groups), [i.mean for i in found], [i.low for i in found],
                       [i.high for i in found], f"{title}: {seen}, alignment {alignment}")  # fmt: skip
        figures[name] = figure
    return Report(tuple(tables), figures)


def report_of_printed(outcome: Outcome) -> Report:
    """The same tables of the settings as printed."""
    return report_of_table(outcome, "printed", "Table IV as printed")


def error_table(name: str, title: str, groups: Mapping[str, Sequence[Row]]) -> Table:
    """Mean and standard deviation over frames as the paper has them; root-aligned; what was lost; the cost."""
    columns = (Column("filter"), Column("error mm"), Column("sd over frames mm"), Column("root-aligned mm"),
               Column("angles deg"), Column("frames lost", 1, percent=True), Column("evaluations", 0),
               Column("CPU ms a frame", 0), Column("runs", 0))  # fmt: skip
    rows: list[tuple[Cell, ...]] = []
    for label, group in groups.items():
        frames = np.concatenate([np.minimum(row.result.frame_mm, LOST_MM) for row in group])
        root = over_seeds(values(group, root_aligned))
        angles = over_seeds(values(group, lambda row: row.result.angle_deg))
        lost = float(np.mean([row.result.lost_share for row in group]))
        evaluations = float(np.mean([row.result.evaluations for row in group]))
        cost = float(np.median([row.result.ms for row in group]))
        rows.append((label, error(group), float(frames.std()), root, angles, lost, evaluations, cost, len(group)))
    return Table(name, title, columns, tuple(rows), SUMMARY_NOTES)


def place_table(name: str, title: str, groups: Mapping[str, Sequence[Row]]) -> Table:
    """Root-aligned error in the quarter of clips whose place is nearest the truth, and so on to the furthest."""
    named = ("nearest", "second", "third", "furthest")
    columns = (Column("filter"), *(Column(f"{which} quarter, mm") for which in named),
               *(Column(f"place of the {which}, mm", 0) for which in named))  # fmt: skip
    rows: list[tuple[Cell, ...]] = []
    for label, group in groups.items():
        by_place = sorted(group, key=lambda row: row.result.place_mm)
        quarters = [[by_place[k] for k in part] for part in np.array_split(np.arange(len(by_place)), len(named))]
        means = [[float(np.mean([getattr(row.result, value) for row in part])) if part else float("nan")
                  for part in quarters] for value in ("root_mm", "place_mm")]  # fmt: skip
        rows.append((label, *means[0], *means[1]))
    notes = ("Alignment root; clips by the mean error of the pelvis, alignment none, in quarters of each filter's own "
             "clips. One camera hardly tells how far away a person is.",)  # fmt: skip
    return Table(name, title, columns, tuple(rows), notes)


def cases_of_curve(scale: Scale) -> Iterator[Case]:
    """Walks, three cameras; with one layer GP-PF and PF take a fifth of the evaluations for as many particles."""
    clips = scale.walks(seeds=CURVE_SEEDS)
    counts = PARTICLES[::2] if scale.quick else PARTICLES
    for name in ("AGP-PF", "APF", "GP-PF", "PF"):
        for count in counts:
            yield from over(clips, name, working(name, scale, clips[0], particles=count), count)


def report_of_curve(outcome: Outcome) -> Report:
    """Error against the number of particles, and against evaluations."""
    figure, axes = new_figure(width=6.4, height=3.8)
    curves, rows = {}, []
    for label, group in outcome.groups().items():
        by_count: dict[float, list[Row]] = {}
        for row in group:
            by_count.setdefault(row.case.x, []).append(row)
        found = {count: error(members) for count, members in sorted(by_count.items())}
        counted = [float(np.mean([row.result.evaluations for row in by_count[count]])) for count in found]
        means = np.array([interval.mean for interval in found.values()])
        low, high = (np.array([np.nan_to_num(getattr(i, end), nan=i.mean) for i in found.values()])
                     for end in ("low", "high"))  # fmt: skip
        curves[label] = (np.array(counted), means, low, high)
        rows += [(label, count, found[count], n) for count, n in zip(found, counted, strict=True)]
    plot_budgets(axes[0, 0], curves, "Fig. 10: walking, three cameras")
    columns = (Column("filter"), Column("particles", 0), Column("error mm"), Column("evaluations", 0))
    return Report((Table("particles", "Error against particles (Fig. 10)", columns, tuple(rows), SUMMARY_NOTES[:1]),),
                  {"particles": figure})  # fmt: skip


def cases_of_recovery(scale: Scale) -> Iterator[Case]:
    """A wrong first pose, and a second in which nobody is seen; with guesses and without."""
    clips = scale.walks(seeds=scale.few(RECOVERY_SEEDS))
    clips = tuple(replace(clip, frames=60 if scale.quick else 150) for clip in clips)
    gap = (10, 29) if scale.quick else GAP
    conditions = {name: working(name, scale, clips[0]) for name in ("AGP-PF", "APF")}
    conditions[DEFAULT] = guided(scale, clips[0])
    conditions["guided, no guesses"] = replace(guided(scale, clips[0]), begin="truth", guesser="")
    for label, trial in conditions.items():
        yield from over(clips, f"{label}: wrong first pose", replace(trial, begin="wrong"))
        begin = "truth" if not trial.guesser else "guess"
        yield from over(clips, f"{label}: a second unseen", replace(trial, begin=begin, gap=gap))


def report_of_recovery(outcome: Outcome) -> Report:
    """Frames until the error is back within 1.5 times the usual one."""
    columns = (Column("filter"), Column("recovered", 0, percent=True), Column("median frames", 0),
               Column("worst frames", 0), Column("usual error mm"), Column("runs", 0))  # fmt: skip
    rows: list[tuple[Cell, ...]] = []
    usual = {label.rpartition(":")[0]: usual_error(group) for label, group in outcome.groups().items()}
    for label, group in outcome.groups().items():
        level = usual[label.rpartition(":")[0]]
        counts = np.array([frames_to_recover(row, level) for row in group])
        back = counts[np.isfinite(counts)]
        rows.append((label, back.size / counts.size, float(np.median(back)) if back.size else float("nan"),
                     float(back.max()) if back.size else float("nan"), level, len(group)))  # fmt: skip
    notes = (
        f"Frames at 60 Hz after the person is seen again (or from the first) until the error is below {RECOVERED:g} "
        f"times the usual one for {STAYS} frames; usual: the filter's median over the last third of its runs.",
    )
    return Report((Table("recovery", "Back on the person", columns, tuple(rows), notes),))


def usual_error(rows: Sequence[Row]) -> float:
    """Median error of the last third of the frames, mm."""
    return float(np.median([row.result.frame_mm[-len(row.result.frame_mm) // 3 :] for row in rows]))


def frames_to_recover(row: Row, usual: float) -> float:
    """Frames from the first that shows the person to the first of `STAYS` within 1.5 times the usual error; inf: never.

    A single one may be luck: the next may be worse for the velocity that the jump was taken for.
    """
    first = row.case.trial.gap[1] + 1 if row.case.trial.gap else 0
    good = np.array(row.result.frame_mm[first:]) <= RECOVERED * usual
    stays = np.flatnonzero(np.lib.stride_tricks.sliding_window_view(good, STAYS).all(axis=1))
    return float(stays[0]) if stays.size else float("inf")


def cases_of_angles(scale: Scale) -> Iterator[Case]:
    """One walk, AGP-PF, three cameras and one."""
    clip = scale.walks(seeds=1)[0]
    for cameras, seen in CAMERAS.items():
        shown = replace(clip, cameras=cameras)
        yield Case(f"AGP-PF, {seen}", replace(working("AGP-PF", scale, shown), keep_track=True))


def report_of_angles(outcome: Outcome) -> Report:
    """Curves with two standard deviations, the truth dashed."""
    figures, rows = {}, []
    for row in outcome.rows:
        trial = row.case.trial
        series = read_joints(trial.track_file(outcome.folder))
        truth = evidence_of(trial.clip, outcome.folder / EVIDENCE).truth
        found, true = (joint_angles(s.positions, s.names) for s in (series, truth))
        figure, axes = new_figure(2, 2, width=9.0, height=5.6)
        spread = angle_deviations(series.positions, series.sd, series.names)
        plot_joint_angles(axes, series.times, found, spread, (truth.times, true))
        figure.suptitle(row.case.label, x=0.01, ha="left", fontsize=10)
        figures["angles-" + row.case.label.lower().replace(" ", "-").replace(",", "")] = figure
        rows.append((row.case.label, row.result.angle_deg, row.result.mean_mm))
    columns = (Column("run"), Column("angle error, deg"), Column("error mm"))
    return Report((Table("angles", "Joint angles of a walk (Fig. 14)", columns, tuple(rows)),), figures)


TABLE4 = Part("table4", "AGP-PF against AGP, APF, GP-PF and PF (Table IV)", report_of_table, cases_of_table)
PRINTED = Part("printed", "The same with the settings as printed", report_of_printed, cases_of_printed)
CURVE = Part("particles", "Error against particles (Fig. 10)", report_of_curve, cases_of_curve)
RECOVERY = Part("recovery", "From a wrong pose, and after a second unseen", report_of_recovery, cases_of_recovery)
ANGLES = Part("angles", "Joint angles against the truth (Fig. 14)", report_of_angles, cases_of_angles)
