"""The gate: scikit-learn's weights at the same penalty, and a likelihood that never falls on the way."""

from __future__ import annotations

import numpy as np
import pytest
from sklearn.linear_model import LogisticRegression

from muybridge.errors import InputError
from muybridge.regression.gate import GateConfig, by_variance, fit_gate, maximise, with_constant


def made(count=200, classes=4, seed=0):
    rng = np.random.default_rng(seed)
    labels = rng.integers(classes, size=count)
    inputs = rng.normal(size=(classes, 5))[labels] + rng.normal(size=(count, 5))
    return inputs, labels


def test_the_weights_are_scikit_learns():
    """Both at the optimum of one strictly concave function: with penalty 1 an error in the weights of e costs e^2 / 2,
    so that improvements below 1e-13 leave 5e-7; scikit-learn stops at a gradient of 1e-8."""
    inputs, labels = made()
    config = GateConfig(penalty=1.0, tolerance=1e-15, iterations=20_000)
    weights, _ = maximise(with_constant(inputs), np.eye(4)[labels], config)
    peer = LogisticRegression(C=1.0, tol=1e-8, max_iter=10_000).fit(inputs, labels)
    constant = peer.intercept_ - peer.intercept_.mean()  # which is not penalised, and so known up to a common shift
    np.testing.assert_allclose(weights[:-1], peer.coef_.T, atol=1e-5)
    np.testing.assert_allclose(weights[-1], constant, atol=1e-5)


def test_it_never_falls_and_a_shorter_bound_would():
    inputs, labels = made(60, 3)
    config = GateConfig(penalty=0.01, tolerance=0.0, iterations=300)
    _, history = maximise(with_constant(inputs), np.eye(3)[labels], config)
    assert len(history) == 300
    assert np.diff(history).min() > -1e-9 * len(inputs)  # rounding of a sum of 60 terms
    assert history[-1] > history[0] + 10
    # negative control: Newton steps with a thirtieth of the bound overshoot
    features, targets, weights, values = with_constant(inputs), np.eye(3)[labels], np.zeros((6, 3)), []
    for _ in range(30):
        scores = features @ weights
        log = scores - np.log(np.exp(scores - scores.max(1, keepdims=True)).sum(1, keepdims=True))
        log -= scores.max(1, keepdims=True)
        values.append(np.sum(targets * log) - 0.005 * np.sum(weights[:-1] ** 2))
        gradient = features.T @ (targets - np.exp(log)) - 0.01 * weights
        weights = weights + 30 * np.linalg.solve(0.5 * features.T @ features + 0.01 * np.eye(6), gradient)
    assert np.diff(values).min() < 0


def test_probabilities_sum_to_one_and_do_not_hang_on_units():
    inputs, labels = made()
    gate, _ = fit_gate(np.random.default_rng(0), inputs, labels, 4)
    log = gate.log_prob(inputs)
    np.testing.assert_allclose(np.exp(log).sum(axis=1), 1.0)
    assert np.mean(np.argmax(log, axis=1) == labels) > 0.7
    scaled, _ = fit_gate(np.random.default_rng(0), 1000 * inputs + 7, labels, 4)
    np.testing.assert_allclose(scaled.log_prob(1000 * inputs + 7), log, atol=1e-6)
    assert np.isfinite(gate.log_prob(1e6 * inputs)).all()


def test_landmarks_tell_what_no_line_can():
    """A ring around a disc: chance for lines (the majority, about half), nearly all for closeness."""
    rng = np.random.default_rng(0)
    labels = rng.integers(2, size=400)
    angle = rng.uniform(0, 2 * np.pi, 400)
    inputs = (1 + 2 * labels[:, None]) * np.column_stack([np.cos(angle), np.sin(angle)]) + rng.normal(0, 0.2, (400, 2))
    found = {}
    for landmarks in (0, 60):
        gate, _ = fit_gate(rng, inputs[:200], labels[:200], 2, GateConfig(landmarks=landmarks))
        found[landmarks] = np.mean(np.argmax(gate.log_prob(inputs[200:]), axis=1) == labels[200:])
    assert found[0] < 0.7 and found[60] > 0.95


def test_a_component_that_never_changes_tells_nothing():
    inputs, labels = made()
    inputs[:, 2] = 4.0
    gate, _ = fit_gate(np.random.default_rng(0), inputs, labels, 4)
    elsewhere = inputs.copy()
    elsewhere[:, 2] = 5.0
    np.testing.assert_allclose(gate.log_prob(elsewhere), gate.log_prob(inputs), atol=1e-9)


def test_the_gate_of_variances():
    weights = by_variance(np.array([[0.1, 0.1], [0.3, 0.1], [0.8, 0.8]]))
    np.testing.assert_allclose(weights, np.array([8, 4, 1]) / 13)


@pytest.mark.parametrize("wrong", [{"penalty": 0.0}, {"width": -1.0}, {"landmarks": -1}, {"iterations": 0}])
def test_settings_check_themselves(wrong):
    with pytest.raises(InputError, match="gate"):
        GateConfig(**wrong)
