"""Boxes of several people over time: one frozen type, whatever file they come from."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError

COLUMNS = ("frames", "ids", "boxes", "confidence")


@dataclass(frozen=True, eq=False)
class BoxSeries:
    """Boxes with identities, in the order of frames and, within a frame, of identities.

    Attributes
    ----------
    frames : (M,) int64, from 0
    ids : (M,) int64
        Each at most once a frame.
    boxes : (M, 4) float64, pixels
        Left, top, width, height; pixel i reaches from i to i + 1.
    confidence : (M,) float64
        Higher is surer; of a truth, 0 marks what is not to be counted.
    """

    frames: NDArray[np.int64]
    ids: NDArray[np.int64]
    boxes: NDArray[np.float64]
    confidence: NDArray[np.float64]

    def __post_init__(self) -> None:
        frames, ids = np.asarray(self.frames, np.int64), np.asarray(self.ids, np.int64)
        boxes, confidence = np.asarray(self.boxes, np.float64), np.asarray(self.confidence, np.float64)
        count = len(frames)
        if not (frames.shape == ids.shape == confidence.shape == (count,) and boxes.shape == (count, 4)):
            raise InputError("boxes", expected="(M,) frames, ids and confidence, (M, 4) boxes",
                             got=f"{frames.shape}, {ids.shape}, {confidence.shape}, {boxes.shape}")  # fmt: skip
        if count and frames.min() < 0:
            raise InputError("boxes: frame", expected="numbers from 0", got=str(frames.min()))
        if not (np.isfinite(boxes).all() and (boxes[:, 2:] >= 0).all()):
            raise InputError("boxes", expected="finite numbers, width and height not below 0", got="others")
        order = np.lexsort((ids, frames))
        again = (np.diff(frames[order]) == 0) & (np.diff(ids[order]) == 0)
        if again.any():
            at = order[int(np.argmax(again))]
            raise InputError("boxes", expected="every identity once a frame",
                             got=f"identity {ids[at]} twice in frame {frames[at]} (from 0)")  # fmt: skip
        for name, column in zip(COLUMNS, (frames, ids, boxes, confidence), strict=True):
            ordered = column[order]
            ordered.flags.writeable = False
            object.__setattr__(self, name, ordered)

    def __len__(self) -> int:
        return len(self.frames)

    def where(self, keep: NDArray[np.bool_]) -> BoxSeries:
        """The rows kept (M,) bool."""
        return BoxSeries(*(getattr(self, name)[keep] for name in COLUMNS))

    def between(self, first: int, last: int) -> BoxSeries:
        """The frames first..last, both included."""
        return self.where((self.frames >= first) & (self.frames <= last))


def read_boxes(path: str | Path) -> BoxSeries:
    """A MOTChallenge text file, or CAVIAR's XML where the name ends in .xml."""
    from muybridge.io.caviar import read_caviar
    from muybridge.io.mot import read_mot

    return read_caviar(path) if Path(path).suffix.lower() == ".xml" else read_mot(path)
