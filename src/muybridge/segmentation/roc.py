"""How scores tell foreground from background: the rates at every threshold, in constant memory.

Scores are counted by the first 16 bits of their 32, sign and exponent included, whatever their unit: thresholds are
told apart to within 1 %.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError

BINS = 1 << 16


class RocCurve:
    """True and false positive rate against the threshold on a score, over all pictures added.

    Examples
    --------
    >>> curve = RocCurve()
    >>> curve.add(np.array([[3.0, 1.0], [2.0, 0.0]]), np.array([[True, False], [True, False]]))
    >>> curve.false_positive_rate(0.8)
    0.0
    """

    def __init__(self) -> None:
        self._counts = np.zeros((2, BINS), np.int64)

    def add(self, score: NDArray, truth: NDArray, counted: NDArray | None = None) -> None:
        """Count a picture.

        Parameters
        ----------
        score : (H, W) float, more where foreground is likelier
        truth : (H, W) bool
        counted : (H, W) bool, optional: False where a pixel is to count nowhere
        """
        bins = _bins(score)
        for row, where in enumerate((~truth, truth)):
            chosen = where if counted is None else where & counted
            self._counts[row] += np.bincount(bins[chosen], minlength=BINS)

    @property
    def rates(self) -> tuple[NDArray, NDArray]:
        """False and true positive rates (BINS + 1,) each, from the highest threshold (0, 0) to the lowest (1, 1)."""
        above = np.concatenate([np.zeros((2, 1)), self._counts[:, ::-1].cumsum(axis=1)], axis=1)
        if not above[:, -1].all():
            raise InputError("ROC curve", expected="pixels of foreground and of background", got="only one of them")
        false, true = above / above[:, -1:]
        return false, true

    def false_positive_rate(self, true_positive_rate: float) -> float:
        """The share of the background that is called foreground where `true_positive_rate` of the foreground is.

        Between two thresholds both rates are interpolated, as if equal scores were told apart by chance.
        """
        if not 0 < true_positive_rate <= 1:
            raise InputError("true positive rate", expected="above 0, at most 1", got=f"{true_positive_rate:g}")
        false, true = self.rates
        at = int(np.searchsorted(true, true_positive_rate))
        low, high = true[at - 1], true[at]
        return float(false[at - 1] + (false[at] - false[at - 1]) * (true_positive_rate - low) / (high - low))

    @property
    def best_f(self) -> float:
        """The largest F-measure over thresholds."""
        found = self._counts[:, ::-1].cumsum(axis=1)
        return float((2 * found[1] / np.maximum(found[0] + found[1] + found[1, -1], 1)).max())


def _bins(score: NDArray) -> NDArray:
    """The first 16 bits of a float32, turned so that they order as the numbers do."""
    bits = np.ascontiguousarray(score, np.float32).view(np.uint32)
    ordered = np.where(bits >> 31, ~bits, bits | np.uint32(1 << 31))
    return (ordered >> 16).astype(np.int64)
