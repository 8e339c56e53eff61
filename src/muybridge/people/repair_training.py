"""Failure detectors learnt from part tracks whose truth is known (Zhao 2009, 5.3).

People are rendered, followed by colours alone and never repaired; a part whose box lies on it is a good example, one
whose box does not is a failure, and what is in between is left out, as in the paper. Some scenes are held back: each
machine is moved until few of their good examples are called failures, and their failures say how many are found.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.io._tables import override, replaced
from muybridge.people.box import HEIGHT, BoxMotion, CountConfig
from muybridge.people.colour_likelihood import ColourConfig
from muybridge.people.failure import FailureDetector, History
from muybridge.people.labelled import LabelledTrack, as_boxes, coverage, follow_labelled
from muybridge.people.part_filters import PartRules
from muybridge.people.parts import PARTS, PartConfig
from muybridge.people.support_vectors import train_support_vectors

FIRST_SEED = 9000
"""Of the scenes that are learnt from; experiments use small numbers."""


class Progress(Protocol):
    """Told how many of how many scenes are done."""

    def __call__(self, done: int, total: int, message: str = "") -> None: ...


@dataclass(frozen=True, kw_only=True)
class RepairTraining:
    """Settings."""

    scenes: int = 3
    held_out: int = 1  # of the scenes, to move the machines and to judge them
    duration_s: float = 16.0  # of a scene
    frame_rate: float = 25.0
    people: int = 4
    spreads: tuple[float, ...] = (0.2, 0.6)  # of the parts' colour likelihood: one that follows well, one that does not
    restart_s: float = 6.0  # after which everybody starts at the truth again
    every: int = 3  # frames from one example to the next
    good: float = 0.6  # share of a part's box that lies on the part: a good example from,
    failed: float = 0.3  # a failure up to
    seen: float = 0.8  # share of every part that nothing hides, in an example
    penalty: float = 1.0  # C of the machines
    kernel: float = 1.0  # width of the kernels, in usual distances of two examples
    false_alarms: float = 0.01  # of good examples

    def __post_init__(self) -> None:
        if not (1 <= self.held_out < self.scenes and 0 <= self.failed < self.good <= 1 and self.every >= 1):
            got = f"{self.held_out}, {self.scenes}, {self.failed}, {self.good}, {self.every}"
            raise InputError(
                "training", expected="1 <= held_out < scenes, failed < good in 0..1, every from 1", got=got
            )
        positive = self.duration_s, self.frame_rate, *self.spreads, self.restart_s, self.penalty, self.kernel
        if not (self.spreads and min(positive) > 0 and 0 <= self.false_alarms < 1):
            raise InputError("training", expected="times, spreads, penalty and kernel above 0, false_alarms in [0, 1)",
                             got=f"{positive}, {self.false_alarms}")  # fmt: skip

    def with_settings(self, settings: Sequence[str]) -> RepairTraining:
        """These settings with KEY=VALUE, such as scenes=8, put over them."""
        table: dict[str, Any] = {}
        for text in settings:
            override(table, text)
        return replaced(self, table, "--set")


def thesis_rules(size: tuple[int, int], frame_rate: float, spread: float = ColourConfig().spread) -> PartRules:
    """The thesis' tracker in pictures (width, height): parts go where their colours are, and nothing is repaired."""
    colour = ColourConfig(spread=spread)
    return PartRules(BoxMotion.within(size), CountConfig(), colour, PartConfig(), frame_rate)


@dataclass(frozen=True, eq=False)
class Examples:
    """features : (M, 36); covered : (M, 3) share of each part's box that lies on the part."""

    features: FloatArray
    covered: FloatArray

    @classmethod
    def joined(cls, several: Sequence[Examples]) -> Examples:
        """All of them."""
        return cls(np.concatenate([e.features for e in several]), np.concatenate([e.covered for e in several]))


@dataclass(frozen=True)
class Quality:
    """How a machine did on scenes that were held back: examples of both kinds, and shares of them."""

    name: str
    good: int
    failed: int
    false_alarms: float
    found: float

    def describe(self) -> str:
        """One line."""
        return (f"{self.name}: {self.found:.0%} of {self.failed} failures found, "
                f"{self.false_alarms:.1%} of {self.good} others called failures")  # fmt: skip


