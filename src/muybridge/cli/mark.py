"""`muybridge mark VIDEO`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from muybridge.cli.reporting import DEFAULT_REPORTING, Reporting, Switch
from muybridge.errors import InputError

if TYPE_CHECKING:
    from muybridge.people.marks import Marks


def mark(
    video: Path,
    /,
    *,
    out: Path | None = None,
    polygons: Path | None = None,
    smallest: float | None = None,
    learn: Switch = False,
    calibration: Path | None = None,
    farthest: float = 20.0,
    frame: int = 0,
    port: int = 0,
    browser: bool = True,
    reporting: Reporting = DEFAULT_REPORTING,
) -> None:
    """Mark what hides people before a camera, and how small the smallest are who matter, for people --marks.

    Parameters
    ----------
    video
        A video, pictures, or a single picture of the camera.
    out
        Where occluders.png and marks.json go; runs/NAME-marks where absent. Marks that are there are taken up.
    polygons
        Take them from a file like marks.json instead of drawing them.
    smallest
        Pixels of a standing person's height below which nobody is looked for.
    learn
        Learn that from the people in the clip.
    calibration
        Or reckon it from the camera's calibration, the floor being z = 0,
    farthest
        for people within so many metres of the camera.
    frame
        The picture that is drawn on.
    port
        Of the page on this machine; a free one where 0.
    browser
        Open the page; else only its address is said.
    """
    from muybridge.io.video import open_pictures
    from muybridge.people.marks import MARKS_FILE, Marks, learnt_smallest, read_polygons, write_marks

    if sum([smallest is not None, learn, calibration is not None]) > 1:
        raise InputError("the smallest person", expected="one of --smallest, --learn, --calibration", got="several")
    out = out or Path("runs") / f"{video.stem.strip('%*?.')}-marks"
    known = out / MARKS_FILE if polygons is None else polygons
    marks = read_polygons(known) if polygons is not None or known.exists() else Marks()
    with open_pictures(video) as pictures:
        picture = pictures.read(frame)
        if learn:
            with reporting.progress("learning"):
                smallest = learnt_smallest(pictures)
        elif calibration is not None:
            smallest = _calibrated(calibration, pictures.size, farthest)
        marks = marks if smallest is None else replace(marks, smallest=smallest)
        if polygons is not None or smallest is not None:
            write_marks(out, marks, pictures.size)
        else:
            marks = _drawn(picture, out, marks, port, browser, reporting)
    reporting.say(f"muybridge people {video} --marks {out}")
    reporting.finish({"out": out, "polygons": len(marks.polygons), "smallest": marks.smallest,
                      "occluded_share": float(marks.mask(pictures.size).mean())})  # fmt: skip


def _drawn(picture, out: Path, marks: Marks, port: int, browser: bool, reporting: Reporting) -> Marks:
    """What somebody draws in the browser, saved."""
    import webbrowser

    from muybridge.people.mark_server import MarkServer

    with MarkServer(picture, out, marks, port) as server:
        reporting.say(f"draw at {server.address}, and press Save and finish there")
        if browser:
            webbrowser.open(server.address)
        server.serve_until_done()
        return server.marks


def _calibrated(path: Path, size: tuple[int, int], farthest: float) -> float:
    from muybridge.cameras.readers import read_camera
    from muybridge.people.marks import calibrated_smallest

    return calibrated_smallest(read_camera(path).with_size(*size), farthest)
