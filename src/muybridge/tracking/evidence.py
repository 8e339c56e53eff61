"""From a job's pictures to masks, camera by camera: ready-made ones, or the difference to a background.

Only the neighbourhood of where the person is expected is looked at: clutter elsewhere costs nothing and time is saved.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field

import cv2
import numpy as np

from muybridge.cameras.model import Camera, Rig
from muybridge.errors import InputError
from muybridge.io.job import CameraInput, Job, background_config
from muybridge.io.video import MaskSource, PictureSource, open_masks, open_pictures
from muybridge.segmentation import (
    BACKGROUND_MODELS,
    CleaningConfig,
    Segmenter,
    ShadowConfig,
    has_colour,
    reduce_image,
)

MARGIN_M = 0.45  # metres round the expected joints in which the person is looked for
MEDIAN = 5  # pixels of a ready-made mask; takes speckle away
SMALLEST, GAP = 25, 8.0  # reduced pixels: of a piece of mask, and between it and the person
TRAINING_FRAMES = 100  # at most, of the empty scene


@dataclass(frozen=True, eq=False)
class Eye:
    """One camera's way from what is read to a mask."""

    camera: Camera
    reduction: int
    segmenter: Segmenter | None

    def mask(self, image: np.ndarray, expected: np.ndarray | None) -> np.ndarray:
        """The person's mask, at recorded or reduced size.

        Parameters
        ----------
        image : (H, W, 3) uint8, or (H, W) bool where masks are ready-made
        expected : (J, 3) float64, metres, world, or None for anywhere
        """
        box = None if expected is None else self._box(expected)
        if self.segmenter is None:
            return _connected(_inside(image, box), self.reduction)
        if box is None:
            return self.segmenter.apply(image)
        small = tuple((v + 0.5) / self.reduction - 0.5 for v in box)
        mask = self.segmenter.apply(image, small)  # type: ignore[arg-type]
        return _inside(mask, tuple(int(round(v)) for v in small), median=1)  # type: ignore[arg-type]

    def _box(self, joints: np.ndarray) -> tuple[int, int, int, int] | None:
        """Left, top, right, bottom in recorded pixels; None where the joints are not before the camera."""
        pixels = self.camera.world_to_pixel(joints)
        pixels = pixels[np.isfinite(pixels).all(axis=1)]
        if not len(pixels):
            return None
        depth = max(0.3, float(np.median(self.camera.world_to_camera(joints)[:, 2])))
        margin = MARGIN_M * np.sqrt(self.camera.matrix[0, 0] * self.camera.matrix[1, 1]) / depth
        (left, top), (right, bottom) = pixels.min(axis=0) - margin, pixels.max(axis=0) + margin
        return int(left), int(top), int(np.ceil(right)), int(np.ceil(bottom))


def _inside(mask: np.ndarray, box: tuple[int, int, int, int] | None, median: int = MEDIAN) -> np.ndarray:
    """The mask without speckle inside the box, and nothing outside it."""
    if box is None:
        return cv2.medianBlur(mask.view(np.uint8), median).view(bool) if median > 1 else mask
    height, width = mask.shape
    left, top = max(0, box[0]), max(0, box[1])
    right, bottom = min(width, box[2] + 1), min(height, box[3] + 1)
    out = np.zeros_like(mask)
    if left < right and top < bottom:
        part = np.ascontiguousarray(mask[top:bottom, left:right])
        out[top:bottom, left:right] = cv2.medianBlur(part.view(np.uint8), median).view(bool) if median > 1 else part
    return out


def _connected(mask: np.ndarray, reduction: int) -> np.ndarray:
    """A ready-made mask without pieces that lie apart from the person; worked out at half size, which is enough."""
    half = np.ascontiguousarray(mask[::2, ::2]).view(np.uint8)
    count, labels, stats, _ = cv2.connectedComponentsWithStats(half, connectivity=8)
    if count < 3:
        return mask
    main = 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA]))
    side = 2 * round(0.5 * GAP * reduction) + 1
    surroundings = cv2.dilate((labels == main).view(np.uint8), np.ones((side, side), np.uint8)).view(bool)
    near = np.bincount(labels[surroundings], minlength=count) > 0
    keep = near & (stats[:, cv2.CC_STAT_AREA] >= 0.25 * SMALLEST * reduction**2)
    keep[0] = False
    keep[main] = True
    wider = cv2.dilate(keep[labels].view(np.uint8), np.ones((3, 3), np.uint8)).view(
        bool
    )  # no border pixel is shaved off
    kept = np.repeat(np.repeat(wider, 2, axis=0), 2, axis=1)[: mask.shape[0], : mask.shape[1]]
    return mask & kept


