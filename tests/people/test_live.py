"""Streams: learnt on the way, written on the way, and nothing remembered for ever."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from made_people import HEIGHT, WIDTH, Walker, empty_scene, picture_of
from muybridge.errors import InputError
from muybridge.io.boxes import read_boxes
from muybridge.io.live import PlayedBack
from muybridge.io.parts import read_parts
from muybridge.io.video import open_pictures
from muybridge.io.video_writer import VideoWriter
from muybridge.people.learning import LearningConfig, Moments
from muybridge.people.live import run_live
from muybridge.people.run import PeopleConfig, run
from muybridge.people.watch import SceneWatch, WatchConfig
from people.made import identities

EMPTY = empty_scene()
RATE = 10.0
LEARN = 40  # frames in which somebody walks, and nobody is followed yet
SETTINGS = [
    "tracker.smallest=30",
    "tracker.counts.most=200",
    "tracker.counts.fewest=100",
    "plate_moments=20",
    "moments=40",
    "learning.first_s=4",
    "learning.again_s=4",
]
CONFIG = PeopleConfig().with_settings(SETTINGS)
# Two walk while the scene is learnt, so that the ground is known; three come later.
EARLY = [Walker((10, 130), (310, 130), 0, 39, 0), Walker((310, 200), (10, 200), 0, 39, 1)]
LATE = [
    Walker((10, 140), (310, 140), 45, 94, 0),
    Walker((310, 190), (-30, 190), 50, 99, 1),  # out of the picture: who vanished inside it would be waited for
    Walker((10, 220), (310, 160), 105, 154, 2),
]
FRAMES = 160


class Made:
    """A stream of pictures made by a function of the frame."""

    name, size, frame_rate = "made", (WIDTH, HEIGHT), RATE

    def __init__(self, picture: Callable[[int], np.ndarray], frames: int, rate: float | None = RATE) -> None:
        self.picture, self.count, self.frame_rate = picture, frames, rate
        self.closed = False

    def frames(self) -> Iterator[tuple[int, float, np.ndarray]]:
        try:
            for frame in range(self.count):
                yield frame, frame / RATE, self.picture(frame)
        finally:
            self.closed = True

    def facts(self) -> dict[str, Any]:
        return {"received": self.count}


def walk(frame: int) -> np.ndarray:
    return picture_of(EARLY + LATE, frame, EMPTY)[0]


def events(folder: Path) -> list[dict[str, Any]]:
    return json.loads((folder / "run.json").read_text())["changes"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("live")
    summary = run_live(Made(walk, FRAMES), folder, CONFIG)
    assert summary.status == "done" and summary.frames == FRAMES
    return folder


class TestRun:
    def test_everybody_is_followed_once_the_scene_is_known(self, folder: Path) -> None:
        boxes = read_boxes(folder / "tracks.txt")
        assert boxes.frames.min() > LEARN and not events(folder)
        found = identities(boxes, LATE, FRAMES)
        usual = [max(set(one), key=one.count) for one in found]
        for one, identity in zip(found, usual):
            assert identity != 0 and one.count(identity) >= 0.8 * len(one)
        assert len(set(usual)) == len(LATE)

    def test_tables_are_whole_and_in_order(self, folder: Path) -> None:
        """Readers check that nobody is in a frame twice; the lines themselves come in the order of frames."""
        frames = [int(line.split(",")[0]) for line in (folder / "tracks.txt").read_text().splitlines()]
        assert frames == sorted(frames)
        boxes, parts = read_boxes(folder / "tracks.txt"), read_parts(folder / "parts.csv")
        rows = set(zip(boxes.frames.tolist(), boxes.ids.tolist()))
        assert len(parts) and set(zip(parts.frames.tolist(), parts.ids.tolist())) <= rows
        summary = json.loads((folder / "run.json").read_text())
        assert summary["boxes"] == len(boxes) and summary["people"] == len(set(boxes.ids.tolist()))

    def test_the_rate_is_measured_where_nobody_says_it(self, folder: Path, tmp_path: Path) -> None:
        run_live(Made(walk, FRAMES, rate=None), tmp_path, CONFIG)
        assert (tmp_path / "tracks.txt").read_text() == (folder / "tracks.txt").read_text()

    def test_what_is_final_is_written_while_it_runs(self, tmp_path: Path) -> None:
        """Rows are written when they are ten seconds old, which the first ones are in a clip of 16 seconds."""
        lines: list[int] = []
        run_live(
            Made(walk, FRAMES),
            tmp_path,
            CONFIG,
            watcher=lambda picture, boxes: lines.append(len((tmp_path / "tracks.txt").read_text().splitlines())),
        )
        assert 0 < lines[-1] < len((tmp_path / "tracks.txt").read_text().splitlines()) and lines[LEARN] == 0

    def test_the_watcher_sees_boxes(self, tmp_path: Path) -> None:
        seen: list[int] = []
        run_live(Made(walk, 80), tmp_path, CONFIG, watcher=lambda picture, boxes: seen.append(len(boxes)))
        assert max(seen) == 2 and seen[0] == 0

    def test_it_stops_after_so_many_seconds(self, tmp_path: Path) -> None:
        stream = Made(walk, FRAMES)
        assert run_live(stream, tmp_path, CONFIG, seconds=6.0).frames == 61 and stream.closed

    def test_an_interrupt_keeps_what_there_is(self, tmp_path: Path) -> None:
        def until(frame: int) -> np.ndarray:
            if frame == 90:
                raise KeyboardInterrupt
            return walk(frame)

        with pytest.raises(KeyboardInterrupt):
            run_live(Made(until, FRAMES), tmp_path, CONFIG)
        assert json.loads((tmp_path / "run.json").read_text())["status"] == "interrupted"
        assert len(read_boxes(tmp_path / "tracks.txt")) > 20

    def test_a_file_played_back(self, tmp_path: Path) -> None:
        with VideoWriter(tmp_path / "walk.mp4", RATE, quality=10) as video:
            for frame in range(110):
                video.write(walk(frame))
        with open_pictures(tmp_path / "walk.mp4") as pictures:
            stream = PlayedBack(pictures)
            summary = run_live(stream, tmp_path / "out", CONFIG)
        assert summary.frames == 110 and stream.facts()["received"] == 110 and summary.people >= 2


class TestChanges:
    def test_a_knocked_camera_is_noticed_and_learnt_anew(self, tmp_path: Path) -> None:
        """Frames of 60 on lie 12 pixels further right; five in a row make sure. Nobody keeps an identity over it."""

        def knocked(frame: int) -> np.ndarray:
            return np.roll(walk(frame), 12, axis=1) if frame >= 60 else walk(frame)

        run_live(Made(knocked, FRAMES), tmp_path, CONFIG)
        (event,) = events(tmp_path)
        assert event["frame"] == 65 and "moved by" in event["what"]
        boxes = read_boxes(tmp_path / "tracks.txt")
        before, after = (set(boxes.ids[part].tolist()) for part in (boxes.frames < 65, boxes.frames > 65))
        assert before and after and not before & after

    def test_light_that_changes_everywhere_is_followed(self, tmp_path: Path) -> None:
        """Half as bright from frame 70 on, people in view: they keep their identities."""

        def darker(frame: int) -> np.ndarray:
            return (walk(frame) * 0.5).astype(np.uint8) if frame >= 70 else walk(frame)

        run_live(Made(darker, FRAMES), tmp_path, CONFIG)
        assert not events(tmp_path)
        boxes = read_boxes(tmp_path / "tracks.txt")
        for found in identities(boxes, LATE[:2], 100):
            assert found[10] != 0 and found.count(found[10]) >= 0.6 * len(found)

    def test_another_scene_is_learnt_anew(self, tmp_path: Path) -> None:
        other = empty_scene(7)
        run_live(Made(lambda frame: walk(frame) if frame < 60 else other, 90), tmp_path, CONFIG)
        assert "learnt anew" in events(tmp_path)[0]["what"]

    def test_people_are_no_change(self) -> None:
        watch = SceneWatch(WatchConfig(), EMPTY)
        for frame in range(60, 90):
            picture, mask = picture_of(LATE, frame, EMPTY)
            assert watch.step(picture, mask) == ""

    def test_a_grey_wall_tells_no_shift(self) -> None:
        flat = np.full((HEIGHT, WIDTH, 3), 128, np.uint8)
        noise = np.random.default_rng(0).integers(0, 255, flat.shape).astype(np.uint8)
        assert SceneWatch(WatchConfig(), flat).shift(flat) == (0.0, 0.0)
        assert SceneWatch(WatchConfig(), EMPTY).shift(noise) == (0.0, 0.0)


class TestMemory:
    def test_moments_reach_back_further_and_further(self) -> None:
        """Of 10,000 seconds at most 60 are kept, evenly until they are as far apart as allowed, then the latest."""
        kept: Moments[int] = Moments(most=60, interval=0.5, longest=8.0)
        for second in range(10_000):
            kept.offer(second, second)
            assert len(kept.items) <= 60
        assert kept.interval == 8.0 and set(np.diff(kept.items)) == {8} and kept.items[-1] >= 9_992

    def test_nobody_is_remembered_for_ever(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        """Sightings that are written are forgotten: what is kept is of the settling time, and a first one a person."""
        from muybridge.people import live

        kept: list[int] = []
        made: list[Any] = []

        class Spied(live.PeopleTracker):
            def __init__(self, *args: Any, **named: Any) -> None:
                super().__init__(*args, **named)
                made.append(self)

        monkeypatch.setattr(live, "PeopleTracker", Spied)
        config = PeopleConfig().with_settings([*SETTINGS, "learning.settle_s=6.5"])

        def again(frame: int) -> np.ndarray:
            return walk(frame if frame < LEARN else LEARN + (frame - LEARN) % 60)

        def count(picture: np.ndarray, boxes: Any) -> None:
            people = [*made[0].people, *made[0].gone] if made else []
            kept.append(sum(len(person.sightings) for person in people))

        run_live(Made(again, 400), tmp_path, config, watcher=count)
        boxes = read_boxes(tmp_path / "tracks.txt")
        assert len(boxes) > 400 and max(kept[300:]) <= 2 * max(kept[100:200])
        lives = [boxes.frames[boxes.ids == identity] for identity in np.unique(boxes.ids)]
        assert max(np.ptp(life) for life in lives) < 120  # nobody comes back as somebody of an earlier round


class TestErrors:
    def test_a_picture_too_small(self, tmp_path: Path) -> None:
        with pytest.raises(InputError, match="at least 32 x 32 pixels, got 1 x 1"):
            run_live(Made(lambda _: np.zeros((1, 1, 3), np.uint8), 3), tmp_path, CONFIG)

    def test_a_video_too_small(self, tmp_path: Path) -> None:
        import cv2

        for frame in range(3):
            cv2.imwrite(str(tmp_path / f"{frame}.png"), np.zeros((1, 1), np.uint8))
        with open_pictures(tmp_path) as pictures, pytest.raises(InputError, match="at least 32 x 32"):
            run(pictures, tmp_path / "out", CONFIG)

    @pytest.mark.parametrize("channels", [1, 4])
    def test_grey_and_four_channels_are_taken(self, tmp_path: Path, channels: int) -> None:
        import cv2

        for frame in range(50):
            picture = walk(frame)
            made = picture[..., 0] if channels == 1 else np.dstack([picture, np.full(picture.shape[:2], 200, np.uint8)])
            cv2.imwrite(str(tmp_path / f"{frame:03d}.png"), made)
        with open_pictures(tmp_path, RATE) as pictures:
            assert run_live(PlayedBack(pictures), tmp_path / "out", CONFIG).frames == 50

    def test_settings(self) -> None:
        with pytest.raises(InputError, match="seconds above 0"):
            LearningConfig(first_s=0)
        with pytest.raises(InputError, match="share above 0"):
            WatchConfig(share=0)

    def test_occluders_of_another_size(self, tmp_path: Path) -> None:
        with pytest.raises(InputError, match="occluders"):
            run_live(Made(walk, 50), tmp_path, CONFIG, occluders=np.zeros((10, 10), bool))
