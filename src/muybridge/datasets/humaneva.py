"""HumanEva-I and HumanEva-II: a user's own copy of a motion -> a recording with its motion capture as reference.

    DIR/S1/Image_Data/Walking_1_(C1).avi      or a folder Walking_1_(C1)/ of pictures, as in HumanEva-II
    DIR/S1/Calibration_Data/C1.cal            22 numbers, see `cameras.cal`
    DIR/S1/Sync_Data/Walking_1_(C1).ofs       3 numbers, see `humaneva_frames`
    DIR/S1/Mocap_Data/Walking_1.mat or .c3d, Static.mat or .c3d, S1.mp       see `humaneva_mocap`, `humaneva_joints`
    DIR/Background/Background_1_(C1).avi      HumanEva-I; HumanEva-II: DIR/S2/Background/Background_1_(C1)/

L. Sigal, A. Balan, M. Black: HumanEva: Synchronized Video and Motion Capture Dataset and Baseline Algorithm for
Evaluation of Articulated Human Motion. IJCV 87, 2010. The data set itself may not be passed on and is not tested here.

Folders and names were checked against the release code 1.1 (github.com/emredog/humaneva: @sync_stream/sync_stream.m,
HumanEva_I and HumanEva_II/BackgroundSubtraction.m) and jackd/human_pose_util, dataset/eva/README.md. That the world is
z up: by the cameras' places in facebookresearch/VideoPose3D, common/humaneva_dataset.py, all 1.4 to 1.5 m above the
floor. From the publication alone: 60 pictures a second. The choice among several background videos is this program's.
"""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from muybridge.cameras import Camera, Rig
from muybridge.cameras.readers import read_rig
from muybridge.datasets.humaneva_frames import (
    RATE_HZ,
    REPEATED,
    StreamOffset,
    Synchrony,
    part_frames,
    read_offset,
    synchronise,
)
from muybridge.datasets.humaneva_mocap import find_mocap, measure, read_measures, read_mocap
from muybridge.datasets.recording import CameraFiles, Recording
from muybridge.errors import InputError
from muybridge.io.run_folder import JointSeries

if TYPE_CHECKING:
    from muybridge.datasets.humaneva_joints import Person

CAMERA = re.compile(r"^(.+)_\((C|BW)(\d+)\)$")
SENSIBLE_HEIGHT = (1.2, 2.3)
"""Metres; what an .mp file states outside is taken for something else."""


@dataclass(frozen=True)
class _Stream:
    """One camera's pictures, opened once to learn their size and count."""

    name: str
    pictures: Path
    size: tuple[int, int]
    count: int
    """From the picture that is frame 0."""


def humaneva_recording(
    folder: Path | str,
    *,
    subject: str | None = None,
    motion: str | None = None,
    cameras: str | None = None,
    part: str | None = None,
) -> Recording:
    """One motion of one person.

    Parameters
    ----------
    folder : Path
        The data set with folders S1, S2, ..., or one of those.
    subject, motion : str, optional
        Such as "S1" and "Walking_1"; needed where there are several.
    cameras : str, optional
        Such as "C1,C2,BW1"; the colour cameras where absent.
    part : str, optional
        "train", "validate" or "test": the published part of the motion. Where absent, all frames that the cameras and,
        where there is one, the motion capture have.
    """
    person = find_subject(Path(folder).absolute(), subject)
    motion = find_motion(person, motion)
    offsets = find_offsets(person, motion)
    names = _chosen(offsets, cameras, f"{person.name} {motion}")
    synchrony = synchronise(offsets)
    streams = [_open(person, motion, name, synchrony.first[name]) for name in names]
    count = min(stream.count for stream in streams)
    reference, covered = _reference(person, motion, synchrony, count)
    frames = _frames(person.name, motion, part, streams, min(count, covered))
    _tell_invalid(motion, reference, frames)
    return Recording(
        name=f"{person.name}_{motion}",
        rig=Rig(tuple(_camera(person, stream) for stream in streams)),
        cameras=tuple(_camera_files(person, stream, synchrony, count) for stream in streams),
        frame_count=count,
        frame_rate=RATE_HZ,
        height_m=_height(person),
        truth=reference,
        frames=frames,
    )


