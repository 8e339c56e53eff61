"""`muybridge experiment`: one clear line for what cannot be, and a whole small experiment."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from muybridge.cli import app
from muybridge.experiments import harness
from muybridge.experiments.experiment import Case, Experiment, Outcome, Part, Report, Scale
from muybridge.experiments.summaries import summary_table
from muybridge.experiments.trial import Clip, Trial
from muybridge.plotting import new_figure


def tiny_cases(scale: Scale) -> Iterator[Case]:
    for seed in range(scale.seeds):
        clip = Clip(frames=2, reduction=8, seed=seed)
        yield Case("tiny", Trial(clip, "condensation", seed=seed).with_settings(particles=10))


def tiny_report(outcome: Outcome) -> Report:
    return Report((summary_table("tiny", "Tiny", outcome.groups()),), {"tiny": new_figure()[0]})


@pytest.fixture
def tiny(monkeypatch: pytest.MonkeyPatch) -> None:
    """An experiment of two short trials in the place of the thesis'."""
    parts = (Part("E1", "tiny", tiny_report, tiny_cases), Part("E2", "nothing", lambda outcome: Report()))
    monkeypatch.setattr(harness, "experiment", lambda name: Experiment("tiny", "Tiny", parts))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["du-2006"], "du-2005"),
        (["du-2005", "--seeds", "0"], "seeds: expected at least 1"),
        (["du-2005", "--workers", "0"], "workers"),
        (["du-2005", "--only", "E1,E9"], "'E9'"),
    ],
)
def test_bad_input_is_one_line(arguments: list[str], words: str, tmp_path: Path, capfd: pytest.CaptureFixture) -> None:
    out = tmp_path / "out"
    assert app.run(["experiment", *arguments, "--out", str(out)]) == 2
    error = capfd.readouterr().err
    assert words in error and len(error.splitlines()) == 1 and not out.exists()


def test_a_folder_of_something_else(tmp_path: Path, capfd: pytest.CaptureFixture) -> None:
    (tmp_path / "thesis.doc").touch()
    assert app.run(["experiment", "du-2005", "--quick", "--out", str(tmp_path)]) == 2
    assert "other files" in capfd.readouterr().err


@pytest.mark.usefixtures("tiny")
def test_from_end_to_end_and_resumed(tmp_path: Path, capfd: pytest.CaptureFixture) -> None:
    arguments = ["experiment", "tiny", "--quick", "--workers", "1", "--out", str(tmp_path / "out"), "--json"]
    assert app.run(arguments) == 0
    record = json.loads(capfd.readouterr().out.splitlines()[-1])
    assert record["trials"] == record["run"] == 2 and record["parts"] == ["E1", "E2"]
    for name in ("results/tiny.csv", "results/tiny.md", "plots/tiny.png", "plots/tiny.svg", "results.md"):
        assert (tmp_path / "out" / name).stat().st_size > 0
    before = (tmp_path / "out" / "results" / "tiny.csv").read_bytes()
    assert app.run(arguments) == 2
    assert "--resume" in capfd.readouterr().err
    assert app.run([*arguments, "--resume", "--seeds", "3"]) == 0
    record = json.loads(capfd.readouterr().out.splitlines()[-1])
    assert record["trials"] == 3 and record["run"] == 1
    assert (tmp_path / "out" / "results" / "tiny.csv").read_bytes() != before
    assert app.run([argument for argument in arguments if argument != "--quick"] + ["--resume"]) == 2
    assert "quick=True" in capfd.readouterr().err
