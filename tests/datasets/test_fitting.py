"""Pictures stored scaled between black bars, and the cameras that fit them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from muybridge.cameras import Camera
from muybridge.datasets.fitting import fit_camera, fit_picture, letterbox
from muybridge.errors import InputError


def camera(size):
    return Camera("c", size, np.array([[50.0, 0, 30], [0, 50, 20], [0, 0, 1]]), np.zeros(5), np.eye(3), np.zeros(3))


def test_the_known_case():
    """1088 x 1920 stored as 1080 x 1920 was measured to be u' = 0.99265 u, v' = 0.99265 v + 7.06."""
    scale, dx, dy = letterbox((1088, 1920), (1080, 1920))
    assert scale == pytest.approx(0.99265, abs=5e-6) and dx == pytest.approx(0) and dy == pytest.approx(7.06, abs=0.005)


sides = st.integers(40, 200)


@given(sides, sides, sides, sides)
def test_a_fitted_picture_and_a_fitted_camera_agree_on_where_the_corners_are(w, h, new_w, new_h):
    scale, dx, dy = letterbox((w, h), (new_w, new_h))
    corners = np.array([[-0.5, -0.5], [w - 0.5, h - 0.5]])
    moved = (corners + 0.5) * scale - 0.5 + [dx, dy]
    np.testing.assert_allclose(moved.sum(0) / 2, [new_w / 2 - 0.5, new_h / 2 - 0.5], atol=1e-9)  # centred
    assert np.isclose(dx, 0, atol=1e-9) or np.isclose(dy, 0, atol=1e-9)  # as large as fits
    assert dx > -1e-9 and dy > -1e-9
    black = np.zeros((new_h, new_w), np.uint8)
    ray = np.array([0.1, -0.05, 1.0])
    before, after = camera((w, h)).camera_to_pixel(ray), fit_camera(camera((w, h)), black).camera_to_pixel(ray)
    np.testing.assert_allclose(after, (before + 0.5) * scale - 0.5 + [dx, dy], atol=1e-9)


def test_a_blob_moves_as_the_camera_says():
    picture = np.zeros((80, 120), np.uint8)
    picture[30:40, 70:90] = 255
    fitted = fit_picture(picture, (90, 80))
    weights = fitted.astype(float)
    rows, columns = np.indices(fitted.shape)
    centre = np.array([(columns * weights).sum(), (rows * weights).sum()]) / weights.sum()
    scale, dx, dy = letterbox((120, 80), (90, 80))
    np.testing.assert_allclose(centre, (np.array([79.5, 34.5]) + 0.5) * scale - 0.5 + [dx, dy], atol=0.1)


def test_the_same_size_is_left_alone():
    picture = np.full((48, 64, 3), 9, np.uint8)
    assert fit_picture(picture, (64, 48)) is picture
    same = camera((64, 48))
    assert fit_camera(same, picture) is same


def test_another_size_without_bars_is_refused():
    bright = np.full((60, 50, 3), 128, np.uint8)
    with pytest.raises(InputError, match="black bars, got 50 x 60"):
        fit_camera(camera((64, 48)), bright)


def test_a_plain_change_of_scale_has_no_bars_and_passes():
    bright = np.full((24, 32, 3), 128, np.uint8)
    assert fit_camera(camera((64, 48)), bright).size == (32, 24)
