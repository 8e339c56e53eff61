from __future__ import annotations

import csv
import io

from muybridge.experiments.statistics import Interval
from muybridge.experiments.tables import Column, Table

TABLE = Table(
    "t",
    "A table",
    (Column("what"), Column("error mm"), Column("lost", 0, percent=True)),
    (("a | b", Interval(12.345, 10.0, 14.69, 5), 0.25), ("one", Interval(3.0, float("nan"), float("nan"), 1), 0.0)),
    ("a note",),
)


def test_markdown() -> None:
    lines = TABLE.to_markdown().splitlines()
    assert lines[0] == "### A table"
    assert lines[2] == "| what | error mm | lost |"
    assert lines[4] == r"| a \| b | 12.3 [10.0, 14.7] | 25 % |"
    assert lines[5] == "| one | 3.0 | 0 % |"
    assert lines[-1] == "- a note"


def test_csv_is_unrounded_and_has_a_column_for_each_bound() -> None:
    rows = list(csv.reader(io.StringIO(TABLE.to_csv())))
    assert rows[0] == ["what", "error mm", "error mm low", "error mm high", "lost"]
    assert rows[1] == ["a | b", "12.345", "10.0", "14.69", "0.25"]
    assert rows[2] == ["one", "3.0", "", "", "0.0"]


def test_a_plain_number_beside_intervals_and_nan() -> None:
    table = Table("t", "t", (Column("x", 0),), ((Interval(1.0, 0.0, 2.0, 3),), (float("nan"),)))
    assert table.to_csv().splitlines()[2] == '"",,' or table.to_csv().splitlines()[2] == ",,"
    assert table.to_markdown().splitlines()[5] == "| - |"
