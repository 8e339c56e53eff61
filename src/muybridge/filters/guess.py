"""A guess of the state from one frame's picture alone, as a mixture of normal densities, and how filters ask for it.

A likelihood that knows one has an attribute `guess`. What the guess says nothing of, such as a person's place, comes
from the motion model.

Source: Sedai, Bennamoun and Huynh, "A Gaussian process guided particle filter for tracking 3D human pose in video",
IEEE Transactions on Image Processing 22(11), 2013, (10).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.filters.state import Likelihood


@dataclass(frozen=True, eq=False)
class Guess:
    """sum_k g_k N(y_k, diag(sigma_k^2)) of some components of the state, (10).

    Parameters
    ----------
    weights : (K,) float64
        g_k; they are made to sum to 1.
    means, variances : (K, B) float64, state units, and their squares
    components : (B,) int
        Those of the state that it speaks of, each once.
    trusted_variance : float, state units squared, optional
        lambda of (19): how uncertain guesses may be and still be right, where whoever guesses has found that out.
    """

    weights: FloatArray
    means: FloatArray
    variances: FloatArray
    components: NDArray[np.intp]
    trusted_variance: float | None = None

    def __post_init__(self) -> None:
        weights, means = np.array(self.weights, dtype=np.float64), np.array(self.means, dtype=np.float64)
        variances, components = np.array(self.variances, dtype=np.float64), np.array(self.components, dtype=np.intp)
        if weights.ndim != 1 or not (np.isfinite(weights).all() and (weights >= 0).all() and weights.sum() > 0):
            raise InputError("guess: weights", expected="shape (K,), none negative, not all 0", got=str(self.weights))
        if components.ndim != 1 or len(np.unique(components)) < components.size or (components < 0).any():
            raise InputError("guess: components", expected="shape (B,), none twice", got=str(self.components))
        shape = weights.size, components.size
        if means.shape != shape or not np.isfinite(means).all():
            raise InputError("guess: means", expected=f"shape {shape}, finite", got=f"shape {means.shape}, {means}")
        if variances.shape != shape or not (np.isfinite(variances).all() and (variances >= 0).all()):
            got = f"shape {variances.shape}, {variances}"
            raise InputError("guess: variances", expected=f"shape {shape}, finite and not negative", got=got)
        if self.trusted_variance is not None and not self.trusted_variance > 0:
            raise InputError("guess: trusted variance", expected="above 0", got=repr(self.trusted_variance))
        columns = {"weights": weights / weights.sum(), "means": means, "variances": variances, "components": components}
        for name, value in columns.items():
            value.flags.writeable = False
            object.__setattr__(self, name, value)

    def __len__(self) -> int:
        """K, the number of modes."""
        return self.weights.size

    @property
    def variance(self) -> float:
        """sigma^2 = trace(Sigma_k) / d of the most likely mode, state units squared, (19)."""
        return float(self.variances[int(np.argmax(self.weights))].mean())

    def sample(self, rng: np.random.Generator, count: int) -> FloatArray:
        """Independent draws (count, B)."""
        modes = rng.choice(len(self), size=count, p=self.weights)
        standard = rng.standard_normal((count, self.components.size))
        drawn: FloatArray = self.means[modes] + np.sqrt(self.variances[modes]) * standard
        return drawn

    def poses(self, pose: FloatArray) -> FloatArray:
        """(K, D): a state (D,) with each mode's mean in the place of what the guess speaks of."""
        found = np.repeat(pose[None], len(self), axis=0)
        found[:, self.components] = self.means
        return found


class GuessingLikelihood(Likelihood, Protocol):
    """A likelihood of a frame of which a guess may have been made."""

    @property
    def guess(self) -> Guess | None:
        """What was guessed; None: nothing."""
        ...


def guess_of(likelihood: Likelihood, size: int) -> Guess | None:
    """The likelihood's guess, if it has any; of states of `size` components."""
    guess: Guess | None = getattr(likelihood, "guess", None)
    if guess is not None and guess.components.size and guess.components.max() >= size:
        raise InputError("guess: components", expected=f"0 to {size - 1}", got=str(guess.components.max()))
    return guess
