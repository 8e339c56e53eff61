"""What a frame's foreground says about boxes: a person fills a box as people do, and nothing is left around it.

With p the share of foreground in a cell of a person's box (`silhouette`) and q outside, the log likelihood ratio of a
box is the sum over its pixels of log p / q where there is foreground and of log (1 - p) / (1 - q) where there is none.
What a nearer person or an occluder covers says nothing, and what is seen of people further away is as good as
background (`appearance` says whose a pixel is). Neighbouring pixels tell much the same, so that the sum counts as so
many independent looks at a whole box.

Not in Zhao (2009), where the foreground starts and restarts people, and between that they are followed by colour alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from muybridge._kernels.occupancy import fill_sums, silhouette_scores
from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.filters.state import Likelihood
from muybridge.people.appearance import claims
from muybridge.people.blobs import Mask
from muybridge.people.colour_likelihood import pixel_boxes
from muybridge.people.histograms import Hull, inside
from muybridge.people.silhouette import Silhouette

AROUND = 0.2  # of a box's size: how far an outline may be larger
HIDES = 0.5  # probability that a pixel is a nearer one's, from which on it says nothing of others
SCRAP = 0.02  # of the largest region: what is smaller is noise; feet are more, where legs above them are missing
NEIGHBOURS = 0.3  # of a person's height: whose box is further away has no part in what is seen of them
RIM = 3  # pixels round somebody: masks miss so much beside what hides them
PIECE = 0.2  # of the largest piece of somebody: what is smaller and apart from it is none
Place = tuple[slice, slice]
"""Rows and columns."""


@dataclass(frozen=True, kw_only=True)
class ForegroundConfig:
    """Settings of the foreground's likelihood."""

    outside: float = 0.05  # q: share of foreground where nobody is, near people
    looks: float = 40.0  # independent looks at a box; 25 to 60 were alike on real people, 8 and 90 worse
    core: float = 0.8  # share of a box's width that surely hides what is behind it
    shared: float = 0.3  # how far a pixel counts where somebody else, further away, is expected

    def __post_init__(self) -> None:
        if not (0 < self.outside < 1 and self.looks > 0 and 0 < self.core <= 1 and 0 <= self.shared <= 1):
            raise InputError("foreground", expected="outside in (0, 1), looks above 0, core and shared in 0..1",
                             got=f"{self.outside}, {self.looks}, {self.core}, {self.shared}")  # fmt: skip


@dataclass(frozen=True, eq=False)
class Claim:
    """Where somebody is, or is expected (>= 4,), and densities (BANDS, CODES) of their colours, where known."""

    box: FloatArray
    colours: NDArray[np.float32] | None = None


@dataclass(frozen=True, eq=False)
class Region:
    """Foreground that hangs together.

    box : (4,) centre, width, height
    filled : share of the box that is foreground
    open : share of the pixels just around it which hide nothing
    """

    box: FloatArray
    filled: float
    open: float = 1.0

    @property
    def pixels(self) -> float:
        """Of the foreground."""
        return self.filled * float(self.box[2] * self.box[3])


