"""True joints from the files they come in: our joints.csv, an office scene's truth_joints.csv, TRC markers."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from muybridge.errors import InputError
from muybridge.evaluation.names import JOINTS, OFFICE_NAMES, joint_of_marker
from muybridge.io.run_folder import JOINTS_HEADER, JointSeries, read_joints


def read_truth(path: str | Path, *, axes: str | None = None) -> JointSeries:
    """Read true joints, whatever the file.

    Parameters
    ----------
    path : str or Path
        A `.trc` file, a joints.csv (metres), a truth_joints.csv (columns NAME_x, NAME_y, NAME_z in millimetres, one row
        a frame), or a folder that holds one of the last two.
    axes : str, optional
        For TRC files: the world axis of X, Y and Z. See `muybridge.io.trc`.

    Returns
    -------
    JointSeries
    """
    path = _file_of(Path(path))
    if path.suffix.lower() == ".trc":
        return read_marker_joints(path, axes)
    try:
        with path.open(newline="", encoding="utf-8-sig") as lines:
            rows = [row for row in csv.reader(lines) if row]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"truth {path}", expected="a readable table", got=str(error)) from error
    header = tuple(cell.strip() for cell in rows[0]) if rows else ()
    if header == JOINTS_HEADER:
        return read_joints(path)
    if any(name.endswith("_x") for name in header):
        return _wide_table(path, header, rows[1:])
    raise InputError(
        f"truth {path}",
        expected="joints.csv, truth_joints.csv or a .trc file",
        got=f"columns {', '.join(header[:4]) or 'none'}",
    )


def read_marker_joints(path: Path, axes: str | None = None) -> JointSeries:
    """The joints among a TRC file's markers, by their usual names; other markers are left out."""
    from muybridge.io.trc import read_trc

    markers = read_trc(path, axes)
    found: dict[str, int] = {}
    for column, marker in enumerate(markers.names):
        joint = joint_of_marker(marker)
        if joint:
            found.setdefault(joint, column)
    if not found:
        raise InputError(
            f"markers of {path}", expected="names such as RHip, LKnee, Neck", got=", ".join(markers.names[:6])
        )
    names = tuple(name for name in JOINTS if name in found)
    return _without_deviations(
        names, markers.frames, markers.times, markers.positions[:, [found[name] for name in names]]
    )


def _file_of(path: Path) -> Path:
    candidates = [path] if path.is_file() else [path / "truth_joints.csv", path / "joints.csv"]
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    raise InputError(f"truth {path}", expected="a file, or a folder with truth_joints.csv or joints.csv", got="neither")


def _wide_table(path: Path, header: tuple[str, ...], rows: list[list[str]]) -> JointSeries:
    """One row a frame, three columns a joint, millimetres: truth_joints.csv of rendered office scenes."""
    try:
        values = np.array([[_number(cell) for cell in row] for row in rows]).reshape(-1, len(header))
    except ValueError as error:
        raise InputError(f"truth {path}", expected=f"{len(header)} numbers in every row", got=str(error)) from error
    column_of = {name: i for i, name in enumerate(header)}
    stems = [
        name[:-2] for name in header if name.endswith("_x") and {f"{name[:-2]}_y", f"{name[:-2]}_z"} <= set(header)
    ]
    known = {OFFICE_NAMES.get(stem, stem): stem for stem in stems}
    columns = [[column_of[f"{stem}_{axis}"] for axis in "xyz"] for stem in known.values()]
    frames = values[:, column_of["frame"]] if "frame" in column_of else np.arange(len(values))
    times = values[:, column_of["time_s"]] if "time_s" in column_of else np.full(len(values), np.nan)
    return _without_deviations(tuple(known), frames.astype(np.int64), times, values[:, columns] / 1000.0)


def _without_deviations(
    names: tuple[str, ...], frames: np.ndarray, times: np.ndarray, positions: np.ndarray
) -> JointSeries:
    return JointSeries(names, frames, times, positions, np.full(positions.shape[:2], np.nan))


def _number(cell: str) -> float:
    return float(cell) if cell.strip() else float("nan")
