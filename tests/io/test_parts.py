"""parts.csv: round trip, order, and bad files in one line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.io.parts import HEADER, PartSeries, read_parts, write_parts


def parts() -> PartSeries:
    names = np.array(["head", "torso", "head", "torso"])
    return PartSeries(
        np.array([3, 3, 1, 1]), np.array([1, 1, 2, 2]), names, np.arange(16.0).reshape(4, 4), np.arange(4) / 4
    )


def test_round_trip(tmp_path: Path) -> None:
    write_parts(tmp_path / "parts.csv", parts())
    again = read_parts(tmp_path / "parts.csv")
    for name in ("frames", "ids", "names", "boxes", "scores"):
        np.testing.assert_array_equal(getattr(again, name), getattr(parts(), name))
    lines = (tmp_path / "parts.csv").read_text().splitlines()
    assert lines[:2] == [HEADER, "2,2,head,9.00,10.00,10.00,11.00,0.50"]


def test_nobody(tmp_path: Path) -> None:
    empty = PartSeries(*(np.zeros(0, int),) * 2, np.zeros(0, np.str_), np.zeros((0, 4)), np.zeros(0))
    write_parts(tmp_path / "parts.csv", empty)
    assert len(read_parts(tmp_path / "parts.csv")) == 0


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "nothing"),
        ("a,b\n", "frame,id,part"),
        (HEADER + "\n1,2,head\n", "line 2"),
        (HEADER + "\n1,2,head,x,1,1,1,1\n", "numbers"),
    ],
)
def test_bad_files_are_one_line(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "parts.csv").write_text(text)
    with pytest.raises(InputError, match=words):
        read_parts(tmp_path / "parts.csv")
