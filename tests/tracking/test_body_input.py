"""A job's body: by name, file and height, then with single lengths as measured."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from muybridge.body import Body, catalogue, named_body, write_body
from muybridge.errors import InputError
from muybridge.io.job import BodyInput
from muybridge.tracking.body_input import body_from, own_lengths, with_measures


def span(body: Body, first: str, second: str) -> float:
    joints = dict(zip(body.joint_names, body.joints(np.zeros(len(body.dof_names))), strict=True))
    return float(np.linalg.norm(joints[first] - joints[second]))


@pytest.mark.parametrize("name", catalogue())
class TestEveryBody:
    def test_its_own_lengths_change_nothing(self, name: str) -> None:
        body = named_body(name)
        same = with_measures(body, own_lengths(body))
        np.testing.assert_array_equal(same.arrays.fixed, body.arrays.fixed)
        np.testing.assert_array_equal(same.arrays.half_axes, body.arrays.half_axes)

    def test_every_length_can_be_measured(self, name: str) -> None:
        body = named_body(name)
        lengths = own_lengths(body)
        assert set(lengths) == set(body.length_groups)
        for group, length in lengths.items():
            longer = own_lengths(with_measures(body, {group: 1.1 * length}))
            assert longer == pytest.approx(lengths | {group: 1.1 * length}, abs=1e-12)

    def test_height_and_measures_go_together(self, name: str) -> None:
        body = named_body(name, 1.3 * named_body(name).height)
        assert own_lengths(body) == pytest.approx({k: 1.3 * v for k, v in own_lengths(named_body(name)).items()})


def test_a_measure_of_one_side_counts_for_both() -> None:
    body = with_measures(named_body("person"), {"left_thigh": 0.5})
    assert span(body, "left_hip", "left_knee") == span(body, "right_hip", "right_knee") == pytest.approx(0.5)
    assert span(body, "left_knee", "left_ankle") == pytest.approx(0.425)


@pytest.mark.parametrize(
    ("measures", "message"),
    [
        ({"tail": 0.3}, "^body measure 'tail': expected one of pelvis, torso"),
        ({"thigh": "long"}, "^body measure 'thigh': expected metres, got 'long'"),
        ({"thigh": 0}, "^body measure 'thigh': expected metres, got 0"),
        ({"thigh": 425}, "^body measure 'thigh': expected metres, got 425"),
        ({"thigh": float("nan")}, "^body measure 'thigh': expected metres, got nan"),
    ],
)
def test_measures_that_cannot_be(measures: dict, message: str) -> None:
    with pytest.raises(InputError, match=message) as error:
        with_measures(named_body("person"), measures)
    assert "\n" not in str(error.value)


def test_a_jobs_body(tmp_path: Path) -> None:
    assert body_from(BodyInput()) == named_body("person")
    assert body_from(BodyInput(name="dog", height_m=0.6)) == named_body("dog", 0.6)
    write_body(tmp_path / "mine.toml", named_body("du-2005", 1.6))
    assert body_from(BodyInput(file=tmp_path / "mine.toml")) == named_body("du-2005", 1.6)
    (tmp_path / "measures.toml").write_text("upper_leg = 0.4\n")
    body = body_from(BodyInput(name="sedai-2013", measures=tmp_path / "measures.toml"))
    assert span(body, "left_hip", "left_knee") == pytest.approx(0.4)
    with pytest.raises(InputError, match="body measures .*: expected a TOML file of lengths in metres"):
        body_from(BodyInput(measures=tmp_path / "none.toml"))
