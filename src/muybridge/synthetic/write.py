"""A scene as a folder that `track` takes: videos, the empty room, masks, calibration, truth, measures and a job.

<camera>.mp4, <camera>_empty.mp4, <camera>_mask.mp4    as seen; without people; white is the person
calibration.json                                     the rig
truth_joints.csv, truth_angles.csv, truth_visibility.csv   see `truth_files`
measures.toml                                        lengths of the person's segments, metres
scene.toml                                           the scene itself, to render it again
job.toml                                             ties them together

A scene of several people (`Scene.follow`) has scene, calibration, clip, empty clip, and the truth of `crowd_files`.

All of it is made in a folder beside, which takes the name when it is whole: nothing half-written is ever found there.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from muybridge.cameras.json_format import write_rig
from muybridge.errors import InputError
from muybridge.evaluation.names import JOINTS
from muybridge.io import job as jobs
from muybridge.io.disk import disk_errors, make_folder, temporary_name
from muybridge.io.video_writer import VideoWriter
from muybridge.synthetic.crowd_files import MASK_QUALITY, write_people
from muybridge.synthetic.scene import Scene, empty, figure_of, shoot, truth
from muybridge.synthetic.scene_text import scene_text
from muybridge.synthetic.truth_files import (
    ANGLES_FILE,
    JOINTS_FILE,
    VISIBILITY_FILE,
    VisibilityTable,
    write_angles,
    write_truth,
)

EMPTY_SECONDS = 1.0
CALIBRATION_FILE, MEASURES_FILE, SCENE_FILE, JOB_FILE = "calibration.json", "measures.toml", "scene.toml", "job.toml"

#: segment -> the joints at its ends
SEGMENTS: dict[str, tuple[str, str]] = {
    f"{side}_{segment}": (f"{side}_{first}", f"{side}_{last}")
    for side in ("left", "right")
    for segment, first, last in (
        ("upper_arm", "shoulder", "elbow"),
        ("forearm", "elbow", "wrist"),
        ("thigh", "hip", "knee"),
        ("shank", "knee", "ankle"),
    )
}


def write_scene(scene: Scene, folder: str | Path, *, progress: Callable[[int, int], None] | None = None) -> Path:
    """Render the whole scene into a folder.

    Parameters
    ----------
    scene : Scene
    folder : path; made where it is not there; an earlier scene in it is replaced, anything else is left alone
    progress : called with (frames done, frames in all)

    Returns
    -------
    Path
        The job file, for `track`; of a scene of several people the video, for `people`.
    """
    folder = Path(folder)
    check_replaceable(folder)
    target = folder.resolve()  # where a link leads: the link itself stays
    unfinished = temporary_name(target)
    make_folder(unfinished.parent)
    with disk_errors(folder):
        shutil.rmtree(unfinished, ignore_errors=True)
        unfinished.mkdir()
    try:
        _write_all(scene, unfinished, target.name, progress)
        with disk_errors(folder):
            if target.exists():
                shutil.rmtree(target)
            os.replace(unfinished, target)
    except BaseException:
        shutil.rmtree(unfinished, ignore_errors=True)
        raise
    return folder / (f"{scene.rig.names[0]}.mp4" if scene.follow == "people" else JOB_FILE)


def check_replaceable(folder: Path) -> None:
    """Raise where a folder holds something that is no scene."""
    if not folder.exists():
        return
    if not folder.is_dir():
        raise InputError(str(folder), expected="a folder, or a new name", got="a file", remedy="choose another --out")
    names = {entry.name for entry in folder.iterdir()}
    if names and not {SCENE_FILE, CALIBRATION_FILE} <= names:
        raise InputError(str(folder), expected="a new or empty folder, or an earlier scene", got="other files in it",
                         remedy="choose another --out")  # fmt: skip


def measures(scene: Scene) -> dict[str, float]:
    """Lengths of the person's segments between joint centres, metres; bones are rigid, so any frame tells them."""
    place = dict(zip(JOINTS, truth(scene).joints[0], strict=True))
    return {segment: float(np.linalg.norm(place[last] - place[first])) for segment, (first, last) in SEGMENTS.items()}


def stature(scene: Scene) -> float:
    """The person's height, metres: soles to the top of the hair, standing."""
    return float(np.ptp(figure_of(scene).vertices[:, 2]))


def job_of(scene: Scene, folder: Path, name: str = "") -> jobs.Job:
    """The job that tracks this scene by what a user would know: the empty room and the person's height."""
    folder = folder.absolute()
    return jobs.Job(
        calibration=jobs.CalibrationInput(file=folder / CALIBRATION_FILE),
        cameras=tuple(
            jobs.CameraInput(
                name=camera,
                pictures=folder / f"{camera}.mp4",
                background=jobs.BackgroundInput(kind="plate", file=folder / f"{camera}_empty.mp4"),
            )
            for camera in scene.rig.names
        ),
        body=jobs.BodyInput(name="person", height_m=round(stature(scene), 2)),
        reference=jobs.ReferenceInput(file=folder / JOINTS_FILE),
        name=name or folder.name or "scene",
    )


def _write_all(scene: Scene, folder: Path, name: str, progress: Callable[[int, int], None] | None) -> None:
    _write_text(folder / SCENE_FILE, scene_text(scene))
    write_rig(folder / CALIBRATION_FILE, scene.rig)
    _write_empty(scene, folder)
    if scene.follow == "people":
        write_people(scene, folder, progress)
        return
    _write_text(folder / MEASURES_FILE, _measures_text(scene))
    write_truth(folder / JOINTS_FILE, truth(scene))
    write_angles(folder / ANGLES_FILE, truth(scene))
    _write_clip(scene, folder, progress)
    with disk_errors(folder / JOB_FILE):
        jobs.write(folder / JOB_FILE, job_of(scene, folder, name))


def _write_text(path: Path, text: str) -> None:
    with disk_errors(path):
        path.write_text(text, encoding="utf-8")


def _write_empty(scene: Scene, folder: Path) -> None:
    with ExitStack() as open_files:
        videos = _videos(scene, folder, "_empty", scene.sensor.quality, open_files)
        for pictures in empty(scene, max(1, round(EMPTY_SECONDS * scene.rate))):
            for video, picture in zip(videos, pictures, strict=True):
                video.write(picture)


def _write_clip(scene: Scene, folder: Path, progress: Callable[[int, int], None] | None) -> None:
    with ExitStack() as open_files:
        videos = _videos(scene, folder, "", scene.sensor.quality, open_files)
        masks = _videos(scene, folder, "_mask", MASK_QUALITY, open_files)
        table = open_files.enter_context(VisibilityTable(folder / VISIBILITY_FILE, scene.rig.names))
        for frame in range(scene.frame_count):
            shots = shoot(scene, frame, visibility=True)
            for video, mask, shot in zip(videos, masks, shots, strict=True):
                video.write(shot.image)
                mask.write(shot.mask)
            table.write(frame, [shot.visible for shot in shots])
            if progress:
                progress(frame + 1, scene.frame_count)


def _videos(scene: Scene, folder: Path, suffix: str, quality: int, open_files: ExitStack) -> list[VideoWriter]:
    names = [folder / f"{name}{suffix}.mp4" for name in scene.rig.names]
    return [open_files.enter_context(VideoWriter(name, scene.rate, quality=quality)) for name in names]


def _measures_text(scene: Scene) -> str:
    lines = [f"# stature {stature(scene):.3f} m, shoes and hair included; lengths between joint centres, metres"]
    return "\n".join(lines + [f"{segment} = {length:.4f}" for segment, length in measures(scene).items()]) + "\n"
