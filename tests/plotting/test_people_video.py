"""People drawn over pictures: boxes where they are, and a video with a picture for every frame."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from io_boxes import two_people
from muybridge.io.video import open_pictures
from muybridge.io.video_writer import VideoWriter
from muybridge.plotting.people_video import colour_of, draw_people, write_people_video


def test_edges_are_drawn_and_the_picture_is_left_alone() -> None:
    picture = np.full((120, 160, 3), 90, np.uint8)
    boxes, parts = two_people()
    drawn = draw_people(picture, 2, boxes, parts, path=3)
    assert (picture == 90).all() and drawn.shape == picture.shape
    changed = (drawn != picture).any(axis=2)
    left, top, width, height = boxes.boxes[boxes.frames == 2][0].astype(int)
    assert (
        changed[top + 30 : top + height - 5, left].all()
        and changed[top + 30 : top + height - 5, left + width - 1].all()
    )
    assert not changed[top + 35 : top + height - 10, left + 6 : left + width // 2 - 3].any()
    assert not (draw_people(picture, 9, boxes, parts) != picture)[40:].any()  # nobody there: only the label


def test_identities_have_colours_apart() -> None:
    colours = np.array([colour_of(identity) for identity in range(1, 9)], float)
    apart = np.linalg.norm(colours[:, None] - colours[None], axis=2)[~np.eye(8, dtype=bool)]
    assert apart.min() > 40


def test_a_video_of_every_frame(tmp_path: Path) -> None:
    with VideoWriter(tmp_path / "in.mp4", 10) as video:
        for _ in range(5):
            video.write(np.full((120, 160, 3), 90, np.uint8))
    told: list[tuple[int, int]] = []
    with open_pictures(tmp_path / "in.mp4") as pictures:
        path = write_people_video(
            tmp_path, pictures, *two_people(), progress=lambda done, total: told.append((done, total))
        )
    with open_pictures(path) as drawn:
        assert drawn.frame_count == 5 and drawn.size == (160, 120) and told[-1] == (5, 5)
        assert np.abs(drawn.read(2).astype(int) - 90).max() > 60
