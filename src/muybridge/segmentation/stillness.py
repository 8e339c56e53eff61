"""Things: regions of the foreground that have not moved at all, as a door that was opened.

Somebody who stands still sways and breathes, so that at least `STIRRING` of the pixels of a person change within
seconds.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

MOVED = 20
"""Grey values, largest over the channels, from which on a pixel has changed; several deviations of usual noise."""
STIRRING = 0.02


class Stillness:
    """Counts for how many pictures each pixel has looked the same.

    Parameters
    ----------
    shape : (H, W)
    rest : int
        Pictures after which what does not move is a thing; with 0 nothing ever is.
    smallest : int
        Pixels of a thing.
    """

    def __init__(self, shape: tuple[int, int], rest: int, smallest: int = 1) -> None:
        self.rest, self.smallest = rest, smallest
        self._still = np.zeros(shape, np.int32)
        self._looked: NDArray | None = None

    def watch(self, picture: NDArray) -> None:
        """Count for how many pictures each pixel of them (H, W, C) uint8 has looked as it did when the count began."""
        if self._looked is None:
            self._looked = picture.copy()
        moved = differs(picture, self._looked)
        self._looked[moved] = picture[moved]
        self._still += 1
        self._still[moved] = 0

    def things(self, foreground: NDArray) -> NDArray:
        """(H, W) bool: components of the foreground (H, W) of which next to nothing has moved for `rest` pictures."""
        import cv2

        if not self.rest or not (foreground & (self._still >= self.rest)).any():
            return np.zeros_like(foreground)
        count, label = cv2.connectedComponents(foreground.view(np.uint8), connectivity=8)
        pixels = np.bincount(label.ravel(), minlength=count)
        moved = np.bincount(label[self._still < self.rest], minlength=count)
        thing = (moved <= STIRRING * pixels) & (pixels >= self.smallest)
        thing[0] = False
        return thing[label]


def differs(picture: NDArray, other: NDArray) -> NDArray:
    """(H, W) bool: where two pictures (H, W, C) uint8 differ by more than `MOVED` in any channel."""
    import cv2

    apart = np.asarray(cv2.absdiff(picture, other)).reshape(picture.shape)
    moved: NDArray = apart[..., 0] > MOVED
    for channel in range(1, picture.shape[2]):
        moved |= apart[..., channel] > MOVED
    return moved
