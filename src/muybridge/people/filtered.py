"""A box that is followed by a particle filter, and what it looks like; and what a frame shows."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from muybridge.filters import condensation
from muybridge.filters.particles import FloatArray
from muybridge.filters.schedule import exponent_for_survival, powered
from muybridge.filters.state import Likelihood, State
from muybridge.people.box import SPEED_X, BoxMotion, CountConfig, Y, adapted_count
from muybridge.people.colour_likelihood import ColourConfig, ColourTarget, Picture
from muybridge.people.contrast_likelihood import ContrastConfig, ContrastTarget
from muybridge.people.evidence import Evidence

Colour = ColourConfig | ContrastConfig
Target = ColourTarget | ContrastTarget
"""By (4.13), the thesis'; or in units of the target's own contrast, ours. What is configured decides."""

FILTER = condensation.Config(estimate="mean", resampling="systematic", particles=600)
"""(4.5) is the mean; the comb adds less variance than (4.8), (4.9) with independent numbers."""
SURVIVAL = 0.1
"""Share of the particles that goes on, at least. Where a sharp likelihood leaves one or two of them, nothing selects
the velocities any more: they wander off, and the box with them. Flattened by a power, it leaves more."""
START_SD = 1.0  # pixels: where somebody new is


@dataclass(frozen=True, eq=False)
class Frame:
    """What a frame shows: its number, picture and background (H, W, 3) uint8 in Y Cr Cb, and the foreground."""

    number: int
    picture: Picture
    background: Picture
    evidence: Evidence


@dataclass(eq=False)
class Filtered:
    """A box and what it looks like."""

    state: State
    target: Target

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
        cls,
        rng: np.random.Generator,
        box: FloatArray,
        frame: Frame,
        motion: BoxMotion,
        colour: Colour,
        speed_sd: float,
    ) -> Filtered:
        """All particles at one place (>= 4,), with velocities drawn at random (4.1.1): `speed_sd`, pixels per frame."""
        mean = np.concatenate([box[:SPEED_X], np.zeros(2)])
        sd = np.array([START_SD] * 4 + [speed_sd] * 2)
        state = condensation.init(rng, mean, sd, FILTER, motion.lower, motion.upper)
        return cls(state, learn(frame.picture, mean, colour))

    def place(self, rng: np.random.Generator, box: FloatArray, motion: BoxMotion) -> None:
        """Put all particles at one place (>= 4,), at rest; what it looks like is kept."""
        mean = np.concatenate([box[:SPEED_X], np.zeros(2)])
        sd = np.array([START_SD] * 4 + [0.0] * 2)
        self.state = condensation.init(rng, mean, sd, FILTER, motion.lower, motion.upper)

    def step(self, rng: np.random.Generator, likelihood: Likelihood, motion: BoxMotion, counts: CountConfig) -> None:
        """One frame, with as many particles as the last weights ask for (4.18)."""
        config = replace(FILTER, particles=adapted_count(self.state.log_weights, counts))
        self.state, _ = condensation.step(rng, flattened(self.state), likelihood, motion, config)


def flattened(state: State) -> State:
    """With weights so even that `SURVIVAL` of the particles go on."""
    exponent = exponent_for_survival(state.log_weights, SURVIVAL, highest=1.0)
    return replace(state, log_weights=powered(state.log_weights, exponent))


def learn(picture: Picture, box: FloatArray, colour: Colour) -> Target:
    """What a box (>= 4,) of a picture (H, W, 3) uint8, Y Cr Cb, looks like."""
    if isinstance(colour, ContrastConfig):
        return ContrastTarget.learn(picture, box, colour)
    return ColourTarget.learn(picture, box, colour)
