"""What a run leaves behind: `joints.csv`, `pose.csv` and `run.json`; written frame by frame, read back as arrays.

joints.csv  frame, time_s, joint, x_m, y_m, z_m, sd_m     one line a joint; world coordinates
pose.csv    frame, time_s, one column a degree of freedom  angles in radians, translations in metres
run.json    status, frames, seed, settings, versions, evaluations_per_frame, ms_per_frame, peak_memory_mb
preparation.json  what run.json adds about start, body and cameras; kept apart for the run that resumes this one

Numbers have a fixed count of decimals, so that equal results give equal bytes. A resumed run writes the tables anew
from its log.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from muybridge.errors import InputError
from muybridge.io.disk import disk_errors, make_folder, replace_file

JOINTS_FILE, POSE_FILE, SUMMARY_FILE, PREPARATION_FILE = "joints.csv", "pose.csv", "run.json", "preparation.json"
JOINTS_HEADER = ("frame", "time_s", "joint", "x_m", "y_m", "z_m", "sd_m")
TIME_DECIMALS = 6
POSITION_DECIMALS = 6
"""Micrometres: a thousandth of any error there is."""
POSE_DECIMALS = 8
SUMMARY_KEYS = (
    "status",
    "frames",
    "seed",
    "settings",
    "versions",
    "evaluations_per_frame",
    "ms_per_frame",
    "peak_memory_mb",
)


@dataclass(frozen=True)
class JointSeries:
    """Joints over time.

    Attributes
    ----------
    names : tuple of J str
    frames : (T,) int64
    times : (T,) float64, seconds
    positions : (T, J, 3) float64, metres, world; NaN where there is no estimate
    sd : (T, J) float64, metres, standard deviation per axis; NaN where unknown
    """

    names: tuple[str, ...]
    frames: np.ndarray
    times: np.ndarray
    positions: np.ndarray
    sd: np.ndarray

    def __post_init__(self) -> None:
        count, joints = len(self.frames), len(self.names)
        _check_shape("times", self.times, (count,))
        _check_shape("positions", self.positions, (count, joints, 3))
        _check_shape("sd", self.sd, (count, joints))


@dataclass(frozen=True)
class PoseSeries:
    """Poses over time: `names` D str, `frames` (T,) int64, `times` (T,) s, `poses` (T, D), radians and metres."""

    names: tuple[str, ...]
    frames: np.ndarray
    times: np.ndarray
    poses: np.ndarray

    def __post_init__(self) -> None:
        _check_shape("times", self.times, (len(self.frames),))
        _check_shape("poses", self.poses, (len(self.frames), len(self.names)))


class RunWriter:
    """Writes the tables of a run folder, a frame at a time; every frame is on its way to disk when `write` returns.

    Parameters
    ----------
    folder : str or Path
        Created where it is not there; tables already in it are replaced.
    joint_names, pose_names : sequences of J and D str
    """

    def __init__(self, folder: str | Path, joint_names: Sequence[str], pose_names: Sequence[str]) -> None:
        self.folder = make_folder(folder)
        self.joint_names, self.pose_names = _checked_names(joint_names), _checked_names(pose_names)
        self._joints = _Table(self.folder / JOINTS_FILE, JOINTS_HEADER)
        self._poses = _Table(self.folder / POSE_FILE, ("frame", "time_s", *self.pose_names))

    def write(self, frame: int, time_s: float, positions: np.ndarray, sd: np.ndarray, pose: np.ndarray) -> None:
        """Append one frame: `positions` (J, 3) metres, `sd` (J,) metres, `pose` (D,) radians and metres."""
        _check_shape("positions", positions, (len(self.joint_names), 3))
        _check_shape("sd", sd, (len(self.joint_names),))
        _check_shape("pose", pose, (len(self.pose_names),))
        when = f"{int(frame)},{fixed(time_s, TIME_DECIMALS)}"
        rows = np.column_stack([positions, sd]).tolist()
        lines = [
            ",".join([when, name, *(fixed(value, POSITION_DECIMALS) for value in row)])
            for name, row in zip(self.joint_names, rows, strict=True)
        ]
        self._joints.write(lines)
        self._poses.write([",".join([when, *(fixed(value, POSE_DECIMALS) for value in np.asarray(pose).tolist())])])

    def close(self) -> None:
        """Close the tables; every frame written is in them."""
        self._joints.close()
        self._poses.close()

    def __enter__(self) -> RunWriter:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


class _Table:
    """A text file that grows by lines and is flushed each time."""

    def __init__(self, path: Path, header: Sequence[str]) -> None:
        self.path = path
        with disk_errors(path):
            self._file = open(path, "w", encoding="utf-8", newline="\n")
        self.write([",".join(header)])

    def write(self, lines: Sequence[str]) -> None:
        """Append lines, given without their ends, and hand them to the operating system."""
        with disk_errors(self.path):
            self._file.write("".join(f"{line}\n" for line in lines))
            self._file.flush()

    def close(self) -> None:
        """Close the file; what it still held may be refused only now."""
        with disk_errors(self.path):
            self._file.close()


def fixed(value: float, decimals: int) -> str:
    """A number with a fixed count of decimals, never a negative zero; NaN where it is not finite.

    Examples
    --------
    >>> fixed(1.23456789, 3), fixed(-1e-9, 3), fixed(float("inf"), 3)
    ('1.235', '0.000', 'nan')
    """
    if not math.isfinite(value):
        return "nan"
    text = f"{value:.{decimals}f}"
    return text[1:] if text.startswith("-") and not text.strip("-0.") else text


def write_joints(path: str | Path, series: JointSeries) -> None:
    """Write a whole series as a joints.csv."""
    table = _Table(Path(path), JOINTS_HEADER)
    names = _checked_names(series.names)
    for frame, time_s, positions, sd in zip(series.frames, series.times, series.positions, series.sd, strict=True):
        when = f"{int(frame)},{fixed(time_s, TIME_DECIMALS)}"
        rows = zip(names, np.column_stack([positions, sd]).tolist(), strict=True)
        table.write([",".join([when, name, *(fixed(v, POSITION_DECIMALS) for v in row)]) for name, row in rows])
    table.close()


def read_joints(path: str | Path) -> JointSeries:
    """Read a joints.csv, or the one in a run folder; a last frame that was cut off is left out."""
    file = _table_path(path, JOINTS_FILE)
    header, rows = _read_rows(file)
    if tuple(header) != JOINTS_HEADER:
        raise InputError(str(file), expected=",".join(JOINTS_HEADER), got=",".join(header)[:80])
    names = tuple(dict.fromkeys(row[2] for row in rows))
    count = len(rows) // max(len(names), 1)
    whole = rows[: count * len(names)]
    if [row[2] for row in whole] != list(names) * count:
        raise InputError(str(file), expected="every joint once a frame, in one order", got="another order")
    numbers = _numbers(file, [[*row[:2], *row[3:]] for row in whole], 6).reshape(count, len(names), 6)
    frames = numbers[:, :, 0]
    if np.any(frames != frames[:, :1]):
        raise InputError(str(file), expected="every joint once a frame", got="frames mixed up")
    times = numbers[:, 0, 1] if names else np.zeros(0)
    first = frames[:, 0] if names else np.zeros(0)
    return JointSeries(names, first.astype(np.int64), times, numbers[:, :, 2:5], numbers[:, :, 5])


def read_pose(path: str | Path) -> PoseSeries:
    """Read a pose.csv, or the one in a run folder; a last line that was cut off is left out."""
    file = _table_path(path, POSE_FILE)
    header, rows = _read_rows(file)
    if header[:2] != ["frame", "time_s"]:
        raise InputError(str(file), expected="columns frame,time_s,...", got=",".join(header)[:80])
    numbers = _numbers(file, rows, len(header))
    return PoseSeries(tuple(header[2:]), numbers[:, 0].astype(np.int64), numbers[:, 1], numbers[:, 2:])


def write_summary(folder: str | Path, summary: Mapping[str, Any]) -> None:
    """Write run.json whole, in the order given; numpy values become plain ones, what is not finite becomes null.

    Raises
    ------
    InputError
        Where one of `SUMMARY_KEYS` is missing.
    """
    missing = [key for key in SUMMARY_KEYS if key not in summary]
    if missing:
        raise InputError(f"{Path(folder) / SUMMARY_FILE}", expected=", ".join(SUMMARY_KEYS), got=f"no {missing[0]}")
    _write_object(make_folder(folder) / SUMMARY_FILE, summary)


def read_summary(folder: str | Path) -> dict[str, Any]:
    """Read the run.json of a run folder."""
    return _read_object(_table_path(folder, SUMMARY_FILE))


def write_preparation(folder: str | Path, facts: Mapping[str, Any]) -> None:
    """Write preparation.json whole: what was found before the first frame, as run.json will have it."""
    _write_object(make_folder(folder) / PREPARATION_FILE, facts)


def read_preparation(folder: str | Path) -> dict[str, Any]:
    """Read the preparation.json of a run folder; empty where it is missing or damaged, for nothing rests on it."""
    try:
        return _read_object(Path(folder) / PREPARATION_FILE)
    except InputError:
        return {}


def _write_object(file: Path, content: Mapping[str, Any]) -> None:
    text = json.dumps(_plain(content), indent=2, ensure_ascii=False, allow_nan=False)
    replace_file(file, (text + "\n").encode())


def _read_object(file: Path) -> dict[str, Any]:
    try:
        content = json.loads(_read_text(file))
    except json.JSONDecodeError as error:
        raise InputError(str(file), expected="JSON", got=str(error)) from error
    if not isinstance(content, dict):
        raise InputError(str(file), expected="a JSON object", got=type(content).__name__)
    return content


def _plain(value: Any) -> Any:
    """Only what JSON has."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, (np.ndarray, np.generic)):
        return _plain(value.tolist())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if value is None or isinstance(value, (bool, int, str)) else str(value)


