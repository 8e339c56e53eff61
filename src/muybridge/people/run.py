"""A video from end to end: look over the clip, follow people, leave a folder.

tracks.txt  bodies, as MOTChallenge has them: frame, id, left, top, width, height, confidence, -1, -1, -1
parts.csv   frame, id, part, left, top, width, height, score
scene.png   the empty scene, at the size that is worked on
run.json    status, frames, people, seed, settings, versions, ms_per_frame, peak_memory_mb, what was found of the scene

Frames and pixels count from 1 in both tables. Nothing is written before the end: who somebody is may be known late.
"""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Protocol, TypeVar

import numpy as np

from muybridge.errors import InputError
from muybridge.io._tables import override, replaced, unknown
from muybridge.io.disk import make_folder, replace_file
from muybridge.io.live import LiveConfig
from muybridge.io.mot import write_mot
from muybridge.io.parts import write_parts
from muybridge.io.prefetch import prefetched
from muybridge.io.run_facts import peak_memory_mb, speed, versions
from muybridge.io.run_folder import write_summary
from muybridge.io.video import PictureSource
from muybridge.people.blobs import BlobConfig, Mask
from muybridge.people.failure import detector_named
from muybridge.people.learning import LearningConfig
from muybridge.people.masks import MaskConfig, Masks
from muybridge.people.scene import Scene, describe
from muybridge.people.tracker import PeopleTracker, TrackerConfig
from muybridge.people.tracks import Tracks
from muybridge.people.watch import WatchConfig
from muybridge.segmentation.pictures import reduce_image

TRACKS_FILE, PARTS_FILE, SCENE_FILE = "tracks.txt", "parts.csv", "scene.png"
SMALLEST_SIDE = 32  # pixels: a picture with a shorter side shows nobody
STILL = 10  # moments in a row: what has not moved between them is a thing
READ_AHEAD = 4  # frames decoded beside the tracking
Config = TypeVar("Config")


class Progress(Protocol):
    """Told how many of how many frames are done."""

    def __call__(self, done: int, total: int | None, message: str = "") -> None: ...


@dataclass(frozen=True, kw_only=True)
class PeopleConfig:
    """All settings of a run."""

    masks: MaskConfig = MaskConfig()
    tracker: TrackerConfig = TrackerConfig()
    repair: str = "shipped"  # what says that a part not held was lost: "shipped", "none", a file of `train-repair`
    rows: int = 720  # pictures with more are worked on reduced to so many
    moments: int = 200  # of the clip that are looked at beforehand
    plate_moments: int = 60  # of those, for the median that is the empty scene
    stream: LiveConfig = LiveConfig()  # how a stream is read,
    learning: LearningConfig = LearningConfig()  # when its scene is learnt,
    watch: WatchConfig = WatchConfig()  # and when it counts as changed

    def __post_init__(self) -> None:
        if self.rows < 60 or self.plate_moments < 1 or self.moments < 1:
            raise InputError("people", expected="rows from 60, moments and plate_moments from 1",
                             got=f"{self.rows}, {self.plate_moments}, {self.moments}")  # fmt: skip

    def with_settings(self, settings: Sequence[str]) -> PeopleConfig:
        """These settings with KEY=VALUE, such as tracker.smallest=60, put over them."""
        table: dict[str, Any] = {}
        for text in settings:
            override(table, text)
        return _replaced(self, table, "--set")


@dataclass(frozen=True)
class PeopleSummary:
    """What a run came to. ms_per_frame and frames_per_second are of the tracking, masks and decoding included."""

    status: str
    frames: int
    people: int
    boxes: int
    seed: int
    ms_per_frame: dict[str, float]
    frames_per_second: float
    peak_memory_mb: float


def run(
    pictures: PictureSource,
    out: Path,
    config: PeopleConfig | None = None,
    *,
    seed: int = 0,
    occluders: Mask | None = None,
    progress: Progress | None = None,
) -> PeopleSummary:
    """Follow everybody in pictures of one fixed colour camera, and write the folder `out`.

    occluders : (H, W) bool, optional
        What hides people, in the pictures' own pixels, beside what is found to.
    """
    config, progress = config or PeopleConfig(), progress or ignore
    detector = detector_named(config.repair)
    if min(pictures.size) < SMALLEST_SIDE:
        raise InputError(pictures.name, expected=f"pictures of at least {SMALLEST_SIDE} x {SMALLEST_SIDE} pixels",
                         got=f"{pictures.size[0]} x {pictures.size[1]}")  # fmt: skip
    make_folder(out)
    factor = min(1.0, config.rows / pictures.size[1])
    masks, scene = look_over(pictures, config, factor, occluders, progress)
    tracker = PeopleTracker(scene, config.tracker, frame_rate=pictures.frame_rate, seed=seed, detector=detector)
    started = time.perf_counter()
    times: list[float] = []

    def finish(status: str) -> PeopleSummary:
        tracks = tracker.tracks().inside(scene.size).scaled(1 / factor)
        summary = _summary(status, tracks, times, time.perf_counter() - started, seed)
        _write(out, tracks, summary, config, scene)
        return summary

    try:
        for index, _, picture in prefetched(pictures.frames(), READ_AHEAD):
            begun = time.perf_counter()
            small = masks.relit(reduce_image(picture, factor))
            tracker.step(index, small, masks.apply(small))
            times.append(1e3 * (time.perf_counter() - begun))
            progress(index + 1, len(pictures), f"{len(tracker.people)} people")
    except KeyboardInterrupt:
        finish("interrupted")
        raise
    return finish("done")


