"""`muybridge background VIDEO`."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from muybridge.cli.reporting import DEFAULT_REPORTING, Progress, Reporting, Switch
from muybridge.cli.track import Overrides
from muybridge.errors import InputError

if TYPE_CHECKING:
    import numpy as np

    from muybridge.io.video import PictureSource
    from muybridge.segmentation import BackgroundModel

    Build = Callable[[Iterable[np.ndarray]], BackgroundModel]

SMALLEST = 8
"""Pixels: a picture with a shorter side shows nobody."""


def background(
    video: str,
    /,
    *,
    model: str = "auto",
    out: Path = Path("runs/background"),
    learn: float = 5.0,
    empty: str | None = None,
    as_video: Switch = False,
    frame_rate: float | None = None,
    changed_share: float = 0.7,
    set_: Overrides = None,
    reporting: Reporting = DEFAULT_REPORTING,
) -> None:
    """Tell people from what stands still: a mask for every picture of a fixed camera.

    Parameters
    ----------
    video
        A video, or pictures: a folder, or a pattern such as 'left/%04d.png'.
    model
        plate, gaussian, hue_key, mixture, spatial, auto, kde, mog2 or knn: see docs/background.md.
    out
        Masks go into masks/ inside, a 000000.png for every picture. Those of an earlier run are replaced.
    learn
        The model is learnt from so many seconds at the beginning; they get masks like the rest.
    empty
        A video or pictures of the scene without people, to learn from instead.
    as_video
        Write masks.mp4 in place of PNGs.
    frame_rate
        Pictures a second, where they carry no times.
    changed_share
        Where more of the picture is foreground, five times in a row, the model is learnt anew; 1: never.
    set_
        One setting of the model, KEY=VALUE, such as update_rate=0.01; may be repeated.
    """
    from muybridge.io.mask_writer import MaskFolder, MaskVideo
    from muybridge.io.video import open_pictures
    from muybridge.segmentation import StreamConfig

    build, stream = builder(model, set_ or []), StreamConfig(changed_share=changed_share)
    with open_pictures(video, frame_rate) as pictures:
        build = builder(model, set_ or [], pictures.frame_rate)
        _check_size(video, pictures.size)
        with reporting.progress("learn") as progress:
            made = _learnt(build, pictures, learn, empty, progress)
        target = out / ("masks.mp4" if as_video else "masks")
        writer = MaskVideo(target, pictures.frame_rate) if as_video else MaskFolder(target)
        try:
            with writer, reporting.progress("masks") as progress:
                record = _write_masks(pictures, made, build, stream, writer, progress)
        except KeyboardInterrupt:
            raise KeyboardInterrupt(f"interrupted; masks so far are in {writer.unfinished}") from None
    for frame, share in record["restarts"]:
        reporting.say(f"frame {frame}: {share:.0%} of the picture changed; the model was learnt anew")
    reporting.say(f"{record['frames']} masks in {target}, {record['foreground']:.1%} foreground")
    restarts = [{"frame": frame, "share": share} for frame, share in record["restarts"]]
    reporting.finish({"out": out, "masks": target, "model": model, **record, "restarts": restarts})


def builder(model: str, overrides: list[str], frame_rate: float | None = None) -> Build:
    """What makes the model of pictures, with its settings checked; what counts pictures suits the rate (Hz)."""
    from muybridge.io import _tables
    from muybridge.segmentation import BACKGROUND_MODELS, build_background, settings_at

    if model not in BACKGROUND_MODELS:
        raise _tables.unknown("--model", model, list(BACKGROUND_MODELS))
    settings: dict = {} if frame_rate is None else settings_at(model, frame_rate)
    for text in overrides:
        _tables.override(settings, text)
    config = _tables.replaced(BACKGROUND_MODELS[model].config(), settings, f"{model} background")
    return lambda pictures: build_background(model, pictures, **vars(config))


def _learnt(
    build: Build, pictures: PictureSource, seconds: float, empty: str | None, progress: Progress
) -> BackgroundModel:
    """The model, learnt from the empty scene, or else from the first seconds."""
    from muybridge.io.video import open_pictures

    if empty is not None:
        with open_pictures(empty) as scene:
            if scene.size != pictures.size:
                raise InputError(empty, expected=f"{_words(pictures.size)} pixels as {pictures.name}",
                                 got=_words(scene.size))  # fmt: skip
            return build(_first(scene, scene.frame_count, progress))
    if not seconds > 0:
        raise InputError("--learn", expected="above 0 seconds", got=f"{seconds:g}", remedy="or give --empty")
    count = max(1, round(min(seconds * pictures.frame_rate, pictures.frame_count)))
    return build(_first(pictures, count, progress))


def _first(pictures: PictureSource, count: int, progress: Progress) -> Iterator[np.ndarray]:
    """The first pictures, one at a time."""
    for index, _, picture in pictures.frames():
        if index >= count:
            return
        progress(index, count)
        yield picture


def _write_masks(pictures: PictureSource, made, build: Build, stream, writer, progress: Progress) -> dict:
    """Write the mask of every picture; what is to be said of it."""
    from muybridge.segmentation import masks_of

    restarts, learning, total = [], 0, 0.0
    start = time.perf_counter()
    images = (picture for _, _, picture in pictures.frames())
    for index, (mask, share, restarted, learns) in enumerate(masks_of(images, made, build, stream)):
        writer.write(mask)
        total += share
        learning += learns
        if restarted:
            restarts.append((index, share))
        progress(index + 1, pictures.frame_count)
    frames = writer.frame_count
    return {
        "frames": frames,
        "restarts": restarts,
        "frames_relearnt": learning,
        "foreground": total / max(frames, 1),
        "frames_per_second": frames / (time.perf_counter() - start),
    }


def _check_size(name: str, size: tuple[int, int]) -> None:
    if min(size) < SMALLEST:
        raise InputError(name, expected=f"pictures of at least {SMALLEST} x {SMALLEST} pixels", got=_words(size))


def _words(size: tuple[int, int]) -> str:
    return f"{size[0]} x {size[1]}"
