"""Benchmarks say what they measured, and where. Time itself is not tested."""

from __future__ import annotations

import json
from collections.abc import Iterator

import numpy as np
import pytest

from muybridge.cli import app
from muybridge.experiments import machine, speed
from muybridge.synthetic.benchmark import RenderTiming


def test_the_machine_is_described() -> None:
    described = machine.describe_machine()
    assert described["processor"] and int(described["cores"]) >= 1 and described["muybridge"]


def test_a_median_is_of_the_calls_after_the_first(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = iter([0.0, 5.0, 10.0, 11.0, 20.0, 23.0])
    monkeypatch.setattr(speed.time, "perf_counter", lambda: next(clock))
    calls: list[int] = []
    assert speed.median_seconds(lambda: calls.append(1), 3) == 3.0
    assert len(calls) == 4


def test_rendering_is_held_to_its_floor(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(speed, "time_rendering", lambda: [RenderTiming("draw a person", 33.0)])
    (row,) = speed.BENCHMARKS["render"](np.random.default_rng(0))
    assert (row.value, row.unit, row.floor, row.aim) == (33.0, "frames/s", 20.0, None)


class TestCommand:
    def test_rows_reach_the_json_line(self, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture) -> None:
        def one(rng: np.random.Generator) -> Iterator[speed.Measurement]:
            yield speed.Measurement("a draw", float(rng.integers(5, 6)), "us", floor=4, aim=2)

        monkeypatch.setattr(speed, "BENCHMARKS", {"one": one})
        assert app.run(["bench", "one", "--json"]) == 0
        record = json.loads(capfd.readouterr().out.splitlines()[-1])
        assert record["measurements"] == [{"what": "a draw", "value": 5.0, "unit": "us", "floor": 4, "aim": 2}]
        assert record["machine"]["processor"]

    def test_only_what_is_wanted_is_said(self, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture) -> None:
        def three(rng: np.random.Generator) -> Iterator[speed.Measurement]:
            yield speed.Measurement("both", 1.0, "us", floor=4, aim=2)
            yield speed.Measurement("floor", 1.0, "us", floor=4)
            yield speed.Measurement("none", 1.0, "us")

        monkeypatch.setattr(speed, "BENCHMARKS", {"three": three})
        assert app.run(["bench", "three"]) == 0
        lines = capfd.readouterr().out.splitlines()
        ends = [line.split(" us")[1].strip() for line in lines if " us" in line]
        assert ends == ["(at least 4, aim 2)", "(at least 4)", ""]

    def test_unknown(self, capfd: pytest.CaptureFixture) -> None:
        assert app.run(["bench", "likelyhood"]) == 2
        assert "likelihood or" in capfd.readouterr().err
