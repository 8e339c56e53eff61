"""How likely a box shows the target, and not the background, and not somebody else: ours, in place of (4.13).

With the printed D = |z - x| / |z - b| whoever is far from the background is as likely as the target: |z - b| in the
denominator grows with |z - x|, and a filter goes over to anybody who crosses. Here both distances are measured in units
of |x - b|, how far the target itself is from the background at that place, and the second only as far as that:

    log p = sum over bands of v (min(|z - b|, |x - b|)^2 - |z - x|^2) / (2 B sigma^2 |x - b|^2)

It is 1 / (2 sigma^2) for the target, minus as much for background, at most 0 for somebody of other colours who is as
far from the target as the background is, and 0 where nothing is seen: behind somebody nearer, whose pixels are not
counted.

==========  ================================================
symbol      name
==========  ================================================
M(.)        ContrastTarget.bins
x, z, b     square roots of a band's shares: of the target, of a candidate in the picture and in the background
v           share of a band's pixels that is in the picture and not hidden
B, sigma    ContrastConfig.bands, ContrastConfig.spread
alpha       ContrastConfig.update_rate
==========  ================================================

Square roots, since |z - x|^2 is then twice 1 - rho of Bhattacharyya's coefficient, and a bin's noise does not grow with
its share. A box is cut into bands, so that a shirt and trousers are not the same the other way round.

Cost: as of `colour_likelihood`, times the number of bands.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from muybridge._kernels.cumulative import CHANNELS, contrast_scores
from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.people.blobs import Mask
from muybridge.people.colour_likelihood import Picture, pixel_boxes
from muybridge.people.histograms import BinMap, Hull, cumulative_map


@dataclass(frozen=True, kw_only=True)
class ContrastConfig:
    """Settings. Three bands and 0.3 were chosen on four rendered clips (seeds 9100 to 9103)."""

    bands: int = 3  # of equal height
    spread: float = 0.3  # sigma, in units of |x - b|
    floor: float = 0.1  # of |x - b|: histograms that differ by less differ by noise
    update_rate: float = 0.05  # alpha, (4.10), per frame
    learn_from: float = 0.8  # share of every band's pixels that must be seen to learn

    def __post_init__(self) -> None:
        shares = self.update_rate, self.learn_from
        if not (self.bands >= 1 and self.spread > 0 and self.floor > 0 and all(0 <= share <= 1 for share in shares)):
            raise InputError("contrast likelihood", expected="bands from 1, spread and floor above 0, update_rate and "
                             "learn_from in 0..1", got=str(self))  # fmt: skip


@dataclass(frozen=True, eq=False)
class ContrastTarget:
    """What a target looks like.

    histogram : (B, 24) float32, shares of each band; each channel's eight sum to 1
    """

    bins: BinMap
    histogram: NDArray[np.float32]
    config: ContrastConfig

    @classmethod
    def learn(cls, picture: Picture, state: FloatArray, config: ContrastConfig | None = None) -> ContrastTarget:
        """From a picture (H, W, 3) uint8, Y Cr Cb, and the box (>= 4,) that holds the target in it."""
        config = config or ContrastConfig()
        left, top, right, bottom = pixel_boxes(np.atleast_2d(state))[0][0]
        bins = BinMap.equalising(picture[max(0, top) : max(0, bottom), max(0, left) : max(0, right)])
        boxes, hull = _bands(np.atleast_2d(state), config.bands)
        return cls(bins, cumulative_map(picture, bins, hull).histograms(boxes[0]), config)

    def observe(self, picture: Picture, background: Picture, shown: Mask | None = None) -> ContrastLikelihood:
        """One frame: picture and background (H, W, 3) uint8, Y Cr Cb; shown (H, W): what nobody nearer covers."""
        return ContrastLikelihood(self, picture, background, shown)

    def updated(self, seen: NDArray[np.float32]) -> ContrastTarget:
        """(4.10), with what was seen (B, 24) at the estimate, see `ContrastLikelihood.histogram`; unless too little."""
        counted = seen.sum(axis=1) / CHANNELS
        if counted.min() < self.config.learn_from:
            return self
        rate = np.float32(self.config.update_rate)
        return replace(self, histogram=(1 - rate) * self.histogram + rate * seen / counted[:, None])


@dataclass(frozen=True, eq=False)
class ContrastLikelihood:
    """One frame, seen with one target in mind."""

    partial: ClassVar[bool] = True
    """Whether it knows what is hidden, and says nothing about it."""
    target: ContrastTarget
    picture: Picture
    background: Picture
    shown: Mask | None

    def log_prob(self, states: FloatArray) -> FloatArray:
        """(N,) of boxes (N, >= 4), against that nothing is known."""
        config, bins = self.target.config, self.target.bins
        boxes, hull = _bands(states, config.bands)
        now, empty = (cumulative_map(image, bins, hull, self.shown) for image in (self.picture, self.background))
        out = np.empty(len(boxes))
        roots = np.sqrt(self.target.histogram)
        contrast_scores(now.table, empty.table, now.left, now.top, boxes, roots, np.float32(config.floor), out)
        return 0.5 * out / config.spread**2

    def likeness(self, state: FloatArray) -> float:
        """0 to 1, of one box (>= 4,): 1 for the target as it was, 0 for background, 1/2 where nothing is seen."""
        return float(np.clip(0.5 + self.target.config.spread**2 * self.log_prob(state[None])[0], 0, 1))

    def histogram(self, state: FloatArray) -> NDArray[np.float32]:
        """(B, 24) of one box (>= 4,): shares of all pixels of each band; what is not seen is missing from the sums."""
        boxes, hull = _bands(np.atleast_2d(state), self.target.config.bands)
        found = cumulative_map(self.picture, self.target.bins, hull, self.shown).histograms(boxes[0])
        height, width = self.picture.shape[:2]
        low, high = np.maximum(boxes[0, :, :2], 0), np.minimum(boxes[0, :, 2:], (width, height))
        inside = np.maximum(0, high - low).prod(axis=1) / np.maximum(
            1, (boxes[0, :, 2:] - boxes[0, :, :2]).prod(axis=1)
        )
        result: NDArray[np.float32] = (found * inside[:, None]).astype(np.float32)
        return result


def _bands(states: FloatArray, count: int) -> tuple[NDArray[np.int64], Hull]:
    """The pixels (N, count, 4) of bands of equal height of boxes (N, >= 4), from above, and what holds them all."""
    bands = np.repeat(states[:, None, :4], count, axis=1)
    bands[:, :, 1] += states[:, None, 3] * ((np.arange(count) + 0.5) / count - 0.5)
    bands[:, :, 3] /= count
    boxes, hull = pixel_boxes(bands.reshape(-1, 4))
    return boxes.reshape(-1, count, 4), hull
