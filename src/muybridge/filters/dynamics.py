"""How particles move from one frame to the next, and the limits they stay within.

Limits are kept by reflection: a sample beyond a limit is folded back by as much as it went over, so that no
pose outside is ever proposed and none piles up on the limit itself. Symbols: V -> velocity, sigma -> noise_sd
(Du, 2005, 6.4).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray


class Dynamics(Protocol):
    """What a filter needs of a motion model. All arrays (D,) float64 in the state's units."""

    @property
    def noise_sd(self) -> FloatArray:
        """Standard deviation of one frame's noise, per component; 0 keeps a component still."""
        ...

    @property
    def lower(self) -> FloatArray:
        """Lower limits; -inf where free."""
        ...

    @property
    def upper(self) -> FloatArray:
        """Upper limits; inf where free."""
        ...

    def sample(
        self,
        rng: np.random.Generator,
        particles: FloatArray,
        velocity: FloatArray | None = None,
        scale: float | FloatArray = 1.0,
    ) -> FloatArray:
        """Draw the next state of each particle.

        Parameters
        ----------
        particles : (N, D) float64
        velocity : (D,) float64, state units per frame
            The estimate's last change, (6.19). None is zero.
        scale : float or (D,) float64
            Multiplies the noise: annealing layers shrink it, limb blocks set components to zero, 0 is the model's mean.
        """
        ...


@dataclass(frozen=True, eq=False)
class GaussianWalk:
    """X_k = X_{k-1} + N(0, diag(noise_sd^2)), folded into [lower, upper]; the velocity is not used.

    Parameters
    ----------
    noise_sd : (D,) float64, state units per frame
    lower, upper : (D,) float64, state units
        Either may be infinite, for single components or (the default) for all.
    """

    noise_sd: FloatArray
    lower: FloatArray = None  # type: ignore[assignment]  # filled in below
    upper: FloatArray = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        noise_sd = np.array(self.noise_sd, dtype=np.float64)
        if noise_sd.ndim != 1 or not (np.isfinite(noise_sd).all() and (noise_sd >= 0).all()):
            raise InputError(
                "dynamics noise_sd", expected="shape (D,), finite and not negative", got=str(self.noise_sd)
            )
        lower, upper = checked_limits(self.lower, self.upper, noise_sd.size)
        for name, value in (("noise_sd", noise_sd), ("lower", lower), ("upper", upper)):
            value.flags.writeable = False
            object.__setattr__(self, name, value)

    def sample(
        self,
        rng: np.random.Generator,
        particles: FloatArray,
        velocity: FloatArray | None = None,
        scale: float | FloatArray = 1.0,
    ) -> FloatArray:
        """See `Dynamics.sample`. Returns (N, D) float64 within the limits."""
        noise = rng.standard_normal(particles.shape) * (self.noise_sd * scale)
        return reflect(particles + self._drift(velocity) + noise, self.lower, self.upper)

    def _drift(self, velocity: FloatArray | None) -> FloatArray | float:
        return 0.0


@dataclass(frozen=True, eq=False)
class ConstantVelocity(GaussianWalk):
    """X_k = X_{k-1} + gain V_{k-1} + noise, (6.16), with V_k = X_k - X_{k-1} of the estimates, (6.19).

    Parameters
    ----------
    gain : float
        1 is printed. The velocity is the difference of two noisy estimates and carries their noise back into the
        prediction: along directions that the pictures hardly see, full gain diverges. A half is safe.
    """

    gain: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0.0 <= self.gain <= 1.0:
            raise InputError("dynamics gain", expected="between 0 and 1", got=str(self.gain))

    def _drift(self, velocity: FloatArray | None) -> FloatArray | float:
        return 0.0 if velocity is None else self.gain * velocity


def checked_limits(lower: FloatArray | None, upper: FloatArray | None, size: int) -> tuple[FloatArray, FloatArray]:
    """Limits as two (size,) float64 arrays; None is unlimited. Raises InputError unless lower <= upper everywhere."""
    low = np.full(size, -np.inf) if lower is None else np.array(lower, dtype=np.float64)
    high = np.full(size, np.inf) if upper is None else np.array(upper, dtype=np.float64)
    if low.shape != (size,) or high.shape != (size,):
        raise InputError("limits", expected=f"shape ({size},) for both", got=f"{low.shape} and {high.shape}")
    if not (low <= high).all():  # NaN fails too
        wrong = int(np.argmin(low <= high))
        raise InputError("limits", expected="lower <= upper", got=f"{low[wrong]} > {high[wrong]} in component {wrong}")
    return low, high


def within(particles: FloatArray, lower: FloatArray, upper: FloatArray) -> NDArray[np.bool_]:
    """(N,) bool: every component of the particle lies within its limits."""
    inside: NDArray[np.bool_] = np.logical_and.reduce((particles >= lower) & (particles <= upper), axis=1)
    return inside


def reflect(particles: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
    """Fold values beyond a limit back inside, as often as it takes; values inside stay as they are, to the bit.

    particles : (N, D); lower, upper : (D,); returns (N, D), all float64.
    """
    outside = (particles < lower) | (particles > upper)
    if not outside.any():
        return particles
    column = np.nonzero(outside)[1]
    low, high, value = lower[column], upper[column], particles[outside]
    span = high - low
    folded = np.where(value < low, 2.0 * low - value, 2.0 * high - value)
    twice = np.isfinite(span) & (span > 0)  # two walls: the folded line repeats every two spans
    offset = np.mod(value[twice] - low[twice], 2.0 * span[twice])
    folded[twice] = low[twice] + span[twice] - np.abs(offset - span[twice])
    inside = particles.copy()
    inside[outside] = np.clip(folded, low, high)
    return inside
