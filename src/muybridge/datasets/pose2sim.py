"""A Pose2Sim project or trial: Config.toml, calibration/, videos/ (or a folder of pictures a camera in it).

As in Pose2Sim, what a trial's Config.toml leaves out comes from the one a level or two above, and so does the
calibration. Cameras and videos belong together by name where all names agree, else by their order.

Where both are there, the Qualisys file (.qca.txt) wins over the .toml made of it: one converter divided the distortion
by 64 on the way, and the original cannot have that fault.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from muybridge.cameras import Camera, Rig
from muybridge.cameras.readers import read_rig
from muybridge.datasets.fitting import fit_camera
from muybridge.datasets.recording import CameraFiles, Recording
from muybridge.errors import InputError

LEVELS = 3
"""A trial lies in a participant, that in a session."""
VIDEO_SUFFIXES = frozenset({".mp4", ".avi", ".mov", ".mkv", ".m4v", ".mpg", ".mpeg", ".webm"})
CALIBRATION_PATTERNS = ("*.qca.txt", "*.toml", "*.json", "*.y*ml")
DEFAULT_PICTURE_RATE = 60.0
"""Frames a second that Pose2Sim assumes for pictures."""


def pose2sim_recording(folder: Path | str) -> Recording:
    """The videos and cameras of a Pose2Sim trial, with the participant's height where it is stated."""
    folder = Path(folder).absolute()
    if not folder.is_dir():
        raise InputError(f"Pose2Sim folder {folder}", expected="a folder", got="none of that name")
    return recording_of_parts(folder, read_config(folder).get("project", {}))


def recording_of_parts(folder: Path, project: dict[str, Any]) -> Recording:
    """The same with the `[project]` table given, for folders that have no Config.toml."""
    pictures = find_pictures(folder / "videos")
    calibration = find_calibration(folder)
    cameras, counts, changed = [], [], False
    for camera, path in match_cameras(read_rig(calibration), pictures):
        fitted, count = _fit_and_count(camera, path)
        changed |= fitted != camera
        cameras.append((fitted, path))
        counts.append(count)
    return Recording(
        name=folder.name,
        rig=Rig(tuple(camera for camera, _ in cameras)),
        cameras=tuple(CameraFiles(camera.name, path, plate=_plate(folder, path)) for camera, path in cameras),
        frame_count=min(counts),
        frame_rate=_frame_rate(project),
        calibration=() if changed else (calibration,),
        height_m=_positive(project.get("participant_height")),
        frames=_frames(project.get("frame_range")),
        reference=_reference(folder),
    )


def read_config(folder: Path) -> dict[str, Any]:
    """Config.toml of the folder over those of the levels above, table by table."""
    merged: dict[str, Any] = {}
    for level in reversed(list(_levels(folder))):
        path = level / "Config.toml"
        if not path.is_file():
            continue
        try:
            tables = tomllib.loads(path.read_text(encoding="utf-8"))
        except (tomllib.TOMLDecodeError, UnicodeDecodeError, OSError) as error:
            raise InputError(str(path), expected="a Pose2Sim configuration in TOML", got=str(error)) from error
        for key, table in tables.items():
            merged[key] = {**merged.get(key, {}), **table} if isinstance(table, dict) else table
    if not merged:
        raise InputError(f"Pose2Sim folder {folder}", expected="Config.toml, here or above", got="none")
    return merged


def participant_mass(folder: Path | str) -> float | None:
    """Kilograms of the (first) participant, where the configuration says so."""
    return _positive(read_config(Path(folder).absolute()).get("project", {}).get("participant_mass"))


