"""A mixture of Gaussians for each pixel (Zhao 2009, section 2.1; Stauffer and Grimson 1999): MBM in the thesis.

Each pixel has up to K components. A colour that is near one moves it (2.3, 2.4) and adds to its weight (2.5); a colour
that is near none becomes a component in place of the lightest. What is seen often is background: the components that
come first by weight over standard deviation and hold `portion` of the weight. A person who stays is seen often too, and
becomes background within 1 / update_rate pictures: `spatial` is for that.

=======  =============================================================
symbol   name
=======  =============================================================
K        `components`
alpha    `update_rate`, and 1 / n for the first pictures
rho      `update_rate` over the component's weight
=======  =============================================================

Differences from the papers: covariances are diagonal; the component nearest by Mahalanobis distance matches, not the
first by weight; rho is alpha over the weight, which makes mean and variance those of the pictures that matched, where
alpha times the density as printed lets nothing move; variances have a floor; densities fall as exp(-d^2 / 2) up to
four standard deviations and slower beyond, so that far colours keep their order; (2.2) is printed with the covariance
for its inverse. `portion=1` scores by all components, as (2.1) is printed.

Cost: O(K) a pixel.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from muybridge._kernels.mixture import (
    MOST_SLOTS,
    calm_deviations,
    mixture_look,
    mixture_nearest,
    mixture_scores,
    mixture_update,
)
from muybridge.errors import InputError
from muybridge.segmentation.cleaning import check_squares, close_open
from muybridge.segmentation.pictures import check_same_shape, learn_each


@dataclass(frozen=True)
class ComponentsConfig:
    """Settings of every pixel's mixture, shared by the models that are made of them."""

    components: int = 6
    """K, 1 to 8 (thesis: 6)."""
    update_rate: float = 0.002
    """alpha of (2.5), 0..1: the share of the newest picture in the weights of a pixel's components."""
    match: float = 2.5
    """Standard deviations, root mean square over the channels, up to which a colour matches (Stauffer and Grimson)."""
    portion: float = 0.95
    """Share of the weight that the background's components hold, in (0, 1]."""
    sd_floor: float = 2.0
    """Grey values of 255: the least standard deviation."""
    first_sd: float = 15.0
    """Grey values: the standard deviation of a new component."""
    closing: int = 3
    """Pixels: side of the square by which the mask is closed; 1 leaves it out (thesis, 6.1: 3)."""
    opening: int = 5
    """Pixels: side of the square by which it is then opened (thesis: 5)."""

    def __post_init__(self) -> None:
        what = f"{self._name} background"
        if not 1 <= self.components <= MOST_SLOTS:
            raise InputError(f"{what} components", expected=f"1 to {MOST_SLOTS}", got=str(self.components))
        for name in ("update_rate", "portion"):
            if not 0 < getattr(self, name) <= 1:
                raise InputError(f"{what} {name}", expected="above 0, at most 1", got=f"{getattr(self, name):g}")
        for name in ("match", "sd_floor", "first_sd"):
            if not 0 < getattr(self, name) < np.inf:
                raise InputError(f"{what} {name}", expected="above 0", got=f"{getattr(self, name):g}")
        check_squares(what, self.closing, self.opening)

    @property
    def _name(self) -> str:
        """The model's, for messages."""
        return type(self).__name__.removesuffix("Config").lower()


@dataclass(frozen=True)
class MixtureConfig(ComponentsConfig):
    """Settings of the mixture model: those of the components."""


class Look(NamedTuple):
    """A picture as the mixtures see it; densities are those of the background, over that of evenly spread colours."""

    nearest: NDArray
    """(H, W) int8: the component that matches; -1 for none."""
    squares: NDArray
    """(H, K, W) float32: squared distances from each component."""
    heights: NDArray
    """(H, K, W) float32: densities at the means; 0 of what is no background."""
    densities: NDArray
    """(H, K, W) float32, of each component."""
    alone: NDArray
    """(H, W) float32: (2.1), all by their weights."""


