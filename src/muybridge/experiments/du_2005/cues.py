"""E3: each cue, each pair, all; E4: colour by area or all segments alike.

Cues have different scales, and a search works at one sharpness. So every mixture is given the sharpness at which it
falls as far round the true pose as the silhouettes of the working settings do, and mixtures are measured twice: at
equal powers, as printed, and balanced, each cue's power being the inverse of its own fall.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np

from muybridge.experiments.bodies import start_pose
from muybridge.experiments.clips import Evidence
from muybridge.experiments.du_2005.budgets import interval_figure
from muybridge.experiments.du_2005.conditions import THREE_CUES, at_shape, over
from muybridge.experiments.experiment import Case, Outcome, Part, Report, Scale
from muybridge.experiments.scenes import right_body
from muybridge.experiments.summaries import difference_table, parts_table, summary_table
from muybridge.likelihood.cues import CueWeights
from muybridge.likelihood.observation import ImageLikelihood

CUE_SEEDS = 3
TURN, MOVE = 0.1, 0.03  # radians and metres: a search's way, not the peak's rounding, on which cues hardly agree
THESIS_CUES = ("silhouette", "colour", "boundary")
#: How far a cue's log likelihood falls round the true pose: `measured_falls` on a walk, three cameras at 320 x 240.
FALLS = {"silhouette": 0.48, "colour": 0.70, "boundary": 0.71, "edges": 0.155}
SHARPNESS = 200.0 * 0.23  # of the settings at the thesis' shape, times how far their two-sided silhouettes fall


def measured_falls(evidence: Evidence, rng: np.random.Generator, poses: int = 200) -> dict[str, float]:
    """How far each cue falls from the true pose to poses off by TURN and MOVE (sd): the median; first frame."""
    body = right_body(evidence.clip)
    true = start_pose(body, evidence)
    near = true + rng.standard_normal((poses, len(true))) * np.where(np.arange(len(true)) < 3, MOVE, TURN)
    found = {}
    for name in FALLS:
        model = ImageLikelihood(body, evidence.rig, evidence.reductions, cues=weights((name,), balanced=False))
        observation = model.observe([view[0] for view in evidence.own], [view[0] for view in evidence.pictures])
        if name == "colour":
            observation = replace(observation, reference=observation.first_reference(true))
        found[name] = float(observation.log_prob(true[None])[0] - np.median(observation.log_prob(near)))
    return found


def weights(names: tuple[str, ...], *, balanced: bool) -> CueWeights:
    """The cues named at equal powers, or each at the inverse of its fall."""
    powers: dict[str, Any] = {
        name: (1.0 / FALLS[name] if balanced else 1.0) if name in names else 0.0 for name in FALLS
    }
    return CueWeights(**powers, silhouette_kind="iou")


def sharpness(cues: CueWeights) -> float:
    """K at which the mixture falls as far as silhouettes do under the working settings: the search is the same."""
    given = cues.by_name
    fall = sum(power * FALLS[name] for name, power in given.items()) / sum(given.values())
    return SHARPNESS / fall


def mixtures() -> dict[str, CueWeights]:
    """Label -> cues: single ones, pairs, all; equal and balanced."""
    found: dict[str, CueWeights] = {name: weights((name,), balanced=True) for name in (*THESIS_CUES, "edges")}
    groups = [*combinations(THESIS_CUES, 2), THESIS_CUES]
    for names in groups:
        found[f"{' + '.join(names)}, equal"] = weights(names, balanced=False)
    for names in (*groups, ("silhouette", "edges")):
        found[f"{' + '.join(names)}, balanced"] = weights(names, balanced=True)
    return found


def cue_cases(scale: Scale) -> Iterator[Case]:
    """DE-MC 500 x 7 with every mixture, walks seen by three cameras."""
    clips = scale.walks(seeds=scale.few(CUE_SEEDS))
    for label, cues in mixtures().items():
        yield from over(clips, label, at_shape("demc", clips[0], cues, sharpness=sharpness(cues)))


def cue_report(outcome: Outcome) -> Report:
    """Errors of every mixture, and differences from the silhouette."""
    groups = outcome.groups()
    return Report(
        (
            summary_table("E3", "E3: cues, DE-MC 500 x 7, three cameras, walking", groups),
            difference_table("E3-paired", "E3: differences", groups, "silhouette"),
            parts_table("E3-parts", "E3: where the error is", groups),
        ),
        {"E3": interval_figure(groups, "E3: cues")},
    )


def area_cases(scale: Scale) -> Iterator[Case]:
    """The three cues fused, and colour alone, with segments by area and alike."""
    clips = scale.walks(seeds=scale.few(CUE_SEEDS))
    fused, colour = weights(THESIS_CUES, balanced=True), weights(("colour",), balanced=True)
    for label, cues in (("three cues", fused), ("three cues at equal powers", THREE_CUES), ("colour alone", colour)):
        for by_area in (True, False):
            given = replace(cues, colour_by_area=by_area)
            trial = at_shape("demc", clips[0], given, sharpness=sharpness(cues))
            yield from over(clips, f"{label}, {'by area (5.5)' if by_area else 'all alike (5.3)'}", trial)


def area_report(outcome: Outcome) -> Report:
    """Errors with and without the thesis' weights, and their difference for each mixture."""
    groups = outcome.groups()
    tables = [summary_table("E4", "E4: segments by area or all alike", groups)]
    for label in ("three cues", "three cues at equal powers", "colour alone"):
        pair = {name: rows for name, rows in groups.items() if name.rpartition(",")[0] == label}
        name = f"E4-{label.replace(' ', '-')}-paired"
        tables.append(difference_table(name, f"E4, {label}: difference", pair, f"{label}, all alike (5.3)"))
    return Report(tuple(tables), {"E4": interval_figure(groups, "E4: colour by area")})


E3 = Part("E3", "Each cue, each pair, all", cue_report, cue_cases)
E4 = Part("E4", "Colour weights by area", area_report, area_cases)