def train_repair(
    config: RepairTraining, *, seed: int = 0, progress: Progress | None = None
) -> tuple[FailureDetector, list[Quality]]:
    """Render, follow, label, learn."""
    found: list[Examples] = []
    for number in range(config.scenes):
        found.append(examples_of_scene(FIRST_SEED + 100 * seed + number, config))
        if progress:
            progress(number + 1, config.scenes, f"{sum(len(e.covered) for e in found)} examples")
    return learn(Examples.joined(found[config.held_out :]), Examples.joined(found[: config.held_out]), config)


def learn(known: Examples, held_back: Examples, config: RepairTraining) -> tuple[FailureDetector, list[Quality]]:
    """Four machines; those that were held back move them, and judge them."""
    machines, judged = [], []
    for k, name in enumerate((*PARTS, "several")):
        (features, good), (other, other_good) = (_of_machine(k, examples, config) for examples in (known, held_back))
        machine = train_support_vectors(features, good, penalty=config.penalty, spread=config.kernel)
        if k < len(PARTS) and other_good.any():  # the fourth is asked about failures only: neither answer is an alarm
            machine = machine.tuned(other[other_good], config.false_alarms)
        machines.append(machine)
        wrong = machine.margins(other) < 0 if len(other) else np.zeros(0, bool)
        judged.append(Quality(name, int(other_good.sum()), int((~other_good).sum()), _share(wrong[other_good]),
                              _share(wrong[~other_good])))  # fmt: skip
    return FailureDetector(tuple(machines[:-1]), machines[-1]), judged


def examples_of_scene(seed: int, config: RepairTraining) -> Examples:
    """Render a scene without events and follow everybody in it."""
    from muybridge.synthetic.crowd import shoot_people
    from muybridge.synthetic.scene import empty
    from muybridge.synthetic.surveillance import surveillance_scene

    scene = surveillance_scene(
        seed=seed, duration=config.duration_s, rate=config.frame_rate, people=config.people, events=()
    )
    bare = np.median([pictures[0] for pictures in empty(scene, 15)], axis=0).astype(np.uint8)

    shots = [shoot_people(scene, frame) for frame in range(scene.frame_count)]
    most = max(2, round(config.restart_s * config.frame_rate))
    found = []
    for number, spread in enumerate(config.spreads):
        rules = thesis_rules(scene.rig[0].size, config.frame_rate, spread)
        rng = np.random.default_rng([seed, 53, number])
        found.append(examples_of(follow_labelled(rng, shots, bare, rules, most=most, again=True), config))
    return Examples.joined(found)


def examples_of(tracks: Sequence[LabelledTrack], config: RepairTraining) -> Examples:
    """Every so many frames of every track, where all parts can be seen."""
    features, covered = [np.zeros((0, 36))], [np.zeros((0, len(PARTS)))]
    for track in tracks:
        history = History(config.frame_rate)
        shares = coverage(as_boxes(track.states), track.true_parts)
        for t, states in enumerate(track.states):
            found = history.features(states, float(track.bodies[t, HEIGHT]))
            if found is not None and t % config.every == 0 and track.visible[t].min() >= config.seen:
                features.append(found[None])
                covered.append(shares[t][None])
    return Examples(np.concatenate(features), np.concatenate(covered))


def _of_machine(k: int, examples: Examples, config: RepairTraining) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Features (M, 36) and which are good (M,): of part k, or, beyond the parts, whether only one has failed."""
    good, failed = examples.covered >= config.good, examples.covered <= config.failed
    if k < len(PARTS):
        use = good[:, k] | failed[:, k]
        return examples.features[use], good[use, k]
    clear = (good | failed).all(axis=1) & failed.any(axis=1)
    return examples.features[clear], failed[clear].sum(axis=1) == 1


def _share(chosen: NDArray[np.bool_]) -> float:
    return float(chosen.mean()) if chosen.size else float("nan")
