"""One person: a particle filter over the whole body's box, what the person looks like, and for how long unseen."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from muybridge.filters import condensation
from muybridge.filters.particles import FloatArray
from muybridge.filters.state import State
from muybridge.people.box import BoxMotion, CountConfig, adapted_count
from muybridge.people.colour_likelihood import ColourConfig, ColourTarget, Picture
from muybridge.people.evidence import Evidence, Together
from muybridge.people.ground import GroundScale

FILTER = condensation.Config(estimate="mean", resampling="systematic", particles=600)


@dataclass(frozen=True, eq=False)
class Frame:
    """What a frame shows: picture and background (H, W, 3) uint8 in Y Cr Cb, and the foreground not yet explained."""

    picture: Picture
    background: Picture
    evidence: Evidence


@dataclass(eq=False)
class Person:
    """A person who is followed."""

    identity: int
    state: State
    target: ColourTarget
    born: int
    seen: int = 1  # frames
    unseen: int = 0  # frames in a row
    hidden: int = 0
    doubled: int = 0
    confirmed: bool = False
    visible: float = 1.0
    filled: float = 1.0
    track: list[tuple[int, FloatArray, float]] = field(default_factory=list)

    @property
    def box(self) -> FloatArray:
        """(6,) the estimate."""
        return self.state.estimate


def start(rng, identity, frame_number, box, frame, motion, colour: ColourConfig, speed_sd=3.0) -> Person:
    """All particles at one place, with velocities drawn at random (4.1.1)."""
    sd = np.array([1.0, 1.0, 1.0, 1.0, speed_sd, speed_sd])
    state = condensation.init(rng, box, sd, FILTER, motion.lower, motion.upper)
    return Person(identity, state, ColourTarget.learn(frame.picture, box, colour), frame_number)


def follow(
    rng: np.random.Generator, person: Person, frame: Frame, motion: BoxMotion, ground: GroundScale | None,
    counts: CountConfig, others=(),
) -> None:
    """One frame of the person's filter."""
    config = replace(FILTER, particles=adapted_count(person.state.log_weights, counts))
    height = float(ground.height(person.box[1:2] + person.box[3] / 2)[0])
    area = ground.aspect * height**2
    colour = person.target.observe(frame.picture, frame.background)
    cues = [frame.evidence.observe(area, others), *([ground] if ground else [])]
    predicted = person.box.copy()
    predicted[:2] += predicted[4:]
    visible, _ = frame.evidence.seen(predicted)
    if visible > 0.6:
        cues.append(colour)
    person.state, info = condensation.step(rng, person.state, Together(tuple(cues)), motion, config)
    person.visible, person.filled = frame.evidence.seen(person.box)
    if person.visible > 0.8 and person.filled > 0.3:
        person.target = person.target.updated(colour.histogram(person.box))
