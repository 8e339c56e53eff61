"""What somebody says of a camera by hand: what hides people, and how small the smallest are who matter.

A folder of marks holds what `muybridge people --marks` takes:

occluders.png    white where something always stands before people
marks.json       polygons: [[[x, y], ...], ...], pixels of the picture; smallest: pixels of a standing person's height

Zhao (2009) draws such masks (5.4.2) and sets the thresholds (5.1) for each camera.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from muybridge.cameras.model import Camera
from muybridge.errors import InputError
from muybridge.io.disk import make_folder, replace_file
from muybridge.io.video import MASK_THRESHOLD, PictureSource, read_image
from muybridge.people.blobs import Mask, find_people
from muybridge.people.run import PeopleConfig, look_over, moments_of, person_blobs
from muybridge.segmentation.pictures import reduce_image

MASK_FILE, MARKS_FILE = "occluders.png", "marks.json"
EXPECTED = '{"polygons": [[[x, y], ...], ...], "smallest": pixels}'
MOST_POINTS = 10_000
SHORT = 1.5  # metres: a small adult
LEEWAY = 0.9  # of the smallest that were seen: the next one may be smaller
FEWEST = 12  # people, to learn from

Polygon = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Marks:
    """polygons : corners (x, y), pixels, of what hides people; smallest : pixels, None where nothing is said."""

    polygons: tuple[Polygon, ...] = ()
    smallest: float | None = None

    def __post_init__(self) -> None:
        points = [point for polygon in self.polygons for point in polygon]
        if len(points) > MOST_POINTS or any(len(polygon) < 3 for polygon in self.polygons):
            raise InputError("marks: polygons", expected=f"three corners or more each, {MOST_POINTS} in all",
                             got=f"{len(points)} in {len(self.polygons)}")  # fmt: skip
        if points and not np.isfinite(points).all():
            raise InputError("marks: polygons", expected="finite numbers", got="others")
        if self.smallest is not None and not 8 <= self.smallest <= 10_000:
            raise InputError("marks: smallest", expected="8 to 10000 pixels", got=f"{self.smallest:g}")

    def mask(self, size: tuple[int, int]) -> Mask:
        """(H, W) bool of a picture (width, height): inside some polygon; what lies outside the picture is cut off."""
        import cv2

        mask = np.zeros(size[::-1], np.uint8)
        for polygon in self.polygons:
            corners = np.clip(np.rint(polygon), -30_000, 30_000).astype(np.int32)
            cv2.fillPoly(mask, [corners], 1)
        return mask.astype(bool)

    def settings(self) -> list[str]:
        """KEY=VALUE for `PeopleConfig.with_settings`."""
        if self.smallest is None:
            return []
        return [f"tracker.smallest={self.smallest:g}", f"tracker.blobs.smallest={round(0.12 * self.smallest**2)}"]


def marks_from(table: Any, what: str) -> Marks:
    """Marks from the plain values that a file, or the page, has."""
    if not isinstance(table, dict) or not set(table) <= {"polygons", "smallest"}:
        raise InputError(what, expected=EXPECTED, got=str(table)[:60])
    try:
        polygons = tuple(tuple((float(x), float(y)) for x, y in polygon) for polygon in table.get("polygons") or ())
        smallest = None if table.get("smallest") is None else float(table["smallest"])
    except (TypeError, ValueError):
        raise InputError(what, expected=EXPECTED, got="something else inside") from None
    return Marks(polygons, smallest)


def read_polygons(path: Path) -> Marks:
    """A marks.json, or a file like it."""
    try:
        table = json.loads(path.read_bytes())
    except OSError as error:
        raise InputError(str(path), expected="a file of marks", got=error.strerror or str(error)) from None
    except ValueError:
        raise InputError(str(path), expected=EXPECTED, got="no JSON") from None
    return marks_from(table, str(path))


def write_marks(folder: Path, marks: Marks, size: tuple[int, int]) -> None:
    """Both files, for pictures (width, height)."""
    import cv2

    make_folder(folder)
    white = marks.mask(size).astype(np.uint8) * np.uint8(255)
    replace_file(folder / MASK_FILE, cv2.imencode(".png", white)[1].tobytes())
    table = {"polygons": marks.polygons, "smallest": marks.smallest}
    replace_file(folder / MARKS_FILE, (json.dumps(table, indent=1) + "\n").encode())


def read_marks(folder: Path) -> tuple[Mask | None, list[str]]:
    """The occluders (H, W) bool, None where none are marked, and settings KEY=VALUE."""
    marks = read_polygons(folder / MARKS_FILE)
    mask = read_image(folder / MASK_FILE, colour=False) > MASK_THRESHOLD
    return (mask if mask.any() else None), marks.settings()


def learnt_smallest(pictures: PictureSource, config: PeopleConfig | None = None) -> float:
    """Pixels, in the pictures' own: a little less than the smallest who walk upright and whole through the clip."""
    config = config or PeopleConfig().with_settings(["tracker.smallest=16"])
    factor = min(1.0, config.rows / pictures.size[1])
    masks, scene = look_over(pictures, config, factor)
    heights = []
    for index in moments_of(pictures, config) if scene.ground is not None else ():
        mask = masks.apply(masks.relit(reduce_image(pictures.read(index), factor)))
        for left, top, width, height in (blob.box for blob in find_people(mask, person_blobs(config))):
            inside = left > 0 and top > 0 and left + width < scene.size[0] and top + height < scene.size[1]
            if inside and scene.ground is not None and abs(height / float(scene.ground.height(top + height)) - 1) < 0.1:
                heights.append(height)
    if len(heights) < FEWEST:
        raise InputError(pictures.name, expected=f"{FEWEST} people who stand free, to learn their size",
                         got=str(len(heights)), remedy="draw the smallest, or give a longer clip")  # fmt: skip
    return float(round(LEEWAY * np.percentile(heights, 2) / factor))


def calibrated_smallest(camera: Camera, farthest: float) -> float:
    """Pixels: the least height of a small adult who stands on the floor in the picture, no further than so many metres.

    The floor is z = 0.
    """
    width, height = camera.size
    grid = np.stack(np.meshgrid(np.linspace(0, width - 1, 33), np.linspace(0, height - 1, 33)), axis=-1).reshape(-1, 2)
    origin, rays = camera.pixel_to_ray(grid)
    down = rays[:, 2] < -1e-9
    floor = camera.position + rays[down] * (-camera.position[2] / rays[down, 2])[:, None]
    floor = floor[np.linalg.norm(floor - camera.position, axis=1) <= farthest]
    if not len(floor):
        raise InputError(f"camera {camera.name}", expected=f"floor (z = 0) in its picture within {farthest:g} m",
                         got="none", remedy="a larger --farthest")  # fmt: skip
    feet, heads = camera.world_to_pixel(floor), camera.world_to_pixel(floor + (0.0, 0.0, SHORT))
    tall = np.linalg.norm(heads - feet, axis=1)
    return float(np.floor(np.nanmin(tall)))
