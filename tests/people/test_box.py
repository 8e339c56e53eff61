"""The motion of boxes against a Kalman filter, and the number of particles against its closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from filters.oracles import agrees
from muybridge.errors import InputError
from muybridge.filters import condensation
from muybridge.filters.dynamics import Belief
from muybridge.people.box import (
    PRINTED_VARIANCES,
    BoxMotion,
    CountConfig,
    adapted_count,
    boxes_from_states,
    states_from_boxes,
)

FREE = BoxMotion(np.sqrt(PRINTED_VARIANCES))
SD = 2.0


def test_boxes_and_states_are_inverse() -> None:
    """A box of one pixel, 3 to 4, has its centre at that pixel's centre, 3."""
    assert states_from_boxes(np.array([[3.0, 7.0, 1.0, 1.0]])).tolist() == [[3.0, 7.0, 1.0, 1.0, 0.0, 0.0]]
    boxes = np.random.default_rng(0).uniform(1, 99, (20, 4))
    np.testing.assert_allclose(boxes_from_states(states_from_boxes(boxes)), boxes, rtol=0, atol=1e-12)


def test_the_centre_goes_on_at_its_own_velocity() -> None:
    still = BoxMotion(np.zeros(6), frames=2.0)
    state = np.array([[10.0, 20.0, 5.0, 9.0, 1.5, -2.0]])
    moved = still.sample(np.random.default_rng(0), state)
    np.testing.assert_allclose(moved, [[13.0, 16.0, 5.0, 9.0, 1.5, -2.0]])
    np.testing.assert_allclose(moved[0], still.transition @ state[0])


def test_spread_of_one_step_is_the_printed_one() -> None:
    """Sample variances of 4000 draws have a relative standard error of sqrt(2 / 4000): 2.2 %; 5 of them."""
    moved = FREE.sample(np.random.default_rng(1), np.zeros((4000, 6)))
    np.testing.assert_allclose(moved.var(axis=0), PRINTED_VARIANCES, rtol=0.11)


class CentreAndSize:
    """The box is measured, the velocity is not."""

    def __init__(self, observation: np.ndarray) -> None:
        self.observation = observation

    def log_prob(self, states: np.ndarray) -> np.ndarray:
        return -0.5 * (((states[:, :4] - self.observation) / SD) ** 2).sum(axis=1)


def kalman(observations: np.ndarray) -> np.ndarray:
    """(6,) mean after the last frame, by `carry` and the textbook's correction."""
    belief, measure = Belief.at_rest(np.zeros(6), np.full(6, 3.0)), np.eye(4, 6)
    for observation in observations:
        belief = FREE.carry(belief)
        gain = (
            belief.covariance @ measure.T @ np.linalg.inv(measure @ belief.covariance @ measure.T + SD**2 * np.eye(4))
        )
        mean = belief.mean + gain @ (observation - measure @ belief.mean)
        belief = replace(belief, mean=mean, covariance=(np.eye(6) - gain @ measure) @ belief.covariance)
    return belief.mean


def test_condensation_with_this_motion_is_a_kalman_filter() -> None:
    """Mean of the state, velocity included, after five frames; 40 runs of 2000 particles on one series."""
    rng = np.random.default_rng(2)
    observations = np.cumsum(rng.normal(2, 3, (5, 4)), axis=0)
    config = condensation.Config(estimate="mean", resampling="systematic", particles=2000)
    estimates = []
    for child in rng.spawn(40):
        state = condensation.init(child, np.zeros(6), np.full(6, 3.0), config)
        for observation in observations:
            state, _ = condensation.step(child, state, CentreAndSize(observation), FREE, config)
        estimates.append(state.estimate)
    expected = kalman(observations)
    assert agrees(np.array(estimates), expected)
    assert not agrees(np.array(estimates), expected + [0, 0, 0, 0, 1.0, 0])  # negative control


def test_limits_keep_boxes_in_the_picture() -> None:
    motion = BoxMotion.within((100, 80), largest=(30, 60))
    far = np.tile([99.0, 0.0, 29.0, 3.0, 40.0, -40.0], (500, 1))
    moved = motion.sample(np.random.default_rng(3), far)
    assert (moved[:, :2] >= -0.5).all() and (moved[:, :2] <= [99.5, 79.5]).all()
    assert (moved[:, 2:4] >= 2).all() and (moved[:, 2:4] <= [30, 60]).all()


def test_the_number_of_particles_follows_the_entropy() -> None:
    """Uniform weights have entropy log N: C N; weights on k of N alike have log k: C N log k / log N."""
    config = CountConfig(fewest=3, most=10_000)
    assert adapted_count(np.zeros(500), config) == 600
    alike = np.where(np.arange(400) < 20, 0.0, -np.inf)
    assert adapted_count(alike, config) == round(1.2 * 400 * np.log(20) / np.log(400)) == 240
    assert adapted_count(alike) == 240 and adapted_count(np.zeros(950)) == 1000
    assert adapted_count(np.where(np.arange(400) < 1, 0.0, -np.inf)) == 200


def test_the_filter_takes_a_number_that_changes() -> None:
    config = condensation.Config(estimate="mean", particles=400)
    rng = np.random.default_rng(4)
    state = condensation.init(rng, np.zeros(6), np.ones(6), config)
    for count in (400, 250, 900):
        likelihood = CentreAndSize(np.zeros(4))
        state, _ = condensation.step(rng, state, likelihood, FREE, replace(config, particles=count))
        assert len(state.particles) == len(state.log_weights) == count


def test_bad_settings_are_one_line() -> None:
    with pytest.raises(InputError, match="6 numbers"):
        BoxMotion(np.ones(4))
    with pytest.raises(InputError, match="frames"):
        BoxMotion(np.ones(6), frames=0)
    with pytest.raises(InputError, match="particle count"):
        CountConfig(fewest=500, most=200)
