"""Boxes as MOTChallenge's text files have them: frame, id, left, top, width, height, confidence, -1, -1, -1.

Frames and pixels count from 1 in the file, from 0 in `BoxSeries`. Columns beyond the seventh (a place in the world, a
class, a visibility) are not read; in a truth, a confidence of 0 marks what is not to be counted.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from muybridge.errors import InputError
from muybridge.io.boxes import BoxSeries
from muybridge.io.disk import replace_file
from muybridge.io.run_folder import fixed

FEWEST_COLUMNS = 6
DECIMALS = 2


def read_mot(path: str | Path) -> BoxSeries:
    """Read a MOTChallenge file; a file without lines is a video without people."""
    rows = [_row(path, number, line) for number, line in enumerate(_lines(path), start=1) if line.strip()]
    table = np.array(rows, dtype=np.float64).reshape(len(rows), 7)
    try:
        return BoxSeries(table[:, 0].astype(np.int64) - 1, table[:, 1].astype(np.int64), _moved(table[:, 2:6], -1),
                         table[:, 6])  # fmt: skip
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def write_mot(path: str | Path, series: BoxSeries) -> None:
    """Write a whole file, or leave the one that was there untouched."""
    replace_file(path, mot_text(series).encode())


def mot_text(series: BoxSeries) -> str:
    """The lines of a file; files of successive frames may be written one after the other."""
    lines = []
    for frame, identity, box, confidence in zip(series.frames, series.ids, _moved(series.boxes, 1), series.confidence):
        numbers = ",".join(fixed(float(value), DECIMALS) for value in (*box, confidence))
        lines.append(f"{frame + 1},{identity},{numbers},-1,-1,-1\n")
    return "".join(lines)


def _moved(boxes: np.ndarray, by: int) -> np.ndarray:
    return boxes + np.array([by, by, 0, 0])


def _row(path: str | Path, number: int, line: str) -> list[float]:
    """Seven numbers of a line; the seventh is 1 where the line has no more than six."""
    what = f"{path}, line {number}"
    cells = line.replace(",", " ").split()
    try:
        row = [float(cell) for cell in cells[:7]]
    except ValueError:
        raise InputError(what, expected="numbers with commas between", got=line.strip()[:60]) from None
    if len(row) < FEWEST_COLUMNS or not all(map(math.isfinite, row)):
        raise InputError(what, expected="frame,id,left,top,width,height,...", got=line.strip()[:60])
    row += [1.0] * (7 - len(row))
    if row[0] < 1 or row[0] != int(row[0]) or row[1] != int(row[1]) or abs(row[1]) > 2**53:
        raise InputError(what, expected="whole numbers: a frame from 1, an identity", got=f"{cells[0]} and {cells[1]}")
    return row


def _lines(path: str | Path) -> list[str]:
    try:
        return Path(path).read_bytes().decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise InputError(str(path), expected="a MOTChallenge text file", got="bytes that are no text") from None
    except OSError as error:
        raise InputError(str(path), expected="a MOTChallenge text file", got=error.strerror or str(error)) from None
