"""A camera's pictures, wherever they are: a video file or numbered images, and the masks that belong to them.

Examples
--------
>>> from muybridge.io.video import open_pictures
>>> with open_pictures("CAM1/image%04d.bmp", frame_rate=60) as pictures:  # doctest: +SKIP
...     for index, time_s, image in pictures:
...         ...
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np

from muybridge.errors import InputError
from muybridge.io.image_sequence import DEFAULT_FRAME_RATE, ImageSequence, is_image_pattern, read_image
from muybridge.io.video_reader import VideoReader

__all__ = [
    "DEFAULT_FRAME_RATE",
    "MASK_THRESHOLD",
    "ImageSequence",
    "MaskSource",
    "PictureSource",
    "VideoReader",
    "open_masks",
    "open_pictures",
    "read_image",
]

MASK_THRESHOLD = 127
"""A mask's foreground is brighter than this; lossy video keeps 0 and 255 far on either side."""


@runtime_checkable
class PictureSource(Protocol):
    """What every reader of pictures offers. Pictures are (H, W, 3) uint8 BGR, grey (H, W), or masks (H, W) bool."""

    name: str
    damage: str
    frame_rate: float
    size: tuple[int, int]
    timestamps: np.ndarray

    @property
    def frame_count(self) -> int:
        """Frames that can be read."""
        ...

    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[tuple[int, float, np.ndarray]]: ...

    def frames(self, start: int = 0) -> Iterator[tuple[int, float, np.ndarray]]:
        """Yield (index, time in seconds, picture) from frame `start` to the end."""
        ...

    def read(self, index: int) -> np.ndarray:
        """The picture of one frame."""
        ...

    def close(self) -> None:
        """Give the files back."""
        ...

    def __enter__(self) -> PictureSource: ...
    def __exit__(self, *exc: object) -> None: ...


def open_pictures(
    path_or_pattern: str | Path, frame_rate: float | None = None, *, colour: bool = True, threads: int = 1
) -> PictureSource:
    """Open a video file, an image pattern (`image%04d.bmp`, `*.png`), a folder of images or one image.

    Parameters
    ----------
    path_or_pattern : str or Path
    frame_rate : float, optional
        Frames per second, for images only: a video knows its times.
    colour : bool
        True gives (H, W, 3) uint8 BGR, False grey (H, W) uint8.
    threads : int
        Decoder threads for a video; 0 lets FFmpeg choose.
    """
    if is_image_pattern(path_or_pattern):
        return ImageSequence(path_or_pattern, frame_rate, colour=colour)
    return VideoReader(path_or_pattern, threads=threads, colour=colour)


class MaskSource:
    """Masks (H, W) bool of a picture source: foreground where grey > threshold. The same interface."""

    def __init__(self, pictures: PictureSource, threshold: int = MASK_THRESHOLD) -> None:
        self.pictures, self.threshold = pictures, threshold
        self.name, self.size = pictures.name, pictures.size
        self.frame_rate, self.timestamps = pictures.frame_rate, pictures.timestamps

    @property
    def damage(self) -> str:
        """What is wrong with the pictures they come from; empty where nothing is."""
        return self.pictures.damage

    @property
    def frame_count(self) -> int:
        """Frames that can be read."""
        return self.pictures.frame_count

    def __len__(self) -> int:
        return self.frame_count

    def __iter__(self) -> Iterator[tuple[int, float, np.ndarray]]:
        return self.frames()

    def frames(self, start: int = 0) -> Iterator[tuple[int, float, np.ndarray]]:
        """Yield (index, time in seconds, mask) from frame `start` to the end."""
        for index, time_s, grey in self.pictures.frames(start):
            yield index, time_s, grey > self.threshold

    def read(self, index: int) -> np.ndarray:
        """The mask of one frame, (H, W) bool."""
        return self.pictures.read(index) > self.threshold

    def close(self) -> None:
        """Give the files back."""
        self.pictures.close()

    def __enter__(self) -> MaskSource:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


def open_masks(
    path_or_pattern: str | Path,
    frame_rate: float | None = None,
    *,
    threshold: int = MASK_THRESHOLD,
    threads: int = 1,
) -> MaskSource:
    """Open masks kept as images or as a video, white on black."""
    if not 0 <= threshold < 255:
        raise InputError(f"{path_or_pattern}: mask threshold", expected="0 to 254", got=str(threshold))
    pictures = open_pictures(path_or_pattern, frame_rate, colour=False, threads=threads)
    if isinstance(pictures, ImageSequence) and threshold > 0 and pictures.read(0).max() == 1:
        remedy = "give threshold=0 if 1 means foreground"
        raise InputError(f"{path_or_pattern}: masks", expected="values 0 and 255", got="0 and 1", remedy=remedy)
    return MaskSource(pictures, threshold)
