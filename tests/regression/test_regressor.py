"""The whole regression on made examples whose descriptor is ambiguous, and on rendered silhouettes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.regression import PRINTED, WORKING, ClusterConfig, GateConfig, RegressionConfig, fit_regressor
from muybridge.regression.components import PoseComponents
from regression.made import COMPONENTS, examples

QUICK = replace(
    WORKING,
    clusters=ClusterConfig(WORKING.clusters.facing, (1, 1, 1, 1), "sectors"),
    logistic=GateConfig(landmarks=60),
    regression=RegressionConfig(frames=100),
)


@pytest.fixture(scope="module")
def learnt():
    return fit_regressor(np.random.default_rng(1), *examples(np.random.default_rng(0), 400), COMPONENTS, QUICK)


def errors(regressor, descriptors, poses):
    """Root mean square over the components (N,): of the most probable mode, of the best, of the mean."""
    rows = []
    for descriptor, pose in zip(descriptors, poses):
        mixture = regressor.predict(descriptor)
        own = np.sqrt(np.mean(COMPONENTS.wrapped(mixture.means - pose) ** 2, axis=1))
        mean = np.sqrt(np.mean(COMPONENTS.wrapped(mixture.mean - pose) ** 2))
        rows.append([own[mixture.most_probable], own.min(), mean])
    return np.array(rows).T


def test_one_of_the_modes_is_right_and_mostly_the_most_probable(learnt):
    """NOISE / 0.15 = .13 is how well coming is told from going; at the sides that is half a right angle's worth.

    Predicted: the best mode is within a few NOISE over the slopes of the descriptor, .05 radians where headings face
    along the view and |cos| is flat; measured .06 and .05 (median). A regression without clusters (the negative
    control) must take the middle of what is confused.
    """
    descriptors, poses = examples(np.random.default_rng(5), 100)
    top, best, _ = errors(learnt, descriptors, poses)
    assert np.median(best) < 0.1 and np.median(top) < 0.12
    one = replace(QUICK, clusters=ClusterConfig((0.0,), (1,)))
    alone = fit_regressor(np.random.default_rng(1), *examples(np.random.default_rng(0), 400), COMPONENTS, one)
    assert np.mean(errors(alone, descriptors, poses)[0]) > 2 * np.mean(top)


def test_the_mixture_is_a_density_that_knows_how_sure_it_is(learnt):
    """Held-out log densities per component, above those of the poses' own spread by more than a nat."""
    descriptors, poses = examples(np.random.default_rng(6), 100)
    log = [learnt.predict(x).log_prob(y[None])[0] for x, y in zip(descriptors, poses)]
    spread = -0.5 * np.log(2 * np.pi * np.e * poses.var(axis=0)).sum()
    assert np.mean(log) > spread + 3


def test_threads_and_repetition_change_nothing():
    data = examples(np.random.default_rng(0), 150)
    small = replace(QUICK, regression=RegressionConfig(frames=40), logistic=GateConfig(landmarks=20, iterations=50))
    found = [
        fit_regressor(np.random.default_rng(3), *data, COMPONENTS, small, workers=workers).predict(data[0][7])
        for workers in (1, 3)
    ]
    for name in ("weights", "means", "variances"):
        np.testing.assert_array_equal(getattr(found[0], name), getattr(found[1], name))


@pytest.mark.parametrize("config", [PRINTED, replace(PRINTED, gate="variance"), replace(QUICK, negligible=0.0)])
def test_the_other_settings_work_too(config):
    config = replace(config, regression=replace(config.regression, frames=40))
    data = examples(np.random.default_rng(0), 200)
    regressor = fit_regressor(np.random.default_rng(3), *data, COMPONENTS, config)
    descriptors, poses = examples(np.random.default_rng(5), 40)
    assert np.median(errors(regressor, descriptors, poses)[1]) < 0.25
    if config.negligible == 0.0:
        assert len(regressor.predict(descriptors[0]).weights) == config.clusters.count


def test_negligible_modes_are_left_out(learnt):
    sure, _ = examples(np.random.default_rng(5), 50)
    everything = replace(learnt, config=replace(learnt.config, negligible=0.0))
    for descriptor in sure:
        few, all_modes = learnt.predict(descriptor), everything.predict(descriptor)
        kept = all_modes.weights >= learnt.config.negligible
        assert len(few.weights) == kept.sum()
        np.testing.assert_array_equal(few.means, all_modes.means[kept])
        # what is left out weighs below 1e-3 a mode, so the rest grows by less than 6e-3
        np.testing.assert_allclose(few.weights, all_modes.weights[kept], rtol=6e-3)


def test_a_shift_and_a_scale_of_the_descriptors_change_nothing():
    data = examples(np.random.default_rng(0), 150)
    small = replace(QUICK, regression=RegressionConfig(frames=40), logistic=GateConfig(iterations=100))
    plain = fit_regressor(np.random.default_rng(3), *data, COMPONENTS, small)
    other = fit_regressor(np.random.default_rng(3), 8.0 * data[0] + 4.0, data[1], COMPONENTS, small)
    a, b = plain.predict(data[0][0]), other.predict(8.0 * data[0][0] + 4.0)
    np.testing.assert_allclose(a.means, b.means, atol=1e-3)  # inputs are rounded to float32, searches stop elsewhere
    np.testing.assert_allclose(a.weights, b.weights, atol=1e-6)


def test_input_that_cannot_be_used(learnt):
    rng = np.random.default_rng(0)
    descriptors, poses = examples(rng, 50)
    with pytest.raises(InputError, match=r"shape \(6,\)"):
        learnt.predict(np.zeros(5))
    with pytest.raises(InputError, match="finite"):
        learnt.predict(np.full(6, np.nan))
    with pytest.raises(InputError, match=r"\(50, F\)"):
        fit_regressor(rng, descriptors[:-1], poses, COMPONENTS)
    with pytest.raises(InputError, match="all alike"):
        fit_regressor(rng, np.ones((50, 6)), poses, COMPONENTS)
    with pytest.raises(InputError, match="facing"):
        fit_regressor(rng, descriptors, poses, PoseComponents(("a", "b", "c")))


@pytest.mark.parametrize("wrong", [{"gate": "linear"}, {"negligible": 1.0}, {"trusted_variance": 0.0}])
def test_settings_check_themselves(wrong):
    with pytest.raises(InputError):
        replace(WORKING, **wrong)
