"""A support vector machine with a radial kernel (Zhao 2009, 5.3; Burges 1998), kept as arrays.

=================  =============================
symbol             name
=================  =============================
x_i^*              vectors, standardised
y_i alpha_i        coefficients
b                  offset
K(x, x')           exp(-gamma |x - x'|^2)
g(x)               `margins`, (5.6)
=================  =============================

scikit-learn finds the vectors; afterwards nothing is needed but (5.6).

Differences from the paper: features are standardised; b is moved afterwards until few enough good examples, of those
that were held back, count as failures.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray

ARRAYS = ("vectors", "coefficients", "centre", "scale")
FEWEST = 10  # examples of each kind


@dataclass(frozen=True, eq=False)
class SupportVectors:
    """g(x) of (5.6), above 0 for what is as it should be.

    vectors : (L, F) float64; coefficients : (L,) float64; centre, scale : (F,) float64, of the features
    """

    vectors: FloatArray
    coefficients: FloatArray
    centre: FloatArray
    scale: FloatArray
    offset: float
    gamma: float

    def __post_init__(self) -> None:
        count, size = np.shape(self.vectors) if np.ndim(self.vectors) == 2 else (0, 0)
        fits = np.shape(self.coefficients) == (count,) and np.shape(self.centre) == np.shape(self.scale) == (size,)
        finite = all(np.isfinite(getattr(self, name)).all() for name in (*ARRAYS, "offset", "gamma"))
        if not (count and fits and finite and (self.scale > 0).all() and self.gamma > 0):
            raise InputError("support vectors", expected="(L, F) vectors, (L,) coefficients, scales and gamma above 0",
                             got=f"{np.shape(self.vectors)}, {np.shape(self.coefficients)}")  # fmt: skip

    def margins(self, features: FloatArray) -> FloatArray:
        """(M,) g of feature vectors (M, F)."""
        scaled = (np.atleast_2d(features) - self.centre) / self.scale
        squared = np.square(scaled[:, None] - self.vectors).sum(axis=2)
        return np.exp(-self.gamma * squared) @ self.coefficients + self.offset

    def tuned(self, good: FloatArray, false_alarms: float) -> SupportVectors:
        """With b such that at most this share of good examples (M, F) counts as failures; never a lower threshold."""
        lowest = float(np.quantile(self.margins(good), false_alarms, method="lower"))
        return replace(self, offset=self.offset - min(0.0, lowest))


def train_support_vectors(
    features: FloatArray, good: NDArray[np.bool_], *, penalty: float = 10.0, spread: float = 1.0
) -> SupportVectors:
    """From examples (M, F), of which `good` (M,) are as they should be; both kinds weigh alike.

    penalty : C of the machine; spread : of the kernel, in units of the usual distance between two examples
    """
    from sklearn.svm import SVC

    count = int(np.count_nonzero(good))
    if min(count, len(good) - count) < FEWEST:
        raise InputError("training", expected=f"{FEWEST} examples each of good and failed parts",
                         got=f"{count} and {len(good) - count}", remedy="longer or harder clips")  # fmt: skip
    centre, scale = features.mean(axis=0), np.maximum(features.std(axis=0), 1e-6)
    gamma = 1.0 / (2 * features.shape[1] * spread**2)
    machine = SVC(C=penalty, gamma=gamma, class_weight="balanced")
    machine.fit((features - centre) / scale, np.where(good, 1, -1))
    offset = float(machine.intercept_[0])
    return SupportVectors(machine.support_vectors_, machine.dual_coef_[0], centre, scale, offset, gamma)
