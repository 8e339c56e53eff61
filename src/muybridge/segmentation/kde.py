"""Kernel density of recent colours at each pixel (Elgammal, Duraiswami, Harwood and Davis 2002).

Each pixel keeps N recent colours. How likely a new one is, is the mean over them of a product of normal kernels, one a
channel (their 2), whose width comes from how much the pixel changes from one picture to the next. Nothing is assumed
about the number of modes. What is unlikely is foreground, unless it has only moved there from beside.

=====================  ==========================================================
symbol                 name
=====================  ==========================================================
N                      `samples`
sigma_j                median |x_i - x_i+1| / (0.68 sqrt 2), for each channel
th                     `threshold`, as nats
P_N, P_C, th1, th2     displacement of a pixel, of a component; `displacement`
=====================  ==========================================================

False detections: a foreground pixel is dropped where its colour is likely at some pixel within `radius` (P_N > th1),
and where so is the whole component that it belongs to (P_C = product of P_N > th2).

Differences from the paper: densities are measured against evenly spread colours, so that a threshold means the same
whatever the number of channels, and th2 = 1 asks whether the component is explained better by having moved than by
chance; samples are taken as pairs of consecutive pictures with `every` between them, so that N of them reach further
back and their differences are still those between consecutive pictures; medians of whole grey values are
interpolated; kernels fall slower than a normal density beyond four widths. Colours are B, G, R, not chromaticities:
shadows are left to `muybridge.segmentation.shadows`. There is one model, updated selectively (their short-term model)
with a patience after which foreground is learnt too, where they intersect it with a second one that learns
everything. A large component is asked at one pixel in sixteen whether it has moved.

Cost: O(N) a pixel, less where a few samples already decide.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from muybridge._kernels.kernel_density import (
    density,
    displaced_density,
    kernel_table,
    learn_bandwidths,
    learn_samples,
)
from muybridge._kernels.mixture import LEAST
from muybridge.errors import InputError
from muybridge.segmentation.cleaning import check_squares, close_open
from muybridge.segmentation.gate import Gate, check_patience
from muybridge.segmentation.pictures import check_same_shape, learn_each

REFRESH = 32
"""Pictures in which the bandwidths of all rows are measured again, some rows at each."""
MOST_SAMPLES = 255
LARGE, STRIDE = 200, 4
"""Pixels from which on a component is asked at every fourth pixel of every fourth row whether it has moved."""


@dataclass(frozen=True)
class KdeConfig:
    """Settings of the kernel density model."""

    samples: int = 50
    """N, 2 to 255, an even number."""
    every: int = 10
    """Pictures from one sample to the next, on average."""
    threshold: float = 4.0
    """Nats by which evenly spread colours explain a foreground pixel better, at least."""
    displacement: float = 0.0
    """Nats, th1: a pixel may be dropped whose colour beside it is better explained than by this."""
    radius: int = 2
    """Pixels: how far a background pixel may have moved (their neighbourhood has a diameter of 5); 0 drops nothing."""
    patience: int = 3600
    """Pictures after which foreground is learnt; 0 learns everything at once."""
    rest: int = 50
    """Pictures after which foreground that does not move is learnt; 0: not for that."""
    closing: int = 3
    """Pixels: as of the mixture model, whose mask is cleaned the same way."""
    opening: int = 5
    """Likewise."""

    def __post_init__(self) -> None:
        if not 2 <= self.samples <= MOST_SAMPLES or self.samples % 2:
            raise InputError("kde background samples", expected=f"an even number, 2 to {MOST_SAMPLES}",
                             got=str(self.samples))  # fmt: skip
        if self.every < 1 or self.radius < 0:
            raise InputError("kde background", expected="every 1 or more, radius 0 or more",
                             got=f"{self.every} and {self.radius}")  # fmt: skip
        if not (np.isfinite(self.threshold) and np.isfinite(self.displacement)):
            raise InputError("kde background thresholds", expected="numbers of nats",
                             got=f"{self.threshold:g} and {self.displacement:g}")  # fmt: skip
        check_patience("kde background", self.patience, self.rest)
        check_squares("kde background", self.closing, self.opening)


class KdeBackground:
    """N recent colours of every pixel.

    Attributes
    ----------
    samples : (H, W, N, C) uint8; of each pixel the first `counts` (H, W) uint8 are filled
    levels : (H, W, C) uint8: bandwidths, as indices into `_kernels.kernel_density.bandwidths()`
    """

    def __init__(self, shape: tuple[int, ...], config: KdeConfig | None = None) -> None:
        self.config = config or KdeConfig()
        height, width, channels = shape
        self.samples = np.zeros((height, width, self.config.samples, channels), np.uint8)
        self.counts, self._heads = np.zeros((height, width), np.uint8), np.zeros((height, width), np.uint8)
        self.levels = np.zeros((height, width, channels), np.uint8)
        self._table, self._seen = kernel_table(), 0
        self._lattice = np.zeros((height, width), bool)
        self._lattice[::STRIDE, ::STRIDE] = True
        self._gate, self._everything = (
            Gate((height, width), self.config.patience, self.config.rest),
            np.ones((height, width), bool),
        )

    @classmethod
    def train(cls, pictures: Iterable[NDArray], config: KdeConfig | None = None) -> KdeBackground:
        """Learn from pictures, each (H, W) or (H, W, 3) uint8, all of one size."""
        return learn_each(pictures, lambda shape: cls(shape, config))

    @property
    def background(self) -> NDArray:
        """(H, W, C) float32: the median of each pixel's samples."""
        filled = int(self.counts.max(initial=1))
        return np.median(self.samples[:, :, :filled], axis=2).astype(np.float32)

    def learn(self, image: NDArray) -> None:
        """Learn a picture."""
        self._learn(self._checked(image), self._everything)

    def score(self, image: NDArray) -> NDArray:
        """(H, W) float32, nats: by how much evenly spread colours explain each pixel better; learns nothing."""
        return -np.log(np.maximum(self._density(self._checked(image)), np.float32(LEAST)))

    def apply(self, image: NDArray) -> NDArray:
        """Foreground (H, W) bool; learns the background of the picture."""
        picture = self._checked(image)
        limit = np.exp(-self.config.threshold)
        mask = self._density(picture, limit) <= limit
        if self.config.radius:
            mask = self._without_displaced(picture, mask)
        mask = close_open(mask, self.config.closing, self.config.opening)
        self._learn(picture, self._gate.learnt(mask, picture))
        return mask

    def _density(self, picture: NDArray, enough: float = np.inf) -> NDArray:
        out = np.empty(picture.shape[:2], np.float32)
        density(picture, self.samples, self.counts, self.levels, self._table, out, enough)
        return out

    def _without_displaced(self, picture: NDArray, mask: NDArray) -> NDArray:
        """The mask without pixels, and components, whose colours are at home beside them."""
        import cv2

        count, label, stats, _ = cv2.connectedComponentsWithStats(mask.view(np.uint8), connectivity=8)
        asked = mask & ((stats[:, cv2.CC_STAT_AREA] < LARGE)[label] | self._lattice)
        beside = np.empty(mask.shape, np.float32)
        displaced_density(
            picture, asked, self.samples, self.counts, self.levels, self._table, self.config.radius, beside
        )
        gain = np.where(asked, np.log(np.maximum(beside, np.float32(LEAST))), 0.0)
        whole = np.bincount(label.ravel(), weights=gain.ravel(), minlength=count)
        return mask & ~((~asked | (gain > -self.config.displacement)) & (whole > 0)[label])

    def _learn(self, picture: NDArray, learnt: NDArray) -> None:
        """Take the picture where its turn has come: two in a row, then none for a while; the first N all."""
        turn = self._seen % (2 * self.config.every) < 2
        if turn or self._seen < 2 * self.config.samples:
            learn_samples(picture, learnt, self.samples, self.counts, self._heads)
        learn_bandwidths(self.samples, self.counts, self._seen % REFRESH, REFRESH, self.levels)
        self._seen += 1

    def _checked(self, image: NDArray) -> NDArray:
        return np.ascontiguousarray(check_same_shape(image, (*self.counts.shape, self.samples.shape[3])))
