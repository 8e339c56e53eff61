"""Support vector machines: our few lines against scikit-learn's own, and the tuning by its definition."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.people.support_vectors import SupportVectors, train_support_vectors


def rings(count: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Good ones within a circle, failures around it: no plane divides them."""
    rng = np.random.default_rng(seed)
    good = rng.random(count) < 0.6
    radius = np.where(good, rng.uniform(0, 1, count), rng.uniform(1.5, 2.5, count))
    angle = rng.uniform(0, 2 * np.pi, count)
    return np.column_stack([3 + radius * np.cos(angle), 10 * radius * np.sin(angle)]), good


def test_the_kernel_expansion_is_the_machine() -> None:
    from sklearn.svm import SVC

    features, good = rings(200)
    found = train_support_vectors(features, good, penalty=3.0)
    scaled = (features - found.centre) / found.scale
    other = SVC(C=3.0, gamma=found.gamma, class_weight="balanced").fit(scaled, np.where(good, 1, -1))
    np.testing.assert_allclose(found.margins(features), other.decision_function(scaled), atol=1e-9)
    unseen, truth = rings(500, seed=1)
    assert ((found.margins(unseen) > 0) == truth).mean() > 0.97  # half a radius of nothing lies between the two


def test_tuning_allows_so_many_false_alarms_and_no_more() -> None:
    features, good = rings(200)
    found = train_support_vectors(features, good)
    hard = rings(400, seed=2)[0]  # failures called good: many margins are below 0
    for share in (0.0, 0.1):
        alarms = (found.tuned(hard, share).margins(hard) < -1e-12).mean()
        assert share - 2 / len(hard) <= alarms <= share
    assert found.tuned(features[good], 0.5).offset == found.offset  # never towards more alarms


def test_what_is_refused() -> None:
    features, good = rings(30)
    with pytest.raises(InputError, match="10 examples each"):
        train_support_vectors(features, np.ones(30, bool))
    machine = train_support_vectors(features, good)
    parts = machine.vectors, machine.coefficients, machine.centre, machine.scale
    for wrong in ((*parts, np.nan, 1.0), (*parts, 0.0, -1.0), (parts[0], parts[1][:-1], *parts[2:], 0.0, 1.0)):
        with pytest.raises(InputError, match="support vectors"):
            SupportVectors(*wrong)
