"""One person followed by colours alone, as the thesis does: by parts, with failure detection and repair, or by one box.

`tracker` follows bodies by the foreground and parts on them. Here the body is where the parts say it is, until the
foreground shows that they are lost: this is what the thesis' experiments measure, and what failure detectors are
trained on (Zhao 2009, ch. 4, 5). `BodyAlone` is what they are compared with in Fig. 6.15 (d): a single box, followed
as a part is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from muybridge.filters.particles import FloatArray
from muybridge.people.filtered import Filtered, Frame
from muybridge.people.part_filters import SPEED_SD, PartRules, Parts, Unknown
from muybridge.people.person import TRUST_WHOLE
from muybridge.people.repair import in_sight


@dataclass(eq=False)
class PartsAlone:
    """A person without a body of their own.

    body : (6,) centre, size and velocity per frame, as the parts have it
    size : (2,) width and height when the parts were cut last
    """

    parts: Parts
    body: FloatArray
    size: FloatArray

    @classmethod
    def start(cls, rng: np.random.Generator, body: FloatArray, frame: Frame, rules: PartRules) -> PartsAlone | None:
        """Cut a body (>= 4,) that is clear to see; None where that cannot be done."""
        parts = Parts.start(rng, body, frame, rules)
        return None if parts is None else cls(parts, np.concatenate([body[:4], np.zeros(2)]), body[2:4])

    def step(self, frame: Frame, again: Frame | None = None) -> FloatArray:
        """One frame: (3, 5) of the parts, see `Parts.follow`; they are mended as soon as the person is in sight.

        again : the frame as those see it who place lost parts anew, where they know less of whose foreground is whose
        """
        expected = self.body.copy()
        expected[:2] += expected[4:]
        found = self.parts.follow(expected, frame, frame.evidence.seen(expected)[0] >= TRUST_WHOLE)
        again = again or frame
        place = in_sight(np.concatenate([expected[:2], self.size]), again)
        if place is not None and self.parts.mend(place, again).all():
            self.size = place[2:]
        self.body = body_of(self.parts, expected)
        return found

    @property
    def states(self) -> FloatArray:
        """(3, 6) of the parts."""
        return self.parts.states


@dataclass(eq=False)
class BodyAlone:
    """A person who is one box; nothing is told of failures, and nothing is repaired."""

    box: Filtered
    rules: PartRules
    rng: np.random.Generator

    @classmethod
    def start(cls, rng: np.random.Generator, body: FloatArray, frame: Frame, rules: PartRules) -> BodyAlone:
        """From a body (>= 4,) that is clear to see."""
        speed_sd = SPEED_SD * float(body[3])
        return cls(Filtered.start(rng, body, frame, rules.motion, rules.colour, speed_sd), rules, rng)

    def step(self, frame: Frame) -> None:
        """One frame: colours while enough can be seen, else the dynamics alone, and nothing is learnt (5.4)."""
        colour = self.box.target.observe(frame.picture, frame.background)
        trusted = frame.evidence.seen(self.box.expected)[0] >= TRUST_WHOLE
        self.box.step(self.rng, colour if trusted else Unknown(), self.rules.motion, self.rules.counts)
        if trusted:
            self.box.target = self.box.target.updated(colour.histogram(self.body))

    @property
    def body(self) -> FloatArray:
        """(6,) the estimate."""
        return self.box.box

    @property
    def states(self) -> FloatArray:
        """(1, 6) of the box."""
        return self.body[None]


def body_of(parts: Parts, expected: FloatArray) -> FloatArray:
    """(6,) the body that parts lie on: the median of what each says, of the shape that is expected (>= 4,).

    The median, so that one part that failed does not move it.
    """
    states, shares = parts.states, parts.shares
    height = float(np.median(states[:, 3] / shares[:, 3]))
    sides = np.array([expected[2] / expected[3] * height, height])
    centre = np.median(states[:, :2] - shares[:, :2] * sides, axis=0)
    return np.concatenate([centre, sides, np.median(states[:, 4:], axis=0)])
