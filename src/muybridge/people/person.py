"""One person: a particle filter over the body's box, one over each of three parts, and what the person looks like.

Every frame: foreground, colour and the ground say how likely each particle is; `filters.condensation` does the rest.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from muybridge.filters import condensation
from muybridge.filters.particles import FloatArray
from muybridge.filters.state import Likelihood, State
from muybridge.people.box import HEIGHT, SPEED_X, X, Y, BoxMotion, CountConfig, adapted_count
from muybridge.people.colour_likelihood import ColourConfig, ColourTarget, Picture
from muybridge.people.evidence import Evidence, Together
from muybridge.people.ground import GroundScale
from muybridge.people.identity import Look

FILTER = condensation.Config(estimate="mean", resampling="systematic", particles=600)
"""(4.5) is the mean; the comb adds less variance than (4.8), (4.9) with independent numbers."""
START_SD, START_SPEED_SD = 1.0, 3.0  # pixels, pixels per frame: where somebody new is, and what speeds are tried
TRUST_COLOUR = 0.6  # share of the box that must be visible: below, the histogram is of somebody else
LEARN_COLOUR = 0.8
ENOUGH_LOOKS = 4  # frames


@dataclass(frozen=True, eq=False)
class Frame:
    """What a frame shows: its number, picture and background (H, W, 3) uint8 in Y Cr Cb, and the foreground."""

    number: int
    picture: Picture
    background: Picture
    evidence: Evidence


@dataclass(frozen=True, eq=False)
class Sighting:
    """A person in one frame: the body's box (6,), how much of it could be seen, and whether it was."""

    frame: int
    box: FloatArray
    score: float
    seen: bool


@dataclass(eq=False)
class Filtered:
    """A box and what it looks like."""

    state: State
    target: ColourTarget

    @property
    def box(self) -> FloatArray:
        """(6,) the estimate."""
        return self.state.estimate

    @property
    def expected(self) -> FloatArray:
        """(6,) where it is expected in the next frame."""
        ahead = self.box.copy()
        ahead[: Y + 1] += ahead[SPEED_X:]
        return ahead

    @classmethod
    def start(
        cls, rng: np.random.Generator, box: FloatArray, frame: Frame, motion: BoxMotion, colour: ColourConfig
    ) -> Filtered:
        """All particles at one place (>= 4,), with velocities drawn at random (4.1.1)."""
        mean = np.concatenate([box[:SPEED_X], np.zeros(2)])
        sd = np.array([START_SD] * 4 + [START_SPEED_SD] * 2)
        state = condensation.init(rng, mean, sd, FILTER, motion.lower, motion.upper)
        return cls(state, ColourTarget.learn(frame.picture, mean, colour))

    def step(
        self, rng: np.random.Generator, likelihood: Likelihood, motion: BoxMotion, counts: CountConfig
    ) -> None:
        """One frame, with as many particles as the last weights ask for (4.18)."""
        config = replace(FILTER, particles=adapted_count(self.state.log_weights, counts))
        self.state, _ = condensation.step(rng, self.state, likelihood, motion, config)


@dataclass(eq=False)
class Person:
    """Somebody who is followed.

    seen : int, frames in which enough was seen, in all; unseen, hidden, doubled : int, frames in a row in which nothing
    was, in which somebody nearer or an occluder covered the box, in which somebody else had nearly the same box.
    """

    identity: int
    body: Filtered
    colour: ColourConfig
    confirmed: bool = False
    seen: int = 1
    unseen: int = 0
    hidden: int = 0
    doubled: int = 0
    visible: float = 1.0
    filled: float = 1.0
    sightings: list[Sighting] = field(default_factory=list)
    look: Look | None = None
    looks: int = 0
    last_clear: Sighting | None = None

    @property
    def missing(self) -> int:
        """Frames in a row without a sight of them."""
        return self.unseen + self.hidden

    @property
    def is_known(self) -> bool:
        """Whether their look was learnt from enough frames to tell them from others."""
        return self.confirmed and self.looks >= ENOUGH_LOOKS

    def remember(self, picture: Picture, number: int) -> None:
        """Learn what they look like; only while they are clear to see."""
        box = self.body.box
        self.look = Look.learn(picture, box, self.colour) if self.look is None else self.look.updated(picture, box)
        self.looks += 1
        self.last_clear = self.sightings[-1]

    def likeness(self, picture: Picture, other: Person) -> float:
        """Squared distance of what they look like to what is seen where another is."""
        return np.inf if self.look is None else self.look.distance(picture, other.body.box)


def follow(
    rng: np.random.Generator,
    body: Filtered,
    frame: Frame,
    motion: BoxMotion,
    counts: CountConfig,
    ground: GroundScale | None,
    behind: list[FloatArray],
) -> tuple[float, float]:
    """One frame of a body's filter; how much of the box can be seen, and how much of that is foreground.

    behind : boxes (>= 4,) of others, expected further away
    """
    colour = body.target.observe(frame.picture, frame.background)
    cues: list[Likelihood] = [frame.evidence.observe(usual_area(body.box, ground), behind)]
    if ground is not None:
        cues.append(ground)
    if frame.evidence.seen(body.expected)[0] >= TRUST_COLOUR:
        cues.append(colour)
    body.step(rng, Together(tuple(cues)), motion, counts)
    visible, filled = frame.evidence.seen(body.box)
    if visible >= LEARN_COLOUR and filled >= 0.5 * frame.evidence.silhouette.mean:
        body.target = body.target.updated(colour.histogram(body.box))
    return visible, filled


def usual_area(box: FloatArray, ground: GroundScale | None) -> float:
    """Pixels of a person's box who stands where this one (>= 4,) does; its own where nothing is known of the ground."""
    if ground is None:
        return float(box[2] * box[HEIGHT])
    height = float(ground.height(feet(box)))
    return ground.aspect * height * height


def feet(box: FloatArray) -> float:
    """Row of the feet of a box (>= 4,)."""
    return float(box[Y] + box[HEIGHT] / 2)


def nearness(person: Person) -> tuple[bool, float, float]:
    """Sorts from near to far: those who are sure first, then by where the feet are expected."""
    return not person.confirmed, -feet(person.body.expected), float(person.body.box[X])
