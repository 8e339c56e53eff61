"""Benchmarks measure what they say: the peer draws the same body, and rows come out. Time itself is not tested."""

from __future__ import annotations

import json
from collections.abc import Iterator

import numpy as np
import pytest

from muybridge.body import Body, Segment
from muybridge.body.model import Shape
from muybridge.cameras import Camera, Rig
from muybridge.cli import app
from muybridge.experiments import machine, speed
from muybridge.experiments.peer import silhouette_costs, tangent_points
from muybridge.likelihood.observation import ImageLikelihood

LOOKING_ALONG_Y = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])


class TestPeer:
    def test_it_costs_what_the_kernel_says(self) -> None:
        """A round cone, seen from 4 m with a focal length of 300: about 300 pixels of outline around 5000 inside. Where
        two renderers differ by up to half a pixel along the outline, areas differ by up to 150 in 5000, 3 %."""
        cone = Shape((0, 0, -0.5), (0, 0, 0.5), (0.2, 0.15))
        body = Body("cone", (Segment("cone", shape=cone),))
        matrix = np.array([[300.0, 0, 119.5], [0, 300.0, 89.5], [0, 0, 1]])
        camera = Camera("a", (240, 180), matrix, np.zeros(5), LOOKING_ALONG_Y, np.array([0, 0, 4.0]))
        mask = np.zeros((180, 240), bool)
        mask[60:150, 100:140] = True
        poses = np.random.default_rng(1).normal(0, 0.1, (20, 3))
        kernel = ImageLikelihood(body, Rig((camera,)), (1,)).observe([mask]).costs(poses)
        peer = silhouette_costs(body, poses, [camera], [mask])
        assert np.abs(kernel - peer).max() < 0.03

    def test_tangents_of_equal_circles_are_parallel(self) -> None:
        corners = tangent_points(np.array([0.0, 0]), np.array([10.0, 0]), 2.0, 2.0)
        np.testing.assert_allclose(corners, [[0, 2], [10, 2], [10, -2], [0, -2]], atol=1e-12)

    def test_tangents_touch_both_circles_at_right_angles(self) -> None:
        first, last, r, s = np.array([1.0, 2.0]), np.array([7.0, -1.0]), 3.0, 1.0
        corners = tangent_points(first, last, r, s)
        assert corners is not None
        for on_first, on_last in (corners[:2], corners[[3, 2]]):
            assert np.hypot(*(on_first - first)) == pytest.approx(r)
            assert (on_last - on_first) @ (on_first - first) == pytest.approx(0, abs=1e-12)
            assert (on_last - on_first) @ (on_last - last) == pytest.approx(0, abs=1e-12)

    def test_a_circle_inside_another_has_none(self) -> None:
        assert tangent_points(np.zeros(2), np.array([0.5, 0]), 3.0, 1.0) is None


def test_the_machine_is_described() -> None:
    described = machine.describe_machine()
    assert described["processor"] and int(described["cores"]) >= 1 and described["muybridge"]


def test_a_median_is_of_the_calls_after_the_first(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = iter([0.0, 5.0, 10.0, 11.0, 20.0, 23.0])
    monkeypatch.setattr(speed.time, "perf_counter", lambda: next(clock))
    calls: list[int] = []
    assert speed.median_seconds(lambda: calls.append(1), 3) == 3.0
    assert len(calls) == 4


class TestCommand:
    def test_rows_reach_the_json_line(self, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture) -> None:
        def one(rng: np.random.Generator) -> Iterator[speed.Measurement]:
            yield speed.Measurement("a draw", float(rng.integers(5, 6)), "us", floor=4, aim=2)

        monkeypatch.setattr(speed, "BENCHMARKS", {"one": one})
        assert app.run(["bench", "one", "--json"]) == 0
        record = json.loads(capfd.readouterr().out.splitlines()[-1])
        assert record["measurements"] == [{"what": "a draw", "value": 5.0, "unit": "us", "floor": 4, "aim": 2}]
        assert record["machine"]["processor"]

    def test_unknown(self, capfd: pytest.CaptureFixture) -> None:
        assert app.run(["bench", "silhuette"]) == 2
        assert "silhouette" in capfd.readouterr().err
