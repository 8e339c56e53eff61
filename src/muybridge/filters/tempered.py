"""The tempered filter: annealing exponents for the way, Metropolis-correct moves for the truth.

Particles drawn from the dynamics are taken to the posterior over a bridge of rising powers of the likelihood;
after each rise they are selected and then moved along their own differences by moves that leave that layer's
target as it is. What comes out is a posterior, and its spread may be reported.

Papers: Neal, "Annealed importance sampling", Statistics and Computing 2001; Del Moral, Doucet and Jasra,
"Sequential Monte Carlo samplers", JRSS B 2006 (section 3.3.2: select, then move); moves as in Du (2005),
(6.12)-(6.13).

====================  ==========================================
symbol                name
====================  ==========================================
beta_l                exponent
p(X_k | X_{k-1})      log_prior, about `centres`, the dynamics' mean for the particle's own ancestor
lambda                config.difference_scale
g                     jumps, c sigma shrunk in every layer
====================  ==========================================

Differences from the papers: the exponents are found by the survival rate of each rise (as in the annealed
filter) and stop at `sharpness`; the moves are differential evolution. Each particle keeps its ancestor, which
makes the prior a product of known normal densities; near a limit the folded part of that density is left out.

Cost: at most N (layers + 1) likelihood evaluations a frame, and one more for the estimate where that is the
mean.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from muybridge.filters.dynamics import Dynamics
from muybridge.filters.moves import LogPrior, Target, difference_scale_of, differential_move
from muybridge.filters.particles import FloatArray, Weights
from muybridge.filters.resampling import Indices, resample
from muybridge.filters.schedule import exponent_for_survival, powered
from muybridge.filters.state import (
    CommonConfig,
    CountingLikelihood,
    Info,
    Layers,
    Likelihood,
    PlainInit,
    State,
    conclude,
    require,
)

UNFINISHED_REMEDY = "the layers ended before the full likelihood was reached: more layers, or a lower survival rate"
ALL_EQUAL = 1.0 - 1e-9


@dataclass(frozen=True, kw_only=True)
class Config(CommonConfig):
    """Settings of the tempered filter. All are ratios, without unit."""

    particles: int = 500  # N
    layers: int = 9  # rises of the exponent, each followed by one move; 500 x (9 + 1) = 5000 evaluations
    survival: float = 0.5  # share that survives a rise; Del Moral et al. (2006), section 3.5: select below a half
    difference_scale: float | None = None  # lambda; None is 2.38 / sqrt(2 D), ter Braak (2006)
    c: float = 0.1  # first layer's jumps by the dynamics' noise; Du (2005), section 6.4
    shrink: float = 0.71  # jumps of a layer by those of the one before; as in the annealed filter
    keep_prior: bool = True  # False: moves see the likelihood alone, as DE-MC's do (a search, not a posterior)

    def __post_init__(self) -> None:
        super().__post_init__()
        require("layers", self.layers >= 1, "at least 1", self.layers)
        require("survival", 0 < self.survival < 1, "between 0 and 1", self.survival)
        require("c", 0 <= self.c <= 1, "between 0 and 1", self.c)
        require("shrink", 0 < self.shrink <= 1, "above 0, at most 1", self.shrink)


PRINTED = Config(estimate="mean")  # no paper prints exactly this; a likelihood that is a likelihood, sharpness 1
# As for DE-MC, few particles that move often beat many that move seldom; survival .9 makes the rises small enough for
# them. Measured: docs/benchmarks.md, "The papers' filters". 60 x (82 + 1) = 4980 evaluations.
WORKING = Config(particles=60, layers=82, survival=0.9, shrink=1.0, sharpness=1000.0, estimate="mean",
                 resampling="systematic")  # fmt: skip

init = PlainInit(WORKING)  # particles around a known pose


def step(
    rng: np.random.Generator, state: State, likelihood: Likelihood, dynamics: Dynamics, config: Config = WORKING
) -> tuple[State, Info]:
    """One frame: predict, then for each layer rise, select, move."""
    counted = CountingLikelihood(likelihood, dynamics, config.sharpness)
    selected = resample(rng, Weights(state.log_weights), config.particles, config.resampling)
    centres = dynamics.sample(rng, state.particles[selected], state.velocity, 0.0)
    predicted = dynamics.sample(rng, centres)
    target = Target(counted, dynamics.lower, dynamics.upper, exponent=0.0)
    population, layers = target.measure(predicted), Layers()
    for layer in range(config.layers):
        exponent = _next_exponent(population.log_likelihoods, target.exponent, config)
        weights = Weights(powered(population.log_likelihoods, exponent - target.exponent))
        if weights.collapsed:
            break
        if weights.survival_rate < ALL_EQUAL:  # selecting among equals would only lose some
            selected = resample(rng, weights, config.particles, config.resampling)
            population, centres = population.take(selected), centres[selected]
        log_prior = _normal_about(centres, dynamics.noise_sd) if config.keep_prior else None
        target = replace(target, exponent=exponent, log_prior=log_prior)
        jumps = rng.standard_normal(predicted.shape) * (config.c * config.shrink**layer * dynamics.noise_sd)
        population, accepted = differential_move(rng, population, target, _scale(config, len(state.estimate)), jumps)
        layers.append(weights.survival_rate, exponent, accepted)
    scores = target.log_density(population, np.arange(config.particles))
    log_weights = np.where(scores > -np.inf, 0.0, -np.inf)
    remedy = UNFINISHED_REMEDY if target.exponent < config.sharpness else ""
    return conclude(
        state, predicted, population, log_weights, counted, config, dynamics, layers, scores=scores, remedy=remedy
    )


def _next_exponent(log_likelihoods: FloatArray, exponent: float, config: Config) -> float:
    """beta_{l+1}: as far as the survival rate allows, at most to the sharpness."""
    missing = config.sharpness - exponent
    if missing <= 0:
        return exponent
    rise = exponent_for_survival(log_likelihoods, config.survival, highest=missing)
    return config.sharpness if rise == missing else exponent + rise


def _normal_about(centres: FloatArray, sd: FloatArray) -> LogPrior:
    """log p(X_k | X_{k-1}) up to a constant, for poses (M, D) that would replace `members` (M,).

    A component without noise has no density and is left out: give it no spread at the start either, and it stays.
    """
    free = sd > 0

    def log_prior(poses: FloatArray, members: Indices) -> FloatArray:
        deviations = (poses[:, free] - centres[members][:, free]) / sd[free]
        squared: FloatArray = np.einsum("nd,nd->n", deviations, deviations)
        return -0.5 * squared

    return log_prior


def _scale(config: Config, dimensions: int) -> float:
    return difference_scale_of(0.0, 2 * dimensions) if config.difference_scale is None else config.difference_scale
