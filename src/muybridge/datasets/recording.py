"""What a folder in a known layout holds, as plain data, and the job that tracks it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from muybridge.cameras import Rig
from muybridge.errors import InputError

if TYPE_CHECKING:
    from muybridge.io.run_folder import JointSeries

JOB_FILE = "JOB.toml"
CAMERAS_FILE = "cameras.json"
REFERENCE_FILE = "reference.csv"


@dataclass(frozen=True)
class CameraFiles:
    """Where one camera's pictures are."""

    name: str
    pictures: Path
    """A video, or a pattern such as `image%04d.bmp`."""
    masks: Path | None = None
    """A video or a pattern; white is the person."""
    plate: Path | None = None
    """A picture of the empty scene, of the pictures' size."""
    empty: Path | None = None
    """Or a video or a folder of it."""
    frames: tuple[int, int] | None = None
    """First and last picture that belong to the recording, both included, from 0; None is all."""


@dataclass(frozen=True)
class Recording:
    """Pictures of several cameras with their calibration, and whatever else came with them."""

    name: str
    rig: Rig
    """In the order of `cameras`, for the pictures as they are stored."""
    cameras: tuple[CameraFiles, ...]
    frame_count: int
    """Of the shortest camera."""
    frame_rate: float | None = None
    """Frames a second, where the files themselves do not say."""
    calibration: tuple[Path, ...] = ()
    """The files that give `rig` as it is; empty where it had to be corrected."""
    body: str | None = None
    """A body of the catalogue."""
    measures: Path | None = None
    """A file with the body's lengths and radii."""
    height_m: float | None = None
    start: Path | None = None
    """A file with the first pose."""
    reference: Path | None = None
    """Another measurement of the same motion: TRC or truth_joints.csv."""
    truth: JointSeries | None = None
    """Or the joints themselves, where no file has them as they are needed; written beside the job."""
    frames: tuple[int, int] | None = None
    """First and last frame of interest, both included, counted from 0; None is all."""

    def __post_init__(self) -> None:
        if self.rig.names != tuple(camera.name for camera in self.cameras):
            raise InputError(f"recording {self.name}", expected=f"pictures for {', '.join(self.rig.names)}",
                             got=", ".join(camera.name for camera in self.cameras))  # fmt: skip


def write_recording_job(recording: Recording, folder: Path | str) -> str:
    """Write `JOB.toml` into `folder`; beside it `cameras.json` and `reference.csv` where no file has what they have.

    Returns
    -------
    str
        The text of the job. Paths inside `folder` are relative, others absolute.
    """
    from muybridge.cameras.json_format import write_rig
    from muybridge.io import job as jobs
    from muybridge.io.disk import make_folder
    from muybridge.io.run_folder import write_joints

    folder = make_folder(Path(folder).absolute())
    calibration = recording.calibration
    if not calibration:
        calibration = (folder / CAMERAS_FILE,)
        write_rig(calibration[0], recording.rig)
    if recording.truth is not None:
        write_joints(folder / REFERENCE_FILE, recording.truth)
        recording = replace(recording, reference=folder / REFERENCE_FILE)
    job = recording_job(recording, calibration)
    jobs.write(folder / JOB_FILE, job)
    return (folder / JOB_FILE).read_text(encoding="utf-8")


def recording_job(recording: Recording, calibration: tuple[Path, ...]):
    """The `io.job.Job` for a recording whose cameras are in the files `calibration`."""
    from muybridge.io import job as jobs

    single = len(calibration) == 1
    optional = {
        "body": _body_input(recording),
        "start": jobs.StartInput(pose=str(recording.start)) if recording.start else None,
        "reference": jobs.ReferenceInput(file=recording.reference) if recording.reference else None,
    }
    return jobs.Job(
        name=recording.name,
        frames=recording.frames,
        calibration=jobs.CalibrationInput(
            file=calibration[0] if single else None, files=() if single else tuple(calibration)
        ),
        cameras=tuple(_camera_input(camera, recording.frame_rate) for camera in recording.cameras),
        **{key: value for key, value in optional.items() if value is not None},
    )


def _body_input(recording: Recording):
    from muybridge.io import job as jobs

    if not (recording.body or recording.measures or recording.height_m):
        return None
    measures = str(recording.measures) if recording.measures else None
    return jobs.BodyInput(name=recording.body, height_m=recording.height_m, measures=measures)


def _camera_input(camera: CameraFiles, frame_rate: float | None):
    """Masks win over a plate and over a video of the empty scene: whoever made them knew more."""
    from muybridge.io import job as jobs
    from muybridge.io.image_sequence import is_image_pattern

    background = None
    if camera.masks is None and camera.plate is not None:
        background = jobs.BackgroundInput(kind="plate", file=camera.plate)
    elif camera.masks is None and camera.empty is not None:
        background = jobs.BackgroundInput(kind="gaussian", file=camera.empty)
    return jobs.CameraInput(
        name=camera.name,
        pictures=camera.pictures,
        masks=camera.masks,
        background=background,
        frame_rate=frame_rate if is_image_pattern(camera.pictures) else None,
        frames=camera.frames,
    )
