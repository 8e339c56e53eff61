"""Marker trajectories in TRC files, as OpenSim, Visual3D and Pose2Sim read and write them.

A TRC file is a table with tabs: three header lines, two lines of column names, then one line a frame. Its unit stands
in the header (`m` or `mm`); its axes stand nowhere. OpenSim's habit is Y up, laboratories often write Z up, and this
module's world is z up, so `axes` says which world axis each file column holds: `"yzx"` means that file X, Y, Z are
world y, z, x (a cyclic turn: right-handed stays right-handed), `"xyz"` means that the file is z up already.

`Frame#` counts from 1 in the format; `MarkerTrack.frames` counts from 0, as video frames do.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from muybridge.errors import InputError
from muybridge.io.disk import replace_file

METRES_PER_UNIT = {"m": 1.0, "cm": 0.01, "mm": 0.001}
AXES_BY_VERTICAL = ("zxy", "yzx", "xyz")
"""Which world axis each column holds, by the column that points up: the cyclic turn that brings it to z."""
UPPER_MARKERS = ("head", "neck", "nose", "c7")
LOWER_MARKERS = ("ankle", "heel", "toe", "foot")


@dataclass(frozen=True)
class MarkerTrack:
    """Markers over time.

    Attributes
    ----------
    names : tuple of str
        The M markers, as the file names them.
    frames : (T,) int64
        Frame numbers from 0.
    times : (T,) float64, seconds
    positions : (T, M, 3) float64, metres, world
        NaN where a marker is missing.
    axes : str
        Which world axis each file column held.
    """

    names: tuple[str, ...]
    frames: np.ndarray
    times: np.ndarray
    positions: np.ndarray
    axes: str = "yzx"


def read_trc(path: str | Path, axes: str | None = None) -> MarkerTrack:
    """Read a TRC file into world coordinates.

    Parameters
    ----------
    path : str or Path
    axes : str, optional
        The world axis of file X, Y and Z, e.g. `"yzx"`. Left out, the column along which heads are above feet is taken
        as vertical and turned to z; without such markers the file is taken as OpenSim's, Y up.

    Returns
    -------
    MarkerTrack

    Raises
    ------
    InputError
        If the file is no TRC file, its unit is unknown, or `axes` is no permutation of x, y, z.
    """
    lines = _lines(Path(path))
    header = dict(zip(lines[1].split(), lines[2].split(), strict=False))
    scale = _scale(header.get("Units", ""), path)
    names = tuple(cell.strip() for cell in lines[3].split("\t")[2:] if cell.strip())
    rows = [line for line in lines[5:] if line.strip()]
    if not names or not rows:
        raise InputError(
            f"TRC file {path}", expected="markers and frames", got=f"{len(names)} markers, {len(rows)} frames"
        )
    numbers = np.array([_numbers(row, 2 + 3 * len(names), path) for row in rows])
    if not np.isfinite(numbers[:, :2]).all():
        raise InputError(f"TRC file {path}", expected="a frame number and a time in every line", got="a line without")
    columns = scale * numbers[:, 2:].reshape(len(rows), len(names), 3)
    axes = axes or guess_axes(names, columns)
    return MarkerTrack(names, numbers[:, 0].astype(np.int64) - 1, numbers[:, 1], columns_to_world(columns, axes), axes)


def write_trc(
    path: str | Path,
    names: tuple[str, ...],
    positions: np.ndarray,
    rate_hz: float,
    *,
    first_frame: int = 0,
    times: np.ndarray | None = None,
    axes: str = "yzx",
    units: str = "m",
) -> None:
    """Write world positions as a TRC file.

    Parameters
    ----------
    path : str or Path
    names : tuple of str
        The M markers.
    positions : (T, M, 3) float64, metres, world
        NaN is written as an empty cell, the format's sign for a missing marker.
    rate_hz : float
        Frames a second.
    first_frame : int
        Number of the first frame, from 0.
    times : (T,) float64, seconds, optional
        Default: frame number over rate.
    axes : str
        The world axis that file X, Y and Z hold; the default is Y up, as OpenSim expects.
    units : str
        `"m"`, `"cm"` or `"mm"`.
    """
    positions = np.asarray(positions, float)
    if positions.ndim != 3 or positions.shape[1:] != (len(names), 3):
        raise InputError("positions for a TRC file", expected=f"shape (T, {len(names)}, 3)", got=f"{positions.shape}")
    columns = world_to_columns(positions, axes) / _scale(units, path)
    frames = first_frame + np.arange(len(positions))
    times = frames / rate_hz if times is None else np.asarray(times, float)
    lines = _header(Path(path).name, names, len(positions), rate_hz, units, first_frame)
    for frame, time, row in zip(frames, times, columns.reshape(len(columns), -1), strict=True):
        cells = ("" if np.isnan(value) else f"{value:.7g}" for value in row)
        lines.append("\t".join([str(frame + 1), f"{time:.6f}", *cells]))
    replace_file(path, ("\n".join(lines) + "\n").encode())


def columns_to_world(columns: np.ndarray, axes: str) -> np.ndarray:
    """File columns (..., 3) to world coordinates (..., 3), given the world axis of each column."""
    order = _axis_order(axes)
    return columns[..., [order.index(axis) for axis in range(3)]]


def world_to_columns(positions: np.ndarray, axes: str) -> np.ndarray:
    """World coordinates (..., 3) to file columns (..., 3): the inverse of `columns_to_world`."""
    return positions[..., _axis_order(axes)]


def guess_axes(names: tuple[str, ...], columns: np.ndarray) -> str:
    """The axes of a file from where its heads and feet are; OpenSim's Y up where the names say nothing.

    Parameters
    ----------
    names : tuple of str
    columns : (T, M, 3) float64
        File columns X, Y, Z.
    """
    upper = [i for i, name in enumerate(names) if any(word in name.lower() for word in UPPER_MARKERS)]
    lower = [i for i, name in enumerate(names) if any(word in name.lower() for word in LOWER_MARKERS)]
    if not upper or not lower or np.isnan(columns[:, upper]).all() or np.isnan(columns[:, lower]).all():
        return AXES_BY_VERTICAL[1]
    rise = np.nanmedian(columns[:, upper], axis=(0, 1)) - np.nanmedian(columns[:, lower], axis=(0, 1))
    return AXES_BY_VERTICAL[int(np.argmax(rise))]


def _lines(path: Path) -> list[str]:
    try:
        lines = path.read_text(encoding="utf-8-sig", errors="replace").splitlines()
    except OSError as error:
        raise InputError(f"TRC file {path}", expected="a readable file", got=error.strerror or "an error") from error
    if len(lines) < 6 or not lines[0].startswith("PathFileType"):
        raise InputError(
            f"TRC file {path}",
            expected="a first line that begins with PathFileType and five header lines",
            got=f"{len(lines)} lines" + (f" beginning with {lines[0][:20]!r}" if lines else ""),
        )
    return lines


def _scale(units: str, path: str | Path) -> float:
    if units not in METRES_PER_UNIT:
        raise InputError(f"units of TRC file {path}", expected=" or ".join(METRES_PER_UNIT), got=repr(units))
    return METRES_PER_UNIT[units]


def _numbers(line: str, width: int, path: str | Path) -> list[float]:
    """One line's cells as numbers; empty cells, and those that a short line leaves out, are missing."""
    cells = [cell.strip() for cell in line.split("\t")][:width]
    try:
        return [float(cell) if cell else np.nan for cell in cells] + [np.nan] * (width - len(cells))
    except ValueError as error:
        raise InputError(f"TRC file {path}", expected="numbers", got=f"line beginning {line[:30]!r}") from error


def _axis_order(axes: str) -> list[int]:
    if sorted(axes) != ["x", "y", "z"]:
        raise InputError("axes", expected="a permutation of x, y and z such as yzx", got=repr(axes))
    return ["xyz".index(axis) for axis in axes]


def _header(name: str, markers: tuple[str, ...], count: int, rate_hz: float, units: str, first_frame: int) -> list[str]:
    numbers = "\t".join(f"{axis}{i}" for i in range(1, len(markers) + 1) for axis in "XYZ")
    values = (f"{rate_hz:g}", f"{rate_hz:g}", count, len(markers), units, f"{rate_hz:g}", first_frame + 1, count)
    return [
        f"PathFileType\t4\t(X/Y/Z)\t{name}",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        "\t".join(str(value) for value in values),
        "Frame#\tTime\t" + "\t\t\t".join(markers) + "\t\t",
        "\t\t" + numbers,
    ]
