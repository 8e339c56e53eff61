"""A stream from now on: learn the scene as it goes, follow people, write what is final.

The folder is that of `people.run`, but tracks.txt and parts.csv grow while the stream runs, some seconds behind it
(`LearningConfig.settle_s`), and nothing that was written is kept: memory does not grow with the stream. Identities are
given once. A camera that was moved is a new scene: it is learnt from the beginning, and everybody is somebody new. Each
picture is brought into the light of the empty scene, so that a lamp which is switched is no change.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.io.boxes import BoxSeries
from muybridge.io.disk import disk_errors, make_folder
from muybridge.io.mot import mot_text
from muybridge.io.parts import HEADER, parts_text
from muybridge.io.run_facts import peak_memory_mb, speed, versions
from muybridge.io.run_folder import write_summary
from muybridge.people.blobs import Mask
from muybridge.people.box import boxes_from_states
from muybridge.people.failure import detector_named
from muybridge.people.learning import SceneLearner
from muybridge.people.masks import Masks
from muybridge.people.run import (
    PARTS_FILE,
    SMALLEST_SIDE,
    TRACKS_FILE,
    PeopleConfig,
    PeopleSummary,
    Progress,
    ignore,
    person_blobs,
    reduced_mask,
    write_scene,
)
from muybridge.people.scene import Scene
from muybridge.people.tracker import PeopleTracker
from muybridge.people.tracks import Tracks
from muybridge.people.watch import SceneWatch

TIMED = 10_000  # frames of which times are kept
Picture = NDArray[np.uint8]
Watcher = Callable[[Picture, BoxSeries], None]


class Stream(Protocol):
    """Pictures (H, W, 3) uint8 BGR as they come, at the size that is worked on; `size` is the camera's own."""

    name: str
    size: tuple[int, int]

    @property
    def frame_rate(self) -> float | None:
        """Frames per second; None where only the pictures tell."""
        ...

    def frames(self) -> Iterator[tuple[int, float, Picture]]:
        """Yield (number, seconds, picture); numbers rise, with gaps where pictures were dropped."""
        ...

    def facts(self) -> dict[str, Any]:
        """What happened on the way."""
        ...


def run_live(
    stream: Stream,
    out: Path,
    config: PeopleConfig | None = None,
    *,
    seed: int = 0,
    seconds: float | None = None,
    occluders: Mask | None = None,
    progress: Progress | None = None,
    watcher: Watcher | None = None,
) -> PeopleSummary:
    """Follow everybody in a stream of one fixed colour camera until it ends, and write the folder `out`.

    seconds : of the stream, after which to stop
    occluders : (H, W) bool, optional
        What hides people, in the camera's own pixels, beside what is found to.
    watcher : told each picture and the boxes in it, as far as they are known then
    """
    progress = progress or ignore
    run = _Run(config or PeopleConfig(), make_folder(out), stream, seed, occluders)
    frames = stream.frames()
    try:
        for number, at, picture in frames:
            run.step(number, at, picture)
            progress(number + 1, None, run.message)
            if watcher is not None:
                watcher(picture, run.boxes_now())
            if seconds is not None and at >= seconds:
                break
    except KeyboardInterrupt:
        run.finish("interrupted")
        raise
    except InputError:
        if run.frames:
            run.finish("broken off")
        raise
    finally:
        close = getattr(frames, "close", None)  # a generator's: the camera is given back at once
        if close is not None:
            close()
    return run.finish("done")


