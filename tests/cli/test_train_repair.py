"""`muybridge train-repair`: a file that `people` takes, or one line and nothing written."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from muybridge.cli import app
from muybridge.people import repair_training
from muybridge.people.failure import load_detector
from people.test_repair_training import examples


@pytest.fixture
def no_scenes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Examples without rendering anybody."""

    def made(seed: int, config: object) -> object:
        return examples(np.random.default_rng(seed))

    monkeypatch.setattr(repair_training, "examples_of_scene", made)


def test_a_trained_file(no_scenes: None, tmp_path: Path, capfd: pytest.CaptureFixture) -> None:
    out = tmp_path / "folder" / "repair.npz"
    assert app.run(["train-repair", "--out", str(out), "--set", "scenes=3", "--seed", "1", "--json"]) == 0
    record = json.loads(capfd.readouterr().out.splitlines()[-1])
    assert [one["name"] for one in record["judged"]] == ["head", "torso", "hip_leg", "several"]
    detector = load_detector(out)
    assert detector.failed(np.zeros(36)).tolist() == [False] * 3
    first = out.read_bytes()
    assert app.run(["train-repair", "--out", str(out), "--set", "scenes=3", "--seed", "1", "--quiet"]) == 0
    again = load_detector(out)
    np.testing.assert_array_equal(again.parts[0].coefficients, detector.parts[0].coefficients)
    assert len(first) > 1000


@pytest.mark.parametrize(
    ("settings", "words"), [("scens=3", "did you mean scenes"), ("held_out=9", "held_out < scenes")]
)
def test_bad_settings(tmp_path: Path, capfd: pytest.CaptureFixture, settings: str, words: str) -> None:
    assert app.run(["train-repair", "--out", str(tmp_path / "x.npz"), "--set", settings]) == 2
    line = capfd.readouterr().err
    assert line.count("\n") == 1 and words in line
    assert not list(tmp_path.iterdir())


def test_people_refuse_a_bad_file(tmp_path: Path, capfd: pytest.CaptureFixture) -> None:
    import cv2

    (tmp_path / "pictures").mkdir()
    cv2.imwrite(str(tmp_path / "pictures" / "0.png"), np.zeros((60, 80, 3), np.uint8))
    (tmp_path / "bad.npz").write_text("nothing")
    arguments = ["people", str(tmp_path / "pictures"), "--frame-rate", "10", "--out", str(tmp_path / "out")]
    assert app.run([*arguments, "--set", f"repair={tmp_path / 'bad.npz'}"]) == 2
    line = capfd.readouterr().err
    assert line.count("\n") == 1 and "bad.npz" in line and "train-repair" in line
    assert not (tmp_path / "out").exists()