def _checked_names(names: Sequence[str]) -> tuple[str, ...]:
    for name in names:
        if not name or set(name) & set(',"\r\n'):
            raise InputError(f"column or joint {name!r}", expected="a name without commas, quotes and line ends")
    if len(set(names)) != len(names):
        raise InputError("joint or column names", expected="each once", got=",".join(names))
    return tuple(names)


def _check_shape(what: str, array: np.ndarray, shape: tuple[int, ...]) -> None:
    if np.shape(array) != shape:
        raise InputError(what, expected=f"shape {shape}", got=str(np.shape(array)))


def _table_path(path: str | Path, name: str) -> Path:
    return Path(path) / name if Path(path).is_dir() else Path(path)


def _read_text(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise InputError(str(file), expected="UTF-8 text", got="other bytes") from error
    except OSError as error:
        raise InputError(str(file), expected="a file", got=error.strerror or str(error)) from error


def _read_rows(file: Path) -> tuple[list[str], list[list[str]]]:
    """The header, and the lines that were written to their end."""
    lines = _read_text(file).split("\n")
    if len(lines) < 2:
        raise InputError(str(file), expected="a table with a header", got="no whole line")
    return lines[0].rstrip("\r").split(","), [line.rstrip("\r").split(",") for line in lines[1:-1] if line.strip()]


def _numbers(file: Path, rows: list[list[str]], columns: int) -> np.ndarray:
    for line, row in enumerate(rows, start=2):
        if len(row) != columns:
            raise InputError(f"{file}, line {line}", expected="a value in every column", got=",".join(row)[:80])
    try:
        return np.array(rows, dtype=object).astype(np.float64).reshape(len(rows), columns)
    except ValueError as error:
        raise InputError(str(file), expected="numbers", got=str(error)) from error
