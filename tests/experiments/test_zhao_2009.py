"""The experiments of Zhao (2009): which trials they ask for, and what is counted."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from muybridge.experiments.experiment import Case, Outcome, Row
from muybridge.experiments.harness import experiment
from muybridge.experiments.store import Store
from muybridge.experiments.zhao_2009.conditions import amount_of
from muybridge.experiments.zhao_2009.hall import FIRST_SEED, HAPPENS, HallClip, clips
from muybridge.experiments.zhao_2009.roc import PICTURES, ROC, further, report_of_curves
from muybridge.experiments.zhao_2009.speed import SpeedResult, SpeedTrial, report
from muybridge.experiments.zhao_2009.subtraction import MODELS, BackgroundResult, BackgroundTrial, added, at_rate
from muybridge.segmentation import BACKGROUND_MODELS, MaskCounts

ZHAO = experiment("zhao-2009")
RESULT = BackgroundResult((0.2, 0.6, 1.0), (0.0, 0.1, 0.5), 80, 20, 20, 880)
SMALL = HallClip("calm", 1, seconds=1.2, rate=10.0, size=(80, 60), people=1, empty=12)


@pytest.mark.parametrize("quick", [True, False])
def test_trials_differ_in_digest_and_are_described(quick: bool) -> None:
    scale = ZHAO.scale(quick, None)
    trials = {case.trial for part in ZHAO.parts for case in part.cases(scale)}
    assert len({trial.digest for trial in trials}) == len(trials)
    assert set(MODELS) <= set(BACKGROUND_MODELS)


def test_pictures_need_no_trials_of_their_own() -> None:
    assert [case.trial for case in PICTURES.cases(amount_of(True))] == [c.trial for c in ROC.cases(amount_of(True))]


def test_reported_seeds_are_not_those_that_settings_were_chosen_on() -> None:
    assert {clip.seed for clip in clips(amount_of(False))} == set(range(FIRST_SEED, FIRST_SEED + 10))
    assert FIRST_SEED + 10 < 901


def test_a_false_rate_between_two_points() -> None:
    """Half way from (0.1, 0.6) to (0.5, 1.0); from (0, 0) to (0, 0.2); at the ends."""
    assert RESULT.false_rate_at(0.8) == pytest.approx(0.3)
    assert RESULT.false_rate_at(0.1) == 0.0
    assert BackgroundResult((0.4,), (0.2,), 1, 1, 1, 1).false_rate_at(0.7) == pytest.approx(0.6)  # towards (1, 1)


def test_what_the_rule_loses_is_told_apart_only_where_pictures_agree() -> None:
    """30 pictures of 900 pixels of background: 9 more in every one is .01 [.01, .01]; 270 more in a single one is the
    same mean, and nothing can be said: the circle has draws without that picture, (1 - 6/30)^5 = a third of them."""
    best, always, once = (
        replace(RESULT, false_positives=0, true_negatives=27000, false_where_found=found)
        for found in ((0,) * 30, (9,) * 30, (270,) + (0,) * 29)
    )
    apart = further(always, best)
    assert (apart.low, apart.mean, apart.high) == pytest.approx((0.01, 0.01, 0.01))
    assert further(once, best).mean == pytest.approx(0.01) and further(once, best).low == 0
    assert not np.isfinite(further(RESULT, best).mean)


def test_the_level_where_enough_is_found_lies_between_two_that_are_known() -> None:
    """Foreground scores 1 to 100, background 1 to 10 of 1000: 80 are above 20; at levels 5 and 50 95 and 50 are."""

    def counts_at(level: float) -> list[MaskCounts]:
        found, false = int(np.sum(np.arange(1, 101) > level)), int(np.sum(np.arange(1, 11) > level))
        return [MaskCounts(found, false, 100 - found, 1000 - false)]

    levels = (5.0, 50.0)
    curve = [counts_at(level) for level in levels]
    assert added(at_rate(0.8, levels, curve, counts_at)) == MaskCounts(80, 0, 20, 1000)
    assert at_rate(0.99, levels, curve, counts_at) == []  # even 5 is too high
    assert at_rate(0.3, levels, curve, counts_at) == []  # and 50 too low


def test_tables_of_made_up_results() -> None:
    scale = amount_of(True, 1)
    rows = tuple(Row(case, RESULT) for case in ROC.cases(scale))
    made = report_of_curves(Outcome(rows, scale, Path()))
    false, choices, measures = made.tables
    assert [row[:2] for row in choices.rows] == [(scene, FIRST_SEED) for scene in HAPPENS]
    assert choices.rows[0][3] == choices.rows[0][4] and not np.isfinite(choices.rows[0][5].low)  # of no pictures
    assert [row[0] for row in false.rows] == list(HAPPENS) and false.rows[0][-1] == 1.0
    assert len(measures.rows) == len(HAPPENS) * len(MODELS)
    np.testing.assert_allclose(measures.rows[0][2:], (0.8, 0.8, 0.8, 4.0, 20 / 900))


def test_results_come_back_beside_others(tmp_path: Path) -> None:
    background, speed = BackgroundTrial(SMALL, "kde"), SpeedTrial((8, 8), 1)
    timed = SpeedResult(("kde",), (9.0,), (12.0,))
    with Store(tmp_path) as store:
        store.append(background, RESULT)
        store.append(speed, timed)
    with Store(tmp_path) as store:
        assert store[background] == RESULT and store[speed] == timed


def test_speed_is_held_against_mog2() -> None:
    trial = SpeedTrial((320, 240), 1)
    row = Row(Case("320 x 240", trial), SpeedResult(("spatial", "mog2"), (40.0, 400.0), (60.0, 500.0)))
    (table,) = report(Outcome((row,), amount_of(True), Path())).tables
    assert table.rows[0] == ("320 x 240", "spatial", 40.0, 60.0, 0.1, 1.0)


def test_a_trial_from_pictures_to_kept_masks(tmp_path: Path) -> None:
    """Somebody walks in at 2 % of the clip and is in the picture by its end, or nobody counts as found."""
    trial = BackgroundTrial(SMALL, "mog2")
    SMALL.prepare(tmp_path, [trial])
    pictures, truths = SMALL.load(tmp_path)
    assert pictures.shape == (24, 60, 80, 3) and truths.shape == (12, 60, 80)
    found = trial.run(tmp_path)
    judged = found.true_positives + found.false_positives + found.false_negatives + found.true_negatives
    assert 0 < judged <= 3 * 60 * 80
    with np.load(trial.masks_file(tmp_path)) as kept:
        assert kept["masks"].shape == kept["truths"].shape == (4, 60, 80) and kept["pictures"].dtype == np.uint8
    SMALL.drop(tmp_path)
    assert not list(tmp_path.rglob("*-pictures.npy"))
