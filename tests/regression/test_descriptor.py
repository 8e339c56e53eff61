"""Descriptors: against scipy's transform, in closed form, and where a mask is no silhouette."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from scipy import fft, ndimage

from muybridge.errors import InputError
from muybridge.regression import descriptor as module
from muybridge.regression.descriptor import PRINTED, WORKING, DescriptorConfig, cosines, describe

CONFIGS = [PRINTED, WORKING, DescriptorConfig(frame="height"), DescriptorConfig(values="distance")]


def person(height=120, width=160, arm=0, scale=1, left=60):
    """Trunk, head, legs apart, and an arm `arm` columns long."""
    mask = np.zeros((height, width), np.uint8)
    mask[20:32, left + 12 : left + 20] = 1
    mask[32:64, left + 6 : left + 26] = 1
    mask[64:100, left + 2 : left + 12] = 1
    mask[64:98, left + 18 : left + 28] = 1
    mask[36:42, left + 26 : left + 26 + arm] = 1
    return np.kron(mask, np.ones((scale, scale), np.uint8)).astype(bool)


def test_the_transform_is_scipys_orthonormal_one():
    mask = person(arm=20)
    box = mask[20:100, 62:106].astype(np.float32)
    picture = cv2.resize(box, (64, 128), interpolation=cv2.INTER_AREA)
    expected = fft.dctn(picture.astype(float), norm="ortho")[:8, :8]
    # the pictures are float32 with sums of 8192 values below 1: rounding stays below 1e-10 in float64
    np.testing.assert_allclose(describe(mask, PRINTED).values, expected.ravel(), atol=1e-10)


def test_cosines_are_orthonormal():
    np.testing.assert_allclose(cosines(64, 64) @ cosines(64, 64).T, np.eye(64), atol=1e-13)


def test_a_full_box_has_a_mean_and_nothing_else():
    mask = np.zeros((90, 90), bool)
    mask[10:70, 20:60] = True
    values = describe(mask, PRINTED).values
    assert values[0] == pytest.approx(np.sqrt(64 * 128))  # (1): alpha_0 alpha_0 times the area of ones
    np.testing.assert_allclose(values[1:], 0, atol=1e-12)


@pytest.mark.parametrize("config", CONFIGS)
def test_place_does_not_matter(config):
    base = describe(person(), config).values
    moved = describe(np.roll(person(), (7, -31), axis=(0, 1)), config).values
    np.testing.assert_array_equal(base, moved)


@pytest.mark.parametrize("config", CONFIGS)
def test_size_hardly_matters(config):
    """The same person two and three times as large, against the change that another posture makes.

    Resampling blurs borders by half a pixel of the small mask; an arm of 20 columns is 120 pixels of 1800. Measured:
    2 % of the arm's change in the distances to 9 % in the crops' masks; an eighth leaves room for OpenCV's versions.
    """
    base, arm = describe(person(), config).values, describe(person(arm=20), config).values
    for scale in (2, 3):
        other = describe(person(scale=scale), config).values
        assert np.linalg.norm(other - base) < np.linalg.norm(arm - base) / 8


def test_the_height_frame_keeps_how_wide_a_person_is_and_the_box_does_not():
    narrow, wide = np.zeros((100, 100), bool), np.zeros((100, 100), bool)
    narrow[10:90, 40:60] = True
    wide[10:90, 30:70] = True
    assert np.linalg.norm(describe(narrow, PRINTED).values - describe(wide, PRINTED).values) < 1e-12
    height = DescriptorConfig(frame="height")
    pixels = 20 * (96 / 80) * 96  # by which the pictures differ; Parseval: no more can be left in 8 x 8 coefficients
    change = np.linalg.norm(describe(narrow, height).values - describe(wide, height).values)
    assert 0.8 * np.sqrt(pixels) < change <= np.sqrt(pixels) * 1.0001


def test_what_is_wider_than_tall_is_cut_off():
    wide = np.zeros((60, 300), bool)
    wide[20:40, 10:290] = True
    full = np.ones((20, 20), bool)
    config = DescriptorConfig(frame="height")
    np.testing.assert_allclose(
        describe(wide, config).values, describe(np.pad(full, 4), config).values, atol=1e-9
    )  # both fill the square


def test_distances_are_to_the_border_and_end_at_the_reach():
    """OpenCV's 3 x 3 chamfer is wrong by up to 5 % of a distance (its steps of .955 and 1.3693), so by 0.6 of 12."""
    picture = np.zeros((96, 96), np.float32)
    picture[30:60, 20:70] = 1.0
    found = module._signed_distance(picture)
    inside = np.pad(picture > 0.5, module.MARGIN)
    exact = ndimage.distance_transform_edt(inside) - ndimage.distance_transform_edt(~inside)
    exact = np.clip(exact, -module.REACH, module.REACH)
    assert found.min() == -module.REACH and found.max() == module.REACH
    assert np.abs(found - exact).max() < 0.05 * module.REACH


@pytest.mark.parametrize(
    ("rows", "columns", "touches"),
    [
        (slice(5, 20), slice(5, 20), False),
        (slice(0, 20), slice(5, 20), True),
        (slice(5, 30), slice(5, 20), True),
        (slice(5, 20), slice(0, 20), True),
        (slice(5, 20), slice(5, 40), True),
    ],
)
def test_a_silhouette_at_the_border_is_flagged(rows, columns, touches):
    mask = np.zeros((30, 40), bool)
    mask[rows, columns] = True
    found = describe(mask)
    assert found.touches_border is touches
    assert found.box == (columns.start, rows.start, columns.stop, rows.stop)
    np.testing.assert_allclose(found.centre, [(columns.start + columns.stop - 1) / 2, (rows.start + rows.stop - 1) / 2])


def test_no_silhouette():
    with pytest.raises(InputError, match="no foreground pixel"):
        describe(np.zeros((20, 20), bool))
    with pytest.raises(InputError, match="bool"):
        describe(np.ones((20, 20), np.uint8))
    with pytest.raises(InputError, match=r"shape \(H, W\)"):
        describe(np.ones((20, 20, 3), bool))


def test_one_pixel_and_one_line_are_silhouettes_too():
    for config in CONFIGS:
        for rows, columns in ((1, 1), (1, 30), (30, 1)):
            mask = np.zeros((40, 40), bool)
            mask[5 : 5 + rows, 5 : 5 + columns] = True
            values = describe(mask, config).values
            assert values.shape == (config.size,) and np.isfinite(values).all()


@pytest.mark.parametrize("wrong", [{"frame": "crop"}, {"values": "grey"}, {"coefficients": 0}, {"coefficients": 65}])
def test_settings_check_themselves(wrong):
    with pytest.raises(InputError, match="descriptor"):
        DescriptorConfig(**wrong)
