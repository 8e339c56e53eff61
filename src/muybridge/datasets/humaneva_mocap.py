"""HumanEva's motion capture: points over time from a .mat or .c3d file, and a person's measures from an .mp file.

The data set's release code keeps beside each `MOTION.c3d` a `MOTION.mat` with what it read from it, and reads that
where it is there; so does this module. Two variables of such a file are looked at, as data: `Markers` (frames, points,
3) and `ParameterGroup`, the C3D's parameters, of which `POINT: LABELS` names the points. Lengths are millimetres, 0 0 0
is a point that was not seen.

Checked against the release code 1.1 (github.com/emredog/humaneva: TOOLBOX_readc3d/readc3d.m and MarkerName2MarkerId.m,
@mocap_stream/mocap_stream.m, TOOLBOX_common/readmp.m) and against jackd/human_pose_util, which reads the published .mat
and .mp files in Python (dataset/eva/raw_tree/motion_capture_data.py and actor_parameter.py).
"""

from __future__ import annotations

import re
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from muybridge.errors import InputError
from muybridge.io.c3d import read_c3d, without_unseen
from muybridge.io.trc import METRES_PER_UNIT, MarkerTrack

MEASURE = re.compile(r"^\s*\$?(\w+)\s*=\s*([-+.\deE]+)\s*$")


def find_mocap(folder: Path, motion: str) -> Path | None:
    """`MOTION.mat` or else `MOTION.c3d` in a Mocap_Data folder; None where there is neither."""
    candidates = (folder / f"{motion}.mat", folder / f"{motion}.c3d")
    return next((path for path in candidates if path.is_file()), None)


def read_mocap(path: Path | str) -> MarkerTrack:
    """Points over time in metres, z up, in the file's order; NaN where a point was not seen."""
    path = Path(path)
    return read_mat(path) if path.suffix.lower() == ".mat" else read_c3d(path)


def read_mat(path: Path | str) -> MarkerTrack:
    """The points of a .mat file that the release code wrote. Nothing in it is run; up to MATLAB's version 7.

    Returns
    -------
    MarkerTrack
        Row by row from frame 0; times are NaN where the file states no rate.
    """
    content = _load(Path(path))
    what = f"motion capture {path}"
    missing = [name for name in ("Markers", "ParameterGroup") if name not in content]
    if missing:
        raise InputError(what, expected="variables Markers and ParameterGroup", got=f"no {missing[0]}")
    markers = content["Markers"]
    if not isinstance(markers, np.ndarray) or markers.dtype.kind not in "fiu" or markers.ndim != 3:
        raise InputError(f"{what}: Markers", expected="numbers, frames x points x 3", got=_kind(markers))
    point = _parameters(content["ParameterGroup"], "POINT")
    names = tuple(name.strip() for name in _texts(point.get("LABELS")))
    if markers.shape[2] != 3 or not markers.size or len(names) < markers.shape[1]:
        got = f"{_kind(markers)} and {len(names)} labels"
        raise InputError(what, expected="a label for each point, frames x points x 3", got=got)
    unit = (_texts(point.get("UNITS")) or ["mm"])[0].strip() or "mm"
    if unit not in METRES_PER_UNIT:
        raise InputError(f"{what}: units", expected=" or ".join(METRES_PER_UNIT), got=repr(unit))
    positions = without_unseen(markers.astype(np.float64)) * METRES_PER_UNIT[unit]
    rate = content.get("VideoFrameRate")
    frames = np.arange(len(positions))
    times = frames / float(rate) if isinstance(rate, (int, float)) and rate > 0 else np.full(len(frames), np.nan)
    return MarkerTrack(names[: positions.shape[1]], frames, times, positions, "xyz")


def read_measures(path: Path | str) -> dict[str, float]:
    """The measures in a Vicon .mp file by name, as the file has them (millimetres): lines `$LKneeWidth = 105`."""
    path = Path(path)
    try:
        lines = path.read_text(encoding="latin-1").splitlines()
    except OSError as error:
        got = error.strerror or str(error)
        raise InputError(f"measures {path}", expected="a Vicon .mp file", got=got) from error
    found = {match[1]: match[2] for line in lines if (match := MEASURE.match(line))}
    try:
        return {name: float(value) for name, value in found.items()}
    except ValueError as error:
        raise InputError(f"measures {path}", expected="numbers", got=str(error)) from error


def measure(measures: dict[str, float], name: str, path: Path) -> float:
    """One measure by the end of its name, for some files put the person's before it."""
    value = next((value for key, value in measures.items() if key.endswith(name)), None)
    if value is None or not np.isfinite(value):
        raise InputError(f"measures {path}", expected=f"a line ${name} = ...", got="none")
    return value


def _load(path: Path) -> dict[str, Any]:
    from scipy.io import loadmat
    from scipy.io.matlab import MatReadError

    what = f"motion capture {path}"
    wanted = ("Markers", "ParameterGroup", "VideoFrameRate")
    try:
        return loadmat(path, variable_names=wanted, simplify_cells=True)
    except NotImplementedError as error:
        remedy = "save it as version 7: save(..., '-v7'), or take it away where there is a .c3d beside it"
        raise InputError(what, expected="a .mat file up to version 7", got="version 7.3", remedy=remedy) from error
    except (OSError, ValueError, TypeError, KeyError, IndexError, EOFError, MatReadError, zlib.error) as error:
        got = getattr(error, "strerror", None) or " ".join(str(error).split())[:80] or "another file"
        raise InputError(what, expected="a .mat file", got=got) from error


def _parameters(groups: Any, wanted: str) -> dict[str, Any]:
    """The parameters of one of a C3D's groups by their names."""
    for group in _rows(groups):
        if "".join(_texts(group.get("name"))).strip() == wanted:
            return {"".join(_texts(row.get("name"))).strip(): row.get("data") for row in _rows(group.get("Parameter"))}
    return {}


def _rows(value: Any) -> list[dict[str, Any]]:
    """A struct array as a list of dicts, also where it has a single element."""
    items = value.ravel().tolist() if isinstance(value, np.ndarray) else value if isinstance(value, list) else [value]
    return [item for item in items if isinstance(item, dict)]


def _texts(value: Any) -> list[str]:
    """All strings in a cell array, however it is nested."""
    if isinstance(value, str):
        return [value]
    if isinstance(value, np.ndarray):
        value = value.ravel().tolist()
    return [text for item in value for text in _texts(item)] if isinstance(value, (list, tuple)) else []


def _kind(value: Any) -> str:
    return " x ".join(map(str, value.shape)) if isinstance(value, np.ndarray) else type(value).__name__
