"""E1: CONDENSATION, annealed and DE-MC at the thesis' budgets; then every filter at every budget; then their spread."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from muybridge.evaluation.calibration import LEVELS
from muybridge.experiments.du_2005.conditions import (
    AT_SHAPE,
    BUDGETS,
    FILTERS,
    NAMES,
    SHAPES,
    SILHOUETTE,
    at_budget,
    at_shape,
    over,
    printed,
    working,
)
from muybridge.experiments.experiment import Case, Outcome, Part, Report, Row, Scale
from muybridge.experiments.statistics import over_seeds
from muybridge.experiments.summaries import coverage_table, difference_table, error, parts_table, summary_table, values
from muybridge.experiments.trial import Clip, Trial
from muybridge.plotting.experiments import plot_budgets, plot_coverage, plot_intervals
from muybridge.plotting.style import new_figure
from muybridge.tracking.motion import motion_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

VIEWS = {"ring": "three cameras", "side": "one camera from the side"}
REFERENCE = "DE-MC 500 x 7"
FEWEST_SEEDS = 3  # of a band in a plot: two seeds' interval reaches over all of it
PRINTED_SEEDS, CURVE_SEEDS = 3, 3  # three cues cost ten times a silhouette; curves have seven budgets


def conditions(clip: Clip) -> dict[str, Trial]:
    """The filters at the thesis' budgets, and ours beside them."""
    found = {NAMES[method]: at_shape(method, clip) for method in NAMES}
    found["annealed, limb by limb, 5000"] = at_budget("annealed", clip, 5000)
    found["DE-MC, long chains, 3500"] = at_budget("demc", clip, 3500)
    found["tempered 500 x 10"] = working("tempered", clip)
    found["guided"] = working("guided", clip)
    return found


def budget_cases(scale: Scale) -> Iterator[Case]:
    """Working settings on every clip; printed ones on those of the first seeds."""
    for view in VIEWS:
        clips = scale.clips(view=view)
        for label, trial in conditions(clips[0]).items():
            yield from over(clips, label, trial)
        for method, name in NAMES.items():
            few = scale.clips(view=view, seeds=scale.few(PRINTED_SEEDS))
            yield from over(few, f"{name}, printed", printed(method, few[0]))


def budget_report(outcome: Outcome) -> Report:
    """A table and a plot of errors for each view, and differences from DE-MC."""
    tables, figures = [], {}
    for view, seen in VIEWS.items():
        groups = outcome.groups(outcome.of_view(view))
        tables.append(summary_table(f"E1-{view}", f"E1, {seen}", groups))
        tables.append(difference_table(f"E1-{view}-paired", f"E1, {seen}: differences", groups, REFERENCE))
        tables.append(parts_table(f"E1-{view}-parts", f"E1, {seen}: where the error is", groups))
        figures[f"E1-{view}"] = interval_figure(groups, f"E1: {seen}")
    return Report(tuple(tables), figures)


def interval_figure(
    groups: Mapping[str, Sequence[Row]], heading: str, targets: Sequence[tuple[float, float]] = ()
) -> Figure:
    """Errors of the groups as dots and lines."""
    found = [error(rows) for rows in groups.values()]
    figure, axes = new_figure(height=1.1 + 0.3 * len(groups))
    plot_intervals(
        axes[0, 0],
        list(groups),
        [interval.mean for interval in found],
        [interval.low for interval in found],
        [interval.high for interval in found],
        heading,
        targets=targets,
    )
    return figure


def curve_cases(scale: Scale) -> Iterator[Case]:
    """Every filter at every budget; a quick look has three budgets."""
    budgets = (250, 1000, 5000) if scale.quick else BUDGETS
    for view in VIEWS:
        clips = scale.walks(view=view, seeds=CURVE_SEEDS)
        for method in FILTERS:
            for budget in budgets:
                yield from over(clips, method, at_budget(method, clips[0], budget), budget)


def curve_report(outcome: Outcome) -> Report:
    """Error against evaluations as they were counted, one panel a view."""
    figure, axes = new_figure(1, 2, width=9.5, height=3.8)
    tables = []
    for ax, (view, seen) in zip(axes[0], VIEWS.items(), strict=True):
        groups = outcome.groups(outcome.of_view(view))
        plot_budgets(ax, {method: _curve(rows) for method, rows in groups.items()}, f"Walking, {seen}")
        labelled: dict[str, list[Row]] = {}
        for row in outcome.of_view(view):
            labelled.setdefault(f"{row.case.label} at {row.case.x:.0f}", []).append(row)
        tables.append(summary_table(f"budgets-{view}", f"Error against evaluations, walking, {seen}", labelled))
    return Report(tuple(tables), {"budgets": figure})


