"""The filters that Du (2005) compares, as printed and as they work, at the thesis' shapes and at any budget."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from muybridge.experiments.experiment import Case
from muybridge.experiments.trial import Clip, Trial
from muybridge.likelihood.cues import CueWeights

#: The thesis' measurement: three cues of equal power, (5.12), silhouettes by intersection over union, (5.1).
THREE_CUES = CueWeights(silhouette=1.0, colour=1.0, boundary=1.0, silhouette_kind="iou")
SILHOUETTE = CueWeights()
#: Table 7.1: particles and layers.
SHAPES: dict[str, dict[str, Any]] = {
    "condensation": {"particles": 5000},
    "annealed": {"particles": 500, "layers": 10},
    "demc": {"particles": 500, "layers": 7},
}
NAMES = {
    "condensation": "CONDENSATION 5000",
    "annealed": "annealed 500 x 10",
    "demc": "DE-MC 500 x 7",
}
#: What works at the thesis' shape, in place of the working settings that belong to another one: seven layers have to
#: carry DE-MC as far as 82 do, so they start from wider noise, jump further, and select between layers. Compared on
#: walks and a jog of 60 frames, seeds 31 to 38, one run each, three cameras and one: sharpness 200, 1000, selections
#: of .05, .1, .2 and none, limb by limb or not.
AT_SHAPE: dict[str, dict[str, Any]] = {
    "condensation": {},
    "annealed": {"by_limb": False},
    "demc": {"c": 0.3, "dynamics_noise": 1.2, "sharpness": 1000.0, "reselect": 0.1},
}
LIMB_ROUNDS = 18  # layers of the annealed filter: three rounds of six limbs, whatever the budget
DEMC_RATIO = 60 / 83  # chains by generations, as in the working settings
BUDGETS = (250, 500, 1000, 2000, 5000, 10000, 20000)
FILTERS = ("condensation", "annealed", "demc", "tempered", "guided")


def printed(method: str, clip: Clip, **settings: Any) -> Trial:
    """As the paper has it: its settings, its three cues, the velocity at full gain."""
    return Trial(clip, method, printed=True, cues=THREE_CUES, seed=clip.seed).with_settings(**settings)


def at_shape(method: str, clip: Clip, cues: CueWeights = SILHOUETTE, **settings: Any) -> Trial:
    """Working settings at the thesis' particles and layers."""
    chosen = {**SHAPES[method], **AT_SHAPE[method], **settings}
    return Trial(clip, method, cues=cues, seed=clip.seed).with_settings(**chosen)


def working(method: str, clip: Clip, **settings: Any) -> Trial:
    """Working settings as they are."""
    return Trial(clip, method, seed=clip.seed).with_settings(**settings)


def at_budget(method: str, clip: Clip, evaluations: int) -> Trial:
    """Working settings at about so many evaluations a frame."""
    return working(method, clip, **budget_settings(method, evaluations))


def budget_settings(method: str, evaluations: int) -> dict[str, Any]:
    """Particles, layers and redraws that make about so many evaluations.

    DE-MC keeps the ratio of chains to generations, the annealed filter its rounds of limbs, the guided filter a third
    of the budget for particles and the rest for redrawing five limbs.
    """
    if method == "condensation":
        return {"particles": evaluations}
    if method == "annealed":
        return {"particles": max(6, evaluations // LIMB_ROUNDS), "layers": LIMB_ROUNDS}
    if method == "demc":
        chains = max(6, round(np.sqrt(evaluations * DEMC_RATIO)))
        return {"particles": chains, "layers": max(1, evaluations // chains - 1)}
    if method == "tempered":
        return {"particles": max(6, evaluations // 10), "layers": 9}
    return {"particles": max(20, evaluations // 3), "redraws": max(4, 2 * evaluations // 15)}


def over(clips: Iterable[Clip], label: str, trial: Trial, x: float = float("nan")) -> Iterator[Case]:
    """One condition on every clip, the tracker's seed being the scene's."""
    for clip in clips:
        yield Case(label, replace(trial, clip=clip, seed=clip.seed), x)
