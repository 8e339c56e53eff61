"""A run drawn over its footage: the outlines lie where the body projects to, and the video has the run's frames."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from muybridge.body import Body, Segment, named_body
from muybridge.body.model import Shape
from muybridge.cameras import Camera
from muybridge.errors import InputError
from muybridge.io.run_folder import RunWriter
from muybridge.io.video import open_pictures
from muybridge.io.video_writer import VideoWriter
from muybridge.plotting.outlines import AROUND, segment_outlines
from muybridge.plotting.overlay_video import write_overlay

FOCAL, DISTANCE, RADIUS = 500.0, 4.0, 0.2
LOOKING_ALONG_Y = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])


def camera(size: tuple[int, int] = (320, 240)) -> Camera:
    """At (0, -4 m, 0), looking along +y, upright."""
    matrix = np.array([[FOCAL, 0, (size[0] - 1) / 2], [0, FOCAL, (size[1] - 1) / 2], [0, 0, 1]])
    return Camera("front", size, matrix, np.zeros(5), LOOKING_ALONG_Y, np.array([0, 0, DISTANCE]))


def ball() -> Body:
    return Body("ball", (Segment("ball", shape=Shape((0, 0, 0), (0, 0, 0), (RADIUS, RADIUS))),))


class TestOutlines:
    def test_a_ball_is_a_circle_around_its_centre(self) -> None:
        """Seen from d, a ball of radius r reaches f r / sqrt(d^2 - r^2) from its centre. No point of the polygon is
        farther; with 16 points around, none of its corners is nearer than cos(pi / 16) of f r / d."""
        outlines, names = segment_outlines(ball(), np.zeros(3), camera())
        radii = np.linalg.norm(outlines[0] - (319 / 2, 239 / 2), axis=1)
        outer = FOCAL * RADIUS / np.sqrt(DISTANCE**2 - RADIUS**2)
        assert names == ["ball"]
        assert radii.max() <= outer + 1e-3  # float32 pixels
        assert radii.min() >= np.cos(np.pi / AROUND) * FOCAL * RADIUS / DISTANCE

    def test_behind_the_camera_is_not_drawn(self) -> None:
        assert segment_outlines(ball(), np.array([0, -DISTANCE - 1, 0]), camera()) == ([], [])

    def test_a_person_has_every_shaped_segment(self) -> None:
        body = named_body("person")
        outlines, names = segment_outlines(body, np.zeros(len(body.dof_names)), camera())
        assert sorted(names) == sorted(s.name for s in body.segments if s.shape is not None)
        assert all(outline.shape[1] == 2 and len(outline) >= 3 for outline in outlines)


@pytest.fixture
def run(tmp_path: Path) -> Path:
    """Frames 2 to 4 of a video of six, with a ball that moves."""
    with VideoWriter(tmp_path / "front.mp4", 25) as video:
        for _ in range(6):
            video.write(np.full((240, 320, 3), 90, np.uint8))
    with RunWriter(tmp_path / "run", ["pelvis"], ball().dof_names) as writer:
        for frame in (2, 3, 4):
            place = np.array([0.1 * (frame - 3), 0, 0])
            writer.write(frame, frame / 25, place[None], np.array([0.02]), place)
    return tmp_path


class TestVideo:
    def test_it_has_the_runs_frames_and_the_body_is_seen(self, run: Path) -> None:
        seen: list[int] = []
        with open_pictures(run / "front.mp4") as pictures:
            target = write_overlay(run / "run", camera(), pictures, ball(), progress=seen.append)
        assert target.name == "overlay_front.mp4" and seen == [1, 2, 3]
        with open_pictures(target) as video:
            assert video.frame_count == 3 and video.size == (320, 240)
            changed = np.abs(video.read(1).astype(int) - 90).max(axis=2) > 30
        rows, columns = np.nonzero(changed[60:])
        assert abs(columns.mean() - 319 / 2) < 3 and abs(rows.mean() + 60 - 239 / 2) < 3

    def test_large_footage_is_drawn_smaller(self, tmp_path: Path) -> None:
        with VideoWriter(tmp_path / "front.mp4", 25) as video:
            video.write(np.zeros((720, 1920, 3), np.uint8))
        with RunWriter(tmp_path, ["pelvis"], ()) as writer:
            writer.write(0, 0.0, np.zeros((1, 3)), np.array([np.nan]), np.zeros(0))
        with open_pictures(tmp_path / "front.mp4") as pictures:
            target = write_overlay(tmp_path, camera((1920, 720)), pictures)
        with open_pictures(target) as video:
            assert video.size == (960, 360)

    def test_a_body_that_is_not_the_runs(self, run: Path) -> None:
        with open_pictures(run / "front.mp4") as pictures, pytest.raises(InputError, match="those of body 'person'"):
            write_overlay(run / "run", camera(), pictures, named_body("person"))
