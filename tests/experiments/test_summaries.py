from __future__ import annotations

import pytest

from experiments.made_results import row
from muybridge.experiments.statistics import Interval
from muybridge.experiments.summaries import coverage_table, difference_table, parts_table, summary_table, verdict

GROUPS = {
    "one": [row("one", seed, error) for seed, error in ((0, 30.0), (1, 110.0), (2, 70.0))],
    "two": [row("two", seed, error) for seed, error in ((0, 20.0), (1, 101.0), (2, 61.0))],
}


def test_summary() -> None:
    table = summary_table("t", "T", GROUPS)
    first = dict(zip((column.name for column in table.columns), table.rows[0], strict=True))
    assert first["condition"] == "one" and first["runs"] == 3 and first["median run mm"] == 70.0
    error = first["error mm"]
    assert isinstance(error, Interval) and error.mean == pytest.approx(70.0) and error.low < 30


def test_differences_are_paired() -> None:
    """10, 9 and 9 mm: mean 9.33 +- 4.303 x 0.577 / sqrt(3) = 1.43."""
    (label, gap, reading), *_ = difference_table("t", "T", GROUPS, "two").rows
    assert label == "one" and isinstance(gap, Interval) and reading == "worse"
    assert gap.mean == pytest.approx(9.333, abs=1e-3) and gap.half_width == pytest.approx(1.434, abs=1e-3)
    assert difference_table("t", "T", GROUPS, "one").rows[0][2] == "better"


def test_parts() -> None:
    first = parts_table("t", "T", GROUPS).rows[0]
    assert [cell.mean for cell in first[1:4]] == pytest.approx([35.0, 70.0, 140.0])  # type: ignore[union-attr]
    assert first[4] == 0.25


def test_verdict() -> None:
    nan = float("nan")
    assert verdict(Interval(1.0, -1.0, 3.0, 3)) == "not told apart"
    assert verdict(Interval(1.0, nan, nan, 1)) == "one seed says nothing"


def test_coverage() -> None:
    table = coverage_table("t", "T", GROUPS)
    assert [round(cell.mean, 6) for cell in table.rows[0][1:4]] == [0.5, 0.8, 0.95]  # type: ignore[union-attr]
    assert table.rows[0][4] == 1.0 and "50 [50, 50] %" in table.to_markdown()
