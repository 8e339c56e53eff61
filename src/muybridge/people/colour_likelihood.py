"""How likely a box shows the target: its colours near the target's and far from the background's (Zhao 2009, 4.2).

One frame's observation: `target.observe(picture, background)` -> an object with `log_prob(states)`.

==========  ================================================
symbol      name
==========  ================================================
M(.)        ColourTarget.bins
x_t, H_t    ColourTarget.histogram
z_t, b_t    a candidate's histogram, in the picture and in the background
alpha       ColourConfig.update_rate
Sigma       ColourConfig.spread ^ 2, one number since D is one
==========  ================================================

Differences from the paper: the denominator of (4.13) has a floor - a box of pure background has z = b up to noise, and
without a floor that noise decides which of them is least bad; Sigma, of which the paper gives no value, was measured.

Cost: two cumulative maps of the part of the picture that holds all boxes, then O(bins) a box.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from muybridge._kernels.cumulative import ratio_distances, round_boxes
from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.people.blobs import Mask
from muybridge.people.histograms import BinMap, CumulativeMap, Hull, cumulative_map

Picture = NDArray[np.uint8]


@dataclass(frozen=True, kw_only=True)
class ColourConfig:
    """Settings of the colour likelihood."""

    spread: float = 0.2  # square root of Sigma, (4.12), in units of D
    floor: float = 0.1  # of |z - b|, (4.13): histograms that differ by less differ by noise
    update_rate: float = 0.05  # alpha, (4.10), per frame
    mapping: bool = True  # edges equalised for the target (4.2.1), or even ones

    def __post_init__(self) -> None:
        if not (self.spread > 0 and self.floor > 0 and 0 <= self.update_rate <= 1):
            raise InputError("colour likelihood", expected="spread and floor above 0, update_rate in 0..1",
                             got=f"{self.spread}, {self.floor}, {self.update_rate}")  # fmt: skip


@dataclass(frozen=True, eq=False)
class ColourTarget:
    """What a target looks like: its bin edges and its histogram.

    histogram : (24,) float32, shares; each channel's eight sum to 1
    """

    bins: BinMap
    histogram: NDArray[np.float32]
    config: ColourConfig

    @classmethod
    def learn(cls, picture: Picture, state: FloatArray, config: ColourConfig | None = None) -> ColourTarget:
        """From a picture (H, W, 3) uint8, Y Cr Cb, and the box (>= 4,) that holds the target in it."""
        config = config or ColourConfig()
        left, top, right, bottom = pixel_boxes(np.atleast_2d(state))[0][0]
        inside = picture[max(0, top) : max(0, bottom), max(0, left) : max(0, right)]
        bins = BinMap.equalising(inside) if config.mapping else BinMap.even()
        histogram = cumulative_map(inside, bins).histograms(np.array([[0, 0, inside.shape[1], inside.shape[0]]]))[0]
        return cls(bins, histogram, config)

    def observe(self, picture: Picture, background: Picture, shown: Mask | None = None) -> ColourLikelihood:
        """One frame: picture and background (H, W, 3) uint8, Y Cr Cb; what is shown is not asked."""
        return ColourLikelihood(self, picture, background)

    def updated(self, seen: NDArray[np.float32]) -> ColourTarget:
        """H_{t+1} = H_t (1 - alpha) + Q_t alpha, (4.10), with the histogram (24,) seen at the estimate."""
        rate = np.float32(self.config.update_rate)
        return replace(self, histogram=(1 - rate) * self.histogram + rate * seen)


@dataclass(frozen=True, eq=False)
class ColourLikelihood:
    """One frame, seen with one target in mind.

    The maps cover the boxes that were asked for first, those of all particles; boxes beyond have them made anew.
    """

    partial: ClassVar[bool] = False
    """Whether it knows what is hidden, and says nothing about it."""
    target: ColourTarget
    picture: Picture
    background: Picture
    _maps: list[CumulativeMap] = field(default_factory=list, init=False, repr=False)

    def distances(self, states: FloatArray) -> FloatArray:
        """D of (4.13), (N,), of boxes (N, >= 4); infinite for one without pixels."""
        boxes, hull = pixel_boxes(states)
        now, empty = self._maps_of(hull)
        out = np.empty(len(boxes))
        floor = np.float32(self.target.config.floor)
        ratio_distances(now.table, empty.table, now.left, now.top, boxes, self.target.histogram, floor, out)
        return out

    def log_prob(self, states: FloatArray) -> FloatArray:
        """-D^2 / (2 Sigma), (4.12) without its constant. states : (N, >= 4); returns (N,)."""
        return -0.5 * np.square(self.distances(states) / self.target.config.spread)

    def likeness(self, state: FloatArray) -> float:
        """0 to 1, of one box (>= 4,): 1 for what looks as the target did."""
        return float(np.exp(self.log_prob(state[None])[0]))

    def histogram(self, state: FloatArray) -> NDArray[np.float32]:
        """(24,) of one box (>= 4,): z, or Q_t of (4.10)."""
        boxes, hull = pixel_boxes(np.atleast_2d(state))
        return self._maps_of(hull)[0].histograms(boxes)[0]

    def _maps_of(self, hull: Hull) -> list[CumulativeMap]:
        """Of picture and background, both over one part that holds `hull` as far as the picture goes."""
        if not (self._maps and self._maps[0].covers(hull, self.picture.shape)):
            self._maps[:] = [cumulative_map(image, self.target.bins, hull) for image in (self.picture, self.background)]
        return self._maps


def updated_background(background: NDArray[np.float32], picture: Picture, rate: float) -> NDArray[np.float32]:
    """B_{t+1} = B_t (1 - beta) + I_t beta, (4.11), pixel by pixel: two arrays (H, W, 3) of one colour space."""
    if not 0 <= rate <= 1:
        raise InputError("background update rate", expected="0..1", got=str(rate))
    result: NDArray[np.float32] = background + np.float32(rate) * (picture.astype(np.float32) - background)
    return result


def pixel_boxes(states: FloatArray) -> tuple[NDArray[np.int64], Hull]:
    """Boxes (N, >= 4), centre and size, as whole pixels (N, 4): left, top, right, bottom; and what holds them all."""
    boxes = np.empty((len(states), 4), np.int64)
    return boxes, round_boxes(np.ascontiguousarray(states, dtype=np.float64), boxes)
