"""How good masks are, where the truth is known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


def mask_scores(mask: NDArray, truth: NDArray) -> dict[str, float]:
    """Recall, precision and intersection over union of one mask against another, both (H, W) bool.

    An empty truth has recall 1, an empty mask precision 1, and two empty masks IoU 1.
    """
    counts = MaskCounts.of(mask, truth)
    either = counts.true_positives + counts.false_positives + counts.false_negatives
    return {
        "recall": counts.recall,
        "precision": counts.precision,
        "iou": counts.true_positives / either if either else 1.0,
    }


@dataclass(frozen=True)
class MaskCounts:
    """Pixels of any number of masks against their truths; the measures are those of changedetection.net.

    Counts of several pictures are added before a measure is taken, not the other way round. Without any foreground in
    the truth recall is 1, without any in the masks precision is 1; without pixels of a kind its rate is 0.

    Examples
    --------
    >>> counts = MaskCounts(true_positives=80, false_positives=20, false_negatives=20, true_negatives=880)
    >>> round(counts.f_measure, 6), counts.wrong_percent
    (0.8, 4.0)
    """

    true_positives: int = 0
    false_positives: int = 0
    false_negatives: int = 0
    true_negatives: int = 0

    @classmethod
    def of(cls, mask: NDArray, truth: NDArray, counted: NDArray | None = None) -> MaskCounts:
        """Count one mask (H, W) bool; where `counted` (H, W) bool is False, a pixel counts nowhere."""
        if counted is not None:
            mask, truth = mask[counted], truth[counted]
        both, found, there = (int(np.count_nonzero(kind)) for kind in (mask & truth, mask, truth))
        return cls(both, found - both, there - both, mask.size - found - there + both)

    def __add__(self, other: MaskCounts) -> MaskCounts:
        return MaskCounts(
            self.true_positives + other.true_positives,
            self.false_positives + other.false_positives,
            self.false_negatives + other.false_negatives,
            self.true_negatives + other.true_negatives,
        )

    @property
    def recall(self) -> float:
        """TP / (TP + FN): the share of the foreground that is found; the true positive rate."""
        there = self.true_positives + self.false_negatives
        return self.true_positives / there if there else 1.0

    @property
    def precision(self) -> float:
        """TP / (TP + FP)."""
        found = self.true_positives + self.false_positives
        return self.true_positives / found if found else 1.0

    @property
    def f_measure(self) -> float:
        """2 precision recall / (precision + recall)."""
        together = self.precision + self.recall
        return 2.0 * self.precision * self.recall / together if together else 0.0

    @property
    def false_positive_rate(self) -> float:
        """FP / (FP + TN)."""
        empty = self.false_positives + self.true_negatives
        return self.false_positives / empty if empty else 0.0

    @property
    def wrong_percent(self) -> float:
        """PWC, the percentage of wrong classifications: 100 (FN + FP) / all."""
        wrong = self.false_negatives + self.false_positives
        total = wrong + self.true_positives + self.true_negatives
        return 100.0 * wrong / total if total else 0.0
