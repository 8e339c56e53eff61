"""Head, torso and hip-leg, each followed by its own colour filter, within reach of the body (Zhao 2009, ch. 4 and 5).

Differences from the paper: each part is expected where it was on the body when the parts were cut, so that one that
loses its colours stays on the body; the paper lets them go and repairs them afterwards (5.3, 5.4).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from muybridge.filters.particles import FloatArray
from muybridge.filters.state import Likelihood
from muybridge.people.blobs import Blob
from muybridge.people.box import BoxMotion, CountConfig
from muybridge.people.colour_likelihood import ColourConfig
from muybridge.people.evidence import Together, middle
from muybridge.people.filtered import Filtered, Frame
from muybridge.people.parts import PartConfig, decompose

PLACE_SD = 0.04  # of the body's height: how far a part moves on the body from frame to frame, and with the gait
SIZE_SD = 0.15  # of its own size
SPEED_SD = 0.04  # of the body's height per frame, at the start


@dataclass(frozen=True, eq=False)
class OnBody:
    """Where on a body a part is expected: its box (4,) there, and the body's height, pixels."""

    part: FloatArray
    height: float

    def log_prob(self, states: FloatArray) -> FloatArray:
        """(N,) of a part's boxes (N, >= 4), up to a constant."""
        place = (states[:, :2] - self.part[:2]) / (PLACE_SD * self.height)
        size = (states[:, 2:4] / self.part[2:4] - 1) / SIZE_SD
        return -0.5 * (np.square(place).sum(axis=1) + np.square(size).sum(axis=1))


@dataclass(eq=False)
class Parts:
    """The three filters.

    shares : (3, 4) float64, centre from the body's and size, as shares of the body's sides
    """

    filters: tuple[Filtered, ...]
    shares: FloatArray
    rng: np.random.Generator

    @classmethod
    def start(
        cls,
        rng: np.random.Generator,
        body: FloatArray,
        frame: Frame,
        motion: BoxMotion,
        colour: ColourConfig,
        config: PartConfig,
    ) -> Parts | None:
        """Cut a body (>= 4,) that is clear to see into three; None where that cannot be done.

        Their random numbers are their own: the body goes where it would without them.
        """
        rows, columns = middle(body, 1.0)
        mask = frame.evidence.mask[rows, columns]
        boxes = decompose(frame.picture, Blob(columns.start, rows.start, mask), config) if mask.any() else None
        if boxes is None:
            return None
        sides = np.array([body[2], body[3], body[2], body[3]])
        shares = (boxes[:, :4] - [body[0], body[1], 0, 0]) / sides
        rng = rng.spawn(1)[0]
        speed_sd = SPEED_SD * float(body[3])
        filters = tuple(Filtered.start(rng, box, frame, motion, colour, speed_sd) for box in boxes)
        return cls(filters, shares, rng)

    def step(self, body: FloatArray, frame: Frame, motion: BoxMotion, counts: CountConfig, trusted: bool) -> FloatArray:
        """One frame: (3, 5) centre, size and score of the parts of a body (>= 4,).

        trusted : bool
            Whether colours are the person's own; if not, parts go with the body, and nothing is learnt.
        """
        found = np.empty((3, 5))
        sides = np.array([body[2], body[3], body[2], body[3]])
        for row, part, share in zip(found, self.filters, self.shares):
            expected = share * sides + [body[0], body[1], 0, 0]
            colour = part.target.observe(frame.picture, frame.background)
            cues: list[Likelihood] = [OnBody(expected, float(body[3])), *([colour] if trusted else [])]
            part.step(self.rng, Together(tuple(cues)), motion, counts)
            row[:4], row[4] = part.box[:4], np.exp(colour.log_prob(part.box[None])[0])
            if trusted:
                part.target = part.target.updated(colour.histogram(part.box))
        return found
