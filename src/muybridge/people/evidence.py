"""What a frame's foreground says about boxes: a person fills a good part of a box, and nothing is left around it.

With p the share of foreground inside a person's box and q outside, a box's log likelihood ratio is
sum over its pixels of log p / q where there is foreground and log (1 - p) / (1 - q) where there is none. What a nearer
person or a known obstacle covers says nothing: 0. Neighbouring pixels tell much the same, so the sum counts as so many
independent looks at the whole box.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from muybridge._kernels.occupancy import box_sums, fill_sums
from muybridge.filters.particles import FloatArray
from muybridge.filters.state import Likelihood
from muybridge.people.colour_likelihood import pixel_boxes
from muybridge.people.histograms import Hull


@dataclass(frozen=True, kw_only=True)
class ForegroundConfig:
    """Settings of the foreground's likelihood."""

    inside: float = 0.55  # p: share of a person's box that is foreground
    outside: float = 0.05  # q: share elsewhere, near people
    looks: float = 40.0  # independent looks at a box
    core: float = 0.8  # share of a box's width that surely hides what is behind it
    shared: float = 0.3  # what a pixel counts that lies where somebody else behind is expected

    @property
    def gain(self) -> float:
        """Of a pixel of foreground."""
        return float(np.log(self.inside / self.outside))

    @property
    def cost(self) -> float:
        """Of a pixel of background, below 0."""
        return float(np.log((1 - self.inside) / (1 - self.outside)))


def core(state: FloatArray, share: float) -> tuple[slice, slice]:
    """Rows and columns of the middle of a box (>= 4,)."""
    x, y, width, height = state[:4]
    left, top, right, bottom = np.maximum(0, pixel_boxes(np.array([[x, y, share * width, height]]))[0][0])
    return slice(top, bottom), slice(left, right)


class Evidence:
    """One frame's foreground, as far as it is not explained by those who stand nearer."""

    def __init__(self, mask: NDArray[np.bool_], config: ForegroundConfig, hidden: NDArray[np.bool_] | None = None):
        self.mask, self.config = mask, config
        self.values = np.where(mask, np.float32(config.gain), np.float32(config.cost))
        self.visible = np.ones(mask.shape, bool) if hidden is None else ~hidden
        self.values[~self.visible] = 0

    def explain(self, state: FloatArray) -> None:
        """What this box (>= 4,) covers, but for its margins, says nothing about those behind it."""
        place = core(state, self.config.core)
        self.values[place] = 0
        self.visible[place] = False

    def seen(self, state: FloatArray) -> tuple[float, float]:
        """Of a box (>= 4,): the share of it that is visible, and the share of that which is foreground."""
        left, top, right, bottom = np.maximum(pixel_boxes(np.atleast_2d(state))[0][0], 0)
        visible, mask = self.visible[top:bottom, left:right], self.mask[top:bottom, left:right]
        area, count = max(1.0, float(state[2] * state[3])), int(visible.sum())
        return count / area, int((visible & mask).sum()) / max(1, count)

    def observe(self, area: float, others) -> ForegroundLikelihood:
        """For a person whose box is expected to have so many pixels."""
        return ForegroundLikelihood(self.values, self.config.looks / area, tuple(core(o, self.config.core) for o in others), self.config.shared)


@dataclass(frozen=True, eq=False)
class ForegroundLikelihood:
    """A copy of nothing: the evidence must not change while it is asked."""

    values: NDArray[np.float32]
    scale: float
    others: tuple
    shared: float
    _sums: list[tuple[NDArray[np.float64], int, int]] = field(default_factory=list, init=False, repr=False)

    def log_prob(self, states: FloatArray) -> FloatArray:
        """(N,) of boxes (N, >= 4)."""
        boxes, hull = pixel_boxes(states)
        table, left, top = self._sums_of(hull)
        out = np.empty(len(boxes))
        box_sums(table, left, top, boxes, out)
        return self.scale * out

    def _sums_of(self, hull: Hull) -> tuple[NDArray[np.float64], int, int]:
        height, width = self.values.shape
        left, top, right, bottom = max(0, hull[0]), max(0, hull[1]), min(width, hull[2]), min(height, hull[3])
        if self._sums:
            table, x, y = self._sums[0]
            if x <= left and y <= top and right <= x + table.shape[1] - 1 and bottom <= y + table.shape[0] - 1:
                return self._sums[0]
        right, bottom = max(left, right), max(top, bottom)
        table = np.empty((bottom - top + 1, right - left + 1))
        part = self.values[top:bottom, left:right].copy()
        claimed = np.zeros(part.shape, bool)
        for rows, columns in self.others:
            claimed[max(0, rows.start - top) : max(0, rows.stop - top), max(0, columns.start - left) : max(0, columns.stop - left)] = True
        part[claimed] *= np.float32(self.shared)
        fill_sums(part, table)
        self._sums[:] = [(table, left, top)]
        return self._sums[0]


@dataclass(frozen=True, eq=False)
class Together:
    """Cues that are independent given the box: their log likelihoods add up."""

    cues: tuple[Likelihood, ...]

    def log_prob(self, states: FloatArray) -> FloatArray:
        """(N,) of boxes (N, >= 4)."""
        total = np.zeros(len(states))
        for cue in self.cues:
            total += cue.log_prob(states)
        return total