def find_pictures(folder: Path) -> list[Path]:
    """The videos in a folder in natural order, or its sub-folders that hold pictures."""
    from muybridge.io.image_sequence import IMAGE_SUFFIXES

    entries = sorted(folder.iterdir(), key=_natural) if folder.is_dir() else []
    videos = [path for path in entries if path.suffix.lower() in VIDEO_SUFFIXES]
    sequences = [
        path
        for path in entries
        if path.is_dir() and any(inner.suffix.lower() in IMAGE_SUFFIXES for inner in path.iterdir())
    ]
    if not videos and not sequences:
        raise InputError(str(folder), expected="videos, or a folder of pictures for each camera", got="neither")
    return videos or sequences


def find_calibration(folder: Path) -> Path:
    """The calibration file of a trial: in `calibration/` or `Calibration/`, here or up to two levels above."""
    for level in _levels(folder):
        for name in ("calibration", "Calibration"):
            for pattern in CALIBRATION_PATTERNS:
                found = sorted((level / name).glob(pattern), key=_natural)
                if found:
                    return found[0]
    raise InputError(f"Pose2Sim folder {folder}", expected="calibration/ with Calib*.toml or *.qca.txt, here or above",
                     got="none", remedy="run Pose2Sim's calibration, or muybridge calibrate")  # fmt: skip


def match_cameras(rig: Rig, pictures: list[Path]) -> list[tuple[Camera, Path]]:
    """Each camera with its pictures: by name where all names agree (cam_01 and cam01.mp4), else by order."""
    if len(rig) != len(pictures):
        raise InputError(
            "Pose2Sim videos", expected=f"{len(rig)}, as many as calibrated cameras", got=str(len(pictures))
        )
    by_name = {_plain(path.stem): path for path in pictures}
    if len(by_name) == len(pictures) and {_plain(name) for name in rig.names} == set(by_name):
        return [(camera, by_name[_plain(camera.name)]) for camera in rig]
    return list(zip(rig, pictures, strict=True))


def _fit_and_count(camera: Camera, path: Path) -> tuple[Camera, int]:
    from muybridge.io.video import open_pictures

    with open_pictures(path) as source:
        fitted = camera if source.size == camera.size else fit_camera(camera, source.read(0))
        return fitted, source.frame_count


def _plate(folder: Path, pictures: Path) -> Path | None:
    """plates/NAME.png or plates/NAME_*.png, which is this program's own addition to the layout."""
    exact = folder / "plates" / f"{pictures.stem}.png"
    found = [exact] if exact.is_file() else sorted((folder / "plates").glob(f"{pictures.stem}_*.png"))
    return found[0] if found else None


def _reference(folder: Path) -> Path | None:
    """What Pose2Sim itself found, filtered rather than raw."""
    found = sorted((folder / "pose-3d").glob("*.trc"))
    filtered = [path for path in found if "filt" in path.name and "LSTM" not in path.name]
    return next(iter(filtered or found), None)


def _frame_rate(project: dict[str, Any]) -> float:
    return _positive(project.get("frame_rate")) or DEFAULT_PICTURE_RATE


def _frames(value: Any) -> tuple[int, int] | None:
    """`frame_range = [first, end]`; the end is not included there, and is here."""
    ok = isinstance(value, list) and len(value) == 2 and all(isinstance(v, int) for v in value)
    return (value[0], value[1] - 1) if ok and 0 <= value[0] < value[1] else None


def _positive(value: Any) -> float | None:
    """A number, or the first of a list; None for 'auto'."""
    first = value[0] if isinstance(value, list) and value else value
    return float(first) if isinstance(first, (int, float)) and not isinstance(first, bool) and first > 0 else None


def _levels(folder: Path) -> Iterator[Path]:
    yield from (folder, *folder.parents)[:LEVELS]


def _plain(name: str) -> str:
    """Letters and numbers alone, leading zeros dropped: cam_01, Cam1 and cam01 are one name."""
    return "".join(str(int(part)) if part.isdecimal() else part for part in re.findall(r"[a-z]+|\d+", name.lower()))


def _natural(path: Path) -> list[tuple[int, int | str]]:
    return [(0, int(p)) if p.isdecimal() else (1, p) for p in re.split(r"(\d+)", path.name) if p]