@dataclass
class Eyes:
    """All cameras of a job, opened; a context manager that closes them.

    sources : what masks come from, one a camera; then the pictures, where they are wanted and masks are ready-made
    shown : which of the sources shows each camera's pictures; empty where none are wanted
    """

    rig: Rig
    reductions: tuple[int, ...]
    eyes: list[Eye] = field(default_factory=list)
    sources: list = field(default_factory=list)
    shown: list[int] = field(default_factory=list)
    _stack: ExitStack = field(default_factory=ExitStack)

    def masks(self, images: Sequence[np.ndarray], expected: np.ndarray | None) -> list[np.ndarray]:
        """Masks of one frame; `expected` (J, 3) metres: where the joints should be."""
        return [eye.mask(image, expected) for eye, image in zip(self.eyes, images, strict=False)]

    def pictures(self, images: Sequence[np.ndarray]) -> list[np.ndarray] | None:
        """Pictures of one frame; None where none are wanted."""
        return [images[place] for place in self.shown] if self.shown else None

    def read(self, index: int) -> list[np.ndarray]:
        """What masks of one frame come from, camera by camera."""
        return [source.read(index) for source in self.sources[: len(self.eyes)]]

    def __enter__(self) -> Eyes:
        return self

    def __exit__(self, *exc: object) -> None:
        self._stack.close()


def open_eyes(job: Job, rig: Rig, reductions: tuple[int, ...], with_pictures: bool = False) -> Eyes:
    """Open every camera's pictures (or ready-made masks) and train its background.

    with_pictures : bool
        Open the pictures as well where masks are ready-made.
    """
    eyes = Eyes(rig, reductions)
    try:
        for entry, camera, reduction in zip(job.cameras, rig, reductions, strict=True):
            if entry.masks is not None:
                _add_source(eyes, open_masks(entry.masks, entry.frame_rate, frames=entry.frames), camera)
                eyes.eyes.append(Eye(camera, reduction, None))
            else:
                _add_source(eyes, open_pictures(entry.pictures, entry.frame_rate, frames=entry.frames), camera)
                eyes.eyes.append(Eye(camera, reduction, build_segmenter(entry, reduction)))
        for place, (entry, camera) in enumerate(zip(job.cameras, rig, strict=True)) if with_pictures else ():
            if entry.masks is not None:
                _add_source(eyes, open_pictures(entry.pictures, entry.frame_rate, frames=entry.frames), camera)
                place = len(eyes.sources) - 1
            eyes.shown.append(place)
    except BaseException:
        eyes._stack.close()
        raise
    return eyes


def _add_source(eyes: Eyes, source: MaskSource | PictureSource, camera: Camera) -> None:
    """Have the source closed with the others, and refuse it where it is not of the calibrated size."""
    eyes.sources.append(source)
    eyes._stack.callback(source.close)
    if tuple(source.size) != tuple(camera.size):
        raise InputError(
            f"camera {camera.name!r}",
            expected=f"pictures of {_sized(camera.size)} as calibrated",
            got=_sized(source.size),
            remedy="give the calibration of these pictures",
        )


def _sized(size: Sequence[int]) -> str:
    return f"{size[0]} x {size[1]}"


def build_segmenter(entry: CameraInput, reduction: int) -> Segmenter:
    """The camera's background model, trained at the reduced size; shadows go where the empty scene has colour."""
    background = entry.background
    if background is None:
        raise InputError(
            f"camera {entry.name!r}",
            expected="masks or a [camera.background]",
            got="neither",
            remedy="give masks, a plate, empty frames, or a hue",
        )
    config = background_config(entry)
    model = BACKGROUND_MODELS[background.kind]
    empty = _empty_pictures(entry, reduction) if model.needs_pictures else []
    shadows = any(map(has_colour, empty)) if background.shadows is None else background.shadows
    return Segmenter(model.build(empty, config), 1.0 / reduction, ShadowConfig() if shadows else None, CleaningConfig())


def _empty_pictures(entry: CameraInput, reduction: int) -> list[np.ndarray]:
    """Reduced pictures of the empty scene, evenly taken, at most `TRAINING_FRAMES`."""
    background = entry.background
    if background is None:
        return []
    with open_pictures(background.file or entry.pictures, entry.frame_rate) as source:
        first, last = background.empty or (0, source.frame_count - 1)
        if background.file is not None and background.empty is None:
            first, last = 0, source.frame_count - 1
        if not 0 <= first <= last < source.frame_count:
            raise InputError(
                f"camera {entry.name!r}: empty",
                expected=f"frames within 0 to {source.frame_count - 1}",
                got=f"{first} to {last}",
            )
        chosen = set(
            np.unique(np.linspace(first, last, min(TRAINING_FRAMES, last - first + 1)).round().astype(int)).tolist()
        )
        pictures = []
        for index, _, image in source.frames(first):
            if index > last:
                break
            if index in chosen:
                pictures.append(reduce_image(image, 1.0 / reduction))
    return pictures