def find_subject(folder: Path, subject: str | None) -> Path:
    """The folder of one person: the one named, the only one, or `folder` itself where it is one."""
    if not folder.is_dir():
        raise InputError(f"HumanEva folder {folder}", expected="a folder", got="none of that name")
    if (folder / "Image_Data").is_dir() and subject in (None, folder.name):
        return folder
    people = sorted(path for path in folder.iterdir() if (path / "Image_Data").is_dir())
    return folder / _the_one("--subject", subject, [path.name for path in people], f"HumanEva folder {folder}",
                             "S1/Image_Data, ...")  # fmt: skip


def find_motion(person: Path, motion: str | None) -> str:
    """A motion that has videos: the one named or the only one."""
    found = {match[1] for path in (person / "Image_Data").iterdir() if (match := CAMERA.match(_stem(path)))}
    return _the_one("--motion", motion, sorted(found), f"{person / 'Image_Data'}", "Walking_1_(C1).avi, ...")


def find_offsets(person: Path, motion: str) -> dict[str, StreamOffset]:
    """The offset of every camera that has one, colour cameras first."""
    found = []
    for path in (person / "Sync_Data").glob("*.ofs") if (person / "Sync_Data").is_dir() else ():
        match = CAMERA.match(path.stem)
        if match and match[1] == motion:
            found.append((match[2] != "C", int(match[3]), f"{match[2]}{match[3]}", path))
    if not found:
        raise InputError(f"{person / 'Sync_Data'}", expected=f"{motion}_(C1).ofs, ...", got="none")
    return {name: read_offset(path) for _, _, name, path in sorted(found)}


def _the_one(option: str, wanted: str | None, found: list[str], where: str, expected: str) -> str:
    """The one asked for, or the only one there is."""
    if not found:
        raise InputError(where, expected=expected, got="none")
    if wanted is None and len(found) == 1:
        return found[0]
    if wanted not in found:
        got = "several" if wanted is None else repr(wanted)
        raise InputError(where, expected=f"one of {', '.join(found)}", got=got, remedy=f"choose with {option}")
    return wanted


def _chosen(offsets: dict[str, StreamOffset], cameras: str | None, what: str) -> list[str]:
    if cameras is None:
        colour = [name for name in offsets if name.startswith("C")]
        return colour or list(offsets)
    wanted = [name.strip() for name in cameras.split(",") if name.strip()]
    unknown = [name for name in wanted if name not in offsets]
    if unknown or not wanted or len(set(wanted)) < len(wanted):
        got = ", ".join(unknown or wanted) or "none"
        raise InputError(f"cameras of {what}", expected=f"some of {', '.join(offsets)}, each once", got=got)
    return wanted


def _stem(path: Path) -> str:
    return path.name if path.is_dir() else path.stem


def _pictures(folder: Path, name: str) -> Path | None:
    """A folder of pictures, else a video, as the release code prefers them."""
    candidates = (folder / name, folder / f"{name}.avi")
    return next((path for path in candidates if path.is_dir() or path.is_file()), None)


def _open(person: Path, motion: str, name: str, first: int) -> _Stream:
    from muybridge.io.video import open_pictures

    pictures = _pictures(person / "Image_Data", f"{motion}_({name})")
    if pictures is None:
        expected = f"{motion}_({name}).avi, or a folder of pictures"
        raise InputError(f"{person / 'Image_Data'}", expected=expected, got="neither")
    with open_pictures(pictures, RATE_HZ) as source:
        size, count = source.size, source.frame_count - first
    if count < 1:
        got = f"{count + first}"
        raise InputError(f"pictures {pictures}", expected=f"more than {first}, where the motion begins", got=got)
    return _Stream(name, pictures, (int(size[0]), int(size[1])), count)


def _camera(person: Path, stream: _Stream) -> Camera:
    path = person / "Calibration_Data" / f"{stream.name}.cal"
    (camera,) = read_rig(path, size=stream.size)
    return camera


def _camera_files(person: Path, stream: _Stream, synchrony: Synchrony, count: int) -> CameraFiles:
    first = synchrony.first[stream.name]
    empty = find_background(person, stream.name, stream.pictures)
    return CameraFiles(stream.name, stream.pictures, empty=empty, frames=(first, first + count - 1))


