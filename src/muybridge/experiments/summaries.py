"""Rows of results made tables: one line a condition, differences against one of them, coverage."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from muybridge.evaluation.calibration import LEVELS
from muybridge.experiments.experiment import LOST_MM, Row
from muybridge.experiments.statistics import Interval, over_seeds, paired
from muybridge.experiments.tables import Cell, Column, Table

SUMMARY = (
    Column("condition"),
    Column("error mm"),
    Column("median run mm"),
    Column("root-aligned mm"),
    Column("angles deg"),
    Column("frames lost", 1, percent=True),
    Column("evaluations", 0),
    Column("CPU ms a frame", 0),
    Column("runs", 0),
)
SUMMARY_NOTES = (
    "Mean over people, motions and frames, alignment none unless said; brackets: 95 % interval over seeds "
    "(Student's t over the seeds' means).",
    f"A frame counts at most {LOST_MM:.0f} mm; lost: a frame's mean error is above 200 mm.",
)
COLLAPSED = 100.0  # a factor above it says no more
Value = Callable[[Row], float]


def values(rows: Sequence[Row], value: Value) -> dict[tuple[int, str], float]:
    """A value of each row by its key."""
    return {row.key: value(row) for row in rows}


def free_error(row: Row) -> float:
    """Mean joint error, mm, alignment none, a frame counting at most LOST_MM."""
    return row.error_mm


def root_aligned(row: Row) -> float:
    """Mean joint error, mm, alignment root, at most LOST_MM."""
    return float(min(row.result.root_mm, LOST_MM))


def error(rows: Sequence[Row]) -> Interval:
    """Mean joint error with its interval."""
    return over_seeds(values(rows, free_error))


def summary_table(name: str, title: str, groups: Mapping[str, Sequence[Row]]) -> Table:
    """One line a group: errors with intervals, what was lost, and the cost."""
    return Table(name, title, SUMMARY, tuple(_summary(label, rows) for label, rows in groups.items()), SUMMARY_NOTES)


def _summary(label: str, rows: Sequence[Row]) -> tuple[Cell, ...]:
    def of(value: Value) -> Interval:
        return over_seeds(values(rows, value))

    return (
        label,
        error(rows),
        float(np.median([row.error_mm for row in rows])),
        of(root_aligned),
        of(lambda row: row.result.angle_deg),
        float(np.mean([row.result.lost_share for row in rows])),
        float(np.mean([row.result.evaluations for row in rows])),
        float(np.median([row.result.ms for row in rows])),
        len(rows),
    )


def parts_table(name: str, title: str, groups: Mapping[str, Sequence[Row]]) -> Table:
    """Where the error is: the place, the legs, the arms; and how often the legs are exchanged."""

    def of(rows: Sequence[Row], value: Value) -> Interval:
        return over_seeds(values(rows, lambda row: min(value(row), LOST_MM)))

    columns = (
        Column("condition"),
        Column("pelvis mm"),
        Column("knees and ankles mm"),
        Column("elbows and wrists mm"),
        Column("legs exchanged", 1, percent=True),
    )
    rows: list[tuple[Cell, ...]] = [
        (
            label,
            of(group, lambda row: row.result.place_mm),
            of(group, lambda row: row.result.legs_mm),
            of(group, lambda row: row.result.arms_mm),
            float(np.mean([row.result.swapped_share for row in group])),
        )
        for label, group in groups.items()
    ]
    note = f"Means over runs, each counting at most {LOST_MM:.0f} mm; exchanged: by more than 50 mm better so."
    return Table(name, title, columns, tuple(rows), (note,))


def difference_table(
    name: str, title: str, groups: Mapping[str, Sequence[Row]], reference: str, value: Value = free_error
) -> Table:
    """Each group minus the reference on the same scene and seed, mm: negative is better than the reference."""
    against = values(groups[reference], value)
    rows: list[tuple[Cell, ...]] = []
    for label, group in groups.items():
        if label != reference:
            gap = paired(values(group, value), against)
            rows.append((label, gap, verdict(gap)))
    columns = (Column("condition"), Column(f"minus {reference}, mm"), Column("reading"))
    return Table(name, title, columns, tuple(rows), ("Paired by scene and seed; 95 % interval over seeds.",))


def verdict(gap: Interval) -> str:
    """What a paired difference says."""
    if not np.isfinite(gap.low):
        return "one seed says nothing"
    if not gap.excludes_zero:
        return "not told apart"
    return "better" if gap.mean < 0 else "worse"


def coverage_table(name: str, title: str, groups: Mapping[str, Sequence[Row]]) -> Table:
    """Share of true joints inside the stated regions, beside the error and the spread that was stated."""
    columns = (
        Column("condition"),
        *(Column(f"in the {level:.0%} region", 0, percent=True) for level in LEVELS),
        Column("sd is too small by", 2),
        Column("error mm"),
        Column("stated sd mm"),
    )
    rows: list[tuple[Cell, ...]] = []
    for label, group in groups.items():
        inside = [over_seeds(values(group, lambda row, k=k: row.result.inside[k])) for k in range(len(LEVELS))]  # type: ignore[misc]
        scale = min(float(np.nanmedian([row.result.scale for row in group])), COLLAPSED)
        spread = float(np.median([row.result.sd_mm for row in group]))
        rows.append((label, *inside, scale, error(group), spread))
    notes = (
        "Regions are balls of the stated standard deviation, chi with 3 degrees of freedom; below the level: too sure.",
        "'Too small by' is the factor that would make the deviations right on average (median run); "
        f"{COLLAPSED:.0f}: that or more, the particles had collapsed onto one.",
    )
    return Table(name, title, columns, tuple(rows), notes)
