"""Tables as people read them (Markdown) and as programs do (CSV): the same rows, numbers rounded only for people."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from muybridge.experiments.statistics import Interval

Cell = str | float | int | Interval


@dataclass(frozen=True)
class Column:
    """A column's heading, and how many decimals its numbers have in Markdown; `percent` shows shares as per cent."""

    name: str
    decimals: int = 1
    percent: bool = False


@dataclass(frozen=True)
class Table:
    """Rows of text, numbers and intervals.

    Parameters
    ----------
    name : the file's, without suffix
    title : a line above it
    columns, rows : as many cells a row as columns
    notes : lines below it
    """

    name: str
    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    notes: tuple[str, ...] = field(default=())

    def to_markdown(self) -> str:
        """The table with its title and notes."""
        lines = [f"### {self.title}", ""]
        lines.append("| " + " | ".join(column.name for column in self.columns) + " |")
        lines.append("|" + "---|" * len(self.columns))
        lines += ["| " + " | ".join(self._shown(row)) + " |" for row in self.rows]
        return "\n".join([*lines, "", *(f"- {note}" for note in self.notes)]).rstrip() + "\n"

    def to_csv(self) -> str:
        """One line a row, unrounded; an interval becomes its mean, low and high."""
        stream = io.StringIO()
        writer = csv.writer(stream, lineterminator="\n")
        wide = [any(isinstance(row[c], Interval) for row in self.rows) for c in range(len(self.columns))]
        names = (([c.name, f"{c.name} low", f"{c.name} high"] if w else [c.name]) for c, w in zip(self.columns, wide))
        writer.writerow([name for group in names for name in group])
        for row in self.rows:
            writer.writerow([value for cell, w in zip(row, wide) for value in _plain(cell, w)])
        return stream.getvalue()

    def _shown(self, row: Sequence[Cell]) -> list[str]:
        return [_text(cell, column) for cell, column in zip(row, self.columns, strict=True)]


def _text(cell: Cell, column: Column) -> str:
    if isinstance(cell, str):
        return cell.replace("|", "\\|")
    factor, unit = (100.0, " %") if column.percent else (1.0, "")
    if isinstance(cell, Interval):
        mean = _number(factor * cell.mean, column.decimals)
        if not math.isfinite(cell.low):
            return mean + unit
        low, high = (_number(factor * bound, column.decimals) for bound in (cell.low, cell.high))
        return f"{mean} [{low}, {high}]{unit}"
    return _number(factor * cell, column.decimals) + unit


def _number(value: float, decimals: int) -> str:
    return f"{value:.{decimals}f}" if math.isfinite(value) else "-"


def _plain(cell: Cell, wide: bool) -> list[object]:
    if isinstance(cell, Interval):
        return [_known(cell.mean), _known(cell.low), _known(cell.high)]
    value = cell if isinstance(cell, str) else _known(cell)
    return [value, "", ""] if wide else [value]


def _known(value: float) -> object:
    return value if math.isfinite(value) else ""
