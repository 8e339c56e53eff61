"""What is true of a scene of several people, as files: boxes, parts, and who is where.

gt.txt            MOTChallenge's truth: frame, id, left, top, width, height, 1, 1, visibility
truth_parts.csv   boxes of head, torso and hip-leg as `io.parts` has them; the score is the visible share
NAME_mask.mp4     white where people fill at least half of the pixel
NAME_ids/         000000.png and on: the identity of each pixel, 0 for nobody
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from muybridge.io.disk import disk_errors
from muybridge.io.parts import PartSeries, write_parts
from muybridge.io.video_writer import VideoWriter
from muybridge.synthetic.crowd import PARTS, PeopleShot, shoot_people
from muybridge.synthetic.description import Scene

BOXES_FILE, PARTS_FILE = "gt.txt", "truth_parts.csv"
MASK_QUALITY = 18  # x264's constant rate factor: fine, whatever the pictures' is


def write_people(scene: Scene, folder: Path, progress: Callable[[int, int], None] | None = None) -> None:
    """Render the clip of a scene's only camera into a folder, with its truth."""
    name = scene.rig.names[0]
    ids, boxes, shots = folder / f"{name}_ids", [], []
    with disk_errors(ids):
        ids.mkdir()
    with ExitStack() as open_files:
        video = open_files.enter_context(VideoWriter(folder / f"{name}.mp4", scene.rate, quality=scene.sensor.quality))
        masks = open_files.enter_context(VideoWriter(folder / f"{name}_mask.mp4", scene.rate, quality=MASK_QUALITY))
        for frame in range(scene.frame_count):
            shot = shoot_people(scene, frame)
            video.write(shot.image)
            masks.write(shot.mask)
            _write_ids(ids / f"{frame:06d}.png", shot.ids)
            boxes += _box_lines(frame, shot)
            shots.append((shot.numbers, shot.parts, shot.parts_visible))
            if progress:
                progress(frame + 1, scene.frame_count)
    with disk_errors(folder / BOXES_FILE):
        (folder / BOXES_FILE).write_text("".join(boxes), encoding="utf-8")
    write_parts(folder / PARTS_FILE, _parts(shots))


def _write_ids(path: Path, ids: np.ndarray) -> None:
    import cv2

    _, data = cv2.imencode(".png", ids)
    with disk_errors(path):
        path.write_bytes(data.tobytes())


def _box_lines(frame: int, shot: PeopleShot) -> list[str]:
    """Frames and pixels count from 1."""
    return [
        f"{frame + 1},{number},{left + 1:g},{top + 1:g},{width:g},{height:g},1,1,{share:.4f}\n"
        for number, (left, top, width, height), share in zip(shot.numbers, shot.boxes, shot.visible, strict=True)
    ]


def _parts(shots: list[tuple[np.ndarray, np.ndarray, np.ndarray]]) -> PartSeries:
    """Parts of which nothing could be seen even if nothing hid them are left out."""
    count, names = len(PARTS), np.array(list(PARTS), dtype=np.str_)
    people = [len(numbers) for numbers, _, _ in shots]
    boxes = np.concatenate([parts for _, parts, _ in shots]).reshape(-1, 4)
    keep = boxes[:, 2] > 0
    return PartSeries(
        np.repeat(np.repeat(np.arange(len(shots)), people), count)[keep],
        np.repeat(np.concatenate([numbers for numbers, _, _ in shots]), count)[keep],
        np.tile(names, sum(people))[keep],
        boxes[keep],
        np.concatenate([shares for _, _, shares in shots]).ravel()[keep],
    )
