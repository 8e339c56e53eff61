"""Trials of tracking in made clips, and tables from results that are known."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest

from made_people import Walker, empty_scene, shots_of
from muybridge.experiments.experiment import Amount, Outcome, Part, Row
from muybridge.experiments.zhao_2009 import EXPERIMENT
from muybridge.experiments.zhao_2009.parts import (
    ALARMS,
    CONDITIONS,
    HARD_RATES,
    RATES,
    AlarmResult,
    AlarmTrial,
    RateResult,
    RateTrial,
)
from muybridge.experiments.zhao_2009.people_clips import ClipPictures, PeopleClip, hard_clips, pillar_of
from muybridge.experiments.zhao_2009.tracking import BOXES, METHODS, PARTICLES, BoxResult, BoxTrial
from muybridge.synthetic.surveillance import surveillance_scene

EMPTY = empty_scene()
CLIP = PeopleClip(seed=0, rate=10.0, size=(320, 240))
QUICK = Amount(True, 2)


@pytest.fixture(scope="module")
def hall() -> ClipPictures:
    """One who crosses in 4 seconds."""
    return ClipPictures(EMPTY, tuple(shots_of([Walker((30, 170), (290, 170), 0, 39)], 40, EMPTY)))


def outcome(cases: list, results: list, folder: Path) -> Outcome:
    return Outcome(tuple(Row(case, result) for case, result in zip(cases, results, strict=True)), QUICK, folder)


TRIALS = [
    BoxTrial(CLIP, "ours", 300),
    BoxTrial(CLIP, "Nummiaro", 100),
    RateTrial(CLIP, "repair"),
    RateTrial(CLIP, "repair, any region"),
    AlarmTrial(CLIP, True, boxes=20, pictures=2),
]


@pytest.mark.parametrize("trial", TRIALS, ids=lambda trial: type(trial).__name__)
def test_a_result_survives_json(trial, hall: ClipPictures) -> None:
    result = trial.measure(hall)
    assert trial.result(json.loads(json.dumps(asdict(result)))) == result
    assert trial.digest != replace(trial, clip=replace(CLIP, seed=1)).digest


def test_ours_stays_on_the_walker(hall: ClipPictures) -> None:
    """Clear colours before a plain background: the centre of a 22 x 62 px box stays within a few pixels."""
    result = BoxTrial(CLIP, "ours", 300).measure(hall)
    assert result.people == 1 and result.deviation < 8 and result.frames_per_second > 0
    nobody = BoxTrial(CLIP, "ours", 300).measure(ClipPictures(EMPTY, hall.shots[:10]))
    assert nobody.people == 0 and np.isnan(nobody.deviation)


def test_parts_start_right(hall: ClipPictures) -> None:
    result = RateTrial(CLIP, "no repair").measure(hall)
    assert [len(texts) for texts in result.right] == [1] * 4 and len(result.right[0][0]) == 40
    assert result.right[1][0].startswith("111") and result.right[3][0].startswith("111")


def test_one_box_has_no_parts(hall: ClipPictures) -> None:
    result = RateTrial(CLIP, "one box").measure(hall)
    assert [len(texts) for texts in result.right] == [0, 0, 0, 1]
    assert result.right[3][0].startswith("111") and np.isnan(result.rate(0, 0, 10)) and result.rate(3, 0, 2) == 1


def test_fitted_bins_are_mistaken_less(hall: ClipPictures) -> None:
    """6.2.3: a tenth in the thesis; here at most as many."""
    fitted, even = (AlarmTrial(CLIP, mapping, boxes=200, pictures=3).measure(hall) for mapping in (True, False))
    assert fitted.tried == even.tried and min(fitted.tried) > 300
    assert sum(fitted.mistaken) <= sum(even.mistaken)


@pytest.mark.parametrize(("part", "name"), [(RATES, "tracking-rate"), (HARD_RATES, "tracking-rate-hard")])
def test_rates_by_hand(part: Part, name: str, tmp_path: Path) -> None:
    """Two people last until frame 105; of one the head is lost at frame 50. A third left before and is not counted."""
    lost = "1" * 50 + "0" * 70
    texts = (("1" * 120, lost, "0" * 60), *[("1" * 120, "1" * 120, "0" * 60)] * 3)
    cases = list(part.cases(QUICK))
    assert [case.label for case in cases[: len(CONDITIONS)]] == list(CONDITIONS)
    report = part.report(outcome(cases, [RateResult(texts)] * len(cases), tmp_path))
    table = report.tables[0]
    assert [cell.mean for cell in table.rows[0][1:5]] == [0.5, 1.0, 1.0, 1.0] and table.rows[0][5] == 4  # two seeds
    assert table.rows[-1][0] == "thesis, repair" and name in report.figures
    assert table.name == name


def test_tables_of_boxes_and_alarms(tmp_path: Path) -> None:
    cases = list(BOXES.cases(QUICK))
    assert {case.trial.method for case in cases} == set(METHODS)
    assert {case.trial.particles for case in cases} <= set(PARTICLES)
    results = [BoxResult(5.0 if case.trial.method == "ours" else 10.0, 100.0, 3) for case in cases]
    table = BOXES.report(outcome(cases, results, tmp_path)).tables[0]
    assert [row[2].mean for row in table.rows] == [5.0, 5.0, 10.0, 10.0, 10.0, 10.0] and table.rows[0][7] == 6
    alarms = list(ALARMS.cases(QUICK))
    results = [AlarmResult((100, 100, 100), (1, 0, 2) if case.trial.mapping else (10, 10, 10)) for case in alarms]
    table = ALARMS.report(outcome(alarms, results, tmp_path)).tables[0]
    assert [cell.mean for cell in table.rows[0][1:4]] == [0.01, 0.0, 0.02]


def test_the_parts_are_on_the_command_line() -> None:
    assert {"boxes", "alarms", "rates", "hard-rates"} <= {part.name for part in EXPERIMENT.parts}


def test_a_hall_is_kept_and_dropped(tmp_path: Path) -> None:
    clip = PeopleClip(seed=1, duration=2.0, rate=5.0, people=1, size=(64, 48))
    clip.prepare(tmp_path, [])
    kept, made = clip.load(tmp_path), clip.render()
    np.testing.assert_array_equal(kept.empty, made.empty)
    assert len(kept.shots) == len(made.shots) == 10
    np.testing.assert_array_equal(kept.shots[-1].image, made.shots[-1].image)
    np.testing.assert_array_equal(kept.shots[-1].parts, made.shots[-1].parts)
    clip.drop(tmp_path)
    assert not clip.path(tmp_path).exists()


def test_a_pillar_is_drawn_where_it_stands(tmp_path: Path) -> None:
    """Up its middle, 0.21 m from its sides; not 0.8 m to either side of it."""
    clip = replace(next(hard_clips(1)), duration=2.0, rate=5.0, people=1, size=(160, 120))
    scene = surveillance_scene(seed=clip.seed, duration=2.0, rate=5.0, people=1, size=(160, 120), events=("pillar",))
    mask = pillar_of(scene)
    up = np.array([[*scene.occluders[-1].place, height] for height in (0.1, 0.7, 1.3, 1.9)])
    for aside, expected in ((0.0, True), (0.8, False), (-0.8, False)):
        x, y = np.rint(scene.rig[0].world_to_pixel(up + (0, aside, 0))).astype(int).T
        inside = (x >= 0) & (x < 160) & (y >= 0) & (y < 120)
        assert inside.any() and (mask[y[inside], x[inside]] == expected).all()
    clip.prepare(tmp_path, [])
    np.testing.assert_array_equal(clip.load(tmp_path).pillar, mask)
    assert RateTrial(clip, "one box").measure(clip.load(tmp_path)).right[0] == ()
