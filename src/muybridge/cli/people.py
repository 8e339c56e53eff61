"""`muybridge people VIDEO`."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from muybridge.cli.reporting import DEFAULT_REPORTING, Reporting, Switch
from muybridge.cli.track import Overrides
from muybridge.errors import InputError

if TYPE_CHECKING:
    from muybridge.cameras.model import Camera
    from muybridge.io.boxes import BoxSeries
    from muybridge.people.blobs import Mask
    from muybridge.people.run import PeopleConfig

PATHS_FILE, MAP_FILE = "paths.png", "map.png"


def people(
    video: str,
    /,
    *,
    out: Path | None = None,
    truth: Path | None = None,
    seed: int = 0,
    frame_rate: float | None = None,
    occluders: Path | None = None,
    marks: Path | None = None,
    calibration: Path | None = None,
    set_: Overrides = None,
    overlay: bool = True,
    live: Switch = False,
    seconds: float | None = None,
    show: Switch = False,
    reporting: Reporting = DEFAULT_REPORTING,
) -> None:
    """Follow several people before one fixed colour camera: who walked where, part by part.

    Parameters
    ----------
    video
        A video, a folder of numbered pictures, or a pattern such as 'frame%04d.jpg'; or a camera as it runs: a webcam's
        number, or an address such as rtsp://HOST/PATH.
    out
        Where tracks.txt, parts.csv, run.json and pictures go; runs/NAME where absent.
    truth
        Boxes to compare with: MOTChallenge text (gt.txt) or CAVIAR's XML.
    seed
        Of the random numbers.
    frame_rate
        Frames per second of pictures; a video knows its own.
    occluders
        A picture that is white where something always stands before people; what is found by itself is added.
    marks
        A folder that `muybridge mark` wrote: such a picture, and how small the smallest people are.
    calibration
        The camera's; then ground.csv and map.png say where people walk on the floor, z = 0, in metres.
    set_
        One setting, KEY=VALUE, such as tracker.smallest=60; may be repeated.
    overlay
        Draw the tracks over the pictures; of a camera there are none left to draw on. paths.png is drawn anyway.
    live
        Treat a video or pictures as a camera: learn the scene on the way, and keep nothing.
    seconds
        Of a camera: stop after so many.
    show
        Of a camera: a window with what is seen; needs an OpenCV that has windows.
    """
    from muybridge.cameras.readers import read_camera
    from muybridge.io.boxes import read_boxes
    from muybridge.io.live import is_live
    from muybridge.io.video import open_pictures
    from muybridge.people.marks import read_marks
    from muybridge.people.run import PeopleConfig, run

    if marks is not None and occluders is not None:
        raise InputError("--occluders", expected="--occluders or --marks", got="both")
    marked, settings = (None, []) if marks is None else read_marks(marks)
    config = PeopleConfig().with_settings([*settings, *(set_ or [])])
    true_boxes = None if truth is None else read_boxes(truth)
    if true_boxes is not None:
        _check_scorer()
    camera = None if calibration is None else read_camera(calibration)
    hidden = marked if occluders is None else _white(occluders)
    out = out or Path("runs") / (_stem(video) or "people")
    if live or is_live(video):
        _watch(video, out, config, seed, frame_rate, seconds, hidden, true_boxes, camera, show, reporting)
        return
    for name, asked in (("--seconds", seconds is not None), ("--show", show)):
        if asked:
            raise InputError(name, expected="a camera, or --live", got=video)
    try:
        with open_pictures(video, frame_rate) as pictures:
            with reporting.progress(f"people in {Path(video).name}") as progress:
                summary = run(pictures, out, config, seed=seed, occluders=hidden, progress=progress)
            reporting.say(f"{summary.frames} frames, {summary.people} people, {summary.frames_per_second:.1f} frames/s")
            drawn = _draw(out, pictures, reporting) if overlay else None
            _draw_paths(out, pictures.size, camera)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"interrupted; what was finished is kept in {out}") from None
    scores = {} if true_boxes is None else _score(out, true_boxes, reporting)
    reporting.say(f"results in {out}")
    reporting.finish({"out": out, **asdict(summary), "overlay": drawn, **scores})


def _watch(
    video: str,
    out: Path,
    config: PeopleConfig,
    seed: int,
    frame_rate: float | None,
    seconds: float | None,
    hidden: Mask | None,
    truth: BoxSeries | None,
    camera: Camera | None,
    show: bool,
    reporting: Reporting,
) -> None:
    """Follow people before a camera as it runs."""
    from contextlib import ExitStack

    from muybridge.io.live import LiveSource, PlayedBack, is_live
    from muybridge.io.video import open_pictures
    from muybridge.people.live import run_live
    from muybridge.segmentation.pictures import reduce_image

    def prepare(picture: Any) -> Any:
        return reduce_image(picture, min(1.0, config.rows / picture.shape[0]))

    with ExitStack() as opened:
        stream: LiveSource | PlayedBack
        if is_live(video):
            stream = LiveSource(video, config.stream, prepare=prepare)
        else:
            stream = PlayedBack(opened.enter_context(open_pictures(video, frame_rate)), prepare)
        window = opened.enter_context(_window(video)) if show else None
        progress = opened.enter_context(reporting.progress(f"people in {stream.name}"))
        try:
            summary = run_live(stream, out, config, seed=seed, seconds=seconds, occluders=hidden, progress=progress,
                               watcher=window)  # fmt: skip
        except KeyboardInterrupt:
            raise KeyboardInterrupt(f"interrupted; what was finished is kept in {out}") from None
    _draw_paths(out, stream.size, camera)
    facts = stream.facts()
    lost = f"{facts['dropped']} dropped, {facts['reconnects']} reconnects"
    reporting.say(f"{summary.frames} frames, {lost}, {summary.people} people; {facts['ended']}")
    scores = {} if truth is None else _score(out, truth, reporting)
    reporting.say(f"results in {out}")
    reporting.finish({"out": out, **asdict(summary), "stream": facts, **scores})


@contextmanager
def _window(name: str) -> Iterator[Callable[[Any, BoxSeries], None]]:
    """A window in which pictures are shown with boxes; one clear line where this OpenCV has none."""
    import cv2

    from muybridge.plotting.people_video import draw_people

    try:
        cv2.namedWindow(name)
    except cv2.error:
        remedy = "leave it out, or install opencv-python in place of opencv-python-headless"
        raise InputError("--show", expected="an OpenCV with windows", got="a headless one", remedy=remedy) from None

    def show(picture: Any, boxes: BoxSeries) -> None:
        frame = int(boxes.frames[0]) if len(boxes) else 0
        cv2.imshow(name, draw_people(picture, frame, boxes))
        cv2.waitKey(1)

    try:
        yield show
    finally:
        cv2.destroyWindow(name)


def _stem(video: str) -> str:
    """What a run is named after: a file's name, or an address's letters and digits."""
    if "://" in video:
        return "-".join(part for part in re.split(r"[^A-Za-z0-9]+", video.split("://", 1)[1].split("@")[-1]) if part)
    return f"camera{video}" if video.isdigit() else Path(video).stem.strip("%*?.")


def _draw(out: Path, pictures: Any, reporting: Reporting) -> Path:
    from muybridge.io.mot import read_mot
    from muybridge.io.parts import read_parts
    from muybridge.people.run import PARTS_FILE, TRACKS_FILE
    from muybridge.plotting.people_video import write_people_video

    with reporting.progress("overlay") as progress:
        return write_people_video(
            out, pictures, read_mot(out / TRACKS_FILE), read_parts(out / PARTS_FILE), progress=progress
        )


def _draw_paths(out: Path, size: tuple[int, int], camera: Camera | None) -> None:
    """Everybody's way over the empty scene; and on the ground, where the camera is known."""
    import cv2

    from muybridge.io.disk import replace_file
    from muybridge.io.mot import read_mot
    from muybridge.io.video import read_image
    from muybridge.people.on_ground import GROUND_FILE, on_ground, write_ground
    from muybridge.people.run import SCENE_FILE, TRACKS_FILE
    from muybridge.plotting.people_paths import draw_paths, plot_ground_map
    from muybridge.plotting.style import new_figure, to_png

    if not (out / SCENE_FILE).exists():  # a stream that ended before its scene was known
        return
    boxes = read_mot(out / TRACKS_FILE)
    scene = cv2.resize(read_image(out / SCENE_FILE), size, interpolation=cv2.INTER_LINEAR)
    replace_file(out / PATHS_FILE, cv2.imencode(".png", draw_paths(scene, boxes))[1].tobytes())
    if camera is None:
        return
    places = on_ground(boxes, camera.with_size(*size))
    write_ground(out / GROUND_FILE, boxes, places)
    figure, axes = new_figure(width=6.0, height=6.0)
    plot_ground_map(axes[0, 0], boxes.ids, places)
    replace_file(out / MAP_FILE, to_png(figure))


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
