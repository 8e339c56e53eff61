"""Moves leave their target as they found it; broken moves fail the very same tests."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from filters.oracles import agrees
from muybridge.filters import moves
from muybridge.filters.moves import Target, differential_move, exchange_move
from muybridge.filters.state import CountingLikelihood, Population

FREE = np.full(2, np.inf)
WALL = 0.8  # the box |x| <= WALL cuts through both modes


@dataclass(frozen=True)
class TwoModes:
    """Mixture of two correlated normals in the plane: .3 at (-1, -1) and .7 at (1, 1), correlation .8, sd .5."""

    def log_prob(self, poses: np.ndarray) -> np.ndarray:
        precision = np.linalg.inv(0.25 * np.array([[1, 0.8], [0.8, 1]]))
        square = [np.einsum("ni,ij,nj->n", poses - m, precision, poses - m) for m in (-1.0, 1.0)]
        return np.logaddexp(np.log(0.3) - 0.5 * square[0], np.log(0.7) - 0.5 * square[1])

    def draw(self, rng: np.random.Generator, count: int, box: float = np.inf) -> np.ndarray:
        centre = np.where(rng.random(40 * count) < 0.3, -1.0, 1.0)[:, None]
        shape = np.linalg.cholesky(0.25 * np.array([[1, 0.8], [0.8, 1]]))
        draws = centre + rng.standard_normal((40 * count, 2)) @ shape.T
        return draws[(np.abs(draws) <= box).all(axis=1)][:count]


def statistics_of(particles: np.ndarray) -> np.ndarray:
    """Averages over the members of moments that any change of shape, place or balance of the modes would move."""
    x, y = particles.T
    return np.array([np.mean(v) for v in (x, y, x * x, y * y, x * y, (x > 0), (x - y) ** 2)])


Move = Callable[[np.random.Generator, Population, Target], Population]


def drift_of(move: Move, box: float = np.inf, members: int = 20, layers: int = 15, replicates: int = 300) -> np.ndarray:
    """Statistics after the moves minus those of fresh draws from the target, (R, 7)."""
    model, rng = TwoModes(), np.random.default_rng(11)
    target = Target(CountingLikelihood(model), np.full(2, -box), np.full(2, box))
    rows = []
    for _ in range(replicates):
        population = target.measure(model.draw(rng, members, box))
        for _ in range(layers):
            population = move(rng, population, target)
        rows.append(statistics_of(population.particles) - statistics_of(model.draw(rng, members, box)))
    return np.array(rows)


def differential(jump_mean: float = 0.0, partners: str = "other_half") -> Move:
    def move(rng: np.random.Generator, population: Population, target: Target) -> Population:
        jump = jump_mean + 0.2 * rng.standard_normal(population.particles.shape)
        return differential_move(rng, population, target, 0.9, jump, partners)[0]

    return move


def exchange(rng: np.random.Generator, population: Population, target: Target) -> Population:
    return exchange_move(rng, population, target, 0.5)[0]


class TestInvariance:
    """The error is that of the mean over 300 independent populations; bounds from Student's t."""

    def test_differential_move_with_few_members(self) -> None:
        assert agrees(drift_of(differential()), 0.0)

    def test_differential_move_between_walls(self) -> None:
        assert agrees(drift_of(differential(), box=WALL), 0.0)

    def test_exchange_move(self) -> None:
        assert agrees(drift_of(exchange), 0.0)

    def test_moving_everybody_at_once_is_right_for_many_members(self) -> None:
        assert agrees(drift_of(differential(partners="all"), members=400, layers=5, replicates=100), 0.0)

    def test_broken_jump_is_caught(self) -> None:
        """Negative control: a jump that is not symmetric about zero."""
        assert not agrees(drift_of(differential(jump_mean=0.3)), 0.0)

    def test_step_towards_the_best_is_caught(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Negative control: (6.10), which the thesis says cannot be written in a balanced form."""

        def towards_one(rng: np.random.Generator, members: np.ndarray, others: np.ndarray) -> tuple:
            return np.full(members.size, others[0]), members

        monkeypatch.setattr(moves, "_two_partners", towards_one)
        assert not agrees(drift_of(differential()), 0.0)

    def test_clipping_at_the_wall_is_caught(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Negative control for the rule that proposals outside are rejected: clipping them to the wall instead."""
        measure = Target.measure

        def clipped(self: Target, particles: np.ndarray) -> Population:
            return measure(self, np.clip(particles, self.lower, self.upper))

        monkeypatch.setattr(Target, "measure", clipped)
        assert not agrees(drift_of(differential(), box=WALL), 0.0)

    def test_one_sided_crossover_is_caught(self) -> None:
        """Negative control: (6.11) taken by one partner alone, accepted by (6.13)."""

        def one_sided(rng: np.random.Generator, population: Population, target: Target) -> Population:
            members = np.arange(len(population.particles))
            swapped = moves._runs(rng, members.size, 2, 0.5)
            proposals = np.where(swapped, population.particles[rng.permutation(members)], population.particles)
            return moves._metropolis(rng, population, members, target.measure(proposals), target)[0]

        assert not agrees(drift_of(one_sided), 0.0)


class TestDetailedBalance:
    """On a small discrete target every transition must be as frequent as its reverse."""

    POWERS = 2 ** np.arange(3)
    LOG_TABLE = np.log(np.array([0.22, 0.05, 0.1, 0.13, 0.02, 0.2, 0.08, 0.2]))

    def log_prob(self, poses: np.ndarray) -> np.ndarray:
        return self.LOG_TABLE[(poses @ self.POWERS).astype(int)]

    def fluxes(self, move: Move) -> np.ndarray:
        """(R, 8, 8) frequencies of state to state, from populations drawn from the target."""
        rng, corners = np.random.default_rng(5), (np.arange(8)[:, None] // self.POWERS) % 2
        target = Target(CountingLikelihood(self), np.full(3, -np.inf), np.full(3, np.inf))
        rows = []
        for _ in range(200):
            before = rng.choice(8, size=400, p=np.exp(self.LOG_TABLE))
            after = move(rng, target.measure(corners[before].astype(float)), target).particles @ self.POWERS
            rows.append(np.histogram2d(before, after, bins=(np.arange(9) - 0.5,) * 2)[0] / 400)
        return np.array(rows)

    @staticmethod
    def imbalance(fluxes: np.ndarray) -> np.ndarray:
        upper = np.triu_indices(8, 1)
        difference = (fluxes - fluxes.transpose(0, 2, 1))[:, *upper]
        return difference[:, fluxes.sum(axis=0)[upper] > 0]

    def test_exchange(self) -> None:
        imbalance = self.imbalance(self.fluxes(exchange))
        assert imbalance.shape[1] >= 18  # every pair of states that a run of one or two components can reach
        assert agrees(imbalance, 0.0)

    def test_one_sided_is_caught(self) -> None:
        def one_sided(rng: np.random.Generator, population: Population, target: Target) -> Population:
            members = np.arange(len(population.particles))
            swapped = moves._runs(rng, members.size, 3, 0.5)
            proposals = np.where(swapped, population.particles[rng.permutation(members)], population.particles)
            return moves._metropolis(rng, population, members, target.measure(proposals), target)[0]

        assert not agrees(self.imbalance(self.fluxes(one_sided)), 0.0)


class TestParts:
    @given(st.integers(3, 40), st.integers(0, 2**32))
    def test_partners_are_three_different_members(self, size: int, seed: int) -> None:
        everybody = np.arange(size)
        first, second = moves._two_partners(np.random.default_rng(seed), everybody, everybody)
        assert (first != second).all() and (first != everybody).all() and (second != everybody).all()

    def test_partners_are_uniform(self) -> None:
        rng, everybody = np.random.default_rng(0), np.arange(5)
        pairs = [np.array(moves._two_partners(rng, everybody, everybody))[:, 2] for _ in range(6000)]
        hits = np.array([[pair == (a, b) for a in range(5) for b in range(5) if len({a, b, 2}) == 3] for pair in pairs])
        assert agrees(hits.all(axis=2).astype(float), 1 / 12)

    @given(st.integers(4, 41), st.integers(0, 2**32))
    def test_halves_cover_everybody_once(self, size: int, seed: int) -> None:
        (first, rest), (second, others) = moves._groups(np.random.default_rng(seed), size, "other_half")
        np.testing.assert_array_equal(np.sort(np.concatenate((first, second))), np.arange(size))
        np.testing.assert_array_equal(first, others)
        np.testing.assert_array_equal(second, rest)

    def test_run_lengths_and_starts(self) -> None:
        """P(V = v) proportional to CR^v, starts uniform; cyclic, so that every component is swapped equally often."""
        runs = np.array([moves._runs(np.random.default_rng(i), 100, 5, 0.5) for i in range(300)])
        lengths = runs.sum(axis=2)
        truth = 0.5 ** np.arange(1, 5) / np.sum(0.5 ** np.arange(1, 5))
        assert agrees(np.array([(lengths == v).mean(axis=1) for v in range(1, 5)]).T, truth)
        assert agrees(runs.mean(axis=1), np.dot(truth, np.arange(1, 5)) / 5)

    def test_outside_is_rejected_without_an_evaluation(self) -> None:
        counted = CountingLikelihood(TwoModes())
        target = Target(counted, np.zeros(2), np.ones(2))
        population = target.measure(np.array([[0.5, 0.5], [1.5, 0.5], [0.0, 1.0]]))
        assert counted.evaluations == 2 and population.log_likelihoods[1] == -np.inf

    def test_impossible_members_escape_and_never_return(self) -> None:
        class RightHalf:
            def log_prob(self, poses: np.ndarray) -> np.ndarray:
                return np.where(poses[:, 0] > 0, 0.0, -np.inf)

        rng = np.random.default_rng(0)
        target = Target(CountingLikelihood(RightHalf()), -FREE, FREE)
        population = target.measure(rng.standard_normal((60, 2)))
        for _ in range(30):
            before = np.isfinite(population.log_likelihoods)
            population, _ = differential_move(rng, population, target, 1.0, rng.normal(0, 0.1, (60, 2)))
            assert np.isfinite(population.log_likelihoods[before]).all()
        assert np.isfinite(population.log_likelihoods).all()

    def test_printed_lambda(self) -> None:
        """(6.17): 'around 0.437' at D = 24."""
        assert moves.difference_scale_of(0.1, 24) == pytest.approx(0.437, abs=5e-4)

    def test_one_dimension_has_nothing_to_exchange(self) -> None:
        target = Target(CountingLikelihood(TwoModes()), -FREE, FREE)
        population = Population(np.zeros((4, 1)), np.zeros(4))
        assert exchange_move(np.random.default_rng(0), population, target, 0.5) == (population, 0.0)