class _Run:
    """All that changes from frame to frame."""

    def __init__(self, config: PeopleConfig, out: Path, stream: Stream, seed: int, drawn: Mask | None) -> None:
        self.config, self.out, self.stream, self.seed, self.drawn = config, out, stream, seed, drawn
        self._detector = detector_named(config.repair)
        self.frames = self.boxes = 0
        self.message = "learning the scene"
        self.events: list[dict[str, Any]] = []
        self._started = time.perf_counter()
        self._times: deque[float] = deque(maxlen=TIMED)
        self._learner: SceneLearner | None = None
        self._known: tuple[Masks, Scene] | None = None
        self._watch: SceneWatch | None = None
        self._tracker: PeopleTracker | None = None
        self._identities: set[int] = set()
        self._last = self._settled = -1
        self._first, self._first_s = 0, 0.0

    def step(self, number: int, at: float, picture: Picture) -> None:
        """One picture; learnt from, or searched for people."""
        begun = time.perf_counter()
        if self._learner is None:
            self._begin(number, at, picture)
        self._last, self.frames = number, self.frames + 1
        if self._known is None:
            self._see(at, picture, None)
        else:
            self._follow(number, at, picture)
        self._times.append(1e3 * (time.perf_counter() - begun))

    def boxes_now(self) -> BoxSeries:
        """Those who are believed in and seen in the last picture, at the size that is worked on."""
        people = self._tracker.people if self._tracker else []
        shown = [person for person in people if person.confirmed and not person.missing]
        states = np.array([person.body.box for person in shown]).reshape(-1, 6)
        count = len(shown)
        return BoxSeries(np.full(count, max(self._last, 0)), np.array([person.identity for person in shown], np.int64),
                         boxes_from_states(states), np.ones(count))  # fmt: skip

    def finish(self, status: str) -> PeopleSummary:
        """Write what is left, and run.json."""
        self._settle(self._last)
        if self._known is not None:
            write_scene(self.out, self._known[1])
        summary = PeopleSummary(status, self.frames, len(self._identities), self.boxes, self.seed, speed(self._times),
                                self.frames / (time.perf_counter() - self._started), peak_memory_mb())  # fmt: skip
        facts = {"settings": asdict(self.config), "versions": versions(), "evaluations_per_frame": None}
        write_summary(
            self.out, {**asdict(summary), **facts, "stream": self.stream.facts(), "changes": self.events,
                       "scene": self._found()},
        )  # fmt: skip
        return summary

    def _found(self) -> dict[str, Any]:
        if self._known is None:
            return {}
        scene = self._known[1]
        ground = None if scene.ground is None else asdict(scene.ground)
        hidden = 0.0 if scene.occluders is None else float(scene.occluders.mean())
        return {"ground": ground, "silhouette": scene.silhouette.share.tolist(), "occluded_share": hidden}

    def _begin(self, number: int, at: float, picture: Picture) -> None:
        """Learn a scene of which nothing is known."""
        height, width = picture.shape[:2]
        if min(height, width) < SMALLEST_SIDE:
            raise InputError(self.stream.name, expected=f"pictures of at least {SMALLEST_SIDE} x {SMALLEST_SIDE} "
                             "pixels", got=f"{width} x {height}")  # fmt: skip
        if self.frames == 0:
            _start_tables(self.out)
        drawn = reduced_mask(self.drawn, self.stream.size, picture.shape[:2])
        config = self.config
        self._learner = SceneLearner(config.learning, config.masks, person_blobs(config),
                                     pictures=config.plate_moments, masks=config.moments, drawn=drawn)  # fmt: skip
        self._known = self._watch = None
        self._first_s, self._first = at, number
        self.message = "learning the scene"

    def _see(self, at: float, picture: Picture, mask: Mask | None) -> None:
        assert self._learner is not None
        self._learner.see(at, picture, mask)
        if self._learner.is_due(at):
            self._adopt(self._learner.learn(at, self._known), at)

    def _adopt(self, known: tuple[Masks, Scene], at: float) -> None:
        """Follow people in what is known now."""
        self._known = known
        if self._watch is None:
            self._watch = SceneWatch(self.config.watch, known[0].empty)
        self._watch.adopt(known[0].empty)
        if self._tracker is None:
            rate = self.stream.frame_rate or (self._last - self._first) / max(at - self._first_s, 1e-3)
            self._rate = rate
            self._tracker = PeopleTracker(known[1], self.config.tracker, frame_rate=rate, seed=self.seed,
                                          detector=self._detector)  # fmt: skip
        self._tracker.adopt(known[1])

    def _follow(self, number: int, at: float, picture: Picture) -> None:
        assert self._known is not None and self._watch is not None and self._tracker is not None
        masks = self._known[0]
        usual = masks.relit(picture)
        mask = masks.apply(usual)
        change = self._watch.step(usual, mask)
        if change:
            self._tracker.abandon()
            self.events.append({"frame": number + 1, "what": f"{change}: the scene is learnt anew"})
            del self.events[:-1000]  # a camera in the wind must not fill the memory either
            self._begin(number, at, picture)
        else:
            flooded = float(mask.mean()) > self.config.watch.share  # that is no foreground, and teaches nothing
            self._tracker.step(number, usual, mask, blind=flooded)
            if not flooded:
                self._see(at, masks.without_people(usual, mask), mask)
        self.message = f"{len(self._tracker.people)} people"
        second = max(1, round(self._rate))
        behind = max(self.config.learning.settle_s, self.config.tracker.identity.recall_s)
        if number - self._settled > second * (behind + 1):
            self._settle(number - round(self._rate * behind))

    def _settle(self, frame: int) -> None:
        """Append what is final."""
        if self._tracker is None:
            return
        scene = self._tracker.scene
        tracks = self._tracker.settle(frame).inside(scene.size).scaled(self.stream.size[0] / scene.size[0])
        self._settled = frame
        self.boxes += len(tracks.boxes)
        self._identities.update(tracks.boxes.ids.tolist())
        _append(self.out, tracks)


def _start_tables(out: Path) -> None:
    for name, head in ((TRACKS_FILE, ""), (PARTS_FILE, f"{HEADER}\n")):
        with disk_errors(out / name):
            (out / name).write_text(head, encoding="utf-8")


def _append(out: Path, tracks: Tracks) -> None:
    for name, text in ((TRACKS_FILE, mot_text(tracks.boxes)), (PARTS_FILE, parts_text(tracks.parts))):
        with disk_errors(out / name), (out / name).open("a", encoding="utf-8") as file:
            file.write(text)
