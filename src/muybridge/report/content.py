"""Gather what a report shows from a run folder; what a run did not leave behind is left out.

Beside joints.csv and run.json these are used where they are there:

- `diagnostics.csv`: frame, then any of time_s, ess, acceptance, log_likelihood, ms (one row a frame);
- `overlay_<camera>.mp4`: pictures for the contact sheets, and `cameras.json`: where in them the person is;
- in run.json: `settings.filter.particles` or `particles`, and `cameras`: {name: {shift_px: [x, y], residual_px: r}}.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from muybridge.errors import InputError
from muybridge.evaluation import JointErrors, evaluate
from muybridge.evaluation.alignment import Alignment
from muybridge.io.run_folder import JointSeries, read_joints, read_summary
from muybridge.report.sheets import contact_sheets, worth_seeing
from muybridge.report.trouble import Trouble, find_trouble

DIAGNOSTICS_FILE = "diagnostics.csv"


@dataclass(frozen=True)
class RunContent:
    """Everything a report is made of.

    Attributes
    ----------
    name : str
    series : JointSeries
    summary : mapping
        run.json.
    diagnostics : mapping of column to (T,) float64
        On the rows of `series`; empty where the run left none.
    errors : JointErrors or None
    truth : JointSeries or None
        On its own frames.
    sheets : mapping of camera to (H, W, 3) uint8 BGR
        Contact sheets.
    trouble : tuple of Trouble
    """

    name: str
    series: JointSeries
    summary: Mapping[str, Any]
    diagnostics: Mapping[str, np.ndarray]
    errors: JointErrors | None
    truth: JointSeries | None
    sheets: Mapping[str, np.ndarray]
    trouble: tuple[Trouble, ...]

    @property
    def particles(self) -> int | None:
        """How many particles the filter had, where run.json says so."""
        return particle_count(self.summary)


def gather(
    folder: str | Path, truth: str | Path | None = None, *, alignment: Alignment = "none", axes: str | None = None
) -> RunContent:
    """Read a run folder.

    Parameters
    ----------
    folder : str or Path
    truth : str or Path, optional
        Any file `muybridge.evaluation.read_truth` reads.
    alignment : {"none", "root", "rigid", "similarity"}
    axes : str, optional
        For TRC truth.
    """
    from muybridge.evaluation import read_truth

    folder = Path(folder)
    if not folder.is_dir():
        raise InputError(f"run {folder}", expected="a run folder", got="none")
    series, summary = read_joints(folder), read_summary(folder)
    diagnostics = read_diagnostics(folder / DIAGNOSTICS_FILE, series.frames)
    errors = evaluate(folder, truth, alignment, axes=axes) if truth is not None else None
    trouble = find_trouble(series, diagnostics.get("ess"), particle_count(summary), errors)
    true_series = read_truth(truth, axes=axes) if truth is not None else None
    sheets = contact_sheets(folder, series, worth_seeing(series.frames, errors))
    return RunContent(folder.resolve().name, series, summary, diagnostics, errors, true_series, sheets, trouble)


def particle_count(summary: Mapping[str, Any]) -> int | None:
    """The number of particles, from wherever run.json keeps it."""
    settings = summary.get("settings")
    tables = [summary, settings, settings.get("filter") if isinstance(settings, Mapping) else None]
    for table in tables:
        if isinstance(table, Mapping) and isinstance(table.get("particles"), int):
            return table["particles"]
    return None


def read_diagnostics(path: Path, frames: np.ndarray) -> dict[str, np.ndarray]:
    """Columns of a diagnostics table on the given frames; NaN where it has no such frame, nothing where it is
    absent."""
    if not path.is_file():
        return {}
    with path.open(newline="", encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    columns = [name for name in (rows[0] if rows else ()) if name and name != "frame"]
    row_of = {int(frame): row for row, frame in enumerate(frames)}
    found = {name: np.full(len(frames), np.nan) for name in columns}
    for row in rows:
        place = row_of.get(int(row["frame"])) if (row.get("frame") or "").isdigit() else None
        if place is not None:
            for name in columns:
                found[name][place] = _number(row[name])
    return {name: values for name, values in found.items() if np.isfinite(values).any()}


def _number(cell: str | None) -> float:
    try:
        return float(cell or "nan")
    except ValueError:
        return float("nan")
