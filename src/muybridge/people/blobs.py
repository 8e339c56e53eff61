"""People from a foreground mask: connected components, the wide ones split between the heads (Zhao 2009, 5.1).

==========  =====================================
symbol      name
==========  =====================================
T_fg        BlobConfig.smallest
T_wh        BlobConfig.widest
==========  =====================================

Differences from the paper: a component is not cut closer to its sides than a share of its width, because the vertical
projection of a single person falls to zero at both; a component that cannot be cut stays whole.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError

Mask = NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True)
class BlobConfig:
    """Settings that depend on the camera: how large a person is in the picture."""

    smallest: int = 2000  # T_fg, pixels; section 5.1
    widest: float = 1.0  # T_wh, width over height; section 5.1
    margin: float = 0.2  # share of the width, left and right, where no valley is looked for

    def __post_init__(self) -> None:
        if not (self.smallest >= 1 and self.widest > 0 and 0 <= self.margin < 0.5):
            raise InputError("blobs", expected="smallest >= 1, widest above 0, margin in [0, 0.5)",
                             got=f"{self.smallest}, {self.widest}, {self.margin}")  # fmt: skip


@dataclass(frozen=True, eq=False)
class Blob:
    """A region of the foreground that may be a person.

    left, top : int, pixels
    mask : (height, width) bool, its own pixels within its bounding box
    """

    left: int
    top: int
    mask: Mask

    @property
    def box(self) -> NDArray[np.float64]:
        """(4,) left, top, width, height, pixels."""
        return np.array([self.left, self.top, self.mask.shape[1], self.mask.shape[0]], dtype=np.float64)

    @property
    def area(self) -> int:
        """Pixels."""
        return int(np.count_nonzero(self.mask))


def find_people(mask: Mask, config: BlobConfig | None = None) -> list[Blob]:
    """The regions of a mask (H, W) bool that are large enough, each narrow enough for one person where it could be cut.

    From left to right.
    """
    config = config or BlobConfig()
    pieces = [piece for blob in components(mask, config.smallest) for piece in split(blob, config)]
    return sorted(pieces, key=lambda blob: (blob.left, blob.top))


def components(mask: Mask, smallest: int) -> list[Blob]:
    """The 8-connected components of at least so many pixels."""
    import cv2

    mask = np.asarray(mask)
    if mask.ndim != 2 or mask.dtype != np.bool_:
        raise InputError("foreground mask", expected="(H, W) bool", got=f"{mask.shape} {mask.dtype}")
    count, label, stats, _ = cv2.connectedComponentsWithStats(mask.view(np.uint8), connectivity=8)
    found = []
    for index in range(1, count):
        left, top, width, height, area = (int(value) for value in stats[index])
        if area >= smallest:
            found.append(Blob(left, top, label[top : top + height, left : left + width] == index))
    return found


def split(blob: Blob, config: BlobConfig) -> list[Blob]:
    """Cut at the lowest valley while it is too wide; pieces that are too small go."""
    if blob.area < config.smallest:
        return []
    height, width = blob.mask.shape
    at = valley(blob.mask, config.margin)
    if width <= config.widest * height or at is None:
        return [blob]
    halves = trimmed(blob, slice(0, at)), trimmed(blob, slice(at, width))
    return [piece for half in halves if half is not None for piece in split(half, config)]


def valley(mask: Mask, margin: float) -> int | None:
    """The column with the fewest pixels, away from the sides: where to cut; None where there is no room for one.

    The middle one of equals, so that a flat projection is cut in half.
    """
    projection = np.count_nonzero(mask, axis=0)
    first = max(1, int(np.ceil(margin * mask.shape[1])))
    inner = projection[first : mask.shape[1] - first]
    if not inner.size:
        return None
    lowest = np.flatnonzero(inner == inner.min())
    return first + int(lowest[len(lowest) // 2])


def trimmed(blob: Blob, columns: slice) -> Blob | None:
    """Those columns of the blob, cut to what they hold; None where that is nothing."""
    part = blob.mask[:, columns]
    rows, across = np.flatnonzero(part.any(axis=1)), np.flatnonzero(part.any(axis=0))
    if not rows.size:
        return None
    kept = part[rows[0] : rows[-1] + 1, across[0] : across[-1] + 1]
    return Blob(blob.left + columns.start + int(across[0]), blob.top + int(rows[0]), kept)
