"""Which of a person's parts is not where it should be: four support vector machines (Zhao 2009, 5.3).

One a part says whether it failed; a fourth, asked when one does, says whether several have: then the others' places
say nothing about which.

==================  ==================================================
symbol              name
==================  ==================================================
S_H, S_T, S_L       states (3, 6) of head, torso, hip-leg
RS_(K)(t)           `relative_states`, (5.7)
Delta t             LOOK_BACK_S
==================  ==================================================

Differences from the paper: lengths are shares of the body's height, velocities heights a second, so that people near
and far, and videos of any frame rate, are alike.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from muybridge.archive import INCOMPLETE, Arrays, Kind, incomplete
from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.people.box import SPEED_X
from muybridge.people.parts import PARTS
from muybridge.people.support_vectors import ARRAYS, SupportVectors

LOOK_BACK_S = 0.5  # Delta t, section 5.3
SHIPPED = Path(__file__).parent / "models" / "repair.npz"
KIND = Kind("muybridge-repair", 1, "train-repair")
MACHINES = (*PARTS, "several")
FEATURES = 2 * len(PARTS) * 6


def relative_states(states: FloatArray, height: float, frame_rate: float) -> FloatArray:
    """(18,) of (5.7): states (3, 6) against their mean, in heights (pixels) and heights a second."""
    relative = (states - states.mean(axis=0)) / height
    relative[:, SPEED_X:] *= frame_rate
    return relative.ravel()


@dataclass
class History:
    """The relative states of the last half second."""

    frame_rate: float
    rows: list[FloatArray] = field(default_factory=list)

    def features(self, states: FloatArray, height: float) -> FloatArray | None:
        """(36,) of this frame, which is kept: relative states, and how they changed; None before there are enough."""
        now = relative_states(states, height, self.frame_rate)
        self.rows.append(now)
        back = max(1, round(LOOK_BACK_S * self.frame_rate))
        del self.rows[: -back - 1]
        return np.concatenate([now, now - self.rows[0]]) if len(self.rows) > back else None

    def forget(self) -> None:
        """After a repair: the jump is no change of the person's."""
        self.rows.clear()


@dataclass(frozen=True, eq=False)
class FailureDetector:
    """parts : one machine each for head, torso, hip-leg; several : above 0 where a single part failed."""

    parts: tuple[SupportVectors, ...]
    several: SupportVectors

    def __post_init__(self) -> None:
        sizes = [machine.vectors.shape[1] for machine in (*self.parts, self.several)]
        if sizes != [FEATURES] * len(MACHINES):
            raise InputError(
                "failure detector", expected=f"{len(MACHINES)} machines of {FEATURES} features", got=str(sizes)
            )

    def failed(self, features: FloatArray) -> NDArray[np.bool_]:
        """(3,) which failed, given (36,): none, one, or all where it cannot be told which."""
        margins = np.array([float(machine.margins(features)[0]) for machine in self.parts])
        if (margins >= 0).all():
            return np.zeros(len(PARTS), bool)
        if self.several.margins(features)[0] < 0:
            return np.ones(len(PARTS), bool)
        return np.arange(len(PARTS)) == margins.argmin()


def save_detector(path: str | Path, detector: FailureDetector, facts: dict[str, object] | None = None) -> None:
    """Write the whole file, or leave the one that was there untouched; `facts` say how it was trained."""
    machines = dict(zip(MACHINES, (*detector.parts, detector.several), strict=True))
    arrays = {f"{name}_{array}": getattr(machine, array) for name, machine in machines.items() for array in ARRAYS}
    numbers = {name: {"offset": machine.offset, "gamma": machine.gamma} for name, machine in machines.items()}
    KIND.save(path, {"machines": numbers, "training": facts or {}}, arrays)


def load_detector(path: str | Path) -> FailureDetector:
    """A detector from a file that `save_detector` wrote; InputError in one line for anything else."""
    what = f"failure detector {path}"
    header, arrays = KIND.load(what, path)
    try:
        machines = [_machine(name, header["machines"][name], arrays) for name in MACHINES]
        detector = FailureDetector(tuple(machines[:-1]), machines[-1])
    except (*INCOMPLETE, InputError) as error:
        raise incomplete(what, f"four machines: {', '.join(MACHINES)}", error) from error
    return detector


def _machine(name: str, numbers: dict[str, float], arrays: Arrays) -> SupportVectors:
    vectors, coefficients, centre, scale = (arrays[f"{name}_{array}"] for array in ARRAYS)
    return SupportVectors(vectors, coefficients, centre, scale, float(numbers["offset"]), float(numbers["gamma"]))


@lru_cache(maxsize=2)
def detector_named(name: str) -> FailureDetector | None:
    """ "shipped", the one that comes with the package; "none"; or one from a file."""
    return None if name == "none" else load_detector(SHIPPED if name == "shipped" else name)
