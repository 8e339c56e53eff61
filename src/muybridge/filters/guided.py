"""The guided filter: climb to the mode of the posterior first, then spend the particles on its shape.

A particle filter in 30 dimensions spends its particles on finding the peak. Where the likelihood can say which way is
up (a contour can: every outline point knows how far the mask's border lies, and in which direction), a few Gauss-Newton
steps find the mode from the prediction, and their curvature is the shape of the posterior around it. The mode is the
estimate, and particles are drawn from that Gaussian (Laplace's approximation). They may be weighted by the likelihood,
or by posterior over proposal (`Config.weighting`), and the estimate be read off them.

After: the iterated extended Kalman filter for the climb, and the unscented and Laplace-proposal particle filters (van
der Merwe et al. 2000; Doucet, Godsill and Andrieu 2000, section II-D) for the draw. Robust spreads: Geman and McClure
(1987). The velocity is carried beside the place as in a Kalman filter, see `dynamics.Belief`.

====================  ==========================================
symbol                name
====================  ==========================================
x^-                   _Prior.mean
P                     State.covariance
Lambda                _Prior.precision
H_L, g                likelihood.normal_equations: curvature, gradient
s_i                   Config.spreads, metres
kappa                 Config.dependence
====================  ==========================================

The prior: `dynamics.carry` takes place and velocity, with their covariances, to the next frame. The inverse of the
carried place's covariance, the precision of a uniform density between the limits, and the pull of what is usual add up
to Lambda; x^- is the carried place, pulled towards what is usual.

Each step of the climb solves (H_L / kappa + Lambda) d = g / kappa + Lambda (x^- - x) and goes from x to x + d: kappa
neighbouring residuals err together, so that they count as one. The posterior's covariance, the next frame's P, is
(H_L / kappa + Lambda)^-1, and the velocity follows the place as far as the two hang together.

A climb finds the nearest mode, and a limb that left the picture's outline (an arm that crossed the trunk) may be found
by no climb again. So in every frame each block of components, a limb, is also drawn anew all over its range. From the
draws that the likelihood likes best that limb climbs alone, which is quick; where it ends better than it was, the whole
pose climbs once more from the prediction with that limb put there and set free of its past, the carried covariance
being cut and widened at its components. That pose is taken if it has clearly less misfit. How much less is a share of
the misfit there is: where masks are bad, chance differences are larger too.

A pose that is lost altogether is found again from a guess, where the likelihood has one (see `guess`): the whole pose
climbs also from the guess's most likely modes, set free of its past as a redrawn limb is, about as far as the guess
says; the best is taken if it has clearly less misfit, by the same share.

Cost: `len(spreads)` looks at the contour and N likelihood evaluations a frame. With blocks, for each: `redraws`
evaluations, and half as many looks, at that limb's contour alone, for every draw that is climbed from; and one whole
climb more wherever a limb may be better elsewhere. With a guess, one whole climb for each of `guesses` modes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.filters.dynamics import STANDING, Belief, Dynamics, reflect
from muybridge.filters.guess import Guess, guess_of
from muybridge.filters.particles import FloatArray, Weights
from muybridge.filters.state import (
    CommonConfig,
    CountingLikelihood,
    Info,
    Layers,
    Likelihood,
    Population,
    conclude,
    initial_state,
    require,
)
from muybridge.filters.state import State as CommonState

LARGEST_TURN = 0.3  # radians; a step that would turn any joint further is shortened


class Linearised(Protocol):
    """Gauss-Newton's view of a log likelihood around a pose.

    curvature : (D, D), minus its second derivative; gradient : (D,), its first.
    """

    @property
    def curvature(self) -> FloatArray:
        """(D, D), minus the second derivative."""
        ...

    @property
    def gradient(self) -> FloatArray:
        """(D,), the first derivative."""
        ...


class GuidingLikelihood(Likelihood, Protocol):
    """A likelihood that also knows which way is up."""

    def normal_equations(
        self, pose: FloatArray, spread: float, components: NDArray[np.intp] | None = None
    ) -> Linearised:
        """At a pose (D,), with residuals beyond `spread` (metres) counting less and less.

        components : (B,) int, optional
            Those that may move, the others standing; D is then B.
        """
        ...


@dataclass(frozen=True, kw_only=True)
class Config(CommonConfig):
    """Settings of the guided filter."""

    particles: int = 300  # N; drawn around the mode
    resampling: str = "systematic"
    sharpness: float = 200.0  # K, where the likelihood weighs
    estimate: Literal["mean", "maximum"] = "mean"
    spreads: tuple[float, ...] = (0.2, 0.13, 0.085, 0.06, 0.045, 0.035, 0.03, 0.025)  # metres, one a step, falling
    dependence: float = 5.0  # kappa
    blocks: tuple[tuple[int, ...], ...] = ()  # components that are drawn anew together; empty: never
    redraws: int = 100  # likelihood evaluations spent on each
    tries: int = 4  # of a block's best redraws, so many are climbed from
    hopeful: float = 4.0  # log likelihood that a redraw may lack and still be climbed from
    improvement: float = 0.02  # share of the negative log likelihood, by which a climbed redraw must be better
    freedom: float = 0.5  # radians (metres); one standard deviation of a redrawn limb about where it climbed to
    guesses: int = 6  # of a guess's modes, so many are climbed from; 0: none
    weighting: Literal["laplace", "likelihood", "importance"] = "laplace"  # equal | p(y|x) | p(y|x) p(x) / proposal

    def __post_init__(self) -> None:
        super().__post_init__()
        falling = all(s > 0 for s in self.spreads) and list(self.spreads) == sorted(self.spreads, reverse=True)
        require("spreads", len(self.spreads) > 0 and falling, "positive metres, falling", self.spreads)
        require("improvement", self.improvement >= 0, "0 or more", self.improvement)
        require("freedom", self.freedom > 0, "above 0", self.freedom)
        require("redraws", self.redraws >= 0, "0 or more", self.redraws)
        require("guesses", self.guesses >= 0, "0 or more", self.guesses)
        require("tries", self.tries >= 1, "1 or more", self.tries)
        require("dependence", self.dependence > 0, "above 0", self.dependence)
        require(
            "weighting",
            self.weighting in ("laplace", "likelihood", "importance"),
            "laplace | likelihood | importance",
            self.weighting,
        )


@dataclass(frozen=True, eq=False)
class State(CommonState):
    """With what the next frame's prediction starts from, see `dynamics.Belief`: all (D, D), state units."""

    covariance: FloatArray
    cross: FloatArray
    velocity_covariance: FloatArray

    @property
    def belief(self) -> Belief:
        """Place and velocity as they are known."""
        none = np.zeros_like(self.covariance)
        return Belief(self.estimate, self.covariance, self.velocity, self.cross, self.velocity_covariance, none)


