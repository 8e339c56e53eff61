from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from experiments.made_results import SMALL, result, row
from muybridge.errors import InputError
from muybridge.experiments.experiment import LOST_MM, Case, Experiment, Outcome, Part, Report, Row, scale_of
from muybridge.experiments.harness import EXPERIMENTS, experiment, run_experiment
from muybridge.experiments.trial import Clip, Trial

DU = experiment("du-2005")


def test_unknown() -> None:
    with pytest.raises(InputError, match="du-2005"):
        experiment("du-2006")


def test_parts_are_chosen_whatever_the_case_in_the_order_of_the_experiment() -> None:
    assert [part.name for part in DU.chosen(["e3", "E1"])] == ["E1", "E3"]
    assert DU.chosen() == DU.parts
    with pytest.raises(InputError, match="E1 | E2"):
        DU.chosen(["E7"])


def test_every_experiment_is_found_by_its_name() -> None:
    for name in EXPERIMENTS:
        found = experiment(name)
        assert found.name == name and len({part.name.lower() for part in found.parts}) == len(found.parts)


@pytest.mark.parametrize("seeds", [0, -3])
def test_seeds(seeds: int) -> None:
    with pytest.raises(InputError, match="seeds"):
        scale_of(False, seeds)


def test_scale() -> None:
    whole = scale_of(False)
    assert whole.seeds == 10 and len(whole.motions) == 3 and len(whole.clips(seeds=2)) == 2 * len(whole.figures) * 3
    assert all(clip.motion == "walk" for clip in whole.walks()) and len(whole.walks()) == 10 * len(whole.figures)
    assert [clip.seed for clip in whole.walks()][: len(whole.figures)] == [0] * len(whole.figures)
    assert scale_of(True).few(5) == 1 and whole.few(5) == 5


def test_a_lost_frame_counts_so_much_and_no_more() -> None:
    far = Row(Case("x", Trial()), result(0.0, frame_mm=(10.0, 50000.0)))
    assert far.error_mm == (10.0 + LOST_MM) / 2


def test_groups_keep_the_order_of_the_cases() -> None:
    rows = (row("b", 0, 1), row("a", 0, 2), row("b", 1, 3))
    found = Outcome(rows, SMALL, Path()).groups()
    assert list(found) == ["b", "a"] and len(found["b"]) == 2


def test_what_left_a_file_that_is_gone_is_run_again(tmp_path: Path) -> None:
    """Results are carried to other places without the tracks that plots are drawn from."""
    trial = replace(Trial(Clip(frames=2, reduction=8), "condensation").with_settings(particles=20), keep_track=True)
    part = Part("one", "One", lambda outcome: Report(), lambda scale: iter([Case("one", trial)]))
    asked = Experiment("made", "Made", (part,), scale=scale_of)
    ran = [run_experiment(asked, SMALL, tmp_path).run]
    (track,) = trial.leaves(tmp_path)
    assert track.is_file()
    ran.append(run_experiment(asked, SMALL, tmp_path, resume=True).run)
    track.unlink()
    ran.append(run_experiment(asked, SMALL, tmp_path, resume=True).run)
    assert ran == [1, 0, 1] and track.is_file()
