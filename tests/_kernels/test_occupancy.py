"""Silhouette scores against visiting every pixel; both add the same terms in another order: 1e-9 of some hundreds."""

from __future__ import annotations

import numpy as np

from muybridge._kernels.occupancy import fill_sums, silhouette_scores
from reference.cumulative import silhouette_score


def test_against_visiting_every_pixel() -> None:
    rng = np.random.default_rng(5)
    mask, weights = rng.random((30, 40)) < 0.4, rng.random((30, 40)).astype(np.float32)
    gain, cost = rng.normal(size=(4, 3)), rng.normal(size=(4, 3))
    states = np.column_stack([rng.uniform(-5, 45, 20), rng.uniform(-5, 35, 20), rng.uniform(2, 25, (20, 2))])
    table, out = np.empty((31, 41, 2)), np.empty(20)
    fill_sums(mask, weights, table)
    silhouette_scores(table, 0, 0, states, gain, cost, out)
    expected = [silhouette_score(mask, weights, state, gain, cost) for state in states]
    np.testing.assert_allclose(out, expected, rtol=0, atol=1e-9)


def test_a_part_of_the_picture_is_enough() -> None:
    rng = np.random.default_rng(6)
    mask, weights = rng.random((30, 40)) < 0.4, np.ones((30, 40), np.float32)
    states = np.column_stack([rng.uniform(15, 25, 9), rng.uniform(12, 18, 9), rng.uniform(2, 8, (9, 2))])
    gain, cost = rng.normal(size=(2, 2)), rng.normal(size=(2, 2))
    whole, part = np.empty((31, 41, 2)), np.empty((21, 31, 2))
    fill_sums(mask, weights, whole)
    fill_sums(np.ascontiguousarray(mask[5:25, 6:36]), weights[5:25, 6:36].copy(), part)
    a, b = np.empty(9), np.empty(9)
    silhouette_scores(whole, 0, 0, states, gain, cost, a)
    silhouette_scores(part, 6, 5, states, gain, cost, b)
    np.testing.assert_allclose(a, b, rtol=0, atol=1e-9)
