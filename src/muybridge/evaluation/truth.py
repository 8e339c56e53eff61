"""True joints from the files they come in: our joints.csv, an office scene's truth_joints.csv, TRC markers."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from muybridge.errors import InputError
from muybridge.evaluation.names import JOINTS, OFFICE_NAMES, joint_of_marker
from muybridge.evaluation.track import JointTrack

JOINTS_HEADER = ("frame", "time_s", "joint", "x_m", "y_m", "z_m")


def read_truth(path: str | Path, *, axes: str | None = None) -> JointTrack:
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
    JointTrack
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
    if header[: len(JOINTS_HEADER)] == JOINTS_HEADER:
        return _long_table(path, header, rows[1:])
    if any(name.endswith("_x") for name in header):
        return _wide_table(path, header, rows[1:])
    raise InputError(
        f"truth {path}",
        expected="joints.csv, truth_joints.csv or a .trc file",
        got=f"columns {', '.join(header[:4]) or 'none'}",
    )


def read_marker_joints(path: Path, axes: str | None = None) -> JointTrack:
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
    return JointTrack(names, markers.frames, markers.times, markers.positions[:, [found[name] for name in names]])


def _file_of(path: Path) -> Path:
    candidates = [path] if path.is_file() else [path / "truth_joints.csv", path / "joints.csv"]
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    raise InputError(f"truth {path}", expected="a file, or a folder with truth_joints.csv or joints.csv", got="neither")


def _long_table(path: Path, header: tuple[str, ...], rows: list[list[str]]) -> JointTrack:
    """One row a frame and joint, metres: joints.csv. An empty cell is a missing value."""
    joint_column = header.index("joint")
    numeric = [header.index(name) for name in ("frame", "time_s", "x_m", "y_m", "z_m")]
    deviation = header.index("sd_m") if "sd_m" in header else None
    try:
        values = np.array([[_number(row[i]) for i in numeric] for row in rows]).reshape(-1, 5)
        spread = np.array([_number(row[deviation]) for row in rows]) if deviation is not None else None
    except (ValueError, IndexError) as error:
        raise InputError(f"joints in {path}", expected="numbers in every row", got=str(error)) from error
    return assemble_track(
        [row[joint_column].strip() for row in rows], values[:, 0], values[:, 1], values[:, 2:], spread
    )


def assemble_track(
    joints: list[str], frames: np.ndarray, times: np.ndarray, positions: np.ndarray, deviations: np.ndarray | None
) -> JointTrack:
    """Rows of frame and joint, in any order, as one track.

    Parameters
    ----------
    joints : list of str, length R
    frames, times : (R,)
    positions : (R, 3) float64, metres
    deviations : (R,) float64, metres, or None
    """
    names = tuple(dict.fromkeys(joints))
    column_of = {name: column for column, name in enumerate(names)}
    numbers, first, row = np.unique(np.asarray(frames).astype(np.int64), return_index=True, return_inverse=True)
    column = np.array([column_of[name] for name in joints], dtype=np.int64)
    points = np.full((len(numbers), len(names), 3), np.nan)
    points[row, column] = positions
    spread = None
    if deviations is not None:
        spread = np.full(points.shape[:2], np.nan)
        spread[row, column] = deviations
    return JointTrack(names, numbers, np.asarray(times, float)[first], points, spread)


def _wide_table(path: Path, header: tuple[str, ...], rows: list[list[str]]) -> JointTrack:
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
    return JointTrack(tuple(known), frames.astype(np.int64), times, values[:, columns] / 1000.0)


def _number(cell: str) -> float:
    return float(cell) if cell.strip() else float("nan")
