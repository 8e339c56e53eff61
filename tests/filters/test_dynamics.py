"""Motion models: moments as stated, limits kept without piling up, noise that can be scaled by component."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from filters.oracles import agrees
from muybridge.errors import InputError
from muybridge.filters.dynamics import ConstantVelocity, GaussianWalk, reflect

ANY = st.floats(-1e3, 1e3)


class TestReflect:
    @given(st.lists(ANY, min_size=1, max_size=20), ANY, st.floats(0, 1e3))
    def test_always_inside(self, values: list[float], low: float, span: float) -> None:
        lower, upper = np.array([low]), np.array([low + span])
        inside = reflect(np.array(values)[:, None], lower, upper)
        assert ((inside >= lower) & (inside <= upper)).all()

    @given(ANY, st.integers(-5, 5))
    def test_folding_has_the_period_of_two_spans(self, value: float, periods: int) -> None:
        """Arguments are below 1e3 + 10 * 7: rounding below 10 eps * 1.1e3 = 2.4e-12."""
        lower, upper = np.array([-2.0]), np.array([5.0])
        moved = reflect(np.array([[value + 14.0 * periods]]), lower, upper)
        np.testing.assert_allclose(moved, reflect(np.array([[value]]), lower, upper), atol=1e-11)

    def test_by_hand(self) -> None:
        inf = np.inf
        values = np.array([[1.25, -3.0, 7.0, 9.0, 4.0]])
        lower, upper = np.array([0, -1, -inf, -inf, 2.0]), np.array([1, inf, 5, inf, 2.0])
        np.testing.assert_allclose(reflect(values, lower, upper), [[0.75, 1.0, 3.0, 9.0, 2.0]])

    def test_inside_stays_to_the_bit(self) -> None:
        values = np.random.default_rng(0).uniform(-1, 1, (100, 2))
        with_one_outside = np.vstack((values, [[7.0, 0.1]]))
        np.testing.assert_array_equal(reflect(with_one_outside, -np.ones(2), np.ones(2))[:-1], values)

    def test_uniform_stays_uniform(self) -> None:
        """A walk between two walls keeps the uniform density; clipping, the negative control, piles up on them."""
        rng = np.random.default_rng(3)
        start = rng.uniform(0, 1, (400, 50, 1))
        moved = start + rng.normal(0, 0.4, start.shape)
        low, high = np.zeros(1), np.ones(1)
        folded = np.array([reflect(sample, low, high) for sample in moved])
        for power, truth in ((1, 1 / 2), (2, 1 / 3), (8, 1 / 9)):
            assert agrees((folded**power).mean(axis=1), truth)
        assert not agrees((np.clip(moved, 0, 1) ** 8).mean(axis=1), 1 / 9)


class TestModels:
    def test_walk_moments(self) -> None:
        walk, rng = GaussianWalk(np.array([0.5, 2.0])), np.random.default_rng(0)
        draws = np.array([walk.sample(rng, np.ones((20, 2)), velocity=np.full(2, 9.0)) - 1.0 for _ in range(500)])
        assert agrees(draws.mean(axis=1), np.zeros(2))
        assert agrees((draws**2).mean(axis=1), walk.noise_sd**2)
        assert not agrees((draws**2).mean(axis=1), (1.1 * walk.noise_sd) ** 2)

    @pytest.mark.parametrize("gain", [0.0, 0.5, 1.0])
    def test_velocity_by_its_gain(self, gain: float) -> None:
        model = ConstantVelocity(np.ones(2), gain=gain)
        moved = model.sample(np.random.default_rng(0), np.zeros((3, 2)), np.array([1.0, -2.0]), scale=0.0)
        np.testing.assert_array_equal(moved, np.tile([gain, -2.0 * gain], (3, 1)))

    def test_scale_by_component(self) -> None:
        walk = GaussianWalk(np.ones(3))
        moved = walk.sample(np.random.default_rng(0), np.zeros((50, 3)), scale=np.array([1.0, 0.0, 2.0]))
        assert (moved[:, 1] == 0).all() and moved[:, 2].std() > moved[:, 0].std() > 0.5

    def test_limits(self) -> None:
        model = ConstantVelocity(np.full(2, 3.0), np.array([-1.0, 0.0]), np.array([1.0, np.inf]))
        moved = model.sample(np.random.default_rng(0), np.zeros((500, 2)), np.array([5.0, -5.0]))
        assert (moved >= model.lower).all() and (moved <= model.upper).all()

    @pytest.mark.parametrize(
        ("make", "what"),
        [
            (lambda: GaussianWalk(np.array([-1.0])), "noise_sd"),
            (lambda: GaussianWalk(np.array([np.nan])), "noise_sd"),
            (lambda: GaussianWalk(np.ones(2), np.ones(2), np.zeros(2)), "component 0"),
            (lambda: GaussianWalk(np.ones(2), np.ones(3), np.ones(3)), "limits"),
            (lambda: GaussianWalk(np.ones(1), np.array([np.nan])), "limits"),
            (lambda: ConstantVelocity(np.ones(1), gain=1.5), "gain"),
        ],
    )
    def test_bad_input(self, make, what: str) -> None:
        with pytest.raises(InputError, match=what):
            make()

    def test_frozen(self) -> None:
        walk = GaussianWalk([1.0, 2.0])
        with pytest.raises(ValueError, match="read-only"):
            walk.noise_sd[0] = 3.0
