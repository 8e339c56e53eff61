"""`muybridge people VIDEO`."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from muybridge.cli.reporting import DEFAULT_REPORTING, Reporting
from muybridge.cli.track import Overrides

if TYPE_CHECKING:
    from muybridge.io.boxes import BoxSeries


def people(
    video: Path,
    /,
    *,
    out: Path | None = None,
    truth: Path | None = None,
    seed: int = 0,
    frame_rate: float | None = None,
    occluders: Path | None = None,
    set_: Overrides = None,
    overlay: bool = True,
    reporting: Reporting = DEFAULT_REPORTING,
) -> None:
    """Follow several people before one fixed colour camera: who walked where, part by part.

    Parameters
    ----------
    video
        A video, a folder of numbered pictures, or a pattern such as 'frame%04d.jpg'.
    out
        Where tracks.txt, parts.csv, run.json and people.mp4 go; runs/NAME where absent.
    truth
        Boxes to compare with: MOTChallenge text (gt.txt) or CAVIAR's XML.
    seed
        Of the random numbers.
    frame_rate
        Frames per second of pictures; a video knows its own.
    occluders
        A picture that is white where something always stands before people; what is found by itself is added.
    set_
        One setting, KEY=VALUE, such as tracker.smallest=60; may be repeated.
    overlay
        Draw the tracks over the pictures.
    """
    from muybridge.io.boxes import read_boxes
    from muybridge.io.video import open_pictures
    from muybridge.people.run import PeopleConfig, run

    config = PeopleConfig().with_settings(set_ or [])
    true_boxes = None if truth is None else read_boxes(truth)
    if true_boxes is not None:
        _check_scorer()
    hidden = None if occluders is None else _white(occluders)
    out = out or Path("runs") / video.stem.strip("%*?.") or Path("runs/people")
    try:
        with open_pictures(video, frame_rate) as pictures:
            with reporting.progress(f"people in {video.name}") as progress:
                summary = run(pictures, out, config, seed=seed, occluders=hidden, progress=progress)
            reporting.say(f"{summary.frames} frames, {summary.people} people, {summary.frames_per_second:.1f} frames/s")
            drawn = _draw(out, pictures, reporting) if overlay else None
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"interrupted; what was finished is kept in {out}") from None
    scores = {} if true_boxes is None else _score(out, true_boxes, reporting)
    reporting.say(f"results in {out}")
    reporting.finish({"out": out, **asdict(summary), "overlay": drawn, **scores})


def _draw(out: Path, pictures: Any, reporting: Reporting) -> Path:
    from muybridge.io.mot import read_mot
    from muybridge.io.parts import read_parts
    from muybridge.people.run import PARTS_FILE, TRACKS_FILE
    from muybridge.plotting.people_video import write_people_video

    with reporting.progress("overlay") as progress:
        return write_people_video(
            out, pictures, read_mot(out / TRACKS_FILE), read_parts(out / PARTS_FILE), progress=progress
        )


def _score(out: Path, truth: BoxSeries, reporting: Reporting) -> dict[str, Any]:
    from muybridge.evaluation.boxes import score_boxes
    from muybridge.io.disk import replace_file
    from muybridge.io.mot import read_mot
    from muybridge.people.run import TRACKS_FILE

    scores = score_boxes(read_mot(out / TRACKS_FILE), truth)
    replace_file(out / "scores.txt", (scores.to_table() + "\n").encode())
    reporting.say(scores.to_table())
    return {"scores": scores.to_dict()}


def _check_scorer() -> None:
    """Find out before the run, not after it, that there is nothing to score with."""
    from muybridge.evaluation.boxes import scorer

    scorer()


def _white(path: Path) -> Any:
    from muybridge.io.video import MASK_THRESHOLD, read_image

    return read_image(path, colour=False) > MASK_THRESHOLD
