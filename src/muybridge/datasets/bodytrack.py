"""The bodytrack layout: four cameras, numbered pictures and masks, 58 body measures, 31 pose numbers.

    CAM1/image0000.bmp ..., FG1/image0000.bmp ..., CALIB/Camera1.cal ..., BodyShapeParameters.txt, InitialPose.txt,
    PoseParameters.txt; rendered scenes add plate1.bmp ..., truth_joints.csv and truth_poses.txt.

Numbers are separated by white space, millimetres and radians; they leave this module in metres and radians. The order
of the measures and of the pose is the file's; `muybridge.body.bodytrack` turns both into a body and its degrees of
freedom.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from muybridge.cameras.readers import read_rig
from muybridge.datasets.recording import CameraFiles, Recording
from muybridge.errors import InputError

BODY = "bodytrack"
SHAPE_FILE, POSE_FILE, PARAMETERS_FILE = "BodyShapeParameters.txt", "InitialPose.txt", "PoseParameters.txt"
SEGMENTS, LENGTHS, POSE = 10, 18, 31
ROOT_POSITION = slice(3, 6)
"""The three of the 31 pose numbers that are lengths."""


@dataclass(frozen=True, eq=False)
class BodytrackFolder:
    """Everything that such a folder holds.

    Attributes
    ----------
    recording : Recording
    measures : dict
        `radii` (10, 4) float64: r_proximal, r_distal in metres, scale_x, scale_y, by segment; `lengths` (18,) float64,
        metres. In the order of the file.
    initial_pose : (31,) float64, radians and metres (3 to 5)
    pose_sd, pose_minimum, pose_maximum : (31,) float64 or None
        Standard deviation a frame, and limits; 14 of the published first pose's values lie outside the limits.
    truth_poses : (T, 31) float64 or None
    """

    recording: Recording
    measures: dict[str, NDArray]
    initial_pose: NDArray
    pose_sd: NDArray | None = None
    pose_minimum: NDArray | None = None
    pose_maximum: NDArray | None = None
    truth_poses: NDArray | None = None


def read_bodytrack(folder: Path | str) -> BodytrackFolder:
    """Read a folder in the bodytrack layout."""
    folder = Path(folder)
    recording = bodytrack_recording(folder)
    parameters, truth = folder / PARAMETERS_FILE, folder / "truth_poses.txt"
    sd, minimum, maximum = read_pose_parameters(parameters) if parameters.is_file() else (None, None, None)
    return BodytrackFolder(
        recording,
        read_measures(folder / SHAPE_FILE),
        read_poses(folder / POSE_FILE)[0],
        sd,
        minimum,
        maximum,
        read_poses(truth) if truth.is_file() else None,
    )


def bodytrack_recording(folder: Path | str) -> Recording:
    """The pictures, masks, plates and cameras of a folder in the bodytrack layout."""
    folder = Path(folder).absolute()
    numbers = _camera_numbers(folder)
    calibration = tuple(folder / "CALIB" / f"Camera{n}.cal" for n in numbers)
    counts = {f"CAM{n}": _count(folder / f"CAM{n}") for n in numbers}
    cameras = tuple(_camera_files(folder, n) for n in numbers)
    counts |= {camera.masks.parent.name: _count(camera.masks.parent) for camera in cameras if camera.masks}
    if len(set(counts.values())) > 1:
        found = ", ".join(f"{name} {count}" for name, count in counts.items())
        raise InputError(f"pictures in {folder}", expected="as many for each camera", got=found)
    truth = folder / "truth_joints.csv"
    return Recording(
        name=folder.name,
        rig=_read_cameras(calibration, cameras),
        cameras=cameras,
        frame_count=min(counts.values()),
        calibration=calibration,
        body=BODY,
        measures=folder / SHAPE_FILE if (folder / SHAPE_FILE).is_file() else None,
        start=folder / POSE_FILE if (folder / POSE_FILE).is_file() else None,
        reference=truth if truth.is_file() else None,
    )


def read_measures(path: Path | str) -> dict[str, NDArray]:
    """`radii` (10, 4) and `lengths` (18,) in metres from the 58 numbers of BodyShapeParameters.txt."""
    values = read_numbers(path, 4 * SEGMENTS + LENGTHS)
    radii = values[: 4 * SEGMENTS].reshape(SEGMENTS, 4).copy()
    radii[:, :2] /= 1000
    lengths = values[4 * SEGMENTS :] / 1000
    if (radii <= 0).any() or (lengths < 0).any():
        raise InputError(str(path), expected="radii above 0 and lengths of 0 or more", got="a smaller one")
    return {"radii": radii, "lengths": lengths}


def read_poses(path: Path | str) -> NDArray:
    """(T, 31) float64, radians and metres, from rows of 31 numbers (InitialPose.txt, truth_poses.txt)."""
    return _in_metres(read_numbers(path, POSE, repeated=True).reshape(-1, POSE))


def read_pose_parameters(path: Path | str) -> tuple[NDArray, NDArray, NDArray]:
    """Standard deviations a frame, minima and maxima, each (31,), from PoseParameters.txt."""
    rows = _in_metres(read_numbers(path, 3 * POSE).reshape(3, POSE))
    return rows[0], rows[1], rows[2]


def read_numbers(path: Path | str, count: int, *, repeated: bool = False) -> NDArray:
    """Exactly `count` finite numbers separated by white space; `repeated`: or a multiple of it."""
    path = Path(path)
    try:
        values = np.array([float(word) for word in path.read_text(encoding="utf-8").split()])
    except OSError as error:
        raise InputError(str(path), expected=f"{count} numbers", got=error.strerror or str(error)) from error
    except ValueError as error:
        raise InputError(str(path), expected=f"{count} numbers", got=str(error)) from None
    fits = len(values) and len(values) % count == 0 if repeated else len(values) == count
    if not fits:
        raise InputError(str(path), expected=f"{'rows of ' * repeated}{count} numbers", got=str(len(values)))
    if not np.isfinite(values).all():
        raise InputError(str(path), expected="finite numbers", got="nan or inf")
    return values


def _in_metres(poses: NDArray) -> NDArray:
    poses = poses.copy()
    poses[..., ROOT_POSITION] /= 1000
    return poses


def _camera_numbers(folder: Path) -> list[int]:
    """The n of CAMn, each with its calibration."""
    if not folder.is_dir():
        raise InputError(f"bodytrack folder {folder}", expected="a folder", got="none of that name")
    numbers = sorted(int(path.name[3:]) for path in folder.glob("CAM*") if path.is_dir() and path.name[3:].isdecimal())
    if not numbers:
        raise InputError(f"bodytrack folder {folder}", expected="CAM1, CAM2, ...", got="no such folder")
    missing = [f"Camera{n}.cal" for n in numbers if not (folder / "CALIB" / f"Camera{n}.cal").is_file()]
    if missing:
        raise InputError(f"{folder}/CALIB", expected="one .cal file for each CAM folder", got=f"no {missing[0]}")
    return numbers


def _camera_files(folder: Path, number: int) -> CameraFiles:
    masks, plate = folder / f"FG{number}", folder / f"plate{number}.bmp"
    return CameraFiles(
        name=f"Camera{number}",
        pictures=folder / f"CAM{number}" / "image%04d.bmp",
        masks=masks / "image%04d.bmp" if masks.is_dir() else None,
        plate=plate if plate.is_file() else None,
    )


def _count(folder: Path) -> int:
    """How many pictures; `io` complains about gaps when they are opened."""
    count = sum(1 for _ in folder.glob("image*.bmp"))
    if not count:
        raise InputError(str(folder), expected="image0000.bmp, ...", got="no picture")
    return count


def _read_cameras(calibration: tuple[Path, ...], cameras: tuple[CameraFiles, ...]):
    """The rig at the pictures' size; .cal files do not say it."""
    from muybridge.io.image_sequence import ImageSequence

    first = ImageSequence(cameras[0].pictures, colour=False)
    return read_rig(calibration, size=first.size)
