"""Marker trajectories in C3D files, the binary format of motion capture laboratories.

Read by the optional package `ezc3d` (extra `io`). The format states its unit; which of its axes points up it does not,
so `axes` says which world axis each of them is, as for TRC files.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from muybridge.errors import InputError
from muybridge.io.trc import METRES_PER_UNIT, MarkerTrack, columns_to_world


def read_c3d(path: str | Path, axes: str = "xyz") -> MarkerTrack:
    """Read the points of a C3D file, markers and what was computed from them, into world coordinates.

    Parameters
    ----------
    path : str or Path
    axes : str
        The world axis of the file's X, Y and Z; the default is a file that is z up already.

    Returns
    -------
    MarkerTrack
        `frames` as the file counts them, from 0; NaN where a point was not seen, or lies exactly at the origin, which
        is how older systems say so.

    Raises
    ------
    InputError
        If ezc3d is not installed, or the file is none that it can read.
    """
    try:
        import ezc3d
    except ImportError as error:
        remedy = "pip install 'muybridge[io]'"
        raise InputError(f"C3D file {path}", expected="the package ezc3d", got="none", remedy=remedy) from error
    try:
        content = ezc3d.c3d(str(path))
    except (OSError, RuntimeError, ValueError, IndexError) as error:
        got = "nothing at this path" if not Path(path).is_file() else " ".join(str(error).split())
        raise InputError(f"C3D file {path}", expected="points over time", got=got) from error
    point = content["parameters"]["POINT"]
    names = [name.strip() for key in _label_keys(point) for name in point[key]["value"]]
    positions = np.array(content["data"]["points"][:3], np.float64).transpose(2, 1, 0)
    if len(names) < positions.shape[1] or not positions.size:
        got = f"{len(names)} names, {positions.shape[1]} points, {len(positions)} frames"
        raise InputError(f"C3D file {path}", expected="named points over time", got=got)
    positions = without_unseen(positions) * _metres(point, path)
    frames = int(content["header"]["points"]["first_frame"]) + np.arange(len(positions))
    rate = float(point["RATE"]["value"][0])
    times = frames / rate if rate > 0 else np.full(len(frames), np.nan)
    return MarkerTrack(tuple(names[: positions.shape[1]]), frames, times, columns_to_world(positions, axes), axes)


def without_unseen(positions: np.ndarray) -> np.ndarray:
    """(..., 3), with NaN where all three coordinates are 0: a marker that was not seen."""
    unseen = (positions == 0).all(axis=-1, keepdims=True)
    return np.where(unseen, np.nan, positions)


def _label_keys(point: dict) -> list[str]:
    """LABELS, and where there are more than 255 points LABELS2, LABELS3, ..."""
    return [key for key in ("LABELS", *(f"LABELS{n}" for n in range(2, 100))) if key in point]


def _metres(point: dict, path: str | Path) -> float:
    """Metres in the file's unit; millimetres where it names none."""
    units = [unit.strip() for unit in point.get("UNITS", {}).get("value", ())]
    unit = units[0] if units and units[0] else "mm"
    if unit not in METRES_PER_UNIT:
        raise InputError(f"units of C3D file {path}", expected=" or ".join(METRES_PER_UNIT), got=repr(unit))
    return METRES_PER_UNIT[unit]
