"""What every filter shares: settings, the state between frames, the diagnostics of a step, and how a step ends.

A method adds its own settings by inheriting from `CommonConfig`, and its own memory by inheriting from `State`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Literal, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.filters.dynamics import Dynamics, checked_limits, reflect
from muybridge.filters.particles import ESTIMATES, FloatArray, Weights, standard_deviation
from muybridge.filters.resampling import RESAMPLING

COLLAPSE_REMEDY = (
    "no particle has a likelihood above zero: start again from a known pose, widen the dynamics noise, "
    "or check that the observation shows the subject"
)


Blocks = tuple[tuple[int, ...], ...]
"""Components of the state that are moved together, such as those of a limb."""


class Likelihood(Protocol):
    """One frame's observation, frozen."""

    def log_prob(self, poses: FloatArray) -> FloatArray:
        """Log likelihood up to a constant. poses : (N, D); returns (N,), both float64; -inf is impossible."""
        ...


@dataclass(frozen=True, kw_only=True)
class CommonConfig:
    """Settings every method has."""

    particles: int = 500  # N; Du (2005), section 7.1
    estimate: Literal["mean", "maximum"] = "maximum"  # (3.25) | (3.24), (6.18)
    resampling: str = "multinomial"  # section 3.5; see resampling.RESAMPLING
    sharpness: float = 1.0  # K multiplies the log likelihood; 1 takes the likelihood as it is given

    def __post_init__(self) -> None:
        require("particles", self.particles >= 3, "at least 3", self.particles)
        require("estimate", self.estimate in ESTIMATES, " | ".join(ESTIMATES), self.estimate)
        require("resampling", self.resampling in RESAMPLING, " | ".join(RESAMPLING), self.resampling)
        require("sharpness", np.isfinite(self.sharpness) and self.sharpness > 0, "finite and above 0", self.sharpness)


def require(name: str, holds: bool, expected: str, got: object) -> None:
    """Raise InputError about the setting `name` unless it holds."""
    if not holds:
        raise InputError(f"filter setting {name!r}", expected=expected, got=repr(got))


@dataclass(frozen=True, eq=False)
class State:
    """What the next frame needs. All float64, in the state's units.

    particles : (N, D); log_weights : (N,), normalised; estimate : (D,); velocity : (D,), per frame, (6.19).
    """

    particles: FloatArray
    log_weights: FloatArray
    estimate: FloatArray
    velocity: FloatArray


@dataclass(frozen=True, eq=False)
class Info:
    """Diagnostics of one step, the same for every method; NaN where a method has no such thing.

    Attributes
    ----------
    ess : float
        Effective sample size of the final weights.
    survival_rate, exponents, acceptance : (L,) float64
        Per layer: effective fraction, power of the likelihood, share of accepted moves.
    evaluations, invalid : int
        Likelihoods asked for, and how many of the answers were NaN or +inf (treated as impossible).
    log_likelihood : float
        Of the estimate, not sharpened, with log p(x) / K of what is usual; -inf when collapsed.
    spread_before, spread_after : (D,) float64
        Standard deviation of the predicted particles, and of the weighted ones.
    alpha : float
        Share of the prior that came from a guess, (22) of Sedai et al. (2013); 0 where there was none.
    collapsed : bool
        No particle was possible; the state is the one before.
    remedy : str
        What to do about it; empty when all is well.
    """

    ess: float
    survival_rate: FloatArray
    exponents: FloatArray
    acceptance: FloatArray
    evaluations: int
    invalid: int
    log_likelihood: float
    spread_before: FloatArray
    spread_after: FloatArray
    alpha: float = np.nan
    collapsed: bool = False
    remedy: str = ""


class CountingLikelihood:
    """A likelihood that counts what it is asked, and turns NaN and +inf into -inf.

    Where the dynamics knows which states are usual, that is part of it, so weighed that it counts once when the filter
    has sharpened everything: log p(y | x) + log p(x) / K.
    """

    def __init__(self, likelihood: Likelihood, dynamics: Dynamics | None = None, sharpness: float = 1.0) -> None:
        self._likelihood = likelihood
        self._dynamics, self._sharpness = dynamics, sharpness
        self.evaluations = 0
        self.invalid = 0

    def log_prob(self, poses: FloatArray) -> FloatArray:
        """poses : (N, D); returns (N,), both float64."""
        if len(poses) == 0:
            return np.empty(0)
        log_likelihoods = np.array(self._likelihood.log_prob(poses), dtype=np.float64)
        if log_likelihoods.shape != (len(poses),):
            raise InputError("likelihood.log_prob", expected=f"shape ({len(poses)},)", got=f"{log_likelihoods.shape}")
        broken = np.isnan(log_likelihoods) | (log_likelihoods == np.inf)
        log_likelihoods[broken] = -np.inf
        self.evaluations += len(poses)
        self.invalid += int(broken.sum())
        if self._dynamics is not None:
            log_likelihoods += self._dynamics.log_usual(poses) / self._sharpness
        return log_likelihoods


def initial_state(
    rng: np.random.Generator,
    mean: FloatArray,
    sd: FloatArray,
    particles: int,
    lower: FloatArray | None = None,
    upper: FloatArray | None = None,
) -> State:
    """N(mean, diag(sd^2)) folded into the limits, equal weights, at rest.

    mean, sd, lower, upper : (D,) float64, the state's units; sd of zero keeps a component fixed.
    """
    mean, sd = np.array(mean, dtype=np.float64), np.array(sd, dtype=np.float64)
    if mean.ndim != 1 or not np.isfinite(mean).all():
        raise InputError("initial mean", expected="shape (D,), finite", got=f"shape {mean.shape}, {mean}")
    if sd.shape != mean.shape or not (np.isfinite(sd).all() and (sd >= 0).all()):
        raise InputError("initial sd", expected=f"shape {mean.shape}, finite and not negative", got=str(sd))
    low, high = checked_limits(lower, upper, mean.size)
    mean = np.clip(mean, low, high)
    cloud = reflect(mean + sd * rng.standard_normal((particles, mean.size)), low, high)
    return State(cloud, np.full(particles, -np.log(particles)), mean, np.zeros_like(mean))


