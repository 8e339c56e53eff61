"""What stands in the scene now and did not before, or does no more: a door that is shut, a chair that was moved.

A clip has one empty scene, but a door has two looks in it. Foreground that has not moved at all for some pictures is a
thing (`segmentation.stillness`), and its look is background from then on, beside that of the empty scene.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from muybridge.people.blobs import Mask
from muybridge.segmentation.plate import PlateBackground
from muybridge.segmentation.stillness import Stillness

SMALLEST = 200  # pixels: feet stand as still as things, where the legs above them are missing
FRINGE = 5  # side of the square, pixels, by which a thing is grown: masks miss its rim


class Things:
    """The looks of things, where any are known.

    plate : PlateBackground, of the empty scene
    rest : int, pictures after which what does not move is a thing; 0: never
    """

    def __init__(self, plate: PlateBackground, rest: int) -> None:
        self._plate = plate
        self._picture = plate.background.copy()
        height, width, _ = self._picture.shape
        self._known = np.zeros((height, width), bool)
        self._looks: tuple[tuple[slice, slice], PlateBackground] | None = None
        self.begin(rest)

    def begin(self, rest: int) -> None:
        """Keep what is known; from now on so many pictures make a thing, of which none was seen yet."""
        height, width, _ = self._picture.shape
        self._stillness = Stillness((height, width), rest, SMALLEST)

    def go_on_from(self, before: Things) -> None:
        """Know what was known before the empty scene was learnt anew, and how long everything has been still."""
        self._known, self._looks, self._stillness = before._known, before._looks, before._stillness
        self._picture[self._known] = before._picture[self._known]

    def compare(self, picture: NDArray[np.uint8]) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
        """How far a picture is from the background, (H, W), in the plate's units, and the background it is nearest to.

        picture : (H, W, 3) uint8
        """
        difference, background = self._plate.difference(picture), self._plate.background
        if self._looks is None:
            return difference, background
        part, plate = self._looks
        other = plate.difference(np.ascontiguousarray(picture[part]))
        nearer = self._known[part] & (other < difference[part])
        background = background.copy()
        difference[part][nearer] = other[nearer]
        background[part][nearer] = self._picture[part][nearer]
        return difference, background

    def learn(self, picture: NDArray[np.uint8], foreground: Mask) -> None:
        """A picture (H, W, 3) uint8 and its foreground (H, W) bool."""
        import cv2

        self._stillness.watch(picture)
        found = self._stillness.things(foreground)
        if not found.any():
            return
        grown = cv2.dilate(found.view(np.uint8), np.ones((FRINGE, FRINGE), np.uint8)).astype(bool)
        self._picture[grown] = picture[grown]
        self._known |= grown
        rows, columns = np.flatnonzero(self._known.any(axis=1)), np.flatnonzero(self._known.any(axis=0))
        part = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
        self._looks = part, PlateBackground(np.ascontiguousarray(self._picture[part]), self._plate.config)
