"""How particles move from one frame to the next, and the limits they stay within.

Limits are kept by reflection: a sample beyond a limit is folded back by as much as it went over, so that no
pose outside is ever proposed and none piles up on the limit itself. Symbols: V -> velocity, sigma -> noise_sd
(Du, 2005, 6.4).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray

WIDEST = 3.0  # state units: an angle that may be so far off, or a place in metres, is not known at all
TAIL = 4.0  # degrees of freedom of what is usual; few: unusual poses do happen
STANDING = 1e-9  # state units; no component is known better, so that covariances can be inverted


@dataclass(frozen=True, eq=False)
class Belief:
    """A normal density of place X and velocity V (per frame), as a Kalman filter keeps it.

    Parameters
    ----------
    mean, velocity : (D,) float64
    covariance, cross, velocity_covariance : (D, D) float64
        Of X; of X (rows) with V; of V, NaN where nothing is known of it yet.
    velocity_gain : (D, D) float64
        How the velocity follows a place that turns out to be other than expected.
    """

    mean: FloatArray
    covariance: FloatArray
    velocity: FloatArray
    cross: FloatArray
    velocity_covariance: FloatArray
    velocity_gain: FloatArray

    @classmethod
    def at_rest(cls, mean: FloatArray, sd: FloatArray) -> Belief:
        """A place (D,) known to sd (D,), and nothing about its velocity."""
        none = np.zeros((mean.size, mean.size))
        return cls(mean, np.diag(np.square(sd)), np.zeros_like(mean), none, np.full_like(none, np.nan), none)

    def corrected(self, mean: FloatArray, covariance: FloatArray) -> Belief:
        """Once the place is known to be N(mean, covariance): the velocity too, as far as the two hang together."""
        gain = self.velocity_gain
        velocity = self.velocity + gain @ (mean - self.mean)
        velocity_covariance = self.velocity_covariance - gain @ (self.covariance - covariance) @ gain.T
        return replace(self, mean=mean, covariance=covariance, velocity=velocity, cross=covariance @ gain.T,
                       velocity_covariance=velocity_covariance)  # fmt: skip

    def freed(self, block: NDArray[np.intp], values: FloatArray, sd: float | FloatArray) -> Belief:
        """The same with one block's components (B,) about `values`, wherever they were: a jump tells no velocity.

        sd : float or (B,) float64, state units
        """
        mean, covariance, cross = self.mean.copy(), self.covariance.copy(), self.cross.copy()
        mean[block] = values
        covariance[block, :] = covariance[:, block] = 0.0
        covariance[block, block] = sd**2
        cross[block, :] = 0.0
        gain = self.velocity_gain.copy()
        gain[block, :] = gain[:, block] = 0.0
        if cross.any():
            gain = np.linalg.solve(covariance, cross).T.astype(np.float64)
        return replace(self, mean=mean, covariance=covariance, cross=cross, velocity_gain=gain)


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

    @property
    def usual(self) -> FloatArray:
        """Where components mostly are, whatever came before."""
        ...

    @property
    def usual_sd(self) -> FloatArray:
        """How far from there they mostly are; inf where nothing is known."""
        ...

    def usual_precision(self, place: FloatArray) -> FloatArray:
        """(D,) the pull of `log_usual` at a place (D,), over the distance from `usual`."""
        ...

    def log_usual(self, particles: FloatArray) -> FloatArray:
        """(N,) log density, up to a constant, of how usual each state (N, D) is, whatever came before."""
        ...

    def carry(self, belief: Belief) -> Belief:
        """What is believed a frame later, before it is seen."""
        ...

    def velocity_after(self, velocity: FloatArray, step: FloatArray) -> FloatArray:
        """The velocity (D,) once the estimate has made a step (D,)."""
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
    usual, usual_sd : (D,) float64, state units
        Where components mostly are, whatever came before, and how far from there; infinite (the default): anywhere.
    """

    noise_sd: FloatArray
    lower: FloatArray = None  # type: ignore[assignment]  # filled in below
    upper: FloatArray = None  # type: ignore[assignment]
    usual: FloatArray = None  # type: ignore[assignment]
    usual_sd: FloatArray = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        noise_sd = np.array(self.noise_sd, dtype=np.float64)
        if noise_sd.ndim != 1 or not (np.isfinite(noise_sd).all() and (noise_sd >= 0).all()):
            raise InputError(
                "dynamics noise_sd", expected="shape (D,), finite and not negative", got=str(self.noise_sd)
            )
        lower, upper = checked_limits(self.lower, self.upper, noise_sd.size)
        usual = np.zeros_like(noise_sd) if self.usual is None else np.array(self.usual, dtype=np.float64)
        usual_sd = (
            np.full_like(noise_sd, np.inf) if self.usual_sd is None else np.array(self.usual_sd, dtype=np.float64)
        )
        if not (usual.shape == usual_sd.shape == noise_sd.shape and np.isfinite(usual).all() and (usual_sd > 0).all()):
            raise InputError("dynamics usual, usual_sd", expected="shape (D,), finite, and shape (D,), above 0",
                             got=f"{self.usual} and {self.usual_sd}")  # fmt: skip
        columns = ("noise_sd", noise_sd), ("lower", lower), ("upper", upper), ("usual", usual), ("usual_sd", usual_sd)
        for name, value in columns:
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

    def log_usual(self, particles: FloatArray) -> FloatArray:
        """See `Dynamics.log_usual`: independent Student densities, so that what is unusual stays possible."""
        away = (particles - self.usual) / self.usual_sd
        log_density: FloatArray = -0.5 * (TAIL + 1) * np.log1p(away * away / TAIL).sum(axis=1)
        return log_density

    def usual_precision(self, place: FloatArray) -> FloatArray:
        """(D,) how strongly what is usual pulls from a place (D,): (nu + 1) / (nu + z^2) / sd^2."""
        away = (place - self.usual) / self.usual_sd
        return (TAIL + 1) / (TAIL + away * away) / self.usual_sd**2

    def carry(self, belief: Belief) -> Belief:
        """The place as it was, less surely; no velocity is believed in."""
        none = np.zeros_like(belief.covariance)
        return replace(belief, covariance=belief.covariance + self._noise, velocity=np.zeros_like(belief.mean),
                       cross=none, velocity_covariance=none, velocity_gain=none)  # fmt: skip

    def velocity_after(self, velocity: FloatArray, step: FloatArray) -> FloatArray:
        """The step itself, V_k = X_k - X_{k-1}, (6.19)."""
        return step

    @property
    def _noise(self) -> FloatArray:
        return np.diag(np.maximum(self.noise_sd, STANDING) ** 2)

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

    def carry(self, belief: Belief) -> Belief:
        """The place moved on by the last step; the velocity follows it fully: it becomes the new step, (6.19)."""
        moved = reflect((belief.mean + self._drift(belief.velocity))[None], self.lower, self.upper)[0]
        carried = super().carry(belief)
        return replace(carried, mean=moved, velocity=moved - belief.mean, velocity_gain=np.eye(moved.size))

    def _drift(self, velocity: FloatArray | None) -> FloatArray | float:
        return 0.0 if velocity is None else self.gain * velocity


