"""Boxes as CAVIAR's ground truth has them: CVML, an XML of frames, objects and boxes about a centre.

    <dataset><frame number="0"><objectlist><object id="9"><box h="75" w="31" xc="515" yc="195"/></object>...

The annotations of PETS 2009 S2.L1 by Milan are of this kind too. Frames and pixels count from 0. Groups of people, and
what CAVIAR says of roles and movement, are not read. The file is read element by element; a document type is refused,
since entities may expand without bound.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any
from xml.parsers import expat

import numpy as np

from muybridge.errors import InputError
from muybridge.io.boxes import BoxSeries

BOX_KEYS = ("xc", "yc", "w", "h")


def read_caviar(path: str | Path) -> BoxSeries:
    """Read a CVML file; every object that has a box counts, with confidence 1."""
    reader = _Reader(str(path))
    try:
        with open(path, "rb") as file:
            reader.parser.ParseFile(file)
    except expat.ExpatError as error:
        raise InputError(str(path), expected="XML", got=str(error)) from None
    except OSError as error:
        raise InputError(str(path), expected="a CVML file", got=error.strerror or str(error)) from None
    if reader.frames == 0:
        raise InputError(str(path), expected="CVML with <frame> elements", got=f"none in <{reader.root}>")
    table = np.array(reader.rows, dtype=np.float64).reshape(len(reader.rows), 6)
    boxes = np.column_stack([table[:, 2:4] - table[:, 4:] / 2, table[:, 4:]])
    try:
        return BoxSeries(table[:, 0].astype(np.int64), table[:, 1].astype(np.int64), boxes, np.ones(len(table)))
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


class _Reader:
    """What the parser tells, gathered: a row (frame, id, xc, yc, w, h) for every object's own box."""

    def __init__(self, path: str) -> None:
        self.path, self.root = path, ""
        self.rows: list[tuple[float, ...]] = []
        self.frames = 0
        self._open: list[str] = []
        self._frame = self._id = 0
        self.parser: Any = expat.ParserCreate()
        self.parser.StartDoctypeDeclHandler = self._refuse
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = lambda name: self._open.pop()

    def _refuse(self, *declaration: object) -> None:
        raise InputError(self.path, expected="XML without a document type", got="a DOCTYPE")

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        self.root = self.root or name
        parent = self._open[-1] if self._open else ""
        self._open.append(name)
        if name == "frame":
            self.frames += 1
            self._frame = self._whole(attributes, "number")
        elif name == "object":
            self._id = self._whole(attributes, "id")
        elif name == "box" and parent == "object":
            self.rows.append((self._frame, self._id, *(self._number(attributes, key) for key in BOX_KEYS)))

    def _number(self, attributes: dict[str, str], key: str) -> float:
        text = attributes.get(key, "")
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            what = f"{self.path}, line {self.parser.CurrentLineNumber}"
            raise InputError(what, expected=f"a number for {key}", got=repr(text) if text else "none")
        return value

    def _whole(self, attributes: dict[str, str], key: str) -> int:
        value = self._number(attributes, key)
        if value != int(value) or abs(value) > 2**53:
            what = f"{self.path}, line {self.parser.CurrentLineNumber}"
            raise InputError(what, expected=f"a whole number for {key}", got=attributes[key])
        return int(value)
