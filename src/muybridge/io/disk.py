"""Writing files so that a reader never finds half of one, and a full disk is one clear line."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from muybridge.errors import InputError

_REMEDIES = {
    errno.ENOSPC: "free some space or choose another --out",
    errno.EDQUOT: "free some space or choose another --out",
    errno.EACCES: "choose a folder that may be written",
    errno.EPERM: "choose a folder that may be written",
    errno.EROFS: "choose a folder that may be written",
}


@contextmanager
def disk_errors(path: str | Path) -> Iterator[None]:
    """Turn an operating system's refusal to write `path` into an `InputError` of one line."""
    try:
        yield
    except OSError as error:
        if error.errno is None:  # not from the operating system
            raise
        remedy = _REMEDIES.get(error.errno, "")
        raise InputError(str(path), expected="room to write", got=os.strerror(error.errno), remedy=remedy) from error


def make_folder(path: str | Path) -> Path:
    """Create a folder and its parents; one that is there already is fine."""
    folder = Path(path)
    with disk_errors(folder):
        folder.mkdir(parents=True, exist_ok=True)
    return folder


def temporary_name(path: Path) -> Path:
    """A name beside `path`, on the same disk so that it can be renamed, with the same suffix so that tools know it.

    Examples
    --------
    >>> temporary_name(Path("run/overlay.mp4")).as_posix()
    'run/overlay.unfinished.mp4'
    """
    return path.with_name(f"{path.stem}.unfinished{path.suffix}")


def replace_file(path: str | Path, data: bytes) -> None:
    """Write a whole file, or leave the one that was there untouched."""
    target = Path(path)
    unfinished = temporary_name(target)
    try:
        with disk_errors(target):
            with open(unfinished, "wb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            os.replace(unfinished, target)
    except BaseException:
        unfinished.unlink(missing_ok=True)
        raise


def sync_folder(folder: Path) -> None:
    """Make a new or renamed file's entry in its folder survive a power cut; not every system can, or needs to."""
    try:
        descriptor = os.open(folder, os.O_RDONLY)
    except OSError:
        return
    try:
        os.fsync(descriptor)
    except OSError:
        pass
    finally:
        os.close(descriptor)
