"""People drawn over their own footage: boxes with identities, the paths of their feet, their parts."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from muybridge.io.video_writer import VideoWriter
from muybridge.plotting.overlay import draw_label, line_width
from muybridge.plotting.overlay_video import LARGEST_SIDE

if TYPE_CHECKING:
    from muybridge.io.boxes import BoxSeries
    from muybridge.io.parts import PartSeries
    from muybridge.io.video import PictureSource

VIDEO_FILE = "people.mp4"
PATH_S = 3.0  # seconds of a path that are drawn
HUES = 0.618034  # of the colour circle between one identity and the next: neighbours in number are far apart in colour
SHADE = (20, 20, 20)


def write_people_video(
    folder: str | Path,
    pictures: PictureSource,
    boxes: BoxSeries,
    parts: PartSeries,
    *,
    progress: Callable[[int, int], None] | None = None,
) -> Path:
    """Draw tracks over the pictures they came from; the path of the video `people.mp4` in the folder.

    boxes, parts : in the pictures' own pixels, frames from 0
    progress : callable, optional
        Told how many of how many frames are done.
    """
    scale = min(1.0, LARGEST_SIDE / max(pictures.size))
    target = Path(folder) / VIDEO_FILE
    length = max(1, round(PATH_S * pictures.frame_rate))
    with VideoWriter(target, pictures.frame_rate) as video:
        for frame, _, picture in pictures.frames():
            video.write(draw_people(picture, frame, boxes, parts, path=length, scale=scale))
            if progress is not None:
                progress(frame + 1, len(pictures))
    return target


def draw_people(
    picture: np.ndarray,
    frame: int,
    boxes: BoxSeries,
    parts: PartSeries | None = None,
    *,
    path: int = 0,
    scale: float = 1.0,
) -> np.ndarray:
    """A new picture (H, W, 3) uint8 BGR with everybody in it, and where their feet were in the last `path` frames."""
    import cv2

    size = max(1, round(picture.shape[1] * scale)), max(1, round(picture.shape[0] * scale))
    result = cv2.resize(picture, size, interpolation=cv2.INTER_AREA) if scale != 1.0 else picture.copy()
    width = line_width(result)
    first, last = np.searchsorted(boxes.frames, (frame - path, frame + 1))
    recent = {name: getattr(boxes, name)[first:last] for name in ("frames", "ids", "boxes")}
    for identity in np.unique(recent["ids"]):
        rows = recent["ids"] == identity
        if recent["frames"][rows][-1] != frame:
            continue
        colour, mine = colour_of(int(identity)), recent["boxes"][rows] * scale
        feet = np.rint(mine[:, :2] + mine[:, 2:] * (0.5, 1.0)).astype(np.int32)
        cv2.polylines(result, [feet[:, None]], False, colour, width, cv2.LINE_AA)
        _rectangle(result, mine[-1], colour, width)
        _name(result, mine[-1], str(identity), colour)
    if parts is not None:
        first, last = np.searchsorted(parts.frames, (frame, frame + 1))
        for identity, box in zip(parts.ids[first:last], parts.boxes[first:last] * scale):
            _rectangle(result, box, colour_of(int(identity)), 1, shaded=False)
    return draw_label(result, f"frame {frame + 1}")


def colour_of(identity: int) -> tuple[int, int, int]:
    """BGR of an identity: bright, and unlike those of its neighbours in number."""
    import colorsys

    red, green, blue = colorsys.hsv_to_rgb((identity * HUES) % 1.0, 0.65, 1.0)
    return round(255 * blue), round(255 * green), round(255 * red)


def _rectangle(
    picture: np.ndarray, box: np.ndarray, colour: tuple[int, int, int], width: int, *, shaded: bool = True
) -> None:
    import cv2

    left, top = np.rint(box[:2]).astype(int)
    right, bottom = np.rint(box[:2] + box[2:] - 1).astype(int)
    for extra, shade in ((2, SHADE), (0, colour))[not shaded :]:
        cv2.rectangle(picture, (int(left), int(top)), (int(right), int(bottom)), shade, width + extra, cv2.LINE_AA)


def _name(picture: np.ndarray, box: np.ndarray, text: str, colour: tuple[int, int, int]) -> None:
    import cv2

    scale = max(0.4, picture.shape[0] / 1200)
    place = int(round(box[0])), max(12, int(round(box[1])) - 4)
    for width, shade in ((3, SHADE), (1, colour)):
        cv2.putText(picture, text, place, cv2.FONT_HERSHEY_SIMPLEX, scale, shade, width, cv2.LINE_AA)
