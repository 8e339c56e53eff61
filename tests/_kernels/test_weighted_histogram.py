"""Nummiaro's histograms against visiting every pixel."""

from __future__ import annotations

import numpy as np

from muybridge._kernels.weighted_histogram import BINS, ellipse_histograms, ellipse_overlaps
from reference.cumulative import ellipse_histogram


def test_against_visiting_every_pixel() -> None:
    rng = np.random.default_rng(2)
    image = rng.integers(0, 256, (24, 30, 3), dtype=np.uint8)
    states = np.column_stack([rng.uniform(-3, 33, 12), rng.uniform(-3, 27, 12), rng.uniform(3, 20, (12, 2))])
    out = np.empty((12, BINS))
    ellipse_histograms(image, states, out)
    np.testing.assert_allclose(out, [ellipse_histogram(image, state) for state in states], rtol=0, atol=1e-12)
    target = out[3]
    rho = np.empty(12)
    ellipse_overlaps(image, states, np.sqrt(target), rho)
    np.testing.assert_allclose(rho[~np.isnan(rho)], np.sqrt(out * target).sum(axis=1)[~np.isnan(rho)], atol=1e-12)
    assert np.isclose(rho[3], 1.0, atol=1e-12)


def test_an_ellipse_outside_has_no_overlap() -> None:
    rho = np.empty(1)
    ellipse_overlaps(np.zeros((5, 5, 3), np.uint8), np.array([[50.0, 2.0, 4.0, 4.0]]), np.ones(BINS), rho)
    assert np.isnan(rho[0])
