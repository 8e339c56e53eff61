"""How a person is expected to move between two frames, and to be posed at all, by filter method.

The guided filter climbs to where the picture says the person is and keeps a covariance, so that it can estimate
velocities and expect them to last. A filter that draws its candidates from the dynamics spends every bit of width on
draws that miss, and has only the difference of two noisy estimates for a velocity.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from muybridge.body.model import Body
from muybridge.errors import InputError
from muybridge.filters import ConstantVelocity, NearlyConstantVelocity

FRAME = 1.0 / 30.0  # seconds


@dataclass(frozen=True)
class Motion:
    """What the prediction does not know, one standard deviation a second; how much of the last step it repeats."""

    root_speed: float = 1.5  # metres a second
    root_turn_speed: float = 3.0  # radians a second
    turn_speed: float = 3.0  # radians a second, of every other joint
    velocity_gain: float = 1.0  # share of the velocity that the prediction repeats
    velocity_follow: float = 0.4  # for filters without a covariance: share of a surprise that the velocity takes up
    root_acceleration: float = 12.0  # metres a second squared; where all three are 0, velocities are differences
    root_turn_acceleration: float = 40.0  # radians a second squared
    turn_acceleration: float = 80.0  # radians a second squared
    usual_weight: float = 1.0  # how strongly the body's usual angles are preferred; 1: as it states them

    def __post_init__(self) -> None:
        for setting in fields(self):
            value = getattr(self, setting.name)
            if not (np.isfinite(value) and value >= 0):
                raise InputError(f"motion {setting.name!r}", expected="finite and not negative", got=repr(value))

    def dynamics(self, body: Body, interval: float) -> ConstantVelocity:
        """How the state moves from one frame to the next, `interval` seconds later.

        What is not known grows alike in a second, whatever the frame rate: white accelerations with the square root of
        time, and what is usual counts in proportion to it. `Motion` states both for frames of `FRAME` seconds.
        """
        speeds = self.speeds(body) * interval
        changes = _of_dofs(body, self.root_acceleration, self.root_turn_acceleration, self.turn_acceleration)
        changes *= interval**1.5 * FRAME**0.5
        usual, usual_sd = body.usual
        weight = self.usual_weight * interval / FRAME
        usual_sd = usual_sd / np.sqrt(weight) if weight > 0 else np.full_like(usual_sd, np.inf)
        common = speeds, body.lower, body.upper, usual, usual_sd, self.velocity_gain
        return (
            NearlyConstantVelocity(*common, changes, self.velocity_follow)
            if changes.any()
            else ConstantVelocity(*common)
        )

    def speeds(self, body: Body) -> np.ndarray:
        """(D,) metres and radians a second: one standard deviation of what the prediction does not know."""
        return _of_dofs(body, self.root_speed, self.root_turn_speed, self.turn_speed)


@dataclass(frozen=True)
class ProportionalMotion(Motion):
    """Turns are as fast as they are usually wide: a knee swings, a hip hardly twists. `turn_speed` is their mean.

    Sedai et al. (2013), V-C1, give every angle its own deviation too: its largest change in training.
    """

    def speeds(self, body: Body) -> np.ndarray:
        """As `Motion.speeds`; what has no usual deviation keeps to what is stated."""
        speeds, wide = super().speeds(body), body.usual[1]
        known = np.isfinite(wide)
        speeds[known] = self.turn_speed * wide[known] / (wide[known].mean() if known.any() else 1.0)
        return speeds


def _of_dofs(body: Body, place: float, root_turn: float, turn: float) -> np.ndarray:
    """(D,) a value for the root's place, one for its turns, one for every other joint."""
    values = np.full(len(body.dof_names), turn)
    values[:3] = place
    values[[index for index, name in enumerate(body.dof_names) if index >= 3 and name.startswith("root_")]] = root_turn
    return values


#: Chosen on studio scenes with seeds of 31 and above, see docs/benchmarks.md, "How people move"; table settings-paired
#: of papers/du-2005: half the gain is better than none or all.
#: At 25 frames a second: 10 mm, 1.5 degrees for the root, 2.5 degrees for the limbs.
SEARCHING = Motion(0.25, 0.65, 1.1, 0.5, 1.0, 0.0, 0.0, 0.0, usual_weight=3.0)
#: One camera sees neither how far away the person is nor whether a limb points towards it: even motion and what is
#: usual hold these.
ONE_CAMERA = Motion(root_acceleration=4.5, root_turn_acceleration=15.0, turn_acceleration=30.0, usual_weight=12.0)
SEARCHING_ONE_CAMERA = replace(SEARCHING, usual_weight=10.0)
#: Whoever is lost is brought back by a guess. See docs/benchmarks.md, "The guided Gaussian-process filter".
GUESSING = ProportionalMotion(0.5, 1.3, 1.1, 0.5, 1.0, 0.0, 0.0, 0.0, usual_weight=3.0)
#: Of it, as Sedai et al. (2013) have it: no velocity, nothing usual, and deviations of the largest change between two
#: frames. The place's, the heading's and the knees' are those of a rendered man's jog (2.2 m, 2.7 and 12 rad a second,
#: see `benchmarks/largest_changes.py`); other turns follow in proportion, which is wider than that for the arms.
GUESSING_PRINTED = ProportionalMotion(2.2, 2.7, 5.5, 0.0, 1.0, 0.0, 0.0, 0.0, usual_weight=0.0)


def motion_of(method: str, cameras: int) -> Motion:
    """What was measured to suit the method with so many cameras."""
    if method == "guided":
        return Motion() if cameras > 1 else ONE_CAMERA
    if method == "agp-pf":
        return GUESSING
    return SEARCHING if cameras > 1 else SEARCHING_ONE_CAMERA
