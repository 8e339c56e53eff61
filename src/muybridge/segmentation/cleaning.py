"""Turn the raw mask into the person: no speckle, no pinholes, and no forearm lost.

"Keep the largest component" cuts off a forearm that a dark sleeve separates from the body. So fragments near the main
component stay: near means a gap of few pixels, and not too small.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError

Box = tuple[float, float, float, float]
"""(left, top, right, bottom), pixels of the mask."""


@dataclass(frozen=True)
class CleaningConfig:
    """Settings of the cleaning, in pixels of the mask (defaults: a person of about 200 to 300 rows)."""

    median: int = 3
    """Side of the median filter, odd; 1 leaves it out."""
    largest_hole: int = 40
    """Holes of up to so many pixels are filled; larger ones may be real (between arm and trunk)."""
    smallest_fragment: int = 20
    """Components of fewer pixels go."""
    gap: float = 15.0
    """Components further than this from the main one go; infinity keeps them all."""

    def __post_init__(self) -> None:
        if self.median < 1 or self.median % 2 == 0:
            raise InputError("cleaning median", expected="an odd number, 1 or more", got=str(self.median))
        if self.largest_hole < 0 or self.smallest_fragment < 0 or self.gap < 0:
            raise InputError("cleaning sizes", expected="0 or more",
                             got=f"{self.largest_hole}, {self.smallest_fragment}, {self.gap:g}")  # fmt: skip


def clean(mask: NDArray, config: CleaningConfig | None = None, box: Box | None = None) -> NDArray:
    """Median, then the main component and the fragments near it that are not too small, then holes.

    Parameters
    ----------
    mask : (H, W) bool
    box : (left, top, right, bottom), pixels, optional
        Where the person is expected: the main component is the one with most pixels inside, instead of the largest.

    Returns
    -------
    (H, W) bool
    """
    config = config or CleaningConfig()
    if config.median > 1:
        mask = median(mask, config.median)
    if np.isfinite(config.gap):
        mask = keep_near_main(mask, config.gap, box, config.smallest_fragment)
    else:
        mask = drop_small(mask, config.smallest_fragment)
    if config.largest_hole and mask.any():
        part = _bounds(mask)
        mask[part] = fill_holes(mask[part], config.largest_hole)
    return mask


def _bounds(mask: NDArray) -> tuple[slice, slice]:
    """Rows and columns of all foreground and one pixel around it: what lies outside cannot change."""

    def span(used: Any) -> slice:
        first, last = int(np.argmax(used)), len(used) - int(np.argmax(used[::-1]))
        return slice(max(0, first - 1), last + 1)

    return span(mask.any(axis=1)), span(mask.any(axis=0))


def median(mask: NDArray, side: int) -> NDArray:
    """Majority over side x side pixels."""
    import cv2

    return cv2.medianBlur(mask.astype(np.uint8), side).astype(bool)


def beside(mask: NDArray, distance: int) -> NDArray:
    """(H, W) bool: what is not foreground, but at most so many pixels from it along rows and columns."""
    import cv2

    side = 2 * distance + 1
    return cv2.dilate(mask.view(np.uint8), np.ones((side, side), np.uint8)).view(bool) & ~mask


def close_open(mask: NDArray, closing: int, opening: int) -> NDArray:
    """Close with a square of side `closing`, then open with one of side `opening` pixels; 1 leaves a step out.

    Zhao (2009, 6.1): a small closing first fills holes without joining noise, a larger opening then removes noise.
    """
    import cv2

    out: Any = mask.view(np.uint8)
    for side, operation in ((closing, cv2.MORPH_CLOSE), (opening, cv2.MORPH_OPEN)):
        if side > 1:
            out = cv2.morphologyEx(out, operation, np.ones((side, side), np.uint8))
    return out.view(bool)


def check_squares(what: str, closing: int, opening: int) -> None:
    """Raise where the sides of `close_open` are none."""
    if closing < 1 or opening < 1:
        raise InputError(f"{what} closing and opening", expected="1 pixel or more", got=f"{closing} and {opening}")


def fill_holes(mask: NDArray, largest: int) -> NDArray:
    """Fill background regions of up to `largest` pixels that do not touch the border."""
    import cv2

    _, label, stats, _ = cv2.connectedComponentsWithStats((~mask).astype(np.uint8), connectivity=4)
    hole = stats[:, cv2.CC_STAT_AREA] <= largest
    hole[0] = False  # label 0 is the foreground here
    hole[np.unique(np.concatenate([label[0], label[-1], label[:, 0], label[:, -1]]))] = False
    return mask | hole[label]


def drop_small(mask: NDArray, smallest: int) -> NDArray:
    """Drop 8-connected components of fewer than `smallest` pixels."""
    import cv2

    _, label, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
    keep = stats[:, cv2.CC_STAT_AREA] >= smallest
    keep[0] = False
    return keep[label]


def keep_near_main(mask: NDArray, gap: float, box: Box | None = None, smallest: int = 0) -> NDArray:
    """The main component and every other one of at least `smallest` pixels that comes within `gap` pixels of it."""
    import cv2

    count, label, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
    pixels = stats[:, cv2.CC_STAT_AREA].copy()
    pixels[0] = 0
    keep = pixels >= max(1, smallest)
    if np.count_nonzero(keep) < 2:
        return keep[label]
    main = _main(label, np.where(keep, pixels, 0), box)
    left, top, width, height = stats[main, :4]
    around = (
        slice(max(0, top - int(gap) - 1), top + height + int(gap) + 1),
        slice(max(0, left - int(gap) - 1), left + width + int(gap) + 1),
    )
    distance = cv2.distanceTransform((label[around] != main).astype(np.uint8), cv2.DIST_L2, 5)
    keep &= np.bincount(label[around][distance <= gap], minlength=count) > 0
    return keep[label]


def _main(label: NDArray, pixels: NDArray, box: Box | None) -> int:
    """The largest component, or the one with most pixels in the box; `pixels` is 0 for those that may not be it."""
    if box is not None:
        inside = np.bincount(label[near(label > 0, box)], minlength=len(pixels)) * (pixels > 0)
        if inside.any():
            return int(np.argmax(inside))
    return int(np.argmax(pixels))


def near(mask: NDArray, box: Box, margin: float = 0.0) -> NDArray:
    """The mask inside a box widened by `margin` on all sides, and nothing outside it.

    Parameters
    ----------
    mask : (H, W) bool
    box : (left, top, right, bottom), pixels, edges included
    margin : float, pixels
    """
    left, top, right, bottom = box
    rows, columns = np.ogrid[: mask.shape[0], : mask.shape[1]]
    inside = (columns >= left - margin) & (columns <= right + margin)
    return mask & inside & (rows >= top - margin) & (rows <= bottom + margin)