@dataclass(frozen=True, eq=False)
class NearlyConstantVelocity(ConstantVelocity):
    """Place and velocity, moved by accelerations that are white noise: Bar-Shalom, Li and Kirubarajan (2001), 6.3.2.

    The velocity is estimated beside the place, not taken as the difference of two noisy places, so that it may be
    repeated in full. Particles that are drawn move as with `ConstantVelocity`.

    Parameters
    ----------
    noise_sd : (D,) float64
        Here of the velocity, per frame, when nothing is known of it yet.
    acceleration_sd : (D,) float64, state units per frame squared
    gain : float
        Share of the velocity that lasts from a frame to the next.
    follow : float
        For filters without a covariance: the share of what a step surprises by that the velocity takes up (the beta of
        an alpha-beta filter); 1 is (6.19).
    """

    acceleration_sd: FloatArray = None  # type: ignore[assignment]
    follow: float = 0.4

    def __post_init__(self) -> None:
        super().__post_init__()
        acceleration_sd = np.array(self.acceleration_sd, dtype=np.float64)
        if acceleration_sd.shape != self.noise_sd.shape or not (
            np.isfinite(acceleration_sd).all() and (acceleration_sd >= 0).all()
        ):
            raise InputError(
                "dynamics acceleration_sd", expected="shape (D,), finite, not negative", got=str(acceleration_sd)
            )
        if not 0.0 <= self.follow <= 1.0:
            raise InputError("dynamics follow", expected="between 0 and 1", got=str(self.follow))
        acceleration_sd.flags.writeable = False
        object.__setattr__(self, "acceleration_sd", acceleration_sd)

    def carry(self, belief: Belief) -> Belief:
        """X + V, and V: F P F' + Q with F = [[1, g], [0, g]] and Q = [[1/4, 1/2], [1/2, 1]] q^2.

        A limit is a stop: what runs into it comes to rest. Were it reflected, each frame's surprise would be a push
        against the limit, and a straight knee's velocity would grow without end.
        """
        gain, q = self.gain, np.diag(self.acceleration_sd**2)
        place, cross, speeds = self._bounded(belief)
        covariance = place + gain * (cross + cross.T) + gain**2 * speeds + q / 4 + STANDING**2 * np.eye(len(q))
        covariance = 0.5 * (covariance + covariance.T)
        moved_cross = gain * cross + gain**2 * speeds + q / 2
        ahead = belief.mean + gain * belief.velocity
        mean = np.clip(ahead, self.lower, self.upper)
        velocity = np.where(mean == ahead, gain * belief.velocity, 0.0)
        velocity_gain: FloatArray = np.linalg.solve(covariance, moved_cross).T.astype(np.float64)
        return Belief(mean, covariance, velocity, moved_cross, gain**2 * speeds + q, velocity_gain)

    def _bounded(self, belief: Belief) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Covariance of place, of place with velocity, of velocity (D, D), none wider than when nothing is known.

        Along what no picture shows, such as the twist of a straight limb, they would grow for ever.
        """
        if np.isnan(belief.velocity_covariance).any():
            return belief.covariance, belief.cross, self._noise
        place = np.minimum(1.0, WIDEST / np.sqrt(np.diag(belief.covariance)))
        widest = np.maximum(self.noise_sd, STANDING)
        speed = np.minimum(1.0, widest / np.sqrt(np.maximum(np.diag(belief.velocity_covariance), STANDING**2)))
        return (
            place[:, None] * belief.covariance * place,
            place[:, None] * belief.cross * speed,
            speed[:, None] * belief.velocity_covariance * speed,
        )

    def velocity_after(self, velocity: FloatArray, step: FloatArray) -> FloatArray:
        """V + follow (step - V), where V is what was expected to last."""
        expected = self.gain * velocity
        return expected + self.follow * (step - expected)


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