def look_over(
    pictures: PictureSource,
    config: PeopleConfig,
    factor: float = 1.0,
    occluders: Mask | None = None,
    progress: Progress | None = None,
) -> tuple[Masks, Scene]:
    """The empty scene and what the clip says of where people walk, from moments spread over it."""
    progress = progress or ignore
    moments = moments_of(pictures, config)
    chosen = [moments[k] for k in _spread(len(moments), config.plate_moments)]
    masks = Masks.train([reduce_image(pictures.read(index), factor) for index in chosen], config.masks)
    if masks.things is not None:
        masks.things.begin(STILL)
    seen = []
    for count, index in enumerate(moments, start=1):
        seen.append(masks.apply(masks.relit(reduce_image(pictures.read(index), factor))))
        progress(count, len(moments), "looking over the clip")
    if masks.things is not None:
        masks.things.begin(config.masks.rest)
    return masks, describe(
        masks.empty, seen, person_blobs(config), reduced_mask(occluders, pictures.size, masks.empty.shape)
    )


def moments_of(pictures: PictureSource, config: PeopleConfig) -> list[int]:
    """The frames that are looked at beforehand."""
    return _spread(len(pictures), config.moments)


def person_blobs(config: PeopleConfig) -> BlobConfig:
    """What may be a person at all, as a scene is learnt."""
    return BlobConfig(smallest=max(50, round(0.12 * config.tracker.smallest**2)))


def _write(out: Path, tracks: Tracks, summary: PeopleSummary, config: PeopleConfig, scene: Scene) -> None:
    write_mot(out / TRACKS_FILE, tracks.boxes)
    write_parts(out / PARTS_FILE, tracks.parts)
    write_scene(out, scene)
    ground = None if scene.ground is None else asdict(scene.ground)
    hidden = 0.0 if scene.occluders is None else float(scene.occluders.mean())
    facts = {"settings": asdict(config), "versions": versions(), "evaluations_per_frame": None}
    found = {"ground": ground, "silhouette": scene.silhouette.share.tolist(), "occluded_share": hidden}
    write_summary(out, {**asdict(summary), **facts, "scene": found})


def write_scene(out: Path, scene: Scene) -> None:
    """The empty scene as a picture."""
    import cv2

    replace_file(out / SCENE_FILE, cv2.imencode(".png", scene.background)[1].tobytes())


def _summary(status: str, tracks: Tracks, times: list[float], took: float, seed: int) -> PeopleSummary:
    people = len(np.unique(tracks.boxes.ids))
    return PeopleSummary(status, len(times), people, len(tracks.boxes), seed, speed(times), len(times) / took,
                         peak_memory_mb())  # fmt: skip


def _spread(count: int, most: int) -> list[int]:
    """At most so many of `count` numbers from 0, evenly spread."""
    return [int(index) for index in np.linspace(0, count - 1, min(count, most)).round()]


def reduced_mask(mask: Mask | None, size: tuple[int, int], shape: tuple[int, ...]) -> Mask | None:
    """Drawn occluders at the size that is worked on; a pixel is hidden where most of it is."""
    if mask is None:
        return None
    if mask.shape != size[::-1]:
        raise InputError("occluders", expected=f"{size[0]} x {size[1]} pixels as the pictures",
                         got=f"{mask.shape[1]} x {mask.shape[0]}")  # fmt: skip
    import cv2

    share = cv2.resize(mask.astype(np.float32), (shape[1], shape[0]), interpolation=cv2.INTER_AREA)
    return np.asarray(share > 0.5)


def _replaced(config: Config, table: Mapping[str, Any], source: str) -> Config:
    """A frozen dataclass with fields replaced, those that are dataclasses themselves by their own tables."""
    inner: dict[str, Any] = {}
    plain: dict[str, Any] = {}
    for key, value in table.items():
        if not hasattr(config, key):
            raise unknown(source, key, [field.name for field in dataclasses.fields(config)])  # type: ignore[arg-type]
        here = getattr(config, key)
        if isinstance(value, Mapping) and dataclasses.is_dataclass(here):
            inner[key] = _replaced(here, value, f"{source} {key}")
        elif isinstance(value, Mapping) or dataclasses.is_dataclass(here):
            raise InputError(f"{source} {key}", expected="KEY=VALUE of a single setting", got=str(value))
        else:
            plain[key] = value
    return dataclasses.replace(replaced(config, plain, source), **inner)  # type: ignore[type-var]


def ignore(done: int, total: int | None, message: str = "") -> None:
    """Progress that nobody watches."""
