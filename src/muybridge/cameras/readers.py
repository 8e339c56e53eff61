"""One door for calibration files: `read_rig` finds out the format and hands the files to its reader."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from muybridge.cameras._reading import read_text
from muybridge.cameras.cal import COUNTS, read_cal
from muybridge.cameras.json_format import read_json
from muybridge.cameras.model import Camera, Rig
from muybridge.cameras.opencv_toml import read_opencv_toml
from muybridge.cameras.opencv_yaml import read_opencv_yaml
from muybridge.cameras.qualisys import read_qualisys
from muybridge.errors import InputError

FORMATS = {
    "toml": "Pose2Sim, Anipose or caliscope (.toml)",
    "yaml": "OpenCV (.yml, .yaml)",
    "qualisys": "Qualisys (.qca.txt)",
    "cal": "HumanEva or bodytrack (.cal)",
    "json": "this program's own (.json)",
}
SUFFIXES = {
    ".toml": "toml",
    ".yml": "yaml",
    ".yaml": "yaml",
    ".qca.txt": "qualisys",
    ".qca": "qualisys",
    ".xml": "qualisys",
    ".cal": "cal",
    ".json": "json",
}
# Rotations that turn the axis named, pointing up in the file's world, to z.
TO_Z_UP = {
    "z": np.eye(3),
    "-z": np.diag([1.0, -1.0, -1.0]),
    "y": np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "-y": np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]),
    "x": np.array([[0.0, 1, 0], [0, 0, 1], [1, 0, 0]]),
    "-x": np.array([[0.0, -1, 0], [0, 0, 1], [-1, 0, 0]]),
}


def read_rig(
    paths: Path | str | Sequence[Path | str],
    unit: str | None = None,
    *,
    size: tuple[int, int] | None = None,
    up: str = "z",
) -> Rig:
    """Cameras from calibration files of any known format, in metres and with z up.

    Parameters
    ----------
    paths : a file, a folder with files of one format, or a list of files of one format
    unit : "m", "cm" or "mm"
        Of the lengths in the file. None: what the format fixes (Qualisys and .cal: mm; our own: m), else judged
        from the rig's size; a rig that could be either is refused.
    size : (width, height), pixels
        For formats that leave the picture's size out (.cal, some YAML).
    up : "z", "y", "x", "-z", "-y" or "-x"
        The axis of the file's world that points up; the world is turned so that it becomes z.

    Raises
    ------
    InputError
        One line, when a path, the content, a key or a value cannot be used.
    """
    if up not in TO_Z_UP:
        raise InputError("up axis", expected="one of " + ", ".join(TO_Z_UP), got=repr(up))
    files = _files(paths)
    kinds = {_format_of(path) for path in files}
    if len(kinds) > 1:
        raise InputError("calibration", expected="files of one format", got=" and ".join(sorted(kinds)))
    cameras = _read(kinds.pop(), files, unit, size)
    return Rig(tuple(cameras if up == "z" else (camera.in_world(TO_Z_UP[up]) for camera in cameras)))


def read_camera(path: Path) -> Camera:
    """The one camera of a calibration file, in metres and with z up; a file of several is refused."""
    rig = read_rig(path)
    if len(rig) != 1:
        raise InputError(str(path), expected="one camera", got=f"{len(rig)}: {', '.join(rig.names)}")
    return rig[0]


def _read(kind: str, files: list[Path], unit: str | None, size: tuple[int, int] | None) -> list[Camera]:
    if kind == "toml":
        return read_opencv_toml(files, unit)
    if kind == "yaml":
        return read_opencv_yaml(files, unit, size)
    if kind == "qualisys":
        return read_qualisys(files, unit)
    if kind == "cal":
        return read_cal(files, unit, size)
    if unit not in (None, "m"):
        raise InputError("unit of length", expected="'m', which our own format fixes", got=repr(unit))
    return read_json(files)


def _files(paths: Path | str | Sequence[Path | str]) -> list[Path]:
    """A list of files; a folder stands for the calibration files in it."""
    if isinstance(paths, (str, os.PathLike)):
        path = Path(paths)
        if not os.path.isdir(path):  # which answers for impossible paths too
            return [path]
        found = sorted((file for file in path.iterdir() if file.is_file() and _suffix_of(file)), key=_natural)
        if not found:
            raise InputError(f"calibration {path}", expected="calibration files in this folder", got="none")
        return found
    try:
        files = [Path(path) for path in paths]
    except TypeError:
        raise InputError("calibration", expected="a path or a list of paths", got=type(paths).__name__) from None
    if not files:
        raise InputError("calibration", expected="at least one file", got="none")
    return files


def _natural(path: Path) -> list[tuple[int, int | str]]:
    """Sorts camera2 before camera10."""
    return [(0, int(part)) if part.isdecimal() else (1, part) for part in re.split(r"(\d+)", path.name) if part]


def _suffix_of(path: Path) -> str | None:
    return next((suffix for suffix in SUFFIXES if path.name.lower().endswith(suffix)), None)


def _format_of(path: Path) -> str:
    """By the name's end, else by how the content begins."""
    suffix = _suffix_of(path)
    if suffix:
        return SUFFIXES[suffix]
    text = read_text(path).lstrip()
    for beginning, kind in (("%YAML", "yaml"), ("<", "qualisys"), ("{", "json"), ("[", "toml")):
        if text.startswith(beginning):
            return kind
    if len(text.split()) in COUNTS:
        return "cal"
    raise InputError(f"calibration {path}", expected="one of: " + "; ".join(FORMATS.values()), got="another format")
