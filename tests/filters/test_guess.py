"""A guess as a value: what it holds, what it refuses, and that its draws are the mixture it says."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from filters.oracles import agrees
from muybridge.errors import InputError
from muybridge.filters import Guess
from muybridge.filters.guess import guess_of

TWO = Guess(np.array([1.0, 3.0]), np.array([[0.0, -2.0], [5.0, 1.0]]), np.array([[0.04, 0.01], [0.25, 0.09]]),
            np.array([3, 1]))  # fmt: skip


def test_weights_are_made_to_sum_to_one_and_nothing_can_be_changed() -> None:
    np.testing.assert_allclose(TWO.weights, [0.25, 0.75])
    assert len(TWO) == 2
    for array in (TWO.weights, TWO.means, TWO.variances, TWO.components):
        with pytest.raises(ValueError):
            array[...] = 0


def test_its_variance_is_the_mean_of_the_most_likely_mode() -> None:
    """trace(Sigma_k) / d, (19): .17 of the second mode; the first has .025, all together .0975."""
    assert TWO.variance == pytest.approx((0.25 + 0.09) / 2)
    assert replace(TWO, weights=np.array([3.0, 1.0])).variance == pytest.approx((0.04 + 0.01) / 2)


def test_draws_have_the_mixtures_moments() -> None:
    """Mean sum g m, variance sum g (v + m^2) - mean^2, and the share of each mode; 40 replicates of 500 draws."""
    moments = []
    for rng in np.random.default_rng(3).spawn(40):
        drawn = TWO.sample(rng, 500)
        assert drawn.shape == (500, 2)
        moments.append([*drawn.mean(axis=0), *(drawn**2).mean(axis=0), (drawn[:, 1] > -0.5).mean()])
    mean = TWO.weights @ TWO.means
    second = TWO.weights @ (TWO.variances + TWO.means**2)
    truth = np.array([*mean, *second, 0.75])  # the modes' second components lie 5 sd from -.5 and more
    assert agrees(np.array(moments), truth)
    assert not agrees(np.array(moments), truth + np.array([0, 0, 0, 0, 0.02])), "a wrong share would pass as well"


def test_poses_keep_what_it_does_not_speak_of() -> None:
    np.testing.assert_array_equal(
        TWO.poses(np.array([9.0, 8.0, 7.0, 6.0])), [[9.0, -2.0, 7.0, 0.0], [9.0, 1.0, 7.0, 5.0]]
    )


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("weights", np.zeros(2)),
        ("weights", np.array([-1.0, 2.0])),
        ("weights", np.array([np.nan, 1.0])),
        ("weights", np.ones(3)),
        ("means", np.zeros((2, 3))),
        ("means", np.full((2, 2), np.nan)),
        ("variances", np.zeros((2, 1))),
        ("variances", np.full((2, 2), -1.0)),
        ("components", np.array([1, 1])),
        ("components", np.array([-1, 1])),
    ],
)
def test_refuses_what_is_no_mixture(field: str, value: np.ndarray) -> None:
    with pytest.raises(InputError, match="guess"):
        replace(TWO, **{field: value})


@dataclass(frozen=True)
class Guessing:
    guess: Guess | None

    def log_prob(self, poses: np.ndarray) -> np.ndarray:
        return np.zeros(len(poses))


def test_a_likelihood_is_asked_for_it() -> None:
    assert guess_of(Guessing(TWO), 4) is TWO and guess_of(Guessing(None), 4) is None
    with pytest.raises(InputError, match="components"):
        guess_of(Guessing(TWO), 3)
