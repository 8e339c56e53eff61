"""MOTChallenge's files: what is read, what is written, what is refused in one line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from conftest import shared_data
from muybridge.errors import InputError
from muybridge.io.boxes import BoxSeries, read_boxes
from muybridge.io.mot import read_mot, write_mot


def series() -> BoxSeries:
    return BoxSeries(
        np.array([4, 0, 0]), np.array([2, 7, 3]), np.array([[1.5, 2, 3, 4], [0, 0, 10, 20], [5, 6, 7.25, 8]]),
        np.array([0.5, 1, -1]),
    )  # fmt: skip


def test_round_trip(tmp_path: Path) -> None:
    write_mot(tmp_path / "tracks.txt", series())
    again = read_boxes(tmp_path / "tracks.txt")
    for name in ("frames", "ids", "boxes", "confidence"):
        np.testing.assert_array_equal(getattr(again, name), getattr(series(), name))
    lines = (tmp_path / "tracks.txt").read_text().splitlines()
    assert lines[0] == "1,3,6.00,7.00,7.25,8.00,-1.00,-1,-1,-1"  # frames and pixels from 1, in order


def test_what_other_tools_write_is_read(tmp_path: Path) -> None:
    """Six columns, blanks, a byte order mark, numbers written as reals, MOT16's nine columns, no last line end."""
    (tmp_path / "a.txt").write_bytes(b"\xef\xbb\xbf1.0, 2, 1, 1, 5, 6\n\n2,2,3,4,5,6,0,1,0.25")
    read = read_mot(tmp_path / "a.txt")
    assert read.frames.tolist() == [0, 1] and read.confidence.tolist() == [1, 0]
    assert read.boxes.tolist() == [[0, 0, 5, 6], [2, 3, 5, 6]]
    (tmp_path / "empty.txt").write_text("")
    assert len(read_mot(tmp_path / "empty.txt")) == 0


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("1,2,3,4\n", "line 1"),
        ("1,2,3,4,5,6\n1,x,3,4,5,6\n", "line 2"),
        ("0,2,3,4,5,6\n", "a frame from 1"),
        ("1.5,2,3,4,5,6\n", "a frame from 1"),
        ("1,2,3,nan,5,6\n", "line 1"),
        ("1,2,3,4,-5,6\n", "not below 0"),
        ("1,2,3,4,5,6\n1,2,3,4,5,7\n", "identity 2 twice"),
        ("frame,id\n", "line 1"),
        ("1,1e300,3,4,5,6\n", "identity"),
    ],
)
def test_bad_files_are_one_line(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "bad.txt").write_text(text)
    with pytest.raises(InputError, match=words) as caught:
        read_mot(tmp_path / "bad.txt")
    assert "bad.txt" in str(caught.value) and "\n" not in str(caught.value)


def test_no_text_and_no_file(tmp_path: Path) -> None:
    (tmp_path / "picture.txt").write_bytes(bytes(range(256)))
    with pytest.raises(InputError, match="no text"):
        read_mot(tmp_path / "picture.txt")
    with pytest.raises(InputError, match="none.txt"):
        read_mot(tmp_path / "none.txt")


def test_real_files() -> None:
    """TUD-Campus has 71 frames with 359 boxes of 8 people; counted with other means (wc, sort -u)."""
    truth = read_mot(shared_data("motmetrics_tud") / "TUD-Campus" / "gt.txt")
    assert (len(truth), len(set(truth.ids)), truth.frames.max()) == (359, 8, 70)
    assert truth.boxes[0].tolist() == [398, 181, 121, 229]


def test_series_are_checked_and_cut() -> None:
    assert series().between(1, 9).ids.tolist() == [2]
    assert series().where(series().confidence > 0).ids.tolist() == [7, 2]
    with pytest.raises(InputError, match="boxes"):
        BoxSeries(np.array([0]), np.array([1]), np.zeros((1, 3)), np.ones(1))
    with pytest.raises(InputError, match="from 0"):
        BoxSeries(np.array([-1]), np.array([1]), np.zeros((1, 4)), np.ones(1))
    with pytest.raises(ValueError, match="read-only"):
        series().boxes[0, 0] = 3
