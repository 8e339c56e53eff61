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
    "PictureRange",
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
    frame_rate: float
    size: tuple[int, int]
    timestamps: np.ndarray

    @property
    def damage(self) -> str:
        """What is wrong with the source, in one line; empty where nothing is."""
        ...

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
    path_or_pattern: str | Path,
    frame_rate: float | None = None,
    *,
    colour: bool = True,
    threads: int = 1,
    frames: tuple[int, int] | None = None,
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
    frames : (first, last), optional
        The part to read, both included, see `PictureRange`; all where absent.
    """
    pictures: PictureSource
    if is_image_pattern(path_or_pattern):
        pictures = ImageSequence(path_or_pattern, frame_rate, colour=colour)
    else:
        pictures = VideoReader(path_or_pattern, threads=threads, colour=colour)
    return pictures if frames is None else PictureRange(pictures, *frames)


class PictureRange:
    """Frames `first` to `last` of a source as a source of their own: frame 0, at second 0, is the first of them.

    For cameras that were started one after another: frame k of one range is frame k of the others.
    """

    def __init__(self, pictures: PictureSource, first: int, last: int) -> None:
        if not 0 <= first <= last < pictures.frame_count:
            expected = f"a range within 0 to {pictures.frame_count - 1}"
            raise InputError(f"{pictures.name}: frames", expected=expected, got=f"{first} to {last}")
        self.pictures, self.first, self.last = pictures, first, last
        self.name, self.size, self.frame_rate = pictures.name, pictures.size, pictures.frame_rate
        self.timestamps = pictures.timestamps[first : last + 1] - pictures.timestamps[first]
        self.timestamps.flags.writeable = False

    @property
    def damage(self) -> str:
        """What is wrong with the source; empty where nothing is."""
        return self.pictures.damage

    @property
    def frame_count(self) -> int:
        """Frames in the range."""
        return self.last - self.first + 1

    def __len__(self) -> int:
        return self.frame_count

    def __iter__(self) -> Iterator[tuple[int, float, np.ndarray]]:
        return self.frames()

    def frames(self, start: int = 0) -> Iterator[tuple[int, float, np.ndarray]]:
        """Yield (index, time in seconds, picture) from frame `start` of the range to its end."""
        for index, _, picture in self.pictures.frames(self.first + start) if start < self.frame_count else ():
            if index > self.last:
                return
            yield index - self.first, float(self.timestamps[index - self.first]), picture

    def read(self, index: int) -> np.ndarray:
        """The picture of one frame of the range."""
        if not 0 <= index < self.frame_count:
            raise InputError(f"{self.name}: frame number", expected=f"0 to {self.frame_count - 1}", got=str(index))
        return self.pictures.read(self.first + index)

    def close(self) -> None:
        """Give the files back."""
        self.pictures.close()

    def __enter__(self) -> PictureRange:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


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
    frames: tuple[int, int] | None = None,
) -> MaskSource:
    """Open masks kept as images or as a video, white on black; `frames` as in `open_pictures`."""
    if not 0 <= threshold < 255:
        raise InputError(f"{path_or_pattern}: mask threshold", expected="0 to 254", got=str(threshold))
    pictures = open_pictures(path_or_pattern, frame_rate, colour=False, threads=threads)
    if isinstance(pictures, ImageSequence) and threshold > 0 and pictures.read(0).max() == 1:
        remedy = "give threshold=0 if 1 means foreground"
        raise InputError(f"{path_or_pattern}: masks", expected="values 0 and 255", got="0 and 1", remedy=remedy)
    return MaskSource(pictures if frames is None else PictureRange(pictures, *frames), threshold)