def _curve(rows: Sequence[Row]) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    by_budget: dict[float, list[Row]] = {}
    for row in rows:
        by_budget.setdefault(row.case.x, []).append(row)
    points = []
    for budget in sorted(by_budget):
        found, group = error(by_budget[budget]), by_budget[budget]
        counted = float(np.mean([row.result.evaluations for row in group]))
        told = len({row.case.trial.clip.seed for row in group}) >= FEWEST_SEEDS
        points.append((counted, found.mean, *((found.low, found.high) if told else (np.nan, np.nan))))
    columns = np.array(points).T
    return columns[0], columns[1], columns[2], columns[3]


def ladder(clip: Clip) -> Iterator[tuple[str, Trial]]:
    """DE-MC 500 x 7, one change after another, from what is printed to what works."""
    end = AT_SHAPE["demc"]
    trial = printed("demc", clip, **SHAPES["demc"])
    yield "as printed", trial
    trial = trial.with_motion(velocity_gain=0.5)
    yield "+ velocity at half gain", trial
    trial = trial.with_settings(sharpness=end["sharpness"])
    yield f"+ likelihood {end['sharpness']:.0f} times as sharp", trial
    trial = replace(trial, cues=SILHOUETTE)
    yield "+ silhouette alone, two-sided", trial
    for label, settings in (
        (f"+ noise before the moves, {end['dynamics_noise']:g}", {"dynamics_noise": end["dynamics_noise"]}),
        (f"+ jumps of constant size, c = {end['c']:g}", {"adaptation": "off", "c": end["c"]}),
        ("+ lambda 0.27, other half", {"difference_scale": 0.27, "partners": "other_half"}),
        ("+ mean, systematic", {"estimate": "mean", "resampling": "systematic"}),
    ):
        trial = trial.with_settings(**settings)
        yield label, trial
    trial = trial.with_settings(reselect=end["reselect"])
    yield f"+ selection of {end['reselect']:.0%} between layers", trial
    usual = motion_of("demc", clip.cameras).usual_weight
    yield f"+ usual poses, weight {usual:g}", trial.with_motion(usual_weight=usual)


def printed_cases(scale: Scale) -> Iterator[Case]:
    """The ladder on walks seen by three cameras and by one."""
    for view in VIEWS:
        clips = scale.walks(view=view, seeds=scale.few(PRINTED_SEEDS))
        for label, trial in ladder(clips[0]):
            yield from over(clips, label, trial)


def printed_report(outcome: Outcome) -> Report:
    """The ladder's rungs for each view."""
    tables, figures = [], {}
    for view, seen in VIEWS.items():
        groups = outcome.groups(outcome.of_view(view))
        tables.append(summary_table(f"printed-{view}", f"From printed to working: DE-MC 500 x 7, {seen}", groups))
        figures[f"printed-{view}"] = interval_figure(groups, f"From printed to working, {seen}")
    return Report(tuple(tables), figures)


def coverage_cases(scale: Scale) -> Iterator[Case]:
    """The rows of E1, three cameras, and the guided filter's other ways to weigh its particles."""
    clips = scale.clips()
    for label, trial in conditions(clips[0]).items():
        yield from over(clips, label, trial)
    for weighting in ("likelihood", "importance"):
        yield from over(clips, f"guided, {weighting}", working("guided", clips[0], weighting=weighting))


def coverage_report(outcome: Outcome) -> Report:
    """Share of true joints inside the stated regions."""
    groups = outcome.groups()
    figure, axes = new_figure(width=7.6, height=3.8)
    curves = {
        label: [over_seeds(values(rows, lambda row, k=k: row.result.inside[k])).mean for k in range(len(LEVELS))]  # type: ignore[misc]
        for label, rows in groups.items()
    }
    plot_coverage(axes[0, 0], LEVELS, curves, "Is the stated spread true?")
    return Report((coverage_table("coverage", "Coverage, three cameras", groups),), {"coverage": figure})


E1 = Part("E1", "The filters at the thesis' budgets", budget_report, budget_cases)
CURVES = Part("budgets", "Error against likelihood evaluations", curve_report, curve_cases)
PRINTED = Part("printed", "From printed to working settings", printed_report, printed_cases)
COVERAGE = Part("coverage", "Is the stated spread true?", coverage_report, coverage_cases)
