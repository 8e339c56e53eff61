"""ROC curves of the background models on halls where nothing or something happens (thesis, 6.1)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from muybridge.experiments.experiment import Amount, Case, Outcome, Part, Report, Row
from muybridge.experiments.statistics import Interval, block_interval
from muybridge.experiments.tables import Cell, Column, Table
from muybridge.experiments.zhao_2009.hall import HAPPENS, clips
from muybridge.experiments.zhao_2009.subtraction import FOUND, MODELS, BackgroundResult, BackgroundTrial
from muybridge.plotting.masks import plot_mask_grid, plot_roc
from muybridge.plotting.style import new_figure
from muybridge.segmentation import MaskCounts, settings_at

BLOCK = 6
"""Judged pictures drawn together: 2.4 s of a small clip, 1.6 of a whole one; somebody crosses a pixel in less."""
RULE = "auto"
"""The label of what chooses between the others."""


def cases(scale: Amount) -> Iterator[Case]:
    """Every model on every clip."""
    for clip in clips(scale):
        for name, label in MODELS.items():
            yield Case(label, BackgroundTrial(clip, name, tuple(settings_at(name, clip.rate).items())))


def by_scene(outcome: Outcome) -> dict[str, dict[str, list[Row]]]:
    """Rows by scene and label."""
    found: dict[str, dict[str, list[Row]]] = {}
    for scene in HAPPENS:
        rows = [row for row in outcome.rows if row.case.trial.clip.scene == scene]
        found[scene] = dict(outcome.groups(rows))
    return found


def report_of_curves(outcome: Outcome) -> Report:
    """A plot a scene; false positives at 80 % true positives; what `auto` loses; changedetection.net's measures."""
    groups = by_scene(outcome)
    figure, axes = new_figure(1, len(groups), width=3.1 * len(groups), height=3.4, sharey=True)
    for ax, (scene, models) in zip(axes[0], groups.items(), strict=True):
        plot_roc(ax, {label: mean_curve(rows) for label, rows in models.items()}, scene)
    axes[0, -1].legend(fontsize=7, loc="lower right")
    return Report((false_positives(groups), choices(groups), measures(groups)), {"roc": figure})


def mean_curve(rows: Sequence[Row]) -> tuple[np.ndarray, np.ndarray]:
    """False and true rates, the mean over seeds of the false rate at each true rate."""
    true = np.linspace(0.0, 1.0, 101)
    return np.mean([[row.result.false_rate_at(rate) for rate in true] for row in rows], axis=0), true


def false_positives(groups: Mapping[str, Mapping[str, Sequence[Row]]]) -> Table:
    """False positive rate at 80 % true positives, the mean over seeds, and SBM against MBM."""
    rows: list[tuple[Cell, ...]] = []
    for scene, models in groups.items():
        rate = {label: float(np.mean([row.result.false_rate_at(FOUND) for row in rows_]))
                for label, rows_ in models.items()}  # fmt: skip
        ratio = rate["SBM"] / rate["MBM"] if rate["MBM"] else float("nan")
        rows.append((scene, *(rate[label] for label in MODELS.values()), ratio))
    columns = (Column("scene"), *(Column(label, 2, percent=True) for label in MODELS.values()), Column("SBM / MBM", 2))
    notes = (
        f"False positive rate at {FOUND:.0%} true positives, mean over seeds; masks closed 3 x 3 and opened 5 x 5.",
    )
    return Table("roc", "False positives at 80 % true positives", columns, tuple(rows), notes)


def choices(groups: Mapping[str, Mapping[str, Sequence[Row]]]) -> Table:
    """Clip by clip, `auto` against whichever single model turned out best there."""
    rows: list[tuple[Cell, ...]] = []
    differences: list[Interval] = []
    for scene, models in groups.items():
        for own in models[RULE]:
            others = [row for label, found in models.items() if label != RULE for row in found if row.key == own.key]
            best = min(others, key=lambda row: row.result.false_rate_at(FOUND))
            differences.append(further(own.result, best.result))
            rates = (row.result.false_rate_at(FOUND) for row in (best, own))
            rows.append((scene, own.key[0], best.case.label, *rates, differences[-1]))
    no_worse = sum(apart.low <= 0 for apart in differences)
    better = sum(apart.high < 0 for apart in differences)
    notes = (
        f"False positive rates at {FOUND:.0%} true positives; the best single model is chosen afterwards, by these.",
        f"Intervals over pictures, {BLOCK} drawn together: {RULE} is not shown to be worse in {no_worse} "
        f"of {len(rows)} clips, and better in {better}.",
    )
    columns = (Column("scene"), Column("seed", 0), Column("best single model"), Column("its", 3, percent=True),
               Column(RULE, 3, percent=True), Column(f"{RULE} less the best", 3, percent=True))  # fmt: skip
    return Table("choices", f"{RULE} against the best single model of each clip", columns, tuple(rows), notes)


def further(result: BackgroundResult, other: BackgroundResult) -> Interval:
    """Difference of two false positive rates on one clip, with its interval over pictures; NaN where one never finds
    enough."""
    if not (result.false_where_found and other.false_where_found):
        return block_interval((), BLOCK)
    background = (result.false_positives + result.true_negatives) / len(result.false_where_found)
    apart = np.subtract(result.false_where_found, other.false_where_found) / background
    return block_interval(apart, BLOCK)


def measures(groups: Mapping[str, Mapping[str, Sequence[Row]]]) -> Table:
    """Of the masks as they come, with each model's own settings."""
    rows: list[tuple[Cell, ...]] = []
    for scene, models in groups.items():
        for label, found in models.items():
            counts = sum((row.result.counts for row in found), MaskCounts())
            rows.append((scene, label, counts.recall, counts.precision, counts.f_measure, counts.wrong_percent,
                         counts.false_positive_rate))  # fmt: skip
    columns = (Column("scene"), Column("model"), Column("recall", 3), Column("precision", 3), Column("F", 3),
               Column("PWC", 2), Column("FPR", 2, percent=True))  # fmt: skip
    return Table("masks", "Masks with default settings", columns, tuple(rows),
                 ("changedetection.net's measures, counts added over pictures and seeds.",))  # fmt: skip


def report_of_pictures(outcome: Outcome) -> Report:
    """Picture, truth and masks of the models at four moments of the first seed's clips."""
    figures = {}
    for scene, models in by_scene(outcome).items():
        first = {label: rows[0].case.trial for label, rows in models.items()}
        masks = {label: np.load(trial.masks_file(outcome.folder)) for label, trial in first.items()}
        kept = next(iter(masks.values()))
        rows = {"truth": kept["truths"], **{label: found["masks"] for label, found in masks.items()}}
        figures[f"masks-{scene}"] = plot_mask_grid(kept["pictures"], rows)
    return Report((), figures)


ROC = Part("roc", "GBM, MBM and SBM, and others beside them", report_of_curves, cases)
PICTURES = Part("pictures", "Hard cases: the light, a door, somebody who stays", report_of_pictures, cases)