PRINTED = Config()  # ours: there is no paper's setting to keep
WORKING = Config()


def init(
    rng: np.random.Generator,
    mean: FloatArray,
    sd: FloatArray,
    config: Config = WORKING,
    lower: FloatArray | None = None,
    upper: FloatArray | None = None,
) -> State:
    """Particles around a known pose. mean, sd, lower, upper : (D,) float64, the state's units."""
    state = initial_state(rng, mean, sd, config.particles, lower, upper)
    belief = Belief.at_rest(state.estimate, np.asarray(sd, dtype=np.float64))
    return State(**vars(state), covariance=belief.covariance, cross=belief.cross,
                 velocity_covariance=belief.velocity_covariance)  # fmt: skip


def step(
    rng: np.random.Generator, state: State, likelihood: GuidingLikelihood, dynamics: Dynamics, config: Config = WORKING
) -> tuple[State, Info]:
    """One frame: predict, climb, draw, weigh."""
    if not hasattr(likelihood, "normal_equations"):
        raise InputError("guided filter", expected="a likelihood with normal_equations", got=type(likelihood).__name__)
    counted = CountingLikelihood(likelihood, dynamics, config.sharpness)
    prior = _Prior(dynamics.carry(state.belief), dynamics)
    peak = _climb_all(prior, counted, likelihood, config)
    guess = guess_of(likelihood, peak.pose.size) if config.guesses else None
    if guess is not None:
        peak = _guessed(guess, peak, counted, likelihood, config)
    taken = np.nan if guess is None else float(peak.prior is not prior)
    for block in config.blocks if config.redraws else ():
        peak = _redraw(rng, np.array(block), peak, counted, likelihood, config)
    mode = peak.pose
    precision = peak.seen.curvature / config.dependence + peak.prior.precision
    precision = 0.5 * (precision + precision.T)  # inverses of inverses drift from symmetry
    standard = rng.standard_normal((config.particles, mode.size))
    standard[0] = 0.0  # the mode itself is always among them
    deviations = np.linalg.solve(np.linalg.cholesky(precision).T, standard.T).T
    particles = reflect(mode + deviations, dynamics.lower, dynamics.upper)
    log_likelihoods = counted.log_prob(particles)
    log_weights = _log_weights(particles, log_likelihoods, standard, peak.prior, config)
    layers = Layers()
    layers.append(Weights(log_weights).survival_rate, config.sharpness)
    population = Population(particles, log_likelihoods)
    following, info = conclude(state, particles, population, log_weights, counted, config, dynamics, layers)
    info = replace(info, alpha=taken)
    if info.collapsed:
        return following, info
    if config.weighting == "laplace":  # the particles' mean is the mode plus noise
        following = replace(following, estimate=mode)
    belief = peak.prior.belief.corrected(following.estimate, np.linalg.inv(precision).astype(np.float64))
    return replace(following, velocity=belief.velocity, covariance=belief.covariance, cross=belief.cross,
                   velocity_covariance=belief.velocity_covariance), info  # fmt: skip


