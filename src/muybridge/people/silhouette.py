"""The mean silhouette of a standing person, cell by cell of the box, learnt from the clip itself.

A rectangle says little about where in it a person stands; which cells are mostly foreground (the trunk), which half the
time (legs) and which hardly ever (beside the head) says it to a pixel or two.

Not in Zhao (2009).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.people.blobs import Blob
from muybridge.people.ground import NEAR, GroundScale, touches_side

ROWS, COLUMNS = 8, 5
FEWEST = 20  # regions; of fewer the mean is their own shape
FILLED = 0.55  # of a box, where nothing was learnt
LOWEST, HIGHEST = 0.03, 0.95  # no cell is known better than that: masks have holes and halos
ALONE = (0.6, 1.3)  # width over the expected one: of one person


@dataclass(frozen=True, eq=False)
class Silhouette:
    """share : (rows, columns) float64, how often each cell of a person's box is foreground; 0..1."""

    share: FloatArray

    def __post_init__(self) -> None:
        if self.share.ndim != 2 or not ((self.share >= 0) & (self.share <= 1)).all():
            raise InputError("silhouette", expected="(rows, columns) shares in 0..1", got=str(self.share))

    @classmethod
    def flat(cls, share: float = FILLED) -> Silhouette:
        """The same everywhere: a box is all that is known."""
        return cls(np.full((1, 1), share))

    @cached_property
    def mean(self) -> float:
        """Share of a box that is foreground."""
        return float(self.share.mean())

    def ratios(self, outside: float) -> tuple[FloatArray, FloatArray]:
        """log p / q of foreground and log (1 - p) / (1 - q) of background, (rows, columns) a pixel; q is `outside`."""
        p = np.clip(self.share, LOWEST, HIGHEST)
        return np.log(p / outside), np.log((1 - p) / (1 - outside))


def learn_silhouette(blobs: Sequence[Blob], ground: GroundScale, picture: tuple[int, int]) -> Silhouette:
    """The mean of the regions that have one person's size; a flat one where there are too few.

    A region's box is as wide as expected, about the mean column of its pixels: legs apart do not widen it.
    """
    shares = [_share(blob, ground) for blob in blobs if _alone(blob, ground, picture)]
    return Silhouette(np.mean(shares, axis=0)) if len(shares) >= FEWEST else Silhouette.flat()


def _alone(blob: Blob, ground: GroundScale, picture: tuple[int, int]) -> bool:
    _, top, width, height = blob.box
    expected = float(ground.height(top + height - 0.5))
    size = abs(height / expected - 1) < NEAR and ALONE[0] < width / (ground.aspect * height) < ALONE[1]
    return size and not touches_side(blob, picture)


def _share(blob: Blob, ground: GroundScale) -> FloatArray:
    """(ROWS, COLUMNS) share of each cell's area that is foreground."""
    height = blob.mask.shape[0]
    width = ground.aspect * height
    y, x = np.nonzero(blob.mask)
    row = (y * ROWS) // height
    column = np.floor(((x - x.mean()) / width + 0.5) * COLUMNS).astype(np.int64)
    inside = (column >= 0) & (column < COLUMNS)
    counts = np.zeros((ROWS, COLUMNS))
    np.add.at(counts, (row[inside], column[inside]), 1.0)
    return np.minimum(1.0, counts * (ROWS * COLUMNS / (width * height)))