class Evidence:
    """One frame's foreground, as far as those who stand nearer do not explain it already.

    mask : (H, W) bool
    codes : (H, W) int16 of `colour_codes`, where colours are reckoned with
    share : (H, W) float32, how far each pixel is foreground that may be the person's
    weights : (H, W) float32, how far it counts; shown : (H, W) bool, where that is at least half
    """

    def __init__(
        self,
        mask: Mask,
        silhouette: Silhouette,
        config: ForegroundConfig | None = None,
        hidden: Mask | None = None,
        codes: NDArray[np.int16] | None = None,
    ) -> None:
        self.config, self.codes = config or ForegroundConfig(), codes
        self.mask, self.silhouette = np.ascontiguousarray(mask), silhouette
        self.gain, self.cost = silhouette.ratios(self.config.outside)
        self.share = self.mask.astype(np.float32)
        self.weights = np.ones(mask.shape, np.float32)
        if hidden is not None:
            if hidden.shape != mask.shape:
                raise InputError("occluders", expected=f"the masks' {mask.shape}", got=str(hidden.shape))
            self.weights[hidden] = 0
        self._open = self.weights.copy()
        self.shown = self.weights > 0

    def of(self, person: Claim, nearer: Sequence[Claim], further: Sequence[Claim]) -> Evidence:
        """As it is for one person, among others whose boxes are nearer and further away.

        What looks like a nearer one counts as hidden, and what looks like one further away as seen past the person.
        """
        view = copy(self)
        view.weights, view.share = self._open.copy(), self.share.copy()
        for other in nearer:
            view._hide(person, other)
        for other in further:
            view._see_past(person, other)
        view.shown = view.weights > 0.5
        return view

    def _hide(self, person: Claim, other: Claim) -> None:
        """Take off what shows somebody nearer: all of their middle, where it is not known what both look like."""
        core, place = middle(other.box, self.config.core), middle(other.box, 1.0)
        if self.codes is None or person.colours is None or other.colours is None:
            self.weights[core] = 0
        elif self.mask[place].size:
            whose = claims(self.codes, place, (other.box, other.colours), (person.box, person.colours), self.silhouette)
            self.weights[core] *= self.mask[core]
            self.weights[place] *= np.where(self.mask[place], np.where(whose < HIDES, 1 - whose, 0), 1)

    def _see_past(self, person: Claim, other: Claim) -> None:
        """What shows somebody further away is as good as background; or tells less, where looks are not known."""
        core, place = middle(other.box, self.config.core), middle(other.box, 1.0)
        if self.codes is None or person.colours is None or other.colours is None:
            self.weights[core] *= np.float32(self.config.shared)
        elif self.mask[place].size:
            self.share[place] *= claims(
                self.codes, place, (person.box, person.colours), (other.box, other.colours), self.silhouette
            )

    def explain(self, state: FloatArray, share: float | None = None) -> None:
        """What the middle of this box (>= 4,) covers says nothing about those behind it."""
        place = middle(state, self.config.core if share is None else share)
        self.weights[place] = 0
        self.shown[place] = False

    def seen(self, state: FloatArray) -> tuple[float, float]:
        """Of a box (>= 4,): the share of it that can be seen, and the share of that which is foreground."""
        place = middle(state, 1.0)
        visible = self.shown[place]
        count = int(np.count_nonzero(visible))
        full = int(np.count_nonzero(visible & (self.share[place] > 0.5)))
        return count / max(1.0, float(state[2] * state[3])), full / max(1, count)

    def outline(self, state: FloatArray) -> FloatArray | None:
        """(4,) centre, width, height of the foreground in and just around a box (>= 4,), without scraps.

        None where there is none, or where it goes on beyond the picture.
        """
        import cv2

        rows, columns = middle(state[:4] * np.array([1, 1, 1 + AROUND, 1 + AROUND]), 1.0)
        part = np.ascontiguousarray(self.mask[rows, columns], dtype=np.uint8)
        _, labels, regions, _ = cv2.connectedComponentsWithStats(part, connectivity=8)
        areas = regions[1:, cv2.CC_STAT_AREA]
        if not areas.size:
            return None
        kept = np.concatenate([[False], areas >= SCRAP * areas.max()])[labels]
        y, x = np.flatnonzero(kept.any(axis=1)) + rows.start, np.flatnonzero(kept.any(axis=0)) + columns.start
        low, high = np.array([x[0], y[0]]), np.array([x[-1], y[-1]])
        if (low == 0).any() or (high == np.array(self.mask.shape[::-1]) - 1).any():
            return None
        return np.concatenate([(low + high) / 2, high - low + 1.0])

    def region(self, state: FloatArray) -> Region | None:
        """The foreground that may be the person's and hangs together with what is in a box (>= 4,).

        None where there is none, or where it goes on beyond the picture or twice the box's height away.
        """
        import cv2

        x, y, width, height = state[:4]
        rows, columns = middle(np.array([x, y, width + 4 * height, 3 * height]), 1.0)
        part = np.ascontiguousarray((self.share[rows, columns] > 0.5) & self.shown[rows, columns], dtype=np.uint8)
        inner_rows, inner_columns = middle(state, 1.0)
        _, labels, regions, _ = cv2.connectedComponentsWithStats(part, connectivity=8)
        inside = labels[inner_rows.start - rows.start : inner_rows.stop - rows.start,
                        inner_columns.start - columns.start : inner_columns.stop - columns.start]  # fmt: skip
        counts = np.bincount(inside.ravel(), minlength=len(regions))
        counts[0] = 0
        if not counts.any():
            return None
        pieces = counts >= PIECE * counts.max()
        kept = regions[pieces]
        low, high = kept[:, :2].min(axis=0), (kept[:, :2] + kept[:, 2:4]).max(axis=0)
        own = pieces[labels].view(np.uint8)
        rim = cv2.dilate(own, np.ones((2 * RIM + 1,) * 2, np.uint8)) > own
        if (low <= 0).any() or (high >= part.shape[::-1]).any():
            return None
        place = (low + high - 1) / 2 + (columns.start, rows.start)
        filled, clear = kept[:, 4].sum() / (high - low).prod(), self.shown[rows, columns][rim].mean()
        return Region(np.concatenate([place, high - low]).astype(np.float64), float(filled), float(clear))

    def observe(self, area: float) -> ForegroundLikelihood:
        """For a person whose box is expected to have so many pixels."""
        return ForegroundLikelihood(self, self.config.looks / area)