class _Prior:
    """What is known before the picture: what was carried over, times what is usual; no less than what the limits know.

    mean : (D,); precision, carried : (D, D), the latter without what is usual
    """

    def __init__(self, belief: Belief, dynamics: Dynamics) -> None:
        self.belief, self.dynamics = belief, dynamics
        span = dynamics.upper - dynamics.lower
        known = np.where(np.isfinite(span), 12.0 / np.maximum(span, 1e-6) ** 2, 1e-9)  # of a uniform density
        usual = dynamics.usual_precision(belief.mean)
        self.carried: FloatArray = np.linalg.inv(belief.covariance).astype(np.float64) + np.diag(known)
        self.precision: FloatArray = self.carried + np.diag(usual)
        towards = np.linalg.solve(self.precision, usual * (dynamics.usual - belief.mean))
        self.mean: FloatArray = np.clip(belief.mean + towards, dynamics.lower, dynamics.upper)

    def freed(self, block: NDArray[np.intp], values: FloatArray, sd: float | FloatArray) -> _Prior:
        """The same with one block's components (B,) about `values`, whatever they were before."""
        return _Prior(self.belief.freed(block, values, sd), self.dynamics)


@dataclass(frozen=True, eq=False)
class _Peak:
    """Where a climb ended: pose (D,), its log likelihood, the curvature there, and the prior it climbed under."""

    pose: FloatArray
    log_likelihood: float
    seen: Linearised
    prior: _Prior


