"""parts.csv: boxes of people's parts: frame, id, part, left, top, width, height, score.

Frames, identities and pixels are those of the tracks.txt beside it: frames and pixels count from 1 in the file, from 0
in `PartSeries`.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.io.disk import replace_file
from muybridge.io.run_folder import fixed

HEADER = "frame,id,part,left,top,width,height,score"
DECIMALS = 2


@dataclass(frozen=True, eq=False)
class PartSeries:
    """Parts in the order of frames, identities and, within a person, as given.

    Attributes
    ----------
    frames, ids : (M,) int64, frames from 0
    names : (M,) str
    boxes : (M, 4) float64, pixels
        Left, top, width, height; pixel i reaches from i to i + 1.
    scores : (M,) float64
        How well the colours fit, 0..1.
    """

    frames: NDArray[np.int64]
    ids: NDArray[np.int64]
    names: NDArray[np.str_]
    boxes: NDArray[np.float64]
    scores: NDArray[np.float64]

    def __post_init__(self) -> None:
        count = len(self.frames)
        shapes = [np.shape(column) for column in (self.ids, self.names, self.scores)]
        if shapes != [(count,)] * 3 or np.shape(self.boxes) != (count, 4):
            raise InputError("parts", expected="(M,) columns and (M, 4) boxes", got=f"{shapes}, {np.shape(self.boxes)}")
        order = np.lexsort((np.arange(count), self.ids, self.frames))
        for name in ("frames", "ids", "names", "boxes", "scores"):
            column = np.asarray(getattr(self, name))[order]
            column.flags.writeable = False
            object.__setattr__(self, name, column)

    def __len__(self) -> int:
        return len(self.frames)

    def scaled(self, factor: float) -> PartSeries:
        """In the pixels of pictures `factor` times as large."""
        return PartSeries(self.frames, self.ids, self.names, factor * self.boxes, self.scores)


def write_parts(path: str | Path, parts: PartSeries) -> None:
    """Write a whole parts.csv, or leave the one that was there untouched."""
    replace_file(path, f"{HEADER}\n{parts_text(parts)}".encode())


def parts_text(parts: PartSeries) -> str:
    """The lines below the header; those of successive frames may be written one after the other."""
    lines = []
    moved = parts.boxes + np.array([1, 1, 0, 0])
    for frame, identity, name, box, score in zip(parts.frames, parts.ids, parts.names, moved, parts.scores):
        numbers = ",".join(fixed(float(value), DECIMALS) for value in (*box, score))
        lines.append(f"{frame + 1},{identity},{name},{numbers}\n")
    return "".join(lines)


def read_parts(path: str | Path) -> PartSeries:
    """Read a parts.csv."""
    try:
        lines = Path(path).read_text(encoding="utf-8").splitlines()
    except UnicodeDecodeError:
        raise InputError(str(path), expected=HEADER, got="bytes that are no text") from None
    except OSError as error:
        raise InputError(str(path), expected="a file", got=error.strerror or str(error)) from None
    if not lines or lines[0] != HEADER:
        raise InputError(str(path), expected=HEADER, got=lines[0][:80] if lines else "nothing")
    rows = [line.split(",") for line in lines[1:]]
    for number, row in enumerate(rows, start=2):
        if len(row) != HEADER.count(",") + 1:
            raise InputError(f"{path}, line {number}", expected=HEADER, got=",".join(row)[:80])
    try:
        numbers = np.array([row[:2] + row[3:] for row in rows], dtype=object).astype(np.float64).reshape(-1, 7)
    except ValueError as error:
        raise InputError(str(path), expected="numbers", got=str(error)) from None
    return PartSeries(
        numbers[:, 0].astype(np.int64) - 1, numbers[:, 1].astype(np.int64), np.array([row[2] for row in rows], np.str_),
        numbers[:, 2:6] - np.array([1, 1, 0, 0]), numbers[:, 6],
    )  # fmt: skip
