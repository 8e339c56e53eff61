"""What the regressor sees of a silhouette: the lowest frequencies of its cropped picture (Sedai 2013, section III-A).

The silhouette's box is cut out and brought to 64 x 128 pixels; of that picture's discrete cosine transform (1) the
8 x 8 lowest coefficients are kept. They do not change with the person's place and size in the picture, and assume a
person who stands upright in it.

==========  ==========================================
symbol      name
==========  ==========================================
W, H        width and height of the picture, pixels
f_p, g_q    rows of `cosines(W, .)` and `cosines(H, .)`
M(p, q)     Descriptor.values, q down, then p across
==========  ==========================================

Differences from the paper
    None in `PRINTED`. `frame = "height"` scales both sides by the factor that makes the height 128, and lays the
    silhouette into a square with its centroid in the middle: a stretched arm then squeezes nothing else, and how wide
    the person looks is kept. `values = "distance"` transforms the signed distance to the silhouette's border, positive
    inside, cut off at `REACH`, in place of ones and zeros: thin limbs weigh more, and a border that moves by a pixel
    changes every value by as little.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray

WIDTH, HEIGHT = 64, 128  # pixels; section III-A
SQUARE = 96  # pixels: with stretched arms a person is about as wide as tall; what is wider is cut off
REACH = 12.0  # pixels of the picture that is transformed, beyond which distances are all the same
MARGIN = 6  # pixels around the silhouette before distances are taken, so that it has a border all round


@dataclass(frozen=True)
class DescriptorConfig:
    """How a silhouette becomes numbers."""

    frame: Literal["box", "height"] = "box"  # what is brought to its size: both sides, or the height alone
    values: Literal["mask", "distance"] = "mask"  # ones and zeros, or signed distances to the border
    coefficients: int = 8  # kept in each direction; section III-A

    def __post_init__(self) -> None:
        if self.frame not in ("box", "height"):
            raise InputError("descriptor frame", expected="box | height", got=repr(self.frame))
        if self.values not in ("mask", "distance"):
            raise InputError("descriptor values", expected="mask | distance", got=repr(self.values))
        if not 1 <= self.coefficients <= WIDTH:
            raise InputError("descriptor coefficients", expected=f"1 to {WIDTH}", got=str(self.coefficients))

    @property
    def size(self) -> int:
        """How many numbers there are."""
        return self.coefficients**2


PRINTED = DescriptorConfig()
# Held-out people on rendered walking and jogging: the joints of the most probable pose are off by 67 mm, by 80 as
# printed (both with 8 clusters); see `docs/benchmarks.md`, "From silhouette to pose".
WORKING = DescriptorConfig(frame="height", values="distance", coefficients=10)


@dataclass(frozen=True, eq=False)
class Descriptor:
    """A silhouette as numbers.

    Attributes
    ----------
    values : (coefficients^2,) float64
    box : (int, int, int, int), pixels of the mask
        Left, top, right, bottom of the silhouette; right and bottom are outside.
    touches_border : bool
        The silhouette reaches the mask's border: part of the person may be outside, and the guess worth little.
    """

    values: FloatArray
    box: tuple[int, int, int, int]
    touches_border: bool

    @property
    def centre(self) -> FloatArray:
        """(2,) float64, pixels of the mask (x, y): the middle of the box."""
        left, top, right, bottom = self.box
        return np.array([left + right - 1, top + bottom - 1]) / 2.0


def describe(mask: NDArray[np.bool_], config: DescriptorConfig = WORKING) -> Descriptor:
    """The descriptor of a mask.

    Parameters
    ----------
    mask : (H, W) bool
        Cleaned: everything in it is taken for the person.

    Raises
    ------
    InputError
        The mask is empty. One that touches the border is described as it is, and flagged.
    """
    import cv2

    if mask.ndim != 2 or mask.dtype != np.bool_:
        raise InputError("mask to describe", expected="shape (H, W), bool", got=f"{mask.shape}, {mask.dtype}")
    pixels = np.ascontiguousarray(mask).view(np.uint8)
    left, top, width, height = cv2.boundingRect(pixels)
    if width == 0 or height == 0:
        raise InputError("mask to describe", expected="a silhouette", got="no foreground pixel")
    box = (left, top, left + width, top + height)
    touches = left == 0 or top == 0 or box[2] == mask.shape[1] or box[3] == mask.shape[0]
    picture = FRAMES[config.frame](pixels[top : box[3], left : box[2]])
    if config.values == "distance":
        picture = _signed_distance(picture)
    return Descriptor(_transformed(picture, config.coefficients).ravel(), box, touches)


def cosines(length: int, count: int) -> FloatArray:
    """(count, length): alpha_p cos(p pi (x + 0.5) / length), the orthonormal rows of (1)."""
    p, x = np.arange(count)[:, None], np.arange(length)[None]
    alpha = np.sqrt((1 + np.minimum(p, 1)) / length)
    rows: FloatArray = alpha * np.cos(p * np.pi * (x + 0.5) / length)
    return rows


_cosines = lru_cache(maxsize=32)(cosines)


def _transformed(picture: NDArray, count: int) -> FloatArray:
    """(count, count): the lowest coefficients of (1); a frequency down a row, across a column."""
    down, across = _cosines(picture.shape[0], count), _cosines(picture.shape[1], count)
    lowest: FloatArray = down @ picture.astype(np.float64) @ across.T
    return lowest


def _by_box(silhouette: NDArray) -> NDArray:
    """(HEIGHT, WIDTH) float32 in 0-1: both sides stretched."""
    import cv2

    return cv2.resize(silhouette.astype(np.float32), (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA)


def _by_height(silhouette: NDArray) -> NDArray:
    """(SQUARE, SQUARE) float32 in 0-1: both sides scaled alike, the centroid's column in the middle."""
    import cv2

    factor = SQUARE / silhouette.shape[0]
    width = max(1, round(silhouette.shape[1] * factor))
    scaled = cv2.resize(silhouette.astype(np.float32), (width, SQUARE), interpolation=cv2.INTER_AREA)
    columns = scaled.sum(axis=0)
    first = round(SQUARE / 2 - 0.5 - float(columns @ np.arange(width)) / float(columns.sum()))
    picture = np.zeros((SQUARE, SQUARE), np.float32)
    start, stop = max(0, first), min(SQUARE, first + width)
    picture[:, start:stop] = scaled[:, start - first : stop - first]
    return picture


def _signed_distance(picture: NDArray) -> NDArray:
    """(H + 2 MARGIN, W + 2 MARGIN) float32, pixels: to the border, positive inside, at most REACH."""
    import cv2

    inside = np.pad((picture > 0.5).astype(np.uint8), MARGIN)
    distance = cv2.distanceTransform(inside, cv2.DIST_L2, 3) - cv2.distanceTransform(1 - inside, cv2.DIST_L2, 3)
    return np.clip(distance, -REACH, REACH)


FRAMES = {"box": _by_box, "height": _by_height}