@dataclass(frozen=True)
class PlainInit:
    """The `init` of a method that remembers no more than `State`: so many particles as its config says.

    working : the method's settings where none are given.
    """

    working: CommonConfig

    def __call__(
        self,
        rng: np.random.Generator,
        mean: FloatArray,
        sd: FloatArray,
        config: CommonConfig | None = None,
        lower: FloatArray | None = None,
        upper: FloatArray | None = None,
    ) -> State:
        """Particles around a known pose. mean, sd, lower, upper : (D,) float64, the state's units."""
        return initial_state(rng, mean, sd, (config or self.working).particles, lower, upper)


@dataclass(frozen=True, eq=False)
class Population:
    """Measured particles. particles : (N, D); log_likelihoods : (N,), not sharpened; both float64."""

    particles: FloatArray
    log_likelihoods: FloatArray

    def take(self, selected: NDArray[np.intp]) -> Population:
        """The selected members, in that order."""
        return Population(self.particles[selected], self.log_likelihoods[selected])

    def replace(self, members: NDArray[np.intp], accepted: NDArray[np.bool_], others: Population) -> Population:
        """`others[i]` in the place of member `members[i]` where `accepted[i]`."""
        particles, log_likelihoods = self.particles.copy(), self.log_likelihoods.copy()
        particles[members[accepted]] = others.particles[accepted]
        log_likelihoods[members[accepted]] = others.log_likelihoods[accepted]
        return Population(particles, log_likelihoods)


@dataclass
class Layers:
    """What a step notes of its layers on the way; becomes part of Info. NaN stands for what a method does not have."""

    rows: list[tuple[float, float, float]] = field(default_factory=list)

    def append(self, survival_rate: float, exponent: float = np.nan, acceptance: float = np.nan) -> None:
        """Note one layer."""
        self.rows.append((survival_rate, exponent, acceptance))

    @property
    def columns(self) -> FloatArray:
        """(3, L) float64: survival rate, exponent, acceptance."""
        return np.array(self.rows, dtype=np.float64).reshape(-1, 3).T


StateT = TypeVar("StateT", bound=State)


def conclude(
    state: StateT,
    predicted: FloatArray,
    population: Population,
    log_weights: FloatArray,
    counted: CountingLikelihood,
    config: CommonConfig,
    dynamics: Dynamics,
    layers: Layers,
    *,
    scores: FloatArray | None = None,
    remedy: str = "",
) -> tuple[StateT, Info]:
    """The end of every step: estimate (3.24) or (3.25), velocity (6.19), diagnostics; the old state if all collapsed.

    Parameters
    ----------
    predicted : (N, D) float64
        The particles before the measurement.
    log_weights : (N,) float64
        Of the population; all -inf says that it collapsed.
    scores : (N,) float64
        What the maximum is taken of, for methods whose particles end with equal weights. None: the weights.
    remedy : str
        For trouble short of collapse.
    """
    weights = Weights(log_weights)
    log_likelihood = -np.inf
    if not weights.collapsed:
        ranking = weights if scores is None or config.estimate == "mean" else Weights(scores)
        estimate = ESTIMATES[config.estimate](population.particles, ranking)
        velocity = dynamics.velocity_after(state.velocity, estimate - state.estimate)  # (6.19)
        log_likelihood = _log_likelihood_of_estimate(estimate, ranking, population.log_likelihoods, counted, config)
        state = replace(
            state, particles=population.particles, log_weights=weights.log, estimate=estimate, velocity=velocity
        )
    survival_rate, exponents, acceptance = layers.columns
    info = Info(
        ess=weights.ess,
        survival_rate=survival_rate,
        exponents=exponents,
        acceptance=acceptance,
        evaluations=counted.evaluations,
        invalid=counted.invalid,
        log_likelihood=log_likelihood,
        spread_before=np.std(predicted, axis=0),
        spread_after=standard_deviation(population.particles, weights),
        collapsed=weights.collapsed,
        remedy=COLLAPSE_REMEDY if weights.collapsed else remedy,
    )
    return state, info


def _log_likelihood_of_estimate(
    estimate: FloatArray,
    ranking: Weights,
    log_likelihoods: FloatArray,
    counted: CountingLikelihood,
    config: CommonConfig,
) -> float:
    """Known for a particle; one more evaluation for a mean."""
    if config.estimate == "maximum":
        return float(log_likelihoods[int(np.argmax(ranking.log))])
    return float(counted.log_prob(estimate[None])[0])


def state_to_arrays(state: State) -> dict[str, FloatArray]:
    """The state as named arrays, for a log that a run can be resumed from."""
    return {column.name: np.asarray(getattr(state, column.name)) for column in fields(state)}


def state_from_arrays(arrays: Mapping[str, FloatArray], kind: type[StateT] = State) -> StateT:  # type: ignore[assignment]
    """The inverse of `state_to_arrays`, to the bit. `kind` is the method's own State where it has one."""
    names = [column.name for column in fields(kind)]
    missing = [name for name in names if name not in arrays]
    if missing:
        raise InputError("saved filter state", expected=", ".join(names), got=f"no {', '.join(missing)}")
    return kind(**{name: np.array(arrays[name]) for name in names})
