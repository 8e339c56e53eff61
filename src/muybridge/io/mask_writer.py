"""Masks as files: a folder of PNGs, or a video that browsers play. A reader never finds half of either.

Both grow under a name with `.unfinished` and take their own when they are whole. What an interrupt leaves can be
looked at under that name; what bad input leaves is removed.
"""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path

import numpy as np

from muybridge.errors import InputError
from muybridge.io.disk import disk_errors, make_folder, temporary_name
from muybridge.io.video_writer import VideoWriter

MASK_QUALITY = 18
"""x264's constant rate factor: 0 and 255 stay far on either side of `video.MASK_THRESHOLD`."""
_OURS = re.compile(r"\d{6,}\.png")


class MaskFolder:
    """Write masks into a folder, `000000.png` and on; an earlier folder of such masks is replaced.

    Parameters
    ----------
    folder : str or Path

    Examples
    --------
    >>> with MaskFolder("run/masks") as masks:  # doctest: +SKIP
    ...     masks.write(mask)
    """

    def __init__(self, folder: str | Path) -> None:
        self.path = Path(folder)
        self.unfinished = temporary_name(self.path)
        self.frame_count = 0
        _check_replaceable(self.path)
        make_folder(self.path.parent)
        with disk_errors(self.path):
            shutil.rmtree(self.unfinished, ignore_errors=True)
            self.unfinished.mkdir()

    def write(self, mask: np.ndarray) -> None:
        """Append one mask (H, W) bool, white on black."""
        import cv2

        _, data = cv2.imencode(".png", mask.view(np.uint8) * np.uint8(255))
        with disk_errors(self.path):
            (self.unfinished / f"{self.frame_count:06d}.png").write_bytes(data.tobytes())
        self.frame_count += 1

    def close(self) -> None:
        """Give the folder its name."""
        with disk_errors(self.path):
            if self.path.exists():
                shutil.rmtree(self.path)
            os.replace(self.unfinished, self.path)

    def __enter__(self) -> MaskFolder:
        return self

    def __exit__(self, kind: type[BaseException] | None, *rest: object) -> None:
        if kind is None:
            self.close()
        elif issubclass(kind, InputError):
            shutil.rmtree(self.unfinished, ignore_errors=True)


class MaskVideo(VideoWriter):
    """Write masks (H, W) bool as a video, white on black."""

    def __init__(self, path: str | Path, frame_rate: float) -> None:
        super().__init__(path, frame_rate, quality=MASK_QUALITY)

    def __exit__(self, kind: type[BaseException] | None, *rest: object) -> None:
        super().__exit__(kind, *rest)
        if kind is not None and issubclass(kind, InputError):
            self.unfinished.unlink(missing_ok=True)


def _check_replaceable(folder: Path) -> None:
    """Raise where a folder holds something that is no mask of ours."""
    if folder.is_dir():
        other = next((entry.name for entry in folder.iterdir() if not _OURS.fullmatch(entry.name)), None)
        if other is not None:
            raise InputError(str(folder), expected="a new or empty folder, or an earlier one of masks",
                             got=f"{other} in it", remedy="choose another --out")  # fmt: skip
    elif folder.exists():
        raise InputError(str(folder), expected="a folder, or a new name", got="a file", remedy="choose another --out")
