from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from muybridge._kernels.occupancy import fill_sums, silhouette_scores
from muybridge.filters.particles import FloatArray
from muybridge.filters.state import Likelihood
from muybridge.people.colour_likelihood import pixel_boxes
from muybridge.people.histograms import Hull


@dataclass(frozen=True, kw_only=True)
class ForegroundConfig:
    """Settings of the foreground's likelihood."""

    outside: float = 0.05  # q: share elsewhere, near people
    looks: float = 15.0  # independent looks at a box
    core: float = 0.8  # share of a box's width that surely hides what is behind it
    shared: float = 0.3  # what a pixel counts that lies where somebody else behind is expected


@dataclass(frozen=True, eq=False)
class Silhouette:
    share: FloatArray  # (rows, columns)

    def gains(self, outside):
        p = np.clip(self.share, 0.03, 0.95)
        return np.log(p / outside), np.log((1 - p) / (1 - outside))

    @property
    def mean(self): return float(self.share.mean())

    @classmethod
    def flat(cls, rows=8, columns=5, share=0.55):
        return cls(np.full((rows, columns), share))

    @classmethod
    def learn(cls, blobs, ground, shape, rows=8, columns=5):
        full = np.zeros((rows, columns)); n = 0
        for b in blobs:
            l, t, w, h = b.box
            if l <= 0 or t <= 0 or l + w >= shape[0] or t + h >= shape[1]: continue
            e = float(ground.height(np.array([t + h - 0.5]))[0])
            if abs(h / e - 1) > 0.12 or not 0.6 < w / (ground.aspect * h) < 1.3: continue
            cx = l + np.nonzero(b.mask)[1].mean(); ww = ground.aspect * h
            ys, xs = np.nonzero(b.mask)
            r = np.clip((ys * rows / h).astype(int), 0, rows - 1)
            c = np.floor((xs + l + 0.5 - (cx + 0.5 - ww / 2)) / ww * columns).astype(int)
            k = (c >= 0) & (c < columns)
            np.add.at(full, (r[k], c[k]), rows * columns / (ww * h)); n += 1
        print('silhouette of', n)
        return cls(np.minimum(1, full / max(n, 1)))


def core(state: FloatArray, share: float) -> tuple[slice, slice]:
    """Rows and columns of the middle of a box (>= 4,)."""
    x, y, width, height = state[:4]
    left, top, right, bottom = np.maximum(0, pixel_boxes(np.array([[x, y, share * width, height]]))[0][0])
    return slice(top, bottom), slice(left, right)


class Evidence:
    """One frame's foreground, as far as it is not explained by those who stand nearer."""

    def __init__(self, mask, config: ForegroundConfig, silhouette, hidden=None):
        self.mask, self.config, self.silhouette = mask, config, silhouette
        self.gain, self.cost = silhouette.gains(config.outside)
        self.weights = np.ones(mask.shape, np.float32)
        if hidden is not None:
            self.weights[hidden] = 0

    def explain(self, state: FloatArray) -> None:
        """What this box (>= 4,) covers, but for its margins, says nothing about those behind it."""
        self.weights[core(state, self.config.core)] = 0

    def seen(self, state: FloatArray) -> tuple[float, float]:
        """Of a box (>= 4,): the share of it that is visible, and the share of that which is foreground."""
        left, top, right, bottom = np.maximum(pixel_boxes(np.atleast_2d(state))[0][0], 0)
        visible, mask = self.weights[top:bottom, left:right] > 0, self.mask[top:bottom, left:right]
        area, count = max(1.0, float(state[2] * state[3])), int(visible.sum())
        return count / area, int((visible & mask).sum()) / max(1, count)

    def observe(self, area: float, others) -> ForegroundLikelihood:
        """For a person whose box is expected to have so many pixels."""
        return ForegroundLikelihood(self, self.config.looks / area, tuple(core(o, self.config.core) for o in others))


@dataclass(frozen=True, eq=False)
class ForegroundLikelihood:
    """A copy of nothing: the evidence must not change while it is asked."""

    evidence: Evidence
    scale: float
    others: tuple
    _sums: list[tuple[NDArray[np.float64], int, int]] = field(default_factory=list, init=False, repr=False)

    def log_prob(self, states: FloatArray) -> FloatArray:
        """(N,) of boxes (N, >= 4)."""
        boxes, hull = pixel_boxes(states)
        table, left, top = self._sums_of(hull)
        out = np.empty(len(boxes))
        silhouette_scores(table, left, top, np.ascontiguousarray(states), self.evidence.gain, self.evidence.cost, out)
        return self.scale * out

    def _sums_of(self, hull: Hull) -> tuple[NDArray[np.float64], int, int]:
        height, width = self.evidence.mask.shape
        left, top, right, bottom = max(0, hull[0]), max(0, hull[1]), min(width, hull[2]), min(height, hull[3])
        if self._sums:
            table, x, y = self._sums[0]
            if x <= left and y <= top and right <= x + table.shape[1] - 1 and bottom <= y + table.shape[0] - 1:
                return self._sums[0]
        right, bottom = max(left, right), max(top, bottom)
        table = np.empty((bottom - top + 1, right - left + 1, 2))
        part = self.evidence.weights[top:bottom, left:right].copy()
        claimed = np.zeros(part.shape, bool)
        for rows, columns in self.others:
            claimed[max(0, rows.start - top) : max(0, rows.stop - top), max(0, columns.start - left) : max(0, columns.stop - left)] = True
        part[claimed] *= np.float32(self.evidence.config.shared)
        fill_sums(np.ascontiguousarray(self.evidence.mask[top:bottom, left:right]), part, table)
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
