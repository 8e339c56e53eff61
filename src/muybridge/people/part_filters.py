"""Head, torso and hip-leg, each followed by its own colour filter, and repaired (Zhao 2009, ch. 4 and 5).

They know nothing of each other until one is lost; `arrangement` has them as one state.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from muybridge.filters.particles import FloatArray
from muybridge.people.blobs import Blob
from muybridge.people.box import BoxMotion, CountConfig
from muybridge.people.evidence import middle
from muybridge.people.failure import FailureDetector, History
from muybridge.people.filtered import Colour, Filtered, Frame
from muybridge.people.parts import PARTS, PartConfig, decompose
from muybridge.people.repair import FEWEST, mended

SPEED_SD = 0.04  # of the body's height per frame, at the start


class Unknown:
    """Nothing can be seen: every box is as likely as any other, and the dynamics alone move them (5.4)."""

    def log_prob(self, states: FloatArray) -> FloatArray:
        """(N,) zeros."""
        return np.zeros(len(states))


@dataclass(frozen=True, eq=False)
class PartRules:
    """How parts are cut, followed and repaired; the same for everybody.

    detector : FailureDetector or None
        What says that one of those that go where their colours are must be repaired; None: nothing is.
    """

    motion: BoxMotion
    counts: CountConfig
    colour: Colour
    cut: PartConfig
    frame_rate: float
    detector: FailureDetector | None = None


@dataclass(eq=False)
class Parts:
    """The three filters.

    shares : (3, 4) float64, centre from the body's and size, as shares of the body's sides
    features : (36,) float64 or None, what a failure detector is asked about; None where there are not enough frames
    """

    filters: list[Filtered]
    shares: FloatArray
    rules: PartRules
    rng: np.random.Generator
    history: History
    features: FloatArray | None = None
    repairs: int = 0

    @classmethod
    def start(cls, rng: np.random.Generator, body: FloatArray, frame: Frame, rules: PartRules) -> Parts | None:
        """Cut a body (>= 4,) that is clear to see into three; None where that cannot be done.

        Their random numbers are their own: the body goes where it would without them.
        """
        boxes = cut(body, frame, rules.cut)
        if boxes is None:
            return None
        rng = rng.spawn(1)[0]
        return cls(_filters(rng, boxes, body, frame, rules), shares_of(boxes, body), rules, rng,
                   History(rules.frame_rate))  # fmt: skip

    @property
    def states(self) -> FloatArray:
        """(3, 6) the estimates."""
        return np.array([part.box for part in self.filters])

    def step(self, body: FloatArray, frame: Frame, trusted: bool) -> FloatArray:
        """One frame: (3, 5) centre, size and score of the parts of a body (>= 4,).

        trusted : bool
            Whether colours are the person's own; if not, parts coast, nothing is learnt, and nothing is repaired (5.4).
            Colours that know what is hidden are asked nevertheless.
        """
        found = self.follow(body, frame, trusted)
        if trusted:
            failed = self.mend(body, frame)
            found[failed, :4] = self.states[failed, :4]
            found[failed, 4] = 1.0  # it is what was just learnt
        return found

    def follow(self, body: FloatArray, frame: Frame, trusted: bool) -> FloatArray:
        """The same without repair."""
        found = np.array([self._follow(k, frame, trusted) for k in range(len(PARTS))])
        self.features = self.history.features(self.states, float(body[3]))
        return found

    def mend(self, body: FloatArray, frame: Frame) -> NDArray[np.bool_]:
        """5.4, of a body (>= 4,) in sight: (3,) which parts failed and are placed anew; none, one or all.

        One part by the other two; several by the foreground where the body is. Parts have failed, too, where they hold
        hardly any foreground.
        """
        failed = np.zeros(len(PARTS), bool)
        detector = self.rules.detector
        if detector is None:
            return failed
        if self.features is not None:
            failed |= detector.failed(self.features)
        failed |= [np.prod(frame.evidence.seen(state)) < FEWEST for state in self.states]
        if failed.sum() > 1:
            failed[:] = True
        if failed.any():
            self._repair(failed, body, frame)
        return failed

    def _follow(self, index: int, frame: Frame, trusted: bool) -> FloatArray:
        """(5,) of one part: its filter's step, and what it looks like now."""
        part = self.filters[index]
        colour = part.target.observe(frame.picture, frame.background, frame.evidence.shown)
        seen = colour if trusted or colour.partial else Unknown()
        part.step(self.rng, seen, self.rules.motion, self.rules.counts)
        score = colour.likeness(part.box)
        if trusted:
            part.target = part.target.updated(colour.histogram(part.box))
        return np.append(part.box[:4], score)

    def _repair(self, failed: NDArray[np.bool_], body: FloatArray, frame: Frame) -> None:
        """5.4: one part from the other two; several from the foreground where the body is."""
        rules = self.rules
        if failed.all():
            boxes = cut(body, frame, rules.cut)
            if boxes is not None:
                self.filters, self.shares = _filters(self.rng, boxes, body, frame, rules), shares_of(boxes, body)
        else:
            index = int(failed.argmax())
            self.filters[index] = mended(self.filters, index, body, frame, rules.cut, rules.colour)
        self.repairs += 1
        self.history.forget()


def cut(body: FloatArray, frame: Frame, config: PartConfig) -> FloatArray | None:
    """The parts' boxes (3, 6) of the foreground in a body's box (>= 4,); None where it cannot be cut."""
    rows, columns = middle(body, 1.0)
    mask = frame.evidence.mask[rows, columns]
    return decompose(frame.picture, Blob(columns.start, rows.start, mask), config) if mask.any() else None


def shares_of(boxes: FloatArray, body: FloatArray) -> FloatArray:
    """(3, 4) where boxes (3, >= 4) are on a body (>= 4,): from its centre, and their size, as shares of its sides."""
    return (boxes[:, :4] - _centre(body)) / _sides(body)


def boxes_of(shares: FloatArray, body: FloatArray) -> FloatArray:
    """(3, 4) the inverse: where parts with these shares (3, 4) are on a body (>= 4,)."""
    return shares * _sides(body) + _centre(body)


def _filters(
    rng: np.random.Generator, boxes: FloatArray, body: FloatArray, frame: Frame, rules: PartRules
) -> list[Filtered]:
    speed_sd = SPEED_SD * float(body[3])
    return [Filtered.start(rng, boxes[k], frame, rules.motion, rules.colour, speed_sd) for k in range(len(PARTS))]


def _sides(body: FloatArray) -> FloatArray:
    return np.array([body[2], body[3], body[2], body[3]])


def _centre(body: FloatArray) -> FloatArray:
    return np.array([body[0], body[1], 0.0, 0.0])
