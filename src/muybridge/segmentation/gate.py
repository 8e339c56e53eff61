"""Which pixels a model may learn from a picture: background at once, foreground where it is no person.

A model that learns everything takes whoever stands still for background within seconds. One that learns background
alone never takes in a door that was opened, nor that the lamps are off. So foreground is learnt where

- more than `FLOOD` of the picture is foreground: the light has changed, and nobody is that large; but not where
  somebody has been for `LASTING` pictures;
- a whole component has not moved for `rest` pictures: a thing (`stillness`);
- a pixel has been foreground for `patience` pictures in a row, whatever it does.

Elgammal (2002) calls learning background alone a selective update; the three exceptions are not in the papers.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.segmentation.stillness import Stillness

FLOOD, SETTLE = 0.4, 15
"""Share of the picture; and for how many more pictures it is learnt, while exposure settles."""
LASTING = 5
"""Pictures for which somebody has been there: what has been foreground for fewer may be the light already."""


class Gate:
    """Counts for how many pictures each pixel has been foreground.

    Parameters
    ----------
    shape : (H, W)
    patience : int
        Pictures; with 0 everything is learnt.
    rest : int
        Pictures after which what does not move is learnt; with 0 nothing is for that.
    """

    def __init__(self, shape: tuple[int, int], patience: int, rest: int = 0) -> None:
        self.patience = patience
        self._age = np.zeros(shape, np.int32)
        self._stillness = Stillness(shape, rest)
        self._settling = 0
        self._people = np.zeros(shape, bool)
        self._everything = np.ones(shape, bool)

    def learnt(self, foreground: NDArray, picture: NDArray) -> NDArray:
        """(H, W) bool: what may be learnt of a picture (H, W, C) uint8 with this foreground (H, W) bool."""
        if self.patience == 0:
            return self._everything
        self._age += 1
        self._age *= foreground
        self._stillness.watch(picture)
        self._settling = SETTLE if foreground.mean() > FLOOD else self._settling - 1
        if self._settling > 0:
            return ~self._people
        self._people = self._age >= LASTING
        return ~foreground | (self._age > self.patience) | self._stillness.things(foreground)


def check_patience(what: str, patience: int, rest: int = 0) -> None:
    """Raise where they are no numbers of pictures."""
    if patience < 0:
        raise InputError(f"{what} patience", expected="0 pictures (learn everything) or more", got=str(patience))
    if rest < 0:
        raise InputError(f"{what} rest", expected="0 pictures (no thing is learnt for resting) or more", got=str(rest))
