"""A scene as a folder that `track` takes: videos, the empty room, masks, calibration, truth, measures and a job.

<camera>.mp4, <camera>_empty.mp4, <camera>_mask.mp4    as seen; without the person; white is the person
calibration.json                                     the rig
truth_joints.csv                                     the columns of a run's joints.csv, sd_m = 0
measures.toml                                        lengths of the person's segments, metres
job.toml                                             ties them together
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from muybridge.cameras.json_format import write_rig
from muybridge.evaluation.names import JOINTS
from muybridge.io import job as jobs
from muybridge.io.disk import disk_errors, make_folder
from muybridge.io.run_folder import JointSeries, write_joints
from muybridge.io.video_writer import VideoWriter
from muybridge.synthetic.motion import Track
from muybridge.synthetic.scene import Scene, empty, figure_of, render, truth

QUALITY = 18  # x264's constant rate factor: fine
EMPTY_SECONDS = 1.0
TRUTH_FILE, CALIBRATION_FILE = "truth_joints.csv", "calibration.json"
MEASURES_FILE, JOB_FILE = "measures.toml", "job.toml"

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
    folder : path; made where it is not there
    progress : called with (frames done, frames in all)

    Returns
    -------
    Path
        The job file, for `track`.
    """
    folder = Path(folder)
    make_folder(folder)
    _write_videos(scene, folder, progress)
    write_rig(folder / CALIBRATION_FILE, scene.rig)
    write_truth(folder / TRUTH_FILE, truth(scene))
    with disk_errors(folder / MEASURES_FILE):
        (folder / MEASURES_FILE).write_text(_measures_text(scene), encoding="utf-8")
    path = folder / JOB_FILE
    with disk_errors(path):
        jobs.write(path, job_of(scene, folder))
    return path


def write_truth(path: Path, track: Track) -> None:
    """The true joints, in the columns of a run's joints.csv; the standard deviation of the truth is 0."""
    count = len(track.times)
    write_joints(path, JointSeries(JOINTS, np.arange(count), track.times, track.joints, np.zeros((count, len(JOINTS)))))


def measures(scene: Scene) -> dict[str, float]:
    """Lengths of the person's segments between joint centres, metres; bones are rigid, so any frame tells them."""
    place = dict(zip(JOINTS, truth(scene).joints[0], strict=True))
    return {segment: float(np.linalg.norm(place[last] - place[first])) for segment, (first, last) in SEGMENTS.items()}


def stature(scene: Scene) -> float:
    """The person's height, metres: soles to the top of the hair, standing."""
    return float(np.ptp(figure_of(scene).vertices[:, 2]))


def job_of(scene: Scene, folder: Path) -> jobs.Job:
    """The job that tracks this scene by what a user would know: the empty room and the person's height."""
    folder = folder.absolute()
    return jobs.Job(
        calibration=jobs.CalibrationInput(file=folder / CALIBRATION_FILE),
        cameras=tuple(
            jobs.CameraInput(
                name=name,
                pictures=folder / f"{name}.mp4",
                background=jobs.BackgroundInput(kind="plate", file=folder / f"{name}_empty.mp4"),
            )
            for name in scene.rig.names
        ),
        body=jobs.BodyInput(name="person", height_m=round(stature(scene), 2)),
        reference=jobs.ReferenceInput(file=folder / TRUTH_FILE),
        name=folder.name or "scene",
    )


def _write_videos(scene: Scene, folder: Path, progress: Callable[[int, int], None] | None) -> None:
    rate = scene.person.motion.rate
    with ExitStack() as open_files:

        def writers(suffix: str) -> list[VideoWriter]:
            names = [folder / f"{name}{suffix}.mp4" for name in scene.rig.names]
            return [open_files.enter_context(VideoWriter(name, rate, quality=QUALITY)) for name in names]

        plates = writers("_empty")
        for pictures in empty(scene, max(1, round(EMPTY_SECONDS * rate))):
            for video, picture in zip(plates, pictures, strict=True):
                video.write(picture)
        videos, mask_videos = writers(""), writers("_mask")
        for frame in range(scene.frame_count):
            images, masks = render(scene, frame)
            for video, picture in zip([*videos, *mask_videos], [*images, *masks], strict=True):
                video.write(picture)
            if progress:
                progress(frame + 1, scene.frame_count)


def _measures_text(scene: Scene) -> str:
    lines = [f"# stature {stature(scene):.3f} m, shoes and hair included; lengths between joint centres, metres"]
    return "\n".join(lines + [f"{segment} = {length:.4f}" for segment, length in measures(scene).items()]) + "\n"
