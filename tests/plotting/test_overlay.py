"""Overlays: what is drawn lies where it should, the input picture stays as it was, and odd input does no harm."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.plotting.overlay import SIDE_COLOURS, contact_sheet, draw_joints, draw_label, draw_limbs

SQUARE = np.array([[20.0, 20], [60, 20], [60, 60], [20, 60]])
SMOOTHED = 0.15 * 255
"""A smoothed line of one pixel leaves about a tenth of what is below it; a half more is allowed."""


def grey(height: int = 80, width: int = 100) -> np.ndarray:
    return np.full((height, width, 3), 100, np.uint8)


class TestLimbs:
    def test_outline_has_the_side_s_colour_and_the_inside_a_tint(self):
        image = grey()
        drawn = draw_limbs(image, [SQUARE], ["left_thigh"], fill=0.5)
        np.testing.assert_allclose(drawn[20, 40], SIDE_COLOURS["left"], atol=SMOOTHED)
        expected = 50 + np.array(SIDE_COLOURS["left"]) / 2
        np.testing.assert_allclose(drawn[40, 40], expected, atol=1)  # rounding of a weighted sum
        np.testing.assert_array_equal(drawn[5, 5], 100)
        np.testing.assert_array_equal(image, grey())

    def test_no_fill(self):
        np.testing.assert_array_equal(draw_limbs(grey(), [SQUARE], ["torso"], fill=0.0)[40, 40], 100)

    def test_sides_differ(self):
        left, right = (draw_limbs(grey(), [SQUARE], [side]) for side in ("left", "right"))
        assert np.any(left != right)

    @pytest.mark.parametrize("outline", [np.empty((0, 2)), SQUARE[:2], np.full((4, 2), np.nan), SQUARE * [np.nan, 1]])
    def test_what_is_no_polygon_is_left_out(self, outline):
        np.testing.assert_array_equal(draw_limbs(grey(), [outline], ["torso"]), grey())

    def test_far_outside(self):
        np.testing.assert_array_equal(draw_limbs(grey(), [SQUARE + 1e9], ["torso"]), grey())

    def test_names_must_match(self):
        with pytest.raises(ValueError):
            draw_limbs(grey(), [SQUARE], [])


class TestJoints:
    def test_a_dot_and_a_circle_of_two_deviations(self):
        drawn = draw_joints(grey(), np.array([[50.0, 40.0]]), ["right_knee"], np.array([10.0]))
        np.testing.assert_array_equal(drawn[40, 50], SIDE_COLOURS["right"])
        np.testing.assert_allclose(drawn[40, 70], SIDE_COLOURS["right"], atol=SMOOTHED)
        np.testing.assert_array_equal(drawn[40, 62], 100)

    def test_unknown_ones_are_left_out(self):
        np.testing.assert_array_equal(
            draw_joints(grey(), np.array([[np.nan, 3.0]]), ["pelvis"], np.array([1.0])), grey()
        )
        draw_joints(grey(), np.array([[5.0, 3.0]]), ["pelvis"], np.array([np.nan]))
        draw_joints(grey(), np.array([[5.0, 3.0]]), ["pelvis"], np.array([1e12]))


class TestSheet:
    def test_size_and_cells(self):
        sheet = contact_sheet([grey(), np.zeros((80, 100, 3), np.uint8)] * 3, columns=4, width=418, gap=6)
        assert sheet.shape == (2 * 80 + 6, 418, 3)
        np.testing.assert_array_equal(sheet[10, 10], 100)
        np.testing.assert_array_equal(sheet[10, 120], 0)

    def test_labels_and_other_shapes(self):
        sheet = contact_sheet([grey(), grey(200, 50)], ["one", "two"], width=400)
        assert sheet.shape[1] == 400

    def test_errors(self):
        with pytest.raises(InputError, match="pictures"):
            contact_sheet([])
        with pytest.raises(InputError, match="label for each"):
            contact_sheet([grey()], ["a", "b"])
        with pytest.raises(InputError, match="uint8"):
            draw_label(np.zeros((4, 4)), "x")
