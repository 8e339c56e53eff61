"""Which pixels a model may learn from a picture: what is background at once, what is foreground only after a while.

A model that learns everything takes whoever stands still for background within seconds. One that learns background
alone never takes in a chair that was moved. So foreground is learnt once it has been foreground for `patience` pictures
in a row. Elgammal (2002) calls learning background alone a selective update.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError


class Gate:
    """Counts for how many pictures each pixel has been foreground.

    Parameters
    ----------
    shape : (H, W)
    patience : int
        Pictures; with 0 everything is learnt.
    """

    def __init__(self, shape: tuple[int, int], patience: int) -> None:
        self.patience = patience
        self._age = np.zeros(shape, np.int32)
        self._everything = np.ones(shape, bool)

    def learnt(self, foreground: NDArray) -> NDArray:
        """(H, W) bool: what may be learnt of the picture with this foreground (H, W) bool."""
        if self.patience == 0:
            return self._everything
        self._age += 1
        self._age *= foreground
        return (self._age == 0) | (self._age > self.patience)


def check_patience(what: str, patience: int) -> None:
    """Raise where it is no number of pictures."""
    if patience < 0:
        raise InputError(f"{what} patience", expected="0 pictures (learn everything) or more", got=str(patience))
