from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from muybridge.errors import InputError
from muybridge.experiments import trial as trials
from muybridge.experiments.trial import Clip, Faults, Trial
from muybridge.likelihood.cues import CueWeights

BASE = Trial()


def test_equal_trials_have_equal_digests() -> None:
    assert Trial().digest == BASE.digest and hash(Trial()) == hash(BASE)
    assert BASE.with_settings(particles=10, redraws=5) == BASE.with_settings(redraws=5, particles=10)


@pytest.mark.parametrize(
    "other",
    [
        replace(BASE, seed=1),
        replace(BASE, method="demc"),
        replace(BASE, printed=True),
        replace(BASE, masks="true"),
        replace(BASE, faults=Faults(body=0.05)),
        replace(BASE, cues=CueWeights(colour=1.0, colour_by_area=False)),
        replace(BASE, clip=Clip(seed=4)),
        BASE.with_settings(particles=301),
        BASE.with_motion(velocity_gain=0.0),
        replace(BASE, begin="wrong"),
        replace(BASE, guesser="model"),
        replace(BASE, gap=(3, 5)),
    ],
)
def test_whatever_decides_the_result_is_in_the_digest(other: Trial) -> None:
    assert other.digest != BASE.digest


def test_a_preset_that_changes_is_another_trial(monkeypatch: pytest.MonkeyPatch) -> None:
    before = BASE.digest
    row = trials.method("guided")
    changed = replace(row, WORKING=replace(row.WORKING, particles=299))
    monkeypatch.setattr(trials, "method", lambda name: changed)
    assert BASE.digest != before


def test_a_preset_spelt_out_gives_the_same_settings_though_it_is_another_trial() -> None:
    assert BASE.with_settings(particles=300).filter_config == BASE.filter_config


def test_the_description_is_json() -> None:
    text = json.dumps(replace(BASE, settings=(("spreads", (0.2, 0.1)),)).description, allow_nan=False)
    assert json.loads(text)["filter"]["spreads"] == [0.2, 0.1]


def test_printed_is_at_full_velocity_gain() -> None:
    assert replace(BASE, method="demc", printed=True).motion.velocity_gain == 1.0
    assert replace(BASE, method="demc").motion.velocity_gain == 0.5


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Clip(view="top"), "clip: view"),
        (lambda: Clip(frames=1), "clip: frames"),
        (lambda: Trial(masks="nice"), "trial: masks"),
        (lambda: Faults(masks="torn"), "faults: masks"),
        (lambda: Trial(masks="job"), "body by height"),
        (lambda: Trial(method="magic").filter_config, "filter"),
    ],
)
def test_bad_input_is_one_line(make, words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        make()
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"begin": "guess"}, "a guesser"),
        ({"begin": "luck"}, "'truth'"),
        ({"gap": (0, 3)}, "not from the beginning"),
        ({"gap": (5, 3)}, "first and last"),
    ],
)
def test_what_cannot_be_tried(changed: dict, words: str) -> None:
    with pytest.raises(InputError, match=words):
        replace(BASE, **changed)


def test_a_rehearsal_needs_no_guess_of_silhouettes_that_it_made_small(monkeypatch: pytest.MonkeyPatch) -> None:
    ran: list[Trial] = []
    monkeypatch.setattr(Trial, "run", lambda trial, folder: ran.append(trial))
    Trial(Clip(), "agp-pf", begin="guess", guesser="some").rehearse(Path("nowhere"))
    (trial,) = ran
    assert trial.begin == "truth" and trial.guesser == "some" and trial.clip.frames == 2