def find_background(person: Path, camera: str, pictures: Path) -> Path:
    """Pictures of the empty scene for a camera; of several, those that look most like `pictures` do.

    HumanEva-I has three, taken on different days. Compared are single pictures, by the median over pixels of their
    difference, which a person in one of them does not move.
    """
    found: list[Path] = []
    for folder in (person / "Background", person.parent / "Background"):
        for path in sorted(folder.iterdir()) if folder.is_dir() and not found else ():
            match = CAMERA.match(_stem(path))
            if match and f"{match[2]}{match[3]}" == camera and (path.is_dir() or path.suffix.lower() == ".avi"):
                found.append(path)
    if not found:
        expected = f"Background_1_({camera}).avi, or a folder of pictures"
        remedy = "unpack the data set's Background there"
        raise InputError(f"{person.parent / 'Background'}", expected=expected, got="none", remedy=remedy)
    if len(found) == 1:
        return found[0]
    seen = _middle_picture(pictures)
    return min(found, key=lambda path: _unlike(_middle_picture(path), seen))


def _middle_picture(path: Path) -> np.ndarray:
    from muybridge.io.video import open_pictures

    with open_pictures(path, RATE_HZ, colour=False) as source:
        return source.read(source.frame_count // 2)


def _unlike(one: np.ndarray, other: np.ndarray) -> float:
    if one.shape != other.shape:
        return float("inf")
    return float(np.median(np.abs(one.astype(np.int16) - other.astype(np.int16))))


def _reference(person: Path, motion: str, synchrony: Synchrony, count: int) -> tuple[JointSeries | None, int]:
    """The motion capture at the cameras' frames, and how many of them it covers."""
    from muybridge.datasets.humaneva_joints import JOINTS, humaneva_joints

    folder = person / "Mocap_Data"
    path = find_mocap(folder, motion)
    if path is None:
        warnings.warn(f"{person.name} {motion} has no motion capture: a job without [reference]", stacklevel=3)
        return None, count
    track = read_mocap(path)
    covered = min(count, synchrony.mocap_frames(len(track.positions)))
    if not covered:
        expected = f"more than {synchrony.mocap_first:.0f} frames, where the videos begin"
        raise InputError(f"motion capture {path}", expected=expected, got=str(len(track.positions)))
    frames = np.arange(covered)
    joints = humaneva_joints(track, synchrony.mocap_rows(frames), _measured(person))
    return JointSeries(JOINTS, frames, frames / RATE_HZ, joints, np.full(joints.shape[:2], np.nan)), covered


def _measured(person: Path) -> Person:
    from muybridge.datasets.humaneva_joints import Person, torso_radius

    folder = person / "Mocap_Data"
    static, measures = find_mocap(folder, "Static"), folder / f"{person.name}.mp"
    if static is None:
        raise InputError(f"{folder}", expected="Static.mat or Static.c3d, the standing trial", got="neither")
    values = read_measures(measures)
    left, right = (measure(values, f"{side}ShoulderOffset", measures) / 1000 for side in "LR")
    return Person(torso_radius(read_mocap(static)), (left, right))


def _height(person: Path) -> float | None:
    """Metres, where the .mp file states it."""
    measures = person / "Mocap_Data" / f"{person.name}.mp"
    values = read_measures(measures) if measures.is_file() else {}
    height = next((value / 1000 for name, value in values.items() if name.endswith("Height")), 0.0)
    return height if SENSIBLE_HEIGHT[0] <= height <= SENSIBLE_HEIGHT[1] else None


def _frames(person: str, motion: str, part: str | None, streams: list[_Stream], count: int) -> tuple[int, int]:
    """First and last frame, from 0; `count` is what cameras and motion capture all have."""
    if part is None:
        first, last = (REPEATED if any(stream.pictures.is_file() for stream in streams) else 0), count - 1
    else:
        first, last = part_frames(person, motion, part)
    if not first <= last < count:
        shortest = min(stream.count for stream in streams)
        what = "motion capture" if count < shortest else "pictures"
        raise InputError(
            f"{person} {motion}", expected=f"{what} of {max(first, last) + 1} frames", got=f"{count}",
            remedy="take another part, or see whether the files are whole",
        )  # fmt: skip
    return first, last


def _tell_invalid(motion: str, reference: JointSeries | None, frames: tuple[int, int]) -> None:
    if reference is not None:
        within = (reference.frames >= frames[0]) & (reference.frames <= frames[1])
        invalid = int(np.isnan(reference.positions[within]).any(axis=(1, 2)).sum())
        if invalid:
            warnings.warn(
                f"{motion}: {invalid} of {int(within.sum())} frames have no valid motion capture", stacklevel=3
            )
