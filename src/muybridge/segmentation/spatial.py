"""Pixels in pairs: the spatially extended background model of Zhao (2009, chapter 3), SBM in the thesis.

Each pixel has a mixture of Gaussians, and for pairs of pixels five apart it is kept how often each combination of
their components was seen. A colour that the pixel knows is background only together with what its partners then show:
a door's colour while the door is shut. (3.1) multiplies the pixel's own density with the joint ones of `partners`
pairs, those of most mutual information (3.8) among eight neighbours.

====================  ========================================================
symbol                name
====================  ========================================================
P(B0 | c0)            the mixture's density, as in `mixture`
P(c0, ci)             joint density (3.2): weights over K x K combinations
w_k1,k2               counts of combinations over their sum; at first none
alpha_c               `update_rate`: covariances are the pixels' own, see below
beta_c                `pair_rate`
Th                    `match`
====================  ========================================================

Differences from the paper:

- A joint covariance is block-diagonal, its blocks being the (diagonal) covariances of the two pixels' components: the
  best joint match (3.4) is then the pair of best matches, and a joint density a product, but for its tail, which is
  that of both distances together (of colour; in grey pictures each has its own). The thesis updates 6 x 6 numbers for
  each of K x K combinations and pair, 0.5 GB at 320 x 240; what that gains is in docs/benchmarks.md.
- (3.6) as printed adds beta_c times two densities, and (3.5) takes nothing from the combinations that did not match, so
  that all weights grow to 1. Here the matched one gains `pair_rate`, 1 / n at first, and all others lose as much (2.5).
- What is foreground is not learnt until it has been foreground for `patience` pictures; with `patience=0` everything is
  learnt, as in the thesis, and who stands still is background soon.
- Light that changes over the whole picture is taken out first (`muybridge.segmentation.light`), unless `light=False`.
- What is beside foreground is not learnt either (`FRINGE`).
- A component counts as background if it is among those that hold `portion` of the weight; `portion=1` takes all.
- P(c0, ci) = P(c0 | ci) P(ci) blames a pixel for a partner in front of which somebody stands, which widens people by
  the distance of the partners, and counts wide shadows twice where a thin limb counts once. -log P(ci) counts up to
  `partner_limit`; infinity is (3.1) as printed.

Cost: O(K^2) for each pair of each pixel to test, as vector code along rows, but for components that none of a row has;
O(pairs) to learn; mutual information is measured for some rows at each picture.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from muybridge._kernels.pairs import choose_partners, pair_scores, pair_update
from muybridge.errors import InputError
from muybridge.segmentation.cleaning import beside, close_open
from muybridge.segmentation.gate import Gate, check_patience
from muybridge.segmentation.light import Light
from muybridge.segmentation.mixture import ComponentsConfig, PixelMixtures
from muybridge.segmentation.pictures import check_same_shape, learn_each

OFFSETS = np.array([(0, 5), (5, 0), (3, 4), (4, -3)], np.int64)
"""(rows, columns), pixels: from a pixel to four of its neighbours; the other four lie opposite. All are 5 away."""
FRINGE = 2
"""Pixels around foreground that are not learnt: the opening has taken people's outlines and limbs off the mask."""
RESELECT = 60
"""Pictures in which the partners of all rows are chosen anew, some rows at each."""


@dataclass(frozen=True)
class SpatialConfig(ComponentsConfig):
    """Settings of the spatial model, beside those of the components; `match` is Th of (3.4) too."""

    portion: float = 0.98
    """Share of the weight that the background's components hold, in (0, 1]."""
    pair_rate: float = 0.002
    """beta_c of (3.6), 0..1: the share of the newest picture in the weights of a pair's combinations."""
    partners: int = 2
    """Pairs that a pixel is judged by, 0 to 8 (thesis: 2)."""
    partner_limit: float = -8.0 / 3.0
    """Nats a channel against evenly spread colours: the most that a partner's own colour may count; infinite in the
    thesis. What the background mostly shows counts -2.7 (noise of 7 grey values) to -3.9 (`sd_floor`)."""
    threshold: float = 0.0
    """Nats by which evenly spread colours explain a foreground pixel better, at least."""
    patience: int = 3600
    """Pictures after which foreground is learnt: two minutes at 30 Hz; 0 learns everything at once."""
    rest: int = 50
    """Pictures after which foreground that does not move is learnt, as a door that was opened; 0: not for that."""
    light: bool = True
    """Take light that changes over the whole picture out before pixels are judged."""

    def __post_init__(self) -> None:
        super().__post_init__()
        what = f"{self._name} background"
        if not 0 < self.pair_rate < 1:
            raise InputError(f"{what} pair_rate", expected="above 0, below 1", got=f"{self.pair_rate:g}")
        if not 0 <= self.partners <= 2 * len(OFFSETS):
            raise InputError(f"{what} partners", expected=f"0 to {2 * len(OFFSETS)}", got=str(self.partners))
        if not self.partner_limit > -np.inf:  # NaN fails too
            raise InputError(f"{what} partner_limit", expected="a number of nats", got=f"{self.partner_limit:g}")
        if not np.isfinite(self.threshold):
            raise InputError(f"{what} threshold", expected="a number of nats", got=f"{self.threshold:g}")
        check_patience(what, self.patience, self.rest)


