"""Rotations from vectors and from matrices with few digits."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from muybridge.cameras.rotations import nearest_rotation, rotation_from_vector
from muybridge.errors import InputError

vectors = st.tuples(*[st.floats(-4, 4)] * 3).map(np.array)


@given(vectors)
def test_is_a_rotation_that_keeps_its_axis(vector):
    rotation = rotation_from_vector(vector)
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-14)
    assert np.linalg.det(rotation) == pytest.approx(1)
    np.testing.assert_allclose(rotation @ vector, vector, atol=1e-13)


@given(vectors)
def test_equals_opencv(vector):
    # OpenCV replaces angles below its epsilon by none; the difference is that angle.
    np.testing.assert_allclose(rotation_from_vector(vector), cv2.Rodrigues(vector)[0], atol=1e-13)


def test_quarter_turn_about_z():
    rotation = rotation_from_vector(np.array([0, 0, np.pi / 2]))
    np.testing.assert_allclose(rotation @ [1, 0, 0], [0, 1, 0], atol=1e-15)


@given(vectors)
def test_rounding_is_mended(vector):
    rotation = rotation_from_vector(vector)
    mended = nearest_rotation("R", np.round(rotation, 4))
    np.testing.assert_allclose(mended @ mended.T, np.eye(3), atol=1e-14)
    # Nine entries off by at most 5e-5 move the matrix by at most 1.5e-4 (Frobenius), its projection by twice that.
    np.testing.assert_allclose(mended, rotation, atol=3e-4)


@pytest.mark.parametrize("matrix", [np.eye(3) * 1.1, np.zeros((3, 3)), np.full((3, 3), np.nan)])
def test_what_is_no_rotation_is_refused(matrix):
    with pytest.raises(InputError, match="^R: expected"):
        nearest_rotation("R", matrix)


def test_a_reflection_stays_one():
    assert np.linalg.det(nearest_rotation("R", np.diag([1.0, 1, -1]))) == pytest.approx(-1)
