"""E2 (layers), one setting of DE-MC at a time (readings of sigma, crossover, estimate, velocity, torso), its search."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from muybridge.experiments.du_2005.budgets import REFERENCE, VIEWS, interval_figure
from muybridge.experiments.du_2005.conditions import at_budget, at_shape, over, printed, working
from muybridge.experiments.experiment import LOST_MM, Case, Outcome, Part, Report, Row, Scale
from muybridge.experiments.statistics import over_seeds
from muybridge.experiments.summaries import SUMMARY_NOTES, difference_table, error, summary_table, values
from muybridge.experiments.tables import Column, Table
from muybridge.experiments.trial import Clip, Trial
from muybridge.plotting.experiments import plot_error_curves
from muybridge.plotting.style import new_figure

LAYERS = (2, 5, 7, 10)
FRAME = 36  # of the thesis' Fig. 7.10
SETTING_SEEDS = 5


def layer_cases(scale: Scale) -> Iterator[Case]:
    """Walks at 2, 5, 7 and 10 layers, otherwise alike."""
    for view in VIEWS:
        clips = scale.walks(view=view)
        for layers in LAYERS:
            yield from over(clips, f"{layers} layers", at_shape("demc", clips[0], layers=layers))


def layer_report(outcome: Outcome) -> Report:
    """Error over the clip and at frame 36, for each view."""
    tables, figures = [], {}
    frame = min(FRAME, outcome.scale.frames - 1)
    figure, axes = new_figure(1, 2, width=9.5, height=3.2)
    for ax, (view, seen) in zip(axes[0], VIEWS.items(), strict=True):
        groups = outcome.groups(outcome.of_view(view))
        tables.append(summary_table(f"E2-{view}", f"E2: layers of DE-MC with 500 particles, {seen}", groups))
        rows = tuple(
            (label, over_seeds(values(found, lambda row: min(row.result.frame_mm[frame], LOST_MM))))
            for label, found in groups.items()
        )
        columns = (Column("condition"), Column(f"error in frame {frame}, mm"))
        tables.append(Table(f"E2-{view}-frame", f"E2 in frame {frame}, {seen}", columns, rows, SUMMARY_NOTES[:1]))
        curves = {
            label: np.mean([np.minimum(row.result.frame_mm, LOST_MM) for row in found], axis=0)
            for label, found in groups.items()
        }
        times = np.arange(outcome.scale.frames) / outcome.rows[0].case.trial.clip.rate
        plot_error_curves(ax, times, curves, f"E2: layers, {seen}")
    figures["E2"] = figure
    return Report(tuple(tables), figures)


BASE = "working"
#: label -> filter settings, motion settings, round torso.
CHOICES: dict[str, tuple[dict, dict, bool]] = {
    BASE: ({}, {}, False),
    "sigma by raw likelihood (6.20)": ({"adaptation": "raw_likelihood"}, {}, False),
    "sigma by effective sample size": ({"adaptation": "effective_sample_size"}, {}, False),
    "crossover 0.5": ({"crossover_rate": 0.5}, {}, False),
    "crossover 0.9": ({"crossover_rate": 0.9}, {}, False),
    "estimate: maximum": ({"estimate": "maximum"}, {}, False),
    "normal jumps": ({"jump": "normal"}, {}, False),
    "lambda as printed (6.17)": ({"difference_scale": None}, {}, False),
    "velocity gain 0": ({}, {"velocity_gain": 0.0}, False),
    "velocity gain 1": ({}, {"velocity_gain": 1.0}, False),
    "round trunk (cones)": ({}, {}, True),
}


def choice_cases(scale: Scale) -> Iterator[Case]:
    """DE-MC 500 x 7, one change at a time; the velocity, the estimate and the trunk of the default filter too."""
    clips = scale.walks(seeds=SETTING_SEEDS)
    for label, (settings, moving, rounded) in CHOICES.items():
        trial = at_shape("demc", clips[0], **settings).with_motion(**moving)
        yield from over(clips, label, replace(trial, torso="round") if rounded else trial)
    default = working("guided", clips[0])
    yield from over(clips, f"guided: {BASE}", default)
    for gain in (0.0, 1.0):
        yield from over(clips, f"guided: velocity gain {gain:g}", default.with_motion(velocity_gain=gain))
    yield from over(clips, "guided: estimate: maximum", default.with_settings(estimate="maximum"))
    yield from over(clips, "guided: round trunk (cones)", replace(default, torso="round"))
    yield from sigma_as_printed(scale)


def choice_report(outcome: Outcome) -> Report:
    """Each change and its difference from the working settings."""
    groups = outcome.groups()
    own = {label: rows for label, rows in groups.items() if not label.startswith(("guided", "printed"))}
    default = {label: rows for label, rows in groups.items() if label.startswith("guided")}
    return Report(
        (
            summary_table("settings", "One setting at a time, three cameras", groups),
            difference_table("settings-paired", "DE-MC 500 x 7: differences", own, BASE),
            difference_table("settings-paired-guided", "Default filter: differences", default, f"guided: {BASE}"),
        ),
        {"settings": interval_figure(groups, "One setting at a time")},
    )


def sigma_as_printed(scale: Scale) -> Iterator[Case]:
    """Both readings of (6.20), everything else printed."""
    clips = scale.walks(seeds=scale.few(3))
    for adaptation in ("raw_likelihood", "effective_sample_size", "off"):
        yield from over(clips, f"printed, sigma {adaptation}", printed("demc", clips[0], adaptation=adaptation))


SEARCH_SEEDS = 5


def search_conditions(clip: Clip) -> dict[str, Trial]:
    """DE-MC beside annealing, one difference at a time: why is it not below?"""
    return {
        REFERENCE: at_shape("demc", clip),
        "no selection between layers": at_shape("demc", clip, reselect=None),
        "no differences, lambda 0": at_shape("demc", clip, difference_scale=0.0),
        "limb by limb": at_shape("demc", clip, by_limb=True),
        "500 x 9, annealing's evaluations": at_shape("demc", clip, layers=9),
        "500 x 19": at_shape("demc", clip, layers=19),
        "500 x 39": at_shape("demc", clip, layers=39),
        "long chains, 60 x 57": at_budget("demc", clip, 3500),
        "annealed 500 x 8, DE-MC's evaluations": at_shape("annealed", clip, layers=8),
        "annealed 500 x 10": at_shape("annealed", clip),
        "guided": working("guided", clip),
    }


def search_cases(scale: Scale) -> Iterator[Case]:
    """Walks, both views."""
    for view in VIEWS:
        clips = scale.walks(view=view, seeds=scale.few(SEARCH_SEEDS))
        for label, trial in search_conditions(clips[0]).items():
            yield from over(clips, label, trial)


def search_report(outcome: Outcome) -> Report:
    """How far each search climbs, and by how many moves; and its error."""
    columns = (Column("condition"), Column("cost of the estimate", 4), Column("accepted moves a chain", 1),
               Column("error mm"), Column("evaluations", 0), Column("runs", 0))  # fmt: skip
    notes = (
        "Cost: of the estimates' silhouettes, two-sided, between 0 and 1; lower is nearer to the mode.",
        SUMMARY_NOTES[0],
    )
    tables, figures = [], {}
    for view, seen in VIEWS.items():
        groups = outcome.groups(outcome.of_view(view))
        figures[f"search-{view}"] = interval_figure(groups, f"Why DE-MC does not beat annealing, {seen}")
        rows = tuple(
            (label, over_seeds(values(found, lambda row: row.result.cost)), mean_moves(found), error(found),
             float(np.mean([row.result.evaluations for row in found])), len(found))
            for label, found in groups.items()
        )  # fmt: skip
        tables.append(Table(f"search-{view}", f"Why DE-MC does not beat annealing, {seen}", columns, rows, notes))
        tables.append(difference_table(f"search-{view}-paired", f"The search: differences, {seen}", groups, REFERENCE))
    return Report(tuple(tables), figures)


def mean_moves(rows: Sequence[Row]) -> float:
    """Accepted moves a chain and frame; NaN where the filter has none that could be refused."""
    moves = np.array([row.result.moves for row in rows])
    return float(np.nanmean(moves)) if np.isfinite(moves).any() else float("nan")


E2 = Part("E2", "Layers of the DE-MC filter", layer_report, layer_cases)
SEARCH = Part("search", "Why DE-MC does not beat annealing", search_report, search_cases)
CHOICE = Part("settings", "One setting at a time", choice_report, choice_cases)