class PixelMixtures:
    """The components of every pixel, and how they learn; shared by the models that are made of them.

    Attributes
    ----------
    weights : (H, K, W) float32; 0 where there is no component
    means, variances : (H, K, C, W) float32, grey values and their squares
    kept : (H, W) uint8, a bit for each component that counts as background
    matched, fresh : (H, W) int8: which component the last picture matched, which slot it made anew; -1 for none
    seen : pictures learnt
    """

    def __init__(self, shape: tuple[int, ...], config: ComponentsConfig) -> None:
        height, width, channels = shape
        slots = config.components
        self.config, self.seen = config, 0
        self.weights = np.zeros((height, slots, width), np.float32)
        self.means = np.zeros((height, slots, channels, width), np.float32)
        self.variances = np.ones_like(self.means)
        self.kept = np.zeros((height, width), np.uint8)
        self.matched, self.fresh = np.full((height, width), -1, np.int8), np.full((height, width), -1, np.int8)
        self._known = np.zeros((height, width), bool)

    @property
    def shape(self) -> tuple[int, ...]:
        """(H, W, C) of the pictures."""
        height, _, channels, width = self.means.shape
        return height, width, channels

    def nearest(self, picture: NDArray) -> NDArray:
        """(H, W) int8: the component that each pixel of a picture matches; -1 for none."""
        out = np.empty(self.kept.shape, np.int8)
        mixture_nearest(picture, self.weights, self.means, self.variances, self._limit, out)
        return out

    def look(self, picture: NDArray) -> Look:
        """What each pixel of a picture matches, and how well all components of the background explain it."""
        size = self.kept.shape
        squares, heights, densities = (np.empty_like(self.weights) for _ in range(3))
        out = Look(np.empty(size, np.int8), squares, heights, densities, np.empty(size, np.float32))
        mixture_look(picture, self.weights, self.means, self.variances, self.kept, self._limit, *out)
        return out

    @property
    def _limit(self) -> float:
        """Squared Mahalanobis distance up to which a component matches."""
        return self.config.match**2 * self.shape[2]

    def score(self, picture: NDArray) -> NDArray:
        """(H, W) float32, nats: -log of (2.1) over evenly spread colours."""
        out = np.empty(self.kept.shape, np.float32)
        mixture_scores(picture, self.weights, self.means, self.variances, self.kept, out)
        return out

    def calm_deviations(self, picture: NDArray, calm: float, floor: float) -> NDArray:
        """(H, W) float32, standard deviations of at least `floor`, grey values: how far each pixel is from its heaviest
        component, the largest over the channels; 0 where that has less of the weight than `calm`."""
        out = np.empty(self.kept.shape, np.float32)
        calm_deviations(picture, self.weights, self.means, self.variances, calm, floor**2, out)
        return out

    def learn(self, picture: NDArray, nearest: NDArray, learnt: NDArray) -> NDArray:
        """Learn where `learnt` (H, W) bool; returns where the picture matched what was background before it.

        nearest : (H, W) int8: what the picture matches, as the model is now
        """
        config = self.config
        self.seen += 1
        mixture_update(
            picture, learnt, nearest, self.weights, self.means, self.variances, self.kept,
            rate=max(config.update_rate, 1.0 / self.seen), floor=config.sd_floor**2, wide=config.first_sd**2,
            portion=config.portion, matched=self.matched, fresh=self.fresh, background=self._known,
        )  # fmt: skip
        return self._known

    @property
    def background(self) -> NDArray:
        """(H, W, C) float32: the mean of each pixel's heaviest component."""
        return self.heaviest((slice(None), slice(None)))[0]

    def heaviest(self, at: tuple[slice, slice]) -> tuple[NDArray, NDArray]:
        """Mean and deviation of the heaviest component at some rows and columns, (R, Q, C) float32 grey values."""
        rows, columns = at
        heaviest = self.weights[rows, :, columns].argmax(axis=1)[:, None, None]
        mean, variance = (
            np.take_along_axis(of[rows, :, :, columns], heaviest, axis=1)[:, 0].transpose(0, 2, 1)
            for of in (self.means, self.variances)
        )
        return mean, np.sqrt(variance)


class MixtureBackground:
    """Foreground is what matches no component of the background; every picture is learnt, wherever people are."""

    def __init__(self, shape: tuple[int, ...], config: MixtureConfig | None = None) -> None:
        self.config = config or MixtureConfig()
        self.mixtures = PixelMixtures(shape, self.config)
        self._everything = np.ones(shape[:2], bool)

    @classmethod
    def train(cls, pictures: Iterable[NDArray], config: MixtureConfig | None = None) -> MixtureBackground:
        """Learn from pictures, each (H, W) or (H, W, 3) uint8, all of one size; people may pass through."""
        return learn_each(pictures, lambda shape: cls(shape, config))

    @property
    def background(self) -> NDArray:
        """(H, W, C) float32: what each pixel mostly looks like."""
        return self.mixtures.background

    def learn(self, image: NDArray) -> None:
        """Learn a picture of the size and channels the model was made for."""
        self._learn(self._checked(image))

    def score(self, image: NDArray) -> NDArray:
        """(H, W) float32, nats: by how much evenly spread colours explain each pixel better; learns nothing."""
        return self.mixtures.score(self._checked(image))

    def apply(self, image: NDArray) -> NDArray:
        """Foreground (H, W) bool; learns the picture."""
        return close_open(~self._learn(self._checked(image)), self.config.closing, self.config.opening)

    def _learn(self, picture: NDArray) -> NDArray:
        return self.mixtures.learn(picture, self.mixtures.nearest(picture), self._everything)

    def _checked(self, image: NDArray) -> NDArray:
        return check_same_shape(image, self.mixtures.shape)
