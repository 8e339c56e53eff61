"""What follows a run: overlays, report, plots, and the comparison with a truth where there is one."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from muybridge.cli.reporting import Progress, Reporting
from muybridge.errors import InputError

if TYPE_CHECKING:
    from muybridge.body import Body
    from muybridge.cameras import Rig
    from muybridge.io.job import Job, ReferenceInput

CAMERAS_FILE, BODY_FILE = "cameras.json", "body.toml"
"""In the run folder: the cameras and the body as tracking used them in the end, corrected and fitted."""


def write_overlays(job: Job, out: Path, reporting: Reporting) -> list[Path]:
    """One video a camera; a camera whose pictures cannot be read any more is left out, and said so."""
    from muybridge.io.video import open_pictures
    from muybridge.plotting.overlay_video import write_overlay

    rig, body = cameras_of(job, out), body_of(out)
    written = []
    for camera in job.cameras:
        try:
            with (
                open_pictures(camera.pictures, camera.frame_rate, frames=camera.frames) as pictures,
                reporting.progress(f"overlay {camera.name}") as progress,
            ):
                tell = partial(_tell, progress, _frames_to_draw(job, pictures.frame_count))
                written.append(write_overlay(out, rig[camera.name], pictures, body, progress=tell))
        except InputError as error:
            reporting.say(f"no overlay of {camera.name}: {error}")
    return written


def _tell(progress: Progress, total: int, done: int) -> None:
    progress(done, total)


def _frames_to_draw(job: Job, count: int) -> int:
    return count if job.frames is None else min(count, job.frames[1] + 1) - job.frames[0]


def check_reference(reference: ReferenceInput | None) -> None:
    """Read the reference once before the run: after it would be late to find out that there is none."""
    from muybridge.evaluation import read_truth

    if reference is not None:
        read_truth(reference.file, axes=reference.axes)


def compare(out: Path, reference: ReferenceInput | None, reporting: Reporting) -> dict[str, Any]:
    """Write the report and plots; say how far off the run is where there is a reference, and return that for --json."""
    from muybridge.report.content import gather
    from muybridge.report.plots import write_plots
    from muybridge.report.write import REPORT_FILE, render

    content = gather(out, reference.file, axes=reference.axes) if reference else gather(out)
    (out / REPORT_FILE).write_text(render(content), encoding="utf-8")
    write_plots(out, content)
    errors = content.errors
    if errors is None:
        return {}
    (out / "errors.txt").write_text(errors.to_table() + "\n", encoding="utf-8")
    reporting.say(
        f"mean joint error {errors.mean_mm:.1f} mm (alignment {errors.alignment}), per joint in {out}/errors.txt"
    )
    return {"errors": errors.to_dict()}


def cameras_of(job: Job, out: Path) -> Rig:
    """The run's cameras: as it left them, else as the job gives them."""
    from muybridge.cameras.readers import read_rig

    if (out / CAMERAS_FILE).is_file():
        return read_rig(out / CAMERAS_FILE)
    calibration = job.calibration
    return read_rig(calibration.file or calibration.files, calibration.unit, up=calibration.up)


def body_of(out: Path) -> Body | None:
    """The run's body; None where it left none, and only joints can be drawn."""
    from muybridge.body import read_body

    return read_body(out / BODY_FILE) if (out / BODY_FILE).is_file() else None
