"""What is learnt from: examples of both kinds from people who are followed, and machines that tell them apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from made_people import Walker, shots_of
from muybridge.errors import InputError
from muybridge.people.labelled import around, as_boxes, coverage, follow_labelled
from muybridge.people.repair_training import Examples, RepairTraining, examples_of, learn, thesis_rules
from people.made import EMPTY

CONFIG = RepairTraining(frame_rate=10.0)
WALKERS = [Walker((20, 150), (300, 150), 0, 49, 0), Walker((340, 215), (-20, 215), 5, 54, 1)]


def examples(rng: np.random.Generator, count: int = 300) -> Examples:
    """Parts whose place (features 1, 7, 13) is off by little where they are covered, by much where not."""
    covered = np.where(rng.random((count, 3)) < 0.3, 0.1, 0.9)
    features = rng.normal(0, 0.05, (count, 36))
    features[:, [1, 7, 13]] += np.where(covered < 0.5, 1.0, 0.0)
    return Examples(features, covered)


def test_coverage_by_hand() -> None:
    truth = np.array([10.0, 10, 20, 40])
    boxes = np.array([[10.0, 10, 20, 40], [20, 10, 20, 40], [30, 10, 20, 40], [0, 0, 100, 100]])
    np.testing.assert_allclose(coverage(boxes, truth), [1, 0.5, 0, 0.08])
    np.testing.assert_allclose(around(boxes), [0, 0, 100, 100])
    np.testing.assert_allclose(as_boxes(np.array([19.5, 29.5, 20, 40, 0, 0])), truth)


def test_tracks_lie_beside_their_truth() -> None:
    """The second is seen whole from its eighth frame on: before, part of it is outside the picture."""
    tracks = follow_labelled(np.random.default_rng(0), shots_of(WALKERS, 50, EMPTY), EMPTY,
                             thesis_rules((320, 240), 10.0), most=20)  # fmt: skip
    assert [(track.person, len(track.states)) for track in tracks] == [(1, 20), (2, 20)]
    for track in tracks:
        assert (coverage(as_boxes(track.states[0]), track.true_parts[0]) > 0.6).all()  # started at the truth
        assert track.visible.shape == (20, 3)
    again = follow_labelled(np.random.default_rng(0), shots_of(WALKERS, 50, EMPTY), EMPTY,
                            thesis_rules((320, 240), 10.0), most=20, again=True)  # fmt: skip
    assert len(again) > len(tracks)
    found = examples_of(again, CONFIG)
    assert found.features.shape[1] == 36 and found.covered.shape == (len(found.features), 3)


def test_machines_find_failures_and_hardly_anything_else() -> None:
    known, held_back, unseen = (examples(np.random.default_rng(seed)) for seed in range(3))
    detector, judged = learn(known, held_back, CONFIG)
    assert [one.name for one in judged] == ["head", "torso", "hip_leg", "several"]
    assert all(one.found > 0.9 and one.false_alarms <= 0.01 for one in judged)
    failed = np.array([detector.failed(row) for row in unseen.features])
    right = unseen.covered > 0.5
    alone = (~right).sum(axis=1) == 1
    assert failed[right.all(axis=1)].any(axis=1).mean() < 0.05
    assert (failed[alone] == ~right[alone]).all(axis=1).mean() > 0.9
    assert failed[(~right).sum(axis=1) > 1].all(axis=1).mean() > 0.8
    blind, _ = learn(Examples(known.features[::-1], known.covered), held_back, CONFIG)
    wrong = np.array([blind.failed(row) for row in unseen.features])
    assert (wrong[alone] == ~right[alone]).all(axis=1).mean() < 0.5  # negative control: labels of other examples


def test_what_is_refused() -> None:
    good = replace(examples(np.random.default_rng(0)), covered=np.ones((300, 3)))
    with pytest.raises(InputError, match="longer or harder clips"):
        learn(good, good, CONFIG)
    for wrong in ({"held_out": 3}, {"failed": 0.7}, {"spreads": (0.0,)}, {"false_alarms": 1.0}):
        with pytest.raises(InputError, match="training"):
            replace(CONFIG, **wrong)
    with pytest.raises(InputError, match="did you mean scenes"):
        CONFIG.with_settings(["scens=3"])
