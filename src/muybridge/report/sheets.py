"""Contact sheets from a run's overlay videos: a few pictures that show the whole run, each cut to the person."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from muybridge.errors import InputError
from muybridge.io.run_folder import JointSeries

if TYPE_CHECKING:
    from muybridge.cameras import Camera
    from muybridge.evaluation import JointErrors

CAMERAS_FILE = "cameras.json"
SHEET_PICTURES = 8
UPRIGHT = 1.2
"""Pictures this many times as high as wide stand in one row, others in two."""
MARGIN = 1.4
"""A cut-out is this many times as wide and high as the joints in it: room for hands, feet and the surroundings."""
WORTH_CUTTING = 0.75
"""A cut-out with more than this share of the picture's area gains nothing; then the whole picture is shown."""


def worth_seeing(frames: np.ndarray, errors: JointErrors | None = None) -> tuple[int, ...]:
    """Rows for a contact sheet: evenly spread from first to last, the nearest of them moved to the worst frame.

    Parameters
    ----------
    frames : (T,) int64
        The run's frame numbers.
    errors : JointErrors, optional
    """
    count = len(frames)
    rows = np.unique(np.rint(np.linspace(0, max(count - 1, 0), min(SHEET_PICTURES, count))).astype(int))
    worst = np.flatnonzero(frames == errors.worst_frame) if errors is not None else rows[:0]
    if len(worst) and len(rows) > 2 and worst[0] not in rows:
        rows[1 + int(np.argmin(np.abs(rows[1:-1] - worst[0])))] = worst[0]
    return tuple(int(row) for row in rows)


def contact_sheets(folder: Path, series: JointSeries, rows: Sequence[int]) -> dict[str, np.ndarray]:
    """A sheet for each overlay video in the folder; a video that cannot be read is left out.

    An overlay has one picture for each row of the run's tables, so row and picture number are the same.

    Parameters
    ----------
    folder : Path
        The run folder; its cameras.json, where there is one, says where in a picture the person is.
    series : JointSeries
    rows : sequence of int

    Returns
    -------
    dict of camera name to (H, W, 3) uint8 BGR
    """
    from muybridge.io.video_reader import VideoReader
    from muybridge.plotting.overlay import contact_sheet

    cameras, sheets = _cameras(folder), {}
    for path in sorted(folder.glob("overlay_*.mp4")):
        name = path.stem.removeprefix("overlay_")
        try:
            with VideoReader(path) as video:
                shown = [row for row in rows if row < video.frame_count]
                pictures = [video.read(row) for row in shown]
        except InputError:
            continue
        if name in cameras:
            pictures = cut_out(pictures, cameras[name], series.positions[shown])
        if pictures:
            labels = [f"frame {series.frames[row]}" for row in shown]
            upright = pictures[0].shape[0] > UPRIGHT * pictures[0].shape[1]
            sheets[name] = contact_sheet(pictures, labels, columns=SHEET_PICTURES if upright else SHEET_PICTURES // 2)
    return sheets


def cut_out(pictures: Sequence[np.ndarray], camera: Camera, points: np.ndarray) -> list[np.ndarray]:
    """Each picture cut to the person, all to one size; the whole pictures where that would gain nothing.

    Parameters
    ----------
    pictures : n arrays (H, W, 3) uint8 BGR
        The camera's pictures, perhaps reduced.
    camera : Camera
    points : (n, J, 3) float64, metres, world

    Returns
    -------
    list of (h, w, 3) uint8 BGR
    """
    if not pictures:
        return []
    bound = np.array(pictures[0].shape[1::-1])
    boxes = [_box(camera, joints, bound) for joints in points]
    known = [box for box in boxes if box is not None]
    if not known:
        return list(pictures)
    size = np.ceil(MARGIN * np.max([high - low for low, high in known], axis=0)).astype(int)
    size = np.clip(size, bound // 8, bound)
    if np.prod(size) > WORTH_CUTTING * np.prod(bound):
        return list(pictures)
    cut = []
    for picture, box in zip(pictures, boxes, strict=True):
        centre = bound / 2 if box is None else (box[0] + box[1]) / 2
        x, y = np.clip(np.rint(centre - size / 2).astype(int), 0, bound - size)
        cut.append(picture[y : y + size[1], x : x + size[0]])
    return cut


def _box(camera: Camera, points: np.ndarray, bound: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Upper left and lower right corner of the joints in a picture of the size `bound`; None where none is in view."""
    depth = camera.world_to_camera(points)[:, 2]
    seen = points[np.isfinite(depth) & (depth > 0)]
    if not len(seen):
        return None
    pixels = (camera.world_to_pixel(seen) + 0.5) * bound / np.array(camera.size) - 0.5
    pixels = np.clip(pixels, 0, bound)
    return pixels.min(axis=0), pixels.max(axis=0)


def _cameras(folder: Path) -> dict[str, Camera]:
    """The run's cameras by name; none where it left none that can be read."""
    from muybridge.cameras.readers import read_rig

    if not (folder / CAMERAS_FILE).is_file():
        return {}
    try:
        return {camera.name: camera for camera in read_rig(folder / CAMERAS_FILE)}
    except InputError:
        return {}
