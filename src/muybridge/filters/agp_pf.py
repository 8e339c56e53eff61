"""The annealed Gaussian process guided particle filter: annealing from a prior that a guess has a share in.

A regressor guesses the state from the picture alone; the first layer of an annealing run begins with some particles
from the guess and the others from the motion model, and the likelihood decides. The guess needs no past, so that a
track that was lost is found again; the motion model needs no guess, so that a frame guessed badly is survived.

Paper: Sedai, Bennamoun and Huynh, "A Gaussian process guided particle filter for tracking 3D human pose in video",
IEEE Transactions on Image Processing 22(11), 2013, section IV-C, Table I.

====================  ==========================================
symbol                name
====================  ==========================================
n, M                  config.particles, config.layers
p(y | x_t)            likelihood.guess, see `guess`
alpha(x_t)            share_of_guess, config.alpha, Info.alpha
sigma^2(x_t)          Guess.variance
lambda                config.trusted_variance
Sigma                 dynamics.noise_sd, squared
A_l, zeta(A_l)        exponent, Weights.survival_rate
====================  ==========================================

The layers are those of `annealed`. Special cases are settings, `PRESETS`: without a share for the guess it is
`annealed` itself, to the bit; with nothing but the guess it detects and does not track; with one layer it does not
anneal.

Differences from the paper: the share may be set (`alpha`) in place of following from the guess's variance; a guess that
speaks of the place is believed there too. Sigma is the dynamics' own. And all that `annealed` may differ by.

Cost: n M likelihood evaluations a frame, and one more for the estimate where that is the mean.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from muybridge.filters import annealed
from muybridge.filters.dynamics import Dynamics, checked_limits, reflect
from muybridge.filters.guess import Guess, guess_of
from muybridge.filters.particles import FloatArray
from muybridge.filters.state import CommonConfig, Info, Likelihood, PlainInit, State, initial_state, require

PRINTED_TRUST = 0.003  # lambda of (19), state units squared (radians); section V-C1


@dataclass(frozen=True, kw_only=True)
class Config(annealed.Config):
    """Settings of the annealed filter, and of the guess's share."""

    particles: int = 300  # n; section V-C1
    layers: int = 5  # M; section V-C1
    survival: float = 0.5  # (24)
    shrink: float = 0.5**0.5  # of standard deviations: Sigma, the covariance, halves; section IV-C
    trusted_variance: float | None = PRINTED_TRUST  # lambda of (19); None: what the guess says of itself, if it does
    alpha: float | None = None  # share of the first layer drawn from the guess; None: (19)

    def __post_init__(self) -> None:
        super().__post_init__()
        known = self.trusted_variance is None or self.trusted_variance > 0
        require("trusted_variance", known, "above 0", self.trusted_variance)
        require("alpha", self.alpha is None or 0 <= self.alpha <= 1, "between 0 and 1", self.alpha)


PRINTED = Config(estimate="mean")  # the expectation: section IV-B
# Measured on rendered people, see docs/benchmarks.md, "The guided Gaussian-process filter". The sharpness matters most:
# without it what is usual outweighs what is seen.
WORKING = Config(survival=0.1, contraction=0.8, sharpness=200.0, trusted_variance=None, estimate="mean",
                 resampling="systematic")  # fmt: skip

#: The cases that the paper compares, section V-C: no layers is one, under the likelihood as it is.
PRESETS = {
    "agp-pf": PRINTED,
    "apf": replace(PRINTED, alpha=0.0),
    "agp": replace(PRINTED, alpha=1.0),
    "gp-pf": replace(PRINTED, layers=1, exponents=(1.0,)),
    "pf": replace(PRINTED, layers=1, exponents=(1.0,), alpha=0.0),
}

init = PlainInit(WORKING)  # particles around a known pose


def begin(
    rng: np.random.Generator,
    guess: Guess,
    mean: FloatArray,
    sd: FloatArray,
    config: CommonConfig = WORKING,
    lower: FloatArray | None = None,
    upper: FloatArray | None = None,
) -> State:
    """S_0, all particles from p(y_0 | x_0) with equal weights; Table I.

    mean, sd, lower, upper : (D,) float64, the state's units; the first two count where the guess says nothing.
    """
    state = initial_state(rng, mean, sd, config.particles, lower, upper)
    low, high = checked_limits(lower, upper, state.estimate.size)
    particles = state.particles.copy()
    particles[:, guess.components] = guess.sample(rng, config.particles)
    particles = reflect(particles, low, high)
    estimate = guess.poses(state.estimate)[int(np.argmax(guess.weights))]
    return replace(state, particles=particles, estimate=np.clip(estimate, low, high))


def step(
    rng: np.random.Generator, state: State, likelihood: Likelihood, dynamics: Dynamics, config: Config = WORKING
) -> tuple[State, Info]:
    """One frame, Table I."""
    guess = guess_of(likelihood, state.particles.shape[1])
    alpha = share_of_guess(guess, config)
    if guess is None or alpha == 0.0:
        state, info = annealed.step(rng, state, likelihood, dynamics, config)
        return state, replace(info, alpha=0.0)

    def mixed(rng: np.random.Generator, predicted: FloatArray) -> FloatArray:
        """The prior (22): what the guess speaks of, in the share of the particles that are its own."""
        own = np.flatnonzero(rng.random(len(predicted)) < alpha)
        particles = predicted.copy()
        particles[np.ix_(own, guess.components)] = guess.sample(rng, own.size)
        return reflect(particles, dynamics.lower, dynamics.upper)

    state, info = annealed.anneal(rng, state, likelihood, dynamics, config, mixed)
    return state, replace(info, alpha=alpha)


def share_of_guess(guess: Guess | None, config: Config) -> float:
    """alpha(x_t) = exp(-sigma^2(x_t) / lambda), (19), unless it is set; 0 without a guess."""
    if guess is None:
        return 0.0
    if config.alpha is not None:
        return config.alpha
    trusted = config.trusted_variance or guess.trusted_variance or PRINTED_TRUST
    return float(np.exp(-guess.variance / trusted))
