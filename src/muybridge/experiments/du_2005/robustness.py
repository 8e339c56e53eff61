"""What matters: a wrong body, worse masks, cameras beside their calibration; and what the whole product reaches."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from muybridge.experiments.du_2005.budgets import interval_figure
from muybridge.experiments.du_2005.conditions import at_budget, at_shape, over, working
from muybridge.experiments.experiment import Case, Outcome, Part, Report, Scale
from muybridge.experiments.summaries import coverage_table, difference_table, summary_table
from muybridge.experiments.trial import Faults, Trial

ROBUST_SEEDS = 3
BASE = "own masks, right body"
#: label -> faults, masks, body
CONDITIONS: dict[str, tuple[Faults, str, str]] = {
    BASE: (Faults(), "own", "right"),
    "true masks": (Faults(), "true", "right"),
    "masks eroded by a pixel": (Faults(masks="eroded"), "own", "right"),
    "masks dilated by a pixel": (Faults(masks="dilated"), "own", "right"),
    "masks with holes": (Faults(masks="holes"), "own", "right"),
    "calibration off by 2 px": (Faults(calibration_px=2.0), "own", "right"),
    "body by height, fitted": (Faults(), "own", "height"),
    "body wrong by 5 %": (Faults(body=0.05), "own", "right"),
    "body wrong by 10 %": (Faults(body=0.10), "own", "right"),
}


def fault_cases(scale: Scale) -> Iterator[Case]:
    """Every fault under the default filter and DE-MC 500 x 7, three cameras; a pixel is one as recorded."""
    clips = scale.walks(seeds=scale.few(ROBUST_SEEDS), reduction=None)
    for method in ("guided", "demc"):
        trial = working("guided", clips[0]) if method == "guided" else at_shape("demc", clips[0])
        for label, (faults, masks, body) in CONDITIONS.items():
            yield from over(clips, f"{method}: {label}", replace(trial, faults=faults, masks=masks, body=body))


def fault_report(outcome: Outcome) -> Report:
    """The user's guide: what each fault costs, with each filter."""
    groups = outcome.groups()
    tables = [summary_table("matters", "What matters: faults one at a time, three cameras", groups)]
    for method in ("guided", "demc"):
        own = {label: rows for label, rows in groups.items() if label.startswith(method)}
        name = f"matters-{method}-paired"
        tables.append(difference_table(name, f"What each fault costs, {method}", own, f"{method}: {BASE}"))
    return Report(tuple(tables), {"matters": interval_figure(groups, "What matters")})


#: Lines of the table of what must be reached: label -> at least, aim, mm.
TARGETS = {
    "3 cameras, default filter, the whole product, body by height": (40.0, 20.0),
    "3 cameras, DE-MC 500 x 7, right body": (50.0, 30.0),
    "3 cameras, DE-MC long chains 3500, right body": (50.0, 30.0),
    "1 camera, walking, DE-MC 500 x 7, right body": (100.0, 60.0),
    "1 camera, walking, DE-MC long chains 3500, right body": (100.0, 60.0),
    "1 camera, walking, annealed limb by limb": (80.0, 50.0),
    "1 camera, walking, guided": (80.0, 50.0),
    "1 camera, walking, default filter (annealed 500 x 10)": (80.0, 50.0),
}


def target_cases(scale: Scale) -> Iterator[Case]:
    """The lines of `TARGETS`: the first through the whole product, at the reduction it chooses; the others are E1's."""
    ring, side = scale.clips(), scale.walks(view="side")
    trials: tuple[tuple[tuple, Trial], ...] = (
        (ring, Trial(ring[0], masks="job", body="height")),
        (ring, at_shape("demc", ring[0])),
        (ring, at_budget("demc", ring[0], 3500)),
        (side, at_shape("demc", side[0])),
        (side, at_budget("demc", side[0], 3500)),
        (side, at_budget("annealed", side[0], 5000)),
        (side, working("guided", side[0])),
        (side, at_shape("annealed", side[0])),
    )
    for label, (clips, trial) in zip(TARGETS, trials, strict=True):
        yield from over(clips, label, trial)


def target_report(outcome: Outcome) -> Report:
    """Errors beside what was asked for, and the coverage of the same runs."""
    groups = outcome.groups()
    table = summary_table("reach", "What is reached", groups)
    asked = tuple(f"{label}: at least {least:g} mm, aim {aim:g} mm" for label, (least, aim) in TARGETS.items())
    table = replace(table, notes=(*table.notes, *asked))
    return Report(
        (table, coverage_table("reach-coverage", "What is reached: coverage", groups)),
        {"reach": interval_figure(groups, "What is reached", list(TARGETS.values()))},
    )


MATTERS = Part("matters", "What matters: wrong bodies, worse masks, cameras that are off", fault_report, fault_cases)
REACH = Part("reach", "What must be reached", target_report, target_cases)
