"""The DE-MC particle filter: predicted particles are a population of Markov chains that learn from their
differences.

Selected particles, moved by the last velocity, climb the likelihood together: each proposes a step along the
difference of two others, which lies along the ridges of the target, and Metropolis decides.

Paper: Du, "Articulated human motion tracking with the differential evolution - Markov chain particle filter",
thesis, 2005, section 6.4 (equations in brackets).

====================  ==========================================
symbol                name
====================  ==========================================
E_n                   population.particles
f                     likelihood ** config.sharpness
lambda                config.difference_scale
c                     config.c
sigma, sigma_{k,t}    dynamics.noise_sd, times _sigma_factor
T                     config.layers
CR                    config.crossover_rate
====================  ==========================================

Differences from the paper: likelihoods live in logarithms, so (6.13) is a difference; it may be sharpened by a
power K, and has in it what the dynamics holds for usual; noise of the dynamics may be added before the moves; the
proportion of (6.20) is fixed so that the factor is 1 where noted in `_sigma_factor`, and the factor is bounded;
crossover is a move of its own, after (6.13), since swapping parts of two proposals before their acceptance would
not keep detailed balance; a proposal outside the limits is rejected. Two things may be added, both off unless asked
for: a selection before every layer that leaves a share of the chains alive (`reselect`), as in the annealed filter,
where layers are too few for chains to climb by themselves; and moves of one block of components, such as a limb, a
layer (`blocks`), lambda (6.17) being that of the block's size.

Cost: N (T + 1) likelihood evaluations a frame at most (the paper counts N T; the first population has to be
measured too), N T more with crossover, one more for the estimate where that is the mean; selections and blocks cost
none.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from muybridge.filters.dynamics import Dynamics
from muybridge.filters.moves import Partners, Target, difference_scale_of, differential_move, exchange_move
from muybridge.filters.particles import FloatArray, Weights
from muybridge.filters.resampling import resample
from muybridge.filters.schedule import exponent_for_survival, powered
from muybridge.filters.state import (
    Blocks,
    CommonConfig,
    CountingLikelihood,
    Info,
    Layers,
    Likelihood,
    PlainInit,
    Population,
    State,
    conclude,
    require,
)

ADAPTATIONS = ("off", "raw_likelihood", "effective_sample_size")
FACTOR_BOUND = 10.0  # (6.20) may not make the jumps more than this much larger or smaller; ours


@dataclass(frozen=True, kw_only=True)
class Config(CommonConfig):
    """Settings of the DE-MC filter. All are ratios, without unit."""

    particles: int = 500  # N; section 7.1
    layers: int = 7  # T; section 7.1
    c: float = 0.1  # jumps by the dynamics' noise; so that (6.17) gives the printed 0.437
    difference_scale: float | None = None  # lambda; None is (6.17)
    jump: Literal["uniform", "normal"] = "uniform"  # g ~ U(-c sigma, c sigma), or N(0, (c sigma)^2); section 6.4
    adaptation: Literal["off", "raw_likelihood", "effective_sample_size"] = "raw_likelihood"  # reading of (6.20)
    crossover_rate: float = 0.0  # CR of (6.11); 0 is no crossover
    partners: Partners = "all"  # who r1 and r2 are; "other_half" is exact at any N, see moves.differential_move
    dynamics_noise: float = 0.0  # noise before the moves, times dynamics.noise_sd; 0 is printed, (6.16)
    reselect: float | None = None  # before every layer so many survive a selection; None is printed: only at the start
    blocks: Blocks | None = None  # components that layer t moves, taken in turn; None is all in every layer
    by_limb: bool = False  # a tracker, which knows the body, fills in blocks: the root, then each limb

    def __post_init__(self) -> None:
        super().__post_init__()
        require("layers", self.layers >= 0, "at least 0", self.layers)
        require("c", 0 <= self.c <= 1, "between 0 and 1", self.c)
        require("jump", self.jump in ("uniform", "normal"), "uniform | normal", self.jump)
        require("adaptation", self.adaptation in ADAPTATIONS, " | ".join(ADAPTATIONS), self.adaptation)
        require("crossover_rate", 0 <= self.crossover_rate <= 1, "between 0 and 1", self.crossover_rate)
        require("partners", self.partners in ("all", "other_half"), "all | other_half", self.partners)
        require("dynamics_noise", self.dynamics_noise >= 0, "not negative", self.dynamics_noise)
        require("reselect", self.reselect is None or 0 < self.reselect < 1, "between 0 and 1", self.reselect)
        if self.blocks is not None:
            require("blocks", len(self.blocks) > 0 and all(map(len, self.blocks)), "no empty block", self.blocks)


PRINTED = Config()
# After selection most members are copies and their differences vanish: spread brought in by the dynamics keeps a
# moving body. Few chains that run long beat many that run short: they have to climb, and only layers are steps. Jumps
# of constant size and a sharp likelihood let them; docs/benchmarks.md, "The papers' filters". 60 x (82 + 1) = 4980.
# Tables of papers/du-2005/results: E2 (more layers are better), settings-paired (crossover is better and costs twice as
# much, for which layers buy more; (6.20) is no better than off; mean and maximum are alike), search (long chains).
WORKING = Config(particles=60, layers=82, c=0.05, difference_scale=0.27, sharpness=1000.0, dynamics_noise=0.5,
                 adaptation="off", partners="other_half", estimate="mean", resampling="systematic")  # fmt: skip

init = PlainInit(WORKING)  # particles around a known pose


def step(
    rng: np.random.Generator, state: State, likelihood: Likelihood, dynamics: Dynamics, config: Config = WORKING
) -> tuple[State, Info]:
    """One frame, section 6.4, steps 1 to 3."""
    counted = CountingLikelihood(likelihood, dynamics, config.sharpness)
    target = Target(counted, dynamics.lower, dynamics.upper, exponent=config.sharpness)
    selected = resample(rng, Weights(state.log_weights), config.particles, config.resampling)  # 1
    predicted = dynamics.sample(rng, state.particles[selected], state.velocity, config.dynamics_noise)  # 2, (6.16)
    population = first = target.measure(predicted)
    log_weights = config.sharpness * population.log_likelihoods
    layers = Layers()
    for layer in range(config.layers):
        population = _reselected(rng, population, config)
        factor = _sigma_factor(population.log_likelihoods, first.log_likelihoods, config)  # (6.20)
        moved = _moved(config, layer, predicted.shape[1])
        jump = moved * _jumps(rng, predicted.shape, config.c * factor * dynamics.noise_sd, config)
        scale = moved * _difference_scale(config, int(moved.sum()))
        population, accepted = differential_move(rng, population, target, scale, jump, config.partners)  # (6.12)-(6.13)
        if config.crossover_rate > 0:
            population, _ = exchange_move(rng, population, target, config.crossover_rate)  # (6.11), (6.15)
        log_weights = config.sharpness * population.log_likelihoods
        layers.append(Weights(log_weights).survival_rate, config.sharpness, accepted)
    return conclude(state, predicted, population, log_weights, counted, config, dynamics, layers)  # 3, (6.18), (6.19)


def _reselected(rng: np.random.Generator, population: Population, config: Config) -> Population:
    """The population after a selection that leaves the wanted share alive; as it was where none is wanted."""
    if config.reselect is None:
        return population
    exponent = min(exponent_for_survival(population.log_likelihoods, config.reselect), config.sharpness)
    weights = Weights(powered(population.log_likelihoods, exponent))
    return (
        population
        if weights.collapsed
        else population.take(resample(rng, weights, config.particles, config.resampling))
    )


def _moved(config: Config, layer: int, size: int) -> FloatArray:
    """(D,) 1 for the components that a layer moves, 0 for the others."""
    if config.blocks is None:
        return np.ones(size)
    block = list(config.blocks[layer % len(config.blocks)])
    require("blocks", 0 <= min(block) and max(block) < size, f"components 0 to {size - 1}", config.blocks)
    moved = np.zeros(size)
    moved[block] = 1.0
    return moved


def _sigma_factor(log_likelihoods: FloatArray, first: FloatArray, config: Config) -> float:
    """What sigma is multiplied by before the next layer: proportional to 1 / sum w^2, (6.20).

    "raw_likelihood": w are the likelihoods themselves, so that a population that fits well jumps less, as the text
    says. The constant makes the factor 1 for the frame's first population (`first`).
    "effective_sample_size": w are normalised, so that jumps grow as more particles survive. The constant, 1 / N, makes
    the factor 1 where all survive.
    Measured on a Gaussian target moving in 24 dimensions: with the printed settings the first reading has 2 to 7 % less
    error than the second (and "off" less than both); with the working settings no difference stands out of the noise.
    """
    if config.adaptation == "off":
        return 1.0
    if config.adaptation == "effective_sample_size":
        factor = Weights(config.sharpness * log_likelihoods).survival_rate
    else:
        factor = np.exp(np.clip(_log_sum_of_squares(first) - _log_sum_of_squares(log_likelihoods), -50.0, 50.0))
    return float(np.clip(factor, 1.0 / FACTOR_BOUND, FACTOR_BOUND))


def _log_sum_of_squares(log_likelihoods: FloatArray) -> float:
    """log sum w^2, finite: a population without any possible member counts as e^-700."""
    highest = max(float(log_likelihoods.max()), -350.0)
    return 2.0 * highest + float(np.log(max(np.exp(2.0 * (log_likelihoods - highest)).sum(), 1e-300)))


def _jumps(rng: np.random.Generator, shape: tuple[int, ...], width: FloatArray, config: Config) -> FloatArray:
    """g of (6.12), (N, D): uniform in +-width, or normal with standard deviation width (D,)."""
    if config.jump == "uniform":
        return rng.uniform(-1.0, 1.0, shape) * width
    return rng.standard_normal(shape) * width


def _difference_scale(config: Config, dimensions: int) -> float:
    return difference_scale_of(config.c, dimensions) if config.difference_scale is None else config.difference_scale
