"""State, settings and the counting likelihood. That a saved state continues to the byte is conformance's business."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.filters import GaussianWalk, State, state_from_arrays, state_to_arrays
from muybridge.filters.state import CommonConfig, CountingLikelihood, initial_state


@dataclasses.dataclass(frozen=True)
class Answering:
    answer: np.ndarray

    def log_prob(self, poses: np.ndarray) -> np.ndarray:
        return self.answer


class TestInitialState:
    def test_shape_limits_and_rest(self) -> None:
        lower, upper = np.array([0.0, -np.inf]), np.array([1.0, 0.0])
        state = initial_state(np.random.default_rng(0), [0.5, -1.0], [3.0, 3.0], 200, lower, upper)
        assert state.particles.shape == (200, 2)
        assert ((state.particles >= lower) & (state.particles <= upper)).all()
        assert np.exp(state.log_weights).sum() == pytest.approx(1.0)
        np.testing.assert_array_equal(state.velocity, 0.0)

    def test_mean_outside_is_brought_to_the_limit(self) -> None:
        state = initial_state(np.random.default_rng(0), np.array([5.0]), np.zeros(1), 10, np.zeros(1), np.ones(1))
        np.testing.assert_array_equal(state.particles, 1.0)
        np.testing.assert_array_equal(state.estimate, 1.0)

    @pytest.mark.parametrize(
        ("mean", "sd", "what"),
        [
            ([np.nan, 0], [1, 1], "mean"),
            ([[0.0]], [1], "mean"),
            ([0.0], [-1], "sd"),
            ([0.0], [1, 1], "sd"),
            ([0.0], [np.inf], "sd"),
        ],
    )
    def test_bad_input(self, mean: list, sd: list, what: str) -> None:
        with pytest.raises(InputError, match=what):
            initial_state(np.random.default_rng(0), mean, sd, 10)


class TestCountingLikelihood:
    def test_counts_and_cleans(self) -> None:
        counted = CountingLikelihood(Answering(np.array([0.0, np.nan, np.inf, -np.inf])))
        np.testing.assert_array_equal(counted.log_prob(np.zeros((4, 2))), [0, -np.inf, -np.inf, -np.inf])
        assert (counted.evaluations, counted.invalid) == (4, 2)

    def test_does_not_write_into_the_answer(self) -> None:
        answer = np.array([np.nan, 0.0])
        CountingLikelihood(Answering(answer)).log_prob(np.zeros((2, 1)))
        assert np.isnan(answer[0])

    @pytest.mark.parametrize("sharpness", [1.0, 200.0])
    def test_what_is_usual_counts_once_when_all_is_sharpened(self, sharpness: float) -> None:
        """K (log p(y | x) + log p(x) / K) is K log p(y | x) + log p(x); the impossible stays so, whatever is usual."""
        poses, answer = np.array([[0.0], [1.0], [5.0]]), np.array([-1.0, -2.0, np.nan])
        dynamics = GaussianWalk(np.ones(1), usual=np.ones(1), usual_sd=np.full(1, 0.5))
        counted = CountingLikelihood(Answering(answer), dynamics, sharpness)
        usual = dynamics.log_usual(poses)
        assert usual[0] < usual[1] == 0.0
        sharpened = sharpness * counted.log_prob(poses)
        np.testing.assert_allclose(sharpened, sharpness * np.array([-1.0, -2.0, -np.inf]) + usual, rtol=1e-14)
        np.testing.assert_array_equal(answer, [-1.0, -2.0, np.nan])
        assert (counted.evaluations, counted.invalid) == (3, 1)

    def test_nobody_asks_about_nobody(self) -> None:
        assert CountingLikelihood(Answering(np.zeros(5))).log_prob(np.empty((0, 2))).shape == (0,)

    def test_wrong_shape(self) -> None:
        with pytest.raises(InputError, match=r"log_prob.*\(4,\)"):
            CountingLikelihood(Answering(np.zeros((4, 1)))).log_prob(np.zeros((4, 2)))


class TestSettings:
    @pytest.mark.parametrize(
        ("setting", "value"),
        [
            ("particles", 2),
            ("estimate", "median"),
            ("resampling", "lottery"),
            ("sharpness", 0.0),
            ("sharpness", np.nan),
        ],
    )
    def test_bad_settings_name_themselves(self, setting: str, value: object) -> None:
        with pytest.raises(InputError, match=setting):
            CommonConfig(**{setting: value})

    def test_frozen(self) -> None:
        with pytest.raises(dataclasses.FrozenInstanceError):
            CommonConfig().particles = 7  # type: ignore[misc]


class TestSaving:
    def test_missing_array(self) -> None:
        arrays = state_to_arrays(initial_state(np.random.default_rng(0), np.zeros(1), np.ones(1), 5))
        del arrays["velocity"]
        with pytest.raises(InputError, match="velocity"):
            state_from_arrays(arrays)

    def test_a_method_may_remember_more(self) -> None:
        @dataclasses.dataclass(frozen=True, eq=False)
        class Longer(State):
            hessian: np.ndarray

        arrays = {name: np.ones(2) for name in ("particles", "log_weights", "estimate", "velocity", "hessian")}
        assert isinstance(state_from_arrays(arrays, Longer), Longer)
        assert state_to_arrays(state_from_arrays(arrays, Longer)).keys() == arrays.keys()
