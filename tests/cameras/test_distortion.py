"""Lens distortion: closed forms, its inverse, and where it ends."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from muybridge.cameras.distortion import distort, fold_radius_squared, undistort

coefficient = st.floats(-0.4, 0.4)
# Sums of 1e-200 lose their relative precision and mean nothing for a lens.
flat = st.tuples(st.floats(-1.2, 1.2), st.floats(-1.2, 1.2)).map(lambda pair: np.round(pair, 9))


def test_closed_form():
    # (0.3, 0.4): r^2 = 0.25; radial 1 + 0.1/4 + 0.2/16 + 0.4/64 = 1.04375; tangential as in the module's formula
    bent = distort(np.array([0.3, 0.4]), np.array([0.1, 0.2, 0.01, 0.02, 0.4]))
    x = 0.3 * 1.04375 + 2 * 0.01 * 0.12 + 0.02 * (0.25 + 0.18)
    y = 0.4 * 1.04375 + 0.01 * (0.25 + 0.32) + 2 * 0.02 * 0.12
    np.testing.assert_allclose(bent, [x, y], atol=1e-15)


def test_no_distortion_is_the_identity():
    points = np.random.default_rng(0).normal(size=(4, 5, 2))
    np.testing.assert_array_equal(distort(points, np.zeros(5)), points)
    np.testing.assert_array_equal(undistort(points, np.zeros(5)), points)


@example((0.0, 1.0), (0.375, 0.25, -0.125))  # a moustache: convex, then concave; the distorted point is beyond the fold
@given(flat, st.tuples(coefficient, coefficient, coefficient))
def test_inverse(point, radial):
    """Up to half the fold the radial slope is well away from 0, and the inverse is exact to its residual of 1e-10."""
    coefficients = np.array([radial[0], radial[1], 0.001, -0.001, radial[2]])
    point = np.asarray(point)
    assume(point @ point < 0.5 * fold_radius_squared(coefficients))
    np.testing.assert_allclose(undistort(distort(point, coefficients), coefficients), point, rtol=0, atol=1e-8)


def test_one_bad_point_does_not_spoil_the_others():
    coefficients = np.array([-0.3, 0, 0, 0, 0])
    back = undistort(np.array([[0.2, 0.1], [5.0, 0.0], [np.nan, 0.0], [0.0, 0.0]]), coefficients)
    np.testing.assert_array_equal(np.isnan(back).any(axis=1), [False, True, True, False])
    np.testing.assert_allclose(distort(back[0], coefficients), [0.2, 0.1], atol=1e-10)


@pytest.mark.parametrize(
    ("radial", "fold"),
    [((-0.3, 0.0, 0.0), 1 / 0.9), ((0.0, -0.2, 0.0), 1.0), ((0.0, 0.0, -1 / 7), 1.0), ((0.1, 0.2, 0.3), np.inf)],
)
def test_fold(radial, fold):
    k1, k2, k3 = radial
    assert fold_radius_squared(np.array([k1, k2, 0, 0, k3])) == pytest.approx(fold)


def test_fold_is_where_the_picture_stops_growing():
    coefficients = np.array([-0.25, 0.02, 0, 0, -0.01])
    radius = np.sqrt(fold_radius_squared(coefficients))
    reach = [distort(np.array([radius * factor, 0.0]), coefficients)[0] for factor in (0.99, 1.0, 1.01)]
    assert reach[1] > reach[0] and reach[1] > reach[2]
