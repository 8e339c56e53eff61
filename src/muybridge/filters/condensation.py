"""CONDENSATION: select, predict, measure - the particle filter every other one here is compared with.

Particles are selected in proportion to their weight, moved by the dynamics alone, and weighted by the
likelihood.

Paper: Isard and Blake, "CONDENSATION - conditional density propagation for visual tracking", IJCV 1998; as
restated in Du (2005), sections 3.4 and 3.5.

====================  ==========================================
symbol                name
====================  ==========================================
X_k^(i)               particles
w(X_k^(i))            exp(log_weights)
c(X^(i))              the cumulative weights inside `resampling`
V_{k-1}               state.velocity
K (ours)              config.sharpness
====================  ==========================================

Differences from the paper: weights live in logarithms; the likelihood may be sharpened by a power K.

Cost: N likelihood evaluations a frame, and one more for the estimate where that is the mean.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from muybridge.filters.dynamics import Dynamics
from muybridge.filters.particles import Weights
from muybridge.filters.resampling import resample
from muybridge.filters.state import (
    CommonConfig,
    CountingLikelihood,
    Info,
    Layers,
    Likelihood,
    PlainInit,
    Population,
    State,
    conclude,
)


@dataclass(frozen=True, kw_only=True)
class Config(CommonConfig):
    """Settings of CONDENSATION: the common ones, no more."""

    particles: int = 5000  # N; Du (2005), Table 7.1


PRINTED = Config()
# Mean rather than maximum, comb rather than independent draws. A likelihood in (0, 1] as (5.12) gives it is far too
# flat as it stands: K = 200 was measured to be a working sharpness for silhouettes from four cameras.
WORKING = Config(estimate="mean", resampling="systematic", sharpness=200.0)

init = PlainInit(WORKING)  # particles around a known pose


def step(
    rng: np.random.Generator, state: State, likelihood: Likelihood, dynamics: Dynamics, config: Config = WORKING
) -> tuple[State, Info]:
    """One frame, section 3.4, lines 1 to 4."""
    counted = CountingLikelihood(likelihood, dynamics, config.sharpness)
    selected = resample(rng, Weights(state.log_weights), config.particles, config.resampling)  # 1, (3.26)-(3.27)
    particles = dynamics.sample(rng, state.particles[selected], state.velocity)  # 2, (3.20), (3.22)
    population = Population(particles, counted.log_prob(particles))
    log_weights = config.sharpness * population.log_likelihoods  # 3, (3.21)
    layers = Layers()
    layers.append(Weights(log_weights).survival_rate, config.sharpness)
    return conclude(state, particles, population, log_weights, counted, config, dynamics, layers)  # 4, (3.24) or (3.25)
