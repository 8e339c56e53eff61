"""Numbered pictures as a camera: `CAM1/image%04d.bmp`, `CAM1/*.png`, or a folder that holds nothing but pictures."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from muybridge.errors import InputError

DEFAULT_FRAME_RATE = 25.0
"""Frames per second where nobody says otherwise; pictures carry no times."""
IMAGE_SUFFIXES = frozenset({".bmp", ".png", ".jpg", ".jpeg", ".pgm", ".ppm", ".tif", ".tiff", ".webp"})
_PRINTF = re.compile(r"%(0?)(\d*)d")


class ImageSequence:
    """Pictures in files, one a frame; the same interface as `VideoReader`.

    Parameters
    ----------
    pattern : str or Path
        With one `%d` or `%04d`, in the order of its numbers, which may start anywhere but have no gaps; or a glob, in
        natural order (image2 before image10); or a folder.
    frame_rate : float, optional
        Frames per second; `DEFAULT_FRAME_RATE` where not given, and then `frame_rate_is_assumed`.
    colour : bool
        True gives (H, W, 3) uint8 BGR, False grey (H, W) uint8; grey files become either.

    Attributes
    ----------
    files : tuple of Path
    timestamps : (T,) float64, seconds, index / frame_rate
    size : (width, height), pixels
    damage : str, always empty: a picture that cannot be read is an error
    """

    damage = ""

    def __init__(self, pattern: str | Path, frame_rate: float | None = None, *, colour: bool = True) -> None:
        if frame_rate is not None and not 0 < frame_rate < float("inf"):
            raise InputError(f"{pattern}: frame rate", expected="a positive number", got=str(frame_rate))
        self.name, self.colour = str(pattern), colour
        self.files = find_images(pattern)
        self.frame_rate_is_assumed = frame_rate is None
        self.frame_rate = DEFAULT_FRAME_RATE if frame_rate is None else float(frame_rate)
        self.timestamps = np.arange(len(self.files)) / self.frame_rate
        self.timestamps.flags.writeable = False
        height, width = read_image(self.files[0], colour).shape[:2]
        self.size = (width, height)

    @property
    def frame_count(self) -> int:
        """Pictures found."""
        return len(self.files)

    def __len__(self) -> int:
        return self.frame_count

    def __iter__(self) -> Iterator[tuple[int, float, np.ndarray]]:
        return self.frames()

    def frames(self, start: int = 0) -> Iterator[tuple[int, float, np.ndarray]]:
        """Yield (index, time in seconds, picture) from frame `start` to the end."""
        for index in range(start, self.frame_count):
            yield index, float(self.timestamps[index]), self.read(index)

    def read(self, index: int) -> np.ndarray:
        """The picture of one frame."""
        if not 0 <= index < self.frame_count:
            raise InputError(f"{self.name}: frame number", expected=f"0 to {self.frame_count - 1}", got=str(index))
        picture = read_image(self.files[index], self.colour)
        if (picture.shape[1], picture.shape[0]) != self.size:
            expected = f"{self.size[0]} x {self.size[1]} pixels as {self.files[0].name}"
            got = f"{picture.shape[1]} x {picture.shape[0]}"
            raise InputError(str(self.files[index]), expected=expected, got=got)
        return picture

    def close(self) -> None:
        """Nothing is held open."""

    def __enter__(self) -> ImageSequence:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


def read_image(path: str | Path, colour: bool = True) -> np.ndarray:
    """Read one picture: (H, W, 3) uint8 BGR, or grey (H, W) uint8."""
    import cv2

    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise InputError(str(path), expected="a picture", got=error.strerror or str(error)) from error
    flag = cv2.IMREAD_COLOR if colour else cv2.IMREAD_GRAYSCALE
    try:
        picture = cv2.imdecode(np.frombuffer(data, np.uint8), flag) if data else None
    except cv2.error:
        picture = None
    if picture is None:
        got = "an empty file" if not data else "data that cannot be decoded"
        raise InputError(str(path), expected="a picture", got=got, remedy="is the file whole?")
    return picture


def is_image_pattern(path: str | Path) -> bool:
    """Whether this names pictures (a pattern, a folder, one picture) rather than a video."""
    text = str(path)
    if Path(text).is_file():
        return Path(text).suffix.lower() in IMAGE_SUFFIXES
    return bool(_PRINTF.search(text)) or any(sign in text for sign in "*?[") or Path(text).is_dir()


def find_images(pattern: str | Path) -> tuple[Path, ...]:
    """The files that a pattern names, in order.

    Raises
    ------
    InputError
        Where there are none, or where the numbers of a printf pattern have a gap.
    """
    path = Path(pattern)
    if path.is_file():
        return (path,)
    if path.is_dir():
        files = sorted((p for p in path.iterdir() if p.suffix.lower() in IMAGE_SUFFIXES), key=_natural_order)
    elif _PRINTF.search(path.name):
        files = _numbered(path)
    else:
        files = sorted((p for p in path.parent.glob(path.name) if p.is_file()), key=_natural_order)
    if not files:
        where = "no such folder" if not (path.is_dir() or path.parent.is_dir()) else "no file that fits"
        raise InputError(str(pattern), expected="pictures", got=where)
    return tuple(files)


def _natural_order(path: Path) -> list:
    """Digits compare as numbers, so that image2 comes before image10."""
    return [(1, int(part), "") if part.isdigit() else (0, 0, part) for part in re.split(r"(\d+)", path.name) if part]


def _numbered(pattern: Path) -> list[Path]:
    """Files whose name fits a printf pattern, in the order of their numbers, without a gap."""
    field = _PRINTF.search(pattern.name)
    assert field is not None
    width = int(field[2] or 0)
    digits = rf"(\d{{{width},}})" if field[1] else r"(\d+)"
    name = re.compile(re.escape(pattern.name[: field.start()]) + digits + re.escape(pattern.name[field.end() :]))
    if not pattern.parent.is_dir():
        return []
    found = {int(match[1]): path for path in pattern.parent.iterdir() if (match := name.fullmatch(path.name))}
    numbers = sorted(found)
    for before, number in zip(numbers, numbers[1:], strict=False):
        if number != before + 1:
            expected = f"a picture for every number from {numbers[0]} to {numbers[-1]}"
            remedy = "name them by a glob such as *.png to take them as they are"
            raise InputError(str(pattern), expected=expected, got=f"none numbered {before + 1}", remedy=remedy)
    return [found[number] for number in numbers]
