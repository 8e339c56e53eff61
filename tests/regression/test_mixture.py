"""Mixtures: against scipy's densities, their own samples, and the paper's alpha."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from muybridge.errors import InputError
from muybridge.regression.components import PoseComponents
from muybridge.regression.mixture import PoseMixture, combined, turned

PLAIN = PoseComponents(("hip", "knee"))
TURNING = PoseComponents(("yaw", "knee"), (0,), 0)


def mixture(components=PLAIN, seed=0):
    rng = np.random.default_rng(seed)
    return PoseMixture(components, rng.uniform(0.2, 1, 3), rng.normal(size=(3, 2)), rng.uniform(0.01, 0.2, (3, 2)))


def test_the_density_is_scipys():
    guess, points = mixture(), np.random.default_rng(1).normal(size=(50, 2))
    densities = [stats.multivariate_normal(m, np.diag(v)).pdf(points) for m, v in zip(guess.means, guess.variances)]
    np.testing.assert_allclose(guess.log_prob(points), np.log(guess.weights @ np.array(densities)), rtol=1e-9)


def test_a_wrapped_density_integrates_to_one_and_does_not_know_the_seam():
    """Rectangle rule over a period of a smooth function: exact to rounding; three images leave out 2 Phi(-3 pi / s),
    3e-10 for the widest here (s^2 = 2.25)."""
    components = PoseComponents(("yaw",), (0,), 0)
    guess = PoseMixture(components, np.array([1.0, 1.0]), np.array([[3.0], [0.5]]), np.array([[0.3], [2.25]]))
    grid = np.linspace(-np.pi, np.pi, 2000, endpoint=False)[:, None]
    assert np.mean(np.exp(guess.log_prob(grid))) * 2 * np.pi == pytest.approx(1.0, abs=1e-6)
    np.testing.assert_allclose(guess.log_prob(grid + 2 * np.pi), guess.log_prob(grid))
    plain = PoseMixture(PoseComponents(("yaw",)), guess.weights, guess.means, guess.variances)
    assert np.mean(np.exp(plain.log_prob(grid))) * 2 * np.pi < 0.95  # the negative control: half of a mode is cut off


def test_samples_have_the_weights_and_moments_of_the_mixture():
    """20000 draws: 5 standard errors of a share, a mean and a variance (deviation of a squared normal: sqrt 2)."""
    guess = PoseMixture(PLAIN, np.array([0.7, 0.3]), np.array([[-3.0, 0.0], [3.0, 1.0]]),
                        np.array([[0.04, 0.5], [0.09, 0.01]]))  # fmt: skip
    draws = guess.sample(np.random.default_rng(0), 20_000)
    first = draws[:, 0] < 0
    assert abs(first.mean() - 0.7) < 5 * np.sqrt(0.21 / 20_000)
    for members, mean, variance in zip((first, ~first), guess.means, guess.variances):
        own, count = draws[members], members.sum()
        assert (np.abs(own.mean(axis=0) - mean) < 5 * np.sqrt(variance / count)).all()
        assert (np.abs(own.var(axis=0) / variance - 1) < 5 * np.sqrt(2 / count)).all()
    error = np.sqrt(draws.var(axis=0) / len(draws))
    assert (np.abs(draws.mean(axis=0) - guess.mean) < 5 * error).all()
    np.testing.assert_array_equal(guess.sample(np.random.default_rng(7), 5), guess.sample(np.random.default_rng(7), 5))


def test_the_mean_of_headings_is_a_direction():
    guess = PoseMixture(TURNING, np.array([1.0, 1.0]), np.array([[3.0, 0.2], [-3.0, 0.4]]), np.full((2, 2), 0.01))
    assert abs(guess.mean[0]) == pytest.approx(np.pi)
    assert guess.mean[1] == pytest.approx(0.3)
    draws = guess.sample(np.random.default_rng(0), 100)
    assert (np.abs(draws[:, 0]) <= np.pi).all() and (draws[:, 0] > 2).any() and (draws[:, 0] < -2).any()


def test_alpha_is_the_papers():
    """At lambda = 0.003 a guess of variance 0.015 is worth e^-5, nearly nothing (Fig. 9)."""
    variances = np.array([[0.02, 0.01], [0.001, 0.001]])
    guess = PoseMixture(PLAIN, np.array([0.6, 0.4]), np.zeros((2, 2)), variances)
    assert guess.most_probable == 0
    assert guess.uncertainty == pytest.approx(0.015)
    assert guess.alpha() == pytest.approx(np.exp(-5))
    assert guess.alpha(0.015) == pytest.approx(np.exp(-1))
    for wrong in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(InputError, match="lambda"):
            guess.alpha(wrong)


def test_turned_is_the_same_guess_seen_from_elsewhere():
    guess = mixture(TURNING)
    other = turned(guess, 2.5)
    points = np.random.default_rng(0).normal(size=(20, 2))
    np.testing.assert_allclose(other.log_prob(points + [2.5, 0.0]), guess.log_prob(points))
    assert (np.abs(other.means[:, 0]) <= np.pi).all()
    with pytest.raises(InputError, match="a heading"):
        turned(mixture(PLAIN), 1.0)


def test_cameras_together_are_weighed_by_their_alpha():
    """Within a camera weights keep their ratios; between cameras they are in the ratio of the alphas."""
    sure = PoseMixture(PLAIN, np.array([0.25, 0.75]), np.zeros((2, 2)), np.full((2, 2), 0.001))
    unsure = PoseMixture(PLAIN, np.array([1.0]), np.ones((1, 2)), np.full((1, 2), 0.004))
    both = combined([sure, unsure], trusted_variance=0.003)
    np.testing.assert_allclose(both.weights[1] / both.weights[0], 3.0)
    np.testing.assert_allclose(both.weights[:2].sum() / both.weights[2], sure.alpha() / unsure.alpha())
    assert np.isfinite(combined([sure, unsure], trusted_variance=1e-7).weights).all()  # where all alphas are 0


def test_cameras_that_agree_outvote_a_mirrored_pose():
    """Each camera takes its mirror image for more likely, but the images of two cameras do not fall together."""

    def view(true, mirrored):
        means = np.array([[mirrored, 0.0], [true, 0.0]])
        return PoseMixture(TURNING, np.array([0.6, 0.4]), means, np.full((2, 2), 0.01))

    views = [view(0.5, 2.9), view(0.55, -1.2)]
    assert combined(views).means[combined(views).most_probable, 0] > 2  # alternatives: the mirror image wins
    agreed = combined(views, agreement=1.0)
    assert agreed.means[agreed.most_probable, 0] == pytest.approx(0.5, abs=0.1)
    assert agreed.weights[np.abs(agreed.means[:, 0] - 0.5) < 0.1].sum() > 0.99


@pytest.mark.parametrize(
    ("weights", "means", "variances", "message"),
    [
        ([0.5, -0.5], np.zeros((2, 2)), np.ones((2, 2)), "none negative"),
        ([0.0, 0.0], np.zeros((2, 2)), np.ones((2, 2)), "not all 0"),
        ([1.0], np.zeros((2, 2)), np.ones((2, 2)), "2 numbers"),
        ([1.0], np.zeros((1, 2)), np.zeros((1, 2)), "above 0"),
        ([1.0], np.zeros((1, 3)), np.ones((1, 3)), r"shape \(N, 2\)"),
    ],
)
def test_they_check_themselves(weights, means, variances, message):
    with pytest.raises(InputError, match=message):
        PoseMixture(PLAIN, np.array(weights), means, variances)


def test_what_cannot_be_combined():
    with pytest.raises(InputError, match="at least one"):
        combined([])
    with pytest.raises(InputError, match="same components"):
        combined([mixture(PLAIN), mixture(TURNING)])


def test_a_mixture_cannot_be_changed():
    with pytest.raises(ValueError, match="read-only"):
        mixture().weights[0] = 1.0
