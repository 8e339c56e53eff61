"""The filter's state every few frames, so that an interrupted run goes on to the same bytes.

A zip of arrays with checksums, replaced whole; nothing is pickled.
"""

from __future__ import annotations

import zipfile
import zlib
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from muybridge.errors import InputError
from muybridge.io.disk import disk_errors, replace_file

CHECKPOINT_FILE = "checkpoint.npz"
#: What reading a cut-off or changed zip of arrays raises.
_DAMAGE = (OSError, EOFError, ValueError, KeyError, NotImplementedError, RuntimeError, zipfile.BadZipFile, zlib.error)


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """How many frames are done, and the tracker's state after them as named arrays."""

    frames: int
    arrays: dict[str, np.ndarray]


def write_checkpoint(folder: Path, checkpoint: Checkpoint, digest: str) -> None:
    """Replace the folder's checkpoint in one move."""
    buffer = BytesIO()
    named = np.frombuffer(digest.encode(), np.uint8)
    arrays: dict[str, Any] = {"frames": np.array(checkpoint.frames), "digest": named, **checkpoint.arrays}
    np.savez(buffer, **arrays)
    path = folder / CHECKPOINT_FILE
    with disk_errors(path):
        replace_file(path, buffer.getvalue())


def read_checkpoint(folder: Path, digest: str) -> Checkpoint | None:
    """The folder's checkpoint; None where there is none.

    Raises
    ------
    InputError
        Damaged, or of another job.
    """
    path = folder / CHECKPOINT_FILE
    if not path.is_file():
        return None
    try:
        with np.load(path, allow_pickle=False) as data:
            arrays = {name: data[name] for name in data.files}
            frames = int(arrays.pop("frames"))
    except _DAMAGE as error:
        raise InputError(
            str(path), expected="a checkpoint of this program", got=str(error), remedy="run without --resume"
        ) from error
    if arrays.pop("digest", np.zeros(0, np.uint8)).tobytes().decode(errors="replace") != digest:
        raise InputError(
            str(path),
            expected="a checkpoint of this job",
            got="one of another job or other settings",
            remedy="run without --resume, or into another folder",
        )
    return Checkpoint(frames, arrays)
