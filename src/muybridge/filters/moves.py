"""Moves that leave a target as they found it: differential evolution and exchange, each accepted by Metropolis.

Du (2005), section 6.3, after ter Braak, "A Markov chain Monte Carlo version of the genetic algorithm
differential evolution", Statistics and Computing 2006.

====================  ==========================================
symbol                name
====================  ==========================================
E_n, E*_n             population.particles, proposals
f                     exp(exponent log_likelihood + log_prior)
lambda                difference_scale
g                     jump
r1, r2                first, second
CR, V, l              rate, length, start
====================  ==========================================

The target is zero outside the limits: a proposal outside is rejected without asking the
likelihood. (Folding it back would break detailed balance, since differences between members are correlated.)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from muybridge.filters.dynamics import within
from muybridge.filters.particles import FloatArray
from muybridge.filters.resampling import Indices
from muybridge.filters.schedule import powered
from muybridge.filters.state import CountingLikelihood, Population

Partners = Literal["all", "other_half"]
LogPrior = Callable[[FloatArray, Indices], FloatArray]


@dataclass(frozen=True, eq=False)
class Target:
    """f of (6.13): likelihood to a power, times an optional prior, zero outside the limits.

    log_prior takes poses (M, D) and the members (M,) they would replace, and returns (M,).
    """

    likelihood: CountingLikelihood
    lower: FloatArray
    upper: FloatArray
    exponent: float = 1.0
    log_prior: LogPrior | None = None

    def measure(self, particles: FloatArray) -> Population:
        """Log likelihoods of the particles inside the limits; -inf for the others, without an evaluation."""
        log_likelihoods = np.full(len(particles), -np.inf)
        inside = within(particles, self.lower, self.upper)
        log_likelihoods[inside] = self.likelihood.log_prob(particles[inside])
        return Population(particles, log_likelihoods)

    def log_density(self, population: Population, members: Indices) -> FloatArray:
        """(M,) log f of a population that stands for `members`."""
        log_f = powered(population.log_likelihoods, self.exponent)
        return log_f if self.log_prior is None else log_f + self.log_prior(population.particles, members)


def differential_move(
    rng: np.random.Generator,
    population: Population,
    target: Target,
    difference_scale: float | FloatArray,
    jump: FloatArray,
    partners: Partners = "other_half",
) -> tuple[Population, float]:
    """One move of every member along the difference of two others, (6.12) and (6.13).

    Parameters
    ----------
    difference_scale : float or (D,) float64
        lambda; 0 for components that stand.
    jump : (N, D) float64, state units
        g, drawn by the caller from a distribution symmetric about zero.
    partners : "all" | "other_half"
        "all" moves everybody at once, with r1 and r2 from the whole population, as printed: right in the limit of many
        members. "other_half" moves one random half with r1 and r2 from the other, then the other way round: exact.

    Returns
    -------
    population, share of the moves that were accepted
    """
    size = len(population.particles)
    accepted_count = 0
    for members, others in _groups(rng, size, partners):
        first, second = _two_partners(rng, members, others)
        difference = population.particles[first] - population.particles[second]
        proposals = population.particles[members] + difference_scale * difference + jump[members]  # (6.12)
        population, accepted = _metropolis(rng, population, members, target.measure(proposals), target)
        accepted_count += int(accepted.sum())
    return population, accepted_count / size


def exchange_move(
    rng: np.random.Generator, population: Population, target: Target, rate: float
) -> tuple[Population, float]:
    """Crossover that keeps detailed balance: two members swap a run of components, both or neither, (6.11) and (6.15).

    Run length V with P(V = v) proportional to rate^v for v = 1 ... D-1 (v = 0 would swap nothing and cost two
    evaluations), start uniform, indices modulo D. Members are paired at random; an odd one sits out.
    """
    size, dimensions = population.particles.shape
    if dimensions < 2:
        return population, 0.0
    first, second = rng.permutation(size)[: size - size % 2].reshape(2, -1)
    swapped = _runs(rng, first.size, dimensions, rate)
    a, b = population.particles[first], population.particles[second]
    child_a, child_b = target.measure(np.where(swapped, b, a)), target.measure(np.where(swapped, a, b))
    with np.errstate(invalid="ignore"):  # -inf - -inf is NaN, and NaN is not accepted
        log_ratio = target.log_density(child_a, first) + target.log_density(child_b, second)
        log_ratio -= target.log_density(population.take(first), first)
        log_ratio -= target.log_density(population.take(second), second)  # (6.15)
    accepted = np.log(rng.random(first.size)) < log_ratio
    population = population.replace(first, accepted, child_a).replace(second, accepted, child_b)
    return population, float(accepted.mean())


def difference_scale_of(c: float, dimensions: int) -> float:
    """lambda = (1 - c) 2.38 / sqrt(D), (6.17): 0.437 for c = 0.1, D = 24."""
    return float((1.0 - c) * 2.38 / np.sqrt(dimensions))


def _metropolis(
    rng: np.random.Generator, population: Population, members: Indices, proposed: Population, target: Target
) -> tuple[Population, NDArray[np.bool_]]:
    """Accept each proposal with probability min(1, f(E*) / f(E)), (6.13). Impossible to impossible is not accepted."""
    with np.errstate(invalid="ignore"):
        log_ratio = target.log_density(proposed, members) - target.log_density(population.take(members), members)
    accepted = np.log(rng.random(members.size)) < log_ratio
    return population.replace(members, accepted, proposed), accepted


def _groups(rng: np.random.Generator, size: int, partners: Partners) -> list[tuple[Indices, Indices]]:
    """Pairs of (members to move, members to take differences from)."""
    if partners == "all" or size < 4:
        everybody = np.arange(size)
        return [(everybody, everybody)]
    shuffled = rng.permutation(size)
    first, second = shuffled[: size // 2], shuffled[size // 2 :]
    return [(first, second), (second, first)]


def _two_partners(rng: np.random.Generator, members: Indices, others: Indices) -> tuple[Indices, Indices]:
    """r1 != r2 for every member, uniform among `others`; neither is the member itself where the two groups are one."""
    count = others.size - (1 if others is members else 0)
    first = rng.integers(0, count, members.size)
    second = rng.integers(0, count - 1, members.size)
    second += second >= first
    if others is members:  # steps of 1 ... N-1 round the ring never end at their start
        start = np.arange(members.size) + 1
        first, second = (start + first) % others.size, (start + second) % others.size
    return others[first], others[second]


def _runs(rng: np.random.Generator, pairs: int, dimensions: int, rate: float) -> NDArray[np.bool_]:
    """(pairs, D) bool: runs of components, cyclic, for (6.11)."""
    lengths = np.arange(1, dimensions)
    probabilities = rate**lengths / np.sum(rate**lengths)
    length = rng.choice(lengths, size=pairs, p=probabilities)
    start = rng.integers(0, dimensions, pairs)
    swapped: NDArray[np.bool_] = (np.arange(dimensions) - start[:, None]) % dimensions < length[:, None]
    return swapped