class SpatialBackground:
    """Mixtures of all pixels, and which components of two pixels are seen together.

    Attributes
    ----------
    mixtures : PixelMixtures
    counts : (H, D, K, K, W) float32, pair, own component, the other's; and their sums totals (D, H, W): pair d of a
        pixel is the one at OFFSETS[d]
    partners : (H, W, M) int8: 2 d for the neighbour at OFFSETS[d], 2 d + 1 for the one opposite, -1 for none
    """

    def __init__(self, shape: tuple[int, ...], config: SpatialConfig | None = None) -> None:
        self.config = config or SpatialConfig()
        height, width = shape[:2]
        self.mixtures = PixelMixtures(shape, self.config)
        slots = self.config.components
        self.counts = np.zeros((height, len(OFFSETS), slots, slots, width), np.float32)
        self.totals = np.zeros((len(OFFSETS), height, width), np.float32)
        self.partners = np.full((height, width, self.config.partners), -1, np.int8)
        self._information = np.zeros_like(self.totals)
        self._gate = Gate((height, width), self.config.patience, self.config.rest)
        self._everything = np.ones((height, width), bool)
        self._light = Light(shape, self.config.match)
        choose_partners(self.counts, OFFSETS, 0, 1, self._information, self.partners)

    @classmethod
    def train(cls, pictures: Iterable[NDArray], config: SpatialConfig | None = None) -> SpatialBackground:
        """Learn from pictures, each (H, W) or (H, W, 3) uint8, all of one size; people may pass through."""
        return learn_each(pictures, lambda shape: cls(shape, config))

    @property
    def background(self) -> NDArray:
        """(H, W, C) float32: what each pixel mostly looks like."""
        return self.mixtures.background

    def learn(self, image: NDArray) -> None:
        """Learn all of a picture."""
        picture = self._followed(self._checked(image))
        self._learn(picture, self.mixtures.nearest(picture), self._everything)

    def score(self, image: NDArray) -> NDArray:
        """(H, W) float32, nats: -log of (3.1) over evenly spread colours; learns nothing."""
        picture = self._checked(image)
        return self._judged(self._light.taken_out(picture, self._field(picture)))[0]

    def apply(self, image: NDArray) -> NDArray:
        """Foreground (H, W) bool; learns the background of the picture."""
        picture = self._followed(self._checked(image))
        score, nearest = self._judged(picture)
        mask = self._cleaned(score > self.config.threshold)
        self._learn_around(mask, picture, nearest)
        return mask

    def _cleaned(self, mask: NDArray) -> NDArray:
        return close_open(mask, self.config.closing, self.config.opening)

    def _learn_around(self, mask: NDArray, picture: NDArray, nearest: NDArray) -> None:
        """Learn what of a picture may be learnt, whose foreground is `mask`."""
        self._learn(picture, nearest, self._gate.learnt(mask, picture) & ~beside(mask, FRINGE))

    def _judged(self, picture: NDArray) -> tuple[NDArray, NDArray]:
        """(H, W) float32, the score; (H, W) int8, the component that each pixel matches."""
        out = np.empty(picture.shape[:2], np.float32)
        look = self.mixtures.look(picture)
        squares, heights = look.squares, look.heights
        if picture.shape[2] == 1:  # densities too low to bear the joint tail: people would be wider by 5 pixels
            squares, heights = np.zeros_like(squares), look.densities
        pair_scores(
            look.alone, squares, heights, look.densities, self.mixtures.kept, self.counts, self.totals, OFFSETS,
            self.partners, self.config.partner_limit * picture.shape[2], out,
        )  # fmt: skip
        return out, look.nearest

    def _learn(self, picture: NDArray, nearest: NDArray, learnt: NDArray) -> None:
        mixtures = self.mixtures
        mixtures.learn(picture, nearest, learnt)
        pair_update(self.counts, self.totals, OFFSETS, mixtures.matched, mixtures.fresh, self.config.pair_rate)
        first = mixtures.seen % RESELECT
        choose_partners(self.counts, OFFSETS, first, RESELECT, self._information, self.partners)

    def _followed(self, picture: NDArray) -> NDArray:
        """The picture as it would look in the light of the background; the next one's is looked for from there."""
        self._light.field = self._field(picture)
        return self._light.taken_out(picture, self._light.field)

    def _field(self, picture: NDArray) -> NDArray:
        """(6, C): the light of a picture over that of the background."""
        if not self.config.light or not self.mixtures.seen:
            return np.zeros_like(self._light.field)
        return self._light.measure(picture, *self.mixtures.heaviest(self._light.lattice))

    def _checked(self, image: NDArray) -> NDArray:
        return np.ascontiguousarray(check_same_shape(image, self.mixtures.shape))
