"""The annealed particle filter: layers of selection and shrinking noise under a likelihood that grows sharper.

The first layer looks at a flattened likelihood with wide noise, the last at a sharp one with narrow noise. How
much each layer flattens is found, not set: the power at which a wanted share of the particles survives.

Paper: Deutscher, Blake and Reid, "Articulated body motion capture by annealed particle filtering", CVPR 2000,
section 3; compared with in Du (2005), section 7.2. Limb blocks after Deutscher, Davison and Reid, "Automatic
partitioning of high dimensional search spaces", CVPR 2001, with the partition given instead of found.

====================  ==========================================
symbol                name
====================  ==========================================
M                     config.layers
beta_m                exponent
alpha (survival)      config.survival, Weights.survival_rate
P_m = alpha_m P       noise scale, config.shrink ** visits
X_k^(i)               particles
====================  ==========================================

Differences from the paper: beta is not bounded by 1, so that a flat likelihood is sharpened as far as needed;
the exponents may be given instead (`exponents`); optional limb blocks and contraction towards the mean. The
final weights carry the last layer's power: the spread they have is the search's, not a posterior's.

Cost: N M likelihood evaluations a frame, and one more for the estimate where that is the mean.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from muybridge.filters.dynamics import Dynamics
from muybridge.filters.particles import FloatArray, Weights, mean_estimate
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


@dataclass(frozen=True, kw_only=True)
class Config(CommonConfig):
    """Settings of the annealed filter. All are ratios, without unit."""

    particles: int = 500  # N; Du (2005), Table 7.1
    layers: int = 10  # M; Du (2005), Table 7.1
    survival: float = 0.5  # share that survives a layer; Deutscher et al. (2000), section 3
    shrink: float = 0.5  # noise of a layer by the noise of the one before; Deutscher et al. (2000), section 3
    contraction: float = 1.0  # between layers, distances to the mean times this; 1 is off (ours)
    exponents: tuple[float, ...] | None = None  # beta_1 ... beta_M given instead of found (times sharpness)
    blocks: Blocks | None = None  # components that layer m perturbs, taken in turn; None is all in every layer
    by_limb: bool = False  # a tracker, which knows the body, fills in blocks: the root, then each limb

    def __post_init__(self) -> None:
        super().__post_init__()
        require("layers", self.layers >= 1, "at least 1", self.layers)
        require("survival", 0 < self.survival < 1, "between 0 and 1", self.survival)
        require("shrink", 0 < self.shrink <= 1, "above 0, at most 1", self.shrink)
        require("contraction", 0 < self.contraction <= 1, "above 0, at most 1", self.contraction)
        if self.exponents is not None:
            rising = all(b > 0 for b in self.exponents) and list(self.exponents) == sorted(self.exponents)
            require("exponents", rising and len(self.exponents) == self.layers, "one a layer, rising", self.exponents)
        if self.blocks is not None:
            require("blocks", len(self.blocks) > 0 and all(map(len, self.blocks)), "no empty block", self.blocks)


PRINTED = Config(estimate="mean")  # the expectation: Deutscher et al. (2000), section 3
# Measured on rendered scenes seen by four cameras, see docs/benchmarks.md, "The papers' filters": three rounds of limb
# blocks beat one or two, which beat five layers of the whole body; shrinking by .71 beats .5; survival between .05 and
# .2 makes little difference. 277 x 18 = 4986 evaluations.
# The sharpness is about what the survival rate finds; only what is usual is weighed by it.
WORKING = Config(particles=277, layers=18, survival=0.1, shrink=0.71, contraction=0.8, by_limb=True, sharpness=200.0,
                 estimate="mean", resampling="systematic")  # fmt: skip

init = PlainInit(WORKING)  # particles around a known pose

Mix = Callable[[np.random.Generator, FloatArray], FloatArray]
"""(rng, predicted particles (N, D)) -> the particles (N, D) that the first layer measures."""


def step(
    rng: np.random.Generator, state: State, likelihood: Likelihood, dynamics: Dynamics, config: Config = WORKING
) -> tuple[State, Info]:
    """One frame, an annealing run of M layers; Deutscher et al. (2000), section 3."""
    return anneal(rng, state, likelihood, dynamics, config)


def anneal(
    rng: np.random.Generator,
    state: State,
    likelihood: Likelihood,
    dynamics: Dynamics,
    config: Config,
    mix: Mix | None = None,
) -> tuple[State, Info]:
    """As `step`, from a first population in which `mix` has put others in the place of some that were predicted."""
    counted = CountingLikelihood(likelihood, dynamics, config.sharpness)
    particles, weights = state.particles, Weights(state.log_weights)
    velocity: FloatArray | None = state.velocity
    layers = Layers()
    for layer, noise_scale in enumerate(_noise_scales(config, particles.shape[1])):
        selected = resample(rng, weights, config.particles, config.resampling)
        if layer > 0:
            particles = _contracted(particles, weights, np.where(noise_scale > 0, config.contraction, 1.0))
        particles = dynamics.sample(rng, particles[selected], velocity, noise_scale)
        if layer == 0 and mix is not None:
            particles = mix(rng, particles)
        if layer == 0:
            predicted, velocity = particles, None  # the prediction is made once
        log_likelihoods = counted.log_prob(particles)
        exponent = _exponent(log_likelihoods, layer, config)
        weights = Weights(powered(log_likelihoods, exponent))
        layers.append(weights.survival_rate, exponent)
        if weights.collapsed:
            break
    log_weights = np.full(len(particles), -np.inf) if weights.collapsed else weights.log
    population = Population(particles, log_likelihoods)
    return conclude(state, predicted, population, log_weights, counted, config, dynamics, layers)


def _noise_scales(config: Config, size: int) -> Iterator[FloatArray]:
    """(D,) noise scale of each layer: shrunk once for every earlier layer that perturbed it; 0 outside the block."""
    if config.blocks is not None:
        components = [component for block in config.blocks for component in block]
        require("blocks", 0 <= min(components) and max(components) < size, f"components 0 to {size - 1}", components)
    visits = np.zeros(size)
    for layer in range(config.layers):
        perturbed = np.ones(size, dtype=bool)
        if config.blocks is not None:
            perturbed[:] = False
            perturbed[list(config.blocks[layer % len(config.blocks)])] = True
        yield np.where(perturbed, config.shrink**visits, 0.0)
        visits[perturbed] += 1


def _contracted(particles: FloatArray, weights: Weights, factor: FloatArray) -> FloatArray:
    """Distances to the mean times factor (D,); particles (N, D) stay within any box that holds them."""
    if (factor == 1.0).all():
        return particles
    centre = mean_estimate(particles, weights)
    return centre + factor * (particles - centre)


def _exponent(log_likelihoods: FloatArray, layer: int, config: Config) -> float:
    """The layer's beta: given, or found by bisection for the wanted survival rate."""
    if config.exponents is not None:
        return config.exponents[layer] * config.sharpness
    return exponent_for_survival(log_likelihoods, config.survival)
