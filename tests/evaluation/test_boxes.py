"""Scores of boxes: cases worked out by hand, and two real sequences with published scores."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from conftest import shared_data
from muybridge.errors import InputError
from muybridge.evaluation.boxes import overlaps, score_boxes
from muybridge.io.boxes import BoxSeries
from muybridge.io.mot import read_mot


def series(rows: list[tuple[int, int, float]], confidence: float = 1.0) -> BoxSeries:
    """(frame, identity, left): boxes of 10 x 20 pixels."""
    boxes = np.array([[left, 0, 10, 20] for _, _, left in rows], float).reshape(-1, 4)
    frames, ids = np.array([row[0] for row in rows], int), np.array([row[1] for row in rows], int)
    return BoxSeries(frames, ids, boxes, np.full(len(rows), confidence))


@pytest.fixture
def needs_scorer() -> None:
    pytest.importorskip("trackeval", reason="the scorer trackeval is not installed")


def test_overlaps_by_hand() -> None:
    boxes = np.array([[0, 0, 10, 10], [0, 0, 0, 0]], float)
    others = np.array([[0, 0, 10, 10], [5, 0, 10, 10], [20, 0, 5, 5], [2, 2, 5, 5]], float)
    np.testing.assert_allclose(overlaps(boxes, others), [[1, 50 / 150, 0, 25 / 100], [0, 0, 0, 0]])
    assert overlaps(np.zeros((0, 4)), others).shape == (0, 4)


@pytest.mark.usefixtures("needs_scorer")
def test_perfect_and_shifted() -> None:
    truth = series([(frame, i, 30.0 * i + frame) for frame in range(10) for i in range(3)])
    perfect = score_boxes(truth, truth)
    assert (perfect.hota, perfect.mota, perfect.idf1, perfect.switches) == (1, 1, 1, 0)
    away = score_boxes(series([(frame, 0, 500.0) for frame in range(10)]), truth)
    assert away.mota == pytest.approx(1 - (30 + 10) / 30)
    assert (away.idf1, away.misses, away.false_alarms) == (0, 30, 10)


@pytest.mark.usefixtures("needs_scorer")
def test_an_identity_that_changes_half_way() -> None:
    """One person, ten frames, identity 1 then 2: MOTA loses one switch of ten boxes; IDF1 keeps one half,
    2 x 5 / (10 + 10); HOTA is sqrt(DetA AssA) with DetA 1 and AssA 5 / 10.
    """
    truth = series([(frame, 0, 0.0) for frame in range(10)])
    scores = score_boxes(series([(frame, 1 + frame // 5, 0.0) for frame in range(10)]), truth)
    assert scores.mota == pytest.approx(0.9) and scores.idf1 == pytest.approx(0.5) and scores.switches == 1
    assert scores.hota == pytest.approx(np.sqrt(0.5)) and scores.association == pytest.approx(0.5)


@pytest.mark.usefixtures("needs_scorer")
def test_truth_that_is_not_to_be_counted() -> None:
    truth, ignored = series([(0, 0, 0.0)]), series([(0, 1, 50.0)], confidence=0.0)
    both = BoxSeries(
        *(np.concatenate([getattr(s, n) for s in (truth, ignored)]) for n in ("frames", "ids", "boxes", "confidence"))
    )
    assert score_boxes(truth, both).mota == 1
    with pytest.raises(InputError, match="truth"):
        score_boxes(truth, ignored)


@pytest.mark.usefixtures("needs_scorer")
def test_nothing_was_found() -> None:
    truth = series([(0, 0, 0.0)])
    scores = score_boxes(series([]), truth)
    assert scores.misses == 1 and scores.hota == 0 and "HOTA" in scores.to_table() and scores.to_dict()["people"] == 1


@pytest.mark.usefixtures("needs_scorer")
@pytest.mark.parametrize(
    ("name", "mota", "idf1", "overlap", "counts"),
    [
        # As published with these files by py-motmetrics: IDF1, MOTA, 1 - MOTP, FP, FN, IDs, FM.
        ("TUD-Campus", 0.526, 0.558, 0.723, (13, 150, 7, 7)),
        ("TUD-Stadtmitte", 0.564, 0.645, 0.655, (45, 452, 7, 6)),
    ],
)
def test_published_scores(name: str, mota: float, idf1: float, overlap: float, counts: tuple[int, ...]) -> None:
    folder = shared_data("motmetrics_tud") / name
    scores = score_boxes(read_mot(folder / "test.txt"), read_mot(folder / "gt.txt"))
    assert (scores.mota, scores.idf1) == pytest.approx((mota, idf1), abs=5e-4)
    assert scores.overlap == pytest.approx(overlap, abs=1e-3)
    assert (scores.false_alarms, scores.misses, scores.switches, scores.fragments) == counts


def test_without_the_scorer_there_is_a_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "trackeval", None)
    with pytest.raises(InputError, match="pip install"):
        score_boxes(series([(0, 0, 0.0)]), series([(0, 0, 0.0)]))
