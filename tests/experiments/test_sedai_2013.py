"""The experiments of Sedai et al. (2013): which trials they ask for, and what is counted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from experiments.made_results import result
from muybridge.experiments.experiment import Case, Row
from muybridge.experiments.harness import experiment
from muybridge.experiments.sedai_2013 import conditions
from muybridge.experiments.sedai_2013.facing import turned_frames
from muybridge.experiments.sedai_2013.tracking import frames_to_recover, usual_error
from muybridge.experiments.trial import Clip, Trial
from muybridge.filters import agp_pf
from muybridge.io.run_folder import JointSeries

SCALE = conditions.scale_of(False, 2)


def test_nobody_tracked_was_learnt_from() -> None:
    (source,) = conditions.training(SCALE).scenes
    assert not set(source.figures) & set(SCALE.figures) and len(source.figures) == 6
    assert not set(source.seeds) & set(range(100))
    count = len(source.figures) * len(source.motions) * len(source.seeds) * (source.frames // source.every) * 3
    assert 2500 <= count <= 3500


@pytest.mark.parametrize("quick", [True, False])
def test_every_part_asks_for_trials_that_can_be_run(quick: bool) -> None:
    asked = experiment("sedai-2013")
    scale = asked.scale(quick, 2)
    for part in asked.parts:
        for case in part.cases(scale):
            trial = case.trial
            assert trial.clip.figure in conditions.UNSEEN and trial.clip.preset == "humaneva" and trial.clip.rate == 60
            assert trial.filter_config is not None and (trial.guesser or trial.begin != "guess")


@pytest.mark.parametrize(
    ("name", "settings"),
    [("AGP-PF", {}), ("AGP", {"alpha": 1.0}), ("APF", {"alpha": 0.0})],
)
def test_the_cases_are_settings_of_one_filter(name: str, settings: dict) -> None:
    assert conditions.case_of(name) == settings
    assert conditions.printed(name, SCALE, Clip()).filter_config == replace(agp_pf.PRINTED, sharpness=2.0, **settings)


def test_without_layers_there_is_one() -> None:
    assert conditions.printed("GP-PF", SCALE, Clip()).filter_config.layers == 1
    pf = conditions.printed("PF", SCALE, Clip()).filter_config
    assert (pf.layers, pf.alpha) == (1, 0.0)


def test_frames_to_recover() -> None:
    """Usual: the median of the last third, 20; back at 30 or less, counted from the first frame after the gap.

    A single good frame between two bad ones does not count.
    """
    frames = (20.0,) * 3 + (400.0,) * 3 + (20.0, 31.0, 29.0) + (20.0,) * 3
    row = Row(Case("x", Trial(Clip(), gap=(3, 5))), replace(result(), frame_mm=frames))
    assert usual_error([row]) == 20.0
    assert frames_to_recover(row, 20.0) == 2
    assert frames_to_recover(replace(row, case=Case("x", Trial(Clip()))), 20.0) == 0
    assert np.isinf(frames_to_recover(row, 10.0))


@pytest.mark.parametrize(("degrees", "turned"), [(0, False), (80, False), (-80, False), (100, True), (180, True)])
def test_turned_is_more_than_a_right_angle_seen_from_above(degrees: float, turned: bool) -> None:
    """Hips 0.3 m apart, one of them 0.1 m higher: height says nothing about where somebody faces."""

    def hips(angle: float) -> JointSeries:
        across = 0.15 * np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle)), 1 / 3])
        positions = np.stack([across, -across])[None] + np.array([1.0, 2.0, 0.9])
        return JointSeries(("left_hip", "right_hip"), np.array([0]), np.array([0.0]), positions, np.full((1, 2), 0.01))

    assert turned_frames(hips(20.0 + degrees), hips(20.0)).tolist() == [turned]