@dataclass(frozen=True, eq=False)
class ForegroundLikelihood:
    """One frame, seen with one person in mind, as long as the evidence stays as it is."""

    evidence: Evidence
    scale: float
    _sums: list[tuple[NDArray[np.float64], Hull]] = field(default_factory=list, init=False, repr=False)

    def log_prob(self, states: FloatArray) -> FloatArray:
        """(N,) of boxes (N, >= 4), against that nobody is there."""
        table, part = self._sums_of(inside(pixel_boxes(states)[1], self.evidence.mask.shape))
        out = np.empty(len(states))
        states = np.ascontiguousarray(states, dtype=np.float64)
        silhouette_scores(table, part[0], part[1], states, self.evidence.gain, self.evidence.cost, out)
        return self.scale * out

    def _sums_of(self, hull: Hull) -> tuple[NDArray[np.float64], Hull]:
        """The table over a part of the picture that holds all boxes, made when first asked for."""
        if not (self._sums and _holds(self._sums[0][1], hull)):
            left, top, right, bottom = hull
            part = slice(top, bottom), slice(left, right)
            table = np.empty((bottom - top + 1, right - left + 1, 2))
            fill_sums(self.evidence.share[part], self.evidence.weights[part], table)
            self._sums[:] = [(table, hull)]
        return self._sums[0]


@dataclass(frozen=True, eq=False)
class Together:
    """Cues that are independent given the box: their log likelihoods add up."""

    cues: tuple[Likelihood, ...]

    def log_prob(self, states: FloatArray) -> FloatArray:
        """(N,) of boxes (N, >= 4)."""
        return np.sum([cue.log_prob(states) for cue in self.cues], axis=0)


def touching(person: Claim, others: Sequence[Claim]) -> list[Claim]:
    """Those whose boxes may meet the person's, wherever in its reach it is."""
    reach = 0.5 * person.box[2:4] + NEIGHBOURS * person.box[3]
    return [other for other in others if (np.abs(other.box[:2] - person.box[:2]) < reach + 0.5 * other.box[2:4]).all()]


def middle(state: FloatArray, share: float) -> Place:
    """The rows of a box (>= 4,) and the middle `share` of its columns, from the picture's first ones on."""
    x, y, width, height = state[:4]
    _, (left, top, right, bottom) = pixel_boxes(np.array([[x, y, share * width, height]]))
    return slice(max(0, top), max(0, bottom)), slice(max(0, left), max(0, right))


def _holds(outer: Hull, inner: Hull) -> bool:
    return outer[0] <= inner[0] and outer[1] <= inner[1] and outer[2] >= inner[2] and outer[3] >= inner[3]