def climb(
    start: FloatArray,
    precision: FloatArray,
    likelihood: GuidingLikelihood,
    dynamics: Dynamics,
    spreads: Sequence[float],
    components: NDArray[np.intp] | None = None,
    dependence: float = 1.0,
) -> tuple[FloatArray, Linearised]:
    """The posterior's mode (D,) near a pose (D,) of prior precision (D, D), and the curvature there.

    components : (B,) int, optional
        Those that may move, the others standing; the curvature is then (B, B).
    """
    part = np.arange(start.size) if components is None else components
    precision = precision[np.ix_(part, part)]
    mode = start.copy()
    for spread in spreads:
        seen = likelihood.normal_equations(mode, spread, components)
        gradient = seen.gradient / dependence + precision @ (start - mode)[part]
        change = np.linalg.solve(seen.curvature / dependence + precision, gradient)
        change *= min(1.0, LARGEST_TURN / max(1e-12, float(np.abs(change).max())))
        mode[part] = np.clip(mode[part] + change, dynamics.lower[part], dynamics.upper[part])
    return mode, seen


def _climb_all(prior: _Prior, counted: CountingLikelihood, likelihood: GuidingLikelihood, config: Config) -> _Peak:
    pose, seen = climb(
        prior.mean, prior.precision, likelihood, prior.dynamics, config.spreads, dependence=config.dependence
    )
    return _Peak(pose, float(counted.log_prob(pose[None])[0]), seen, prior)


def _guessed(
    guess: Guess, peak: _Peak, counted: CountingLikelihood, likelihood: GuidingLikelihood, config: Config
) -> _Peak:
    """The best of the peaks above the guess's modes, where it explains the picture clearly better than `peak`."""
    best, needed = peak, _needed(peak, config)
    for mode in np.argsort(-guess.weights, kind="stable")[: config.guesses]:
        sd = np.maximum(np.sqrt(guess.variances[mode]), STANDING)
        free = peak.prior.freed(guess.components, guess.means[mode], sd)
        other = _climb_all(free, counted, likelihood, config)
        if other.log_likelihood > max(needed, best.log_likelihood):
            best = other
    return best


def _needed(peak: _Peak, config: Config) -> float:
    """The log likelihood from which another peak is clearly better."""
    return peak.log_likelihood + config.improvement * abs(peak.log_likelihood)


def _redraw(
    rng: np.random.Generator,
    block: NDArray[np.intp],
    peak: _Peak,
    counted: CountingLikelihood,
    likelihood: GuidingLikelihood,
    config: Config,
) -> _Peak:
    """Draw one block anew; the peak that explains the picture best."""
    dynamics = peak.prior.dynamics
    low, high = np.maximum(dynamics.lower[block], -np.pi), np.minimum(dynamics.upper[block], np.pi)
    drawn = np.repeat(peak.pose[None], config.redraws, axis=0)
    drawn[:, block] = rng.uniform(low, high, (config.redraws, block.size))
    scores = counted.log_prob(drawn)
    best = np.argsort(-scores, kind="stable")[: config.tries]
    free = np.eye(peak.pose.size) / config.freedom**2
    for start in drawn[best[config.sharpness * (scores[best] - peak.log_likelihood) > -config.hopeful]]:
        alone, _ = climb(start, free, likelihood, dynamics, config.spreads[::2], block, config.dependence)
        needed = _needed(peak, config)
        if float(counted.log_prob(alone[None])[0]) <= needed:
            continue
        other = _climb_all(peak.prior.freed(block, alone[block], config.freedom), counted, likelihood, config)
        if other.log_likelihood > needed:
            peak = other
    return peak


def _log_weights(
    particles: FloatArray,
    log_likelihoods: FloatArray,
    standard: FloatArray,
    prior: _Prior,
    config: Config,
) -> FloatArray:
    """Unnormalised log weights (N,): of equal draws, by the likelihood, or by posterior over proposal."""
    possible = np.where(np.isfinite(log_likelihoods), 0.0, -np.inf)
    if config.weighting == "laplace":
        return possible
    if config.weighting == "likelihood":
        return config.sharpness * log_likelihoods
    away = particles - prior.belief.mean  # what is usual is part of the log likelihood already, see CountingLikelihood
    log_prior = -0.5 * np.einsum("nd,de,ne->n", away, prior.carried, away)
    log_proposal = -0.5 * np.sum(standard**2, axis=1)
    return config.sharpness * log_likelihoods + log_prior - log_proposal
