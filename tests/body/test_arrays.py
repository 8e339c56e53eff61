"""Half axes of shapes, in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from muybridge.body import Segment, Shape
from muybridge.body.arrays import arrays_of, half_axes_of


def test_a_flat_cone_has_discs() -> None:
    shape = Shape((0, 0, 0), (0, 0, -0.4), (0.1, 0.05), scale=(1.2, 0.5), round_ends=False)
    axes = half_axes_of(shape)
    np.testing.assert_allclose(np.linalg.norm(axes, axis=-1), [[0.12, 0.05, 0.0], [0.06, 0.025, 0.0]], atol=1e-15)
    np.testing.assert_allclose(np.abs(axes[0, 0]), [0.12, 0, 0], atol=1e-15)


def test_a_sphere_is_round_whatever_its_ends() -> None:
    for round_ends in (True, False):
        axes = half_axes_of(Shape((0, 0, 1), (0, 0, 1), (0.1, 0.1), round_ends=round_ends))
        np.testing.assert_allclose(axes @ axes.transpose(0, 2, 1), [0.01 * np.eye(3)] * 2, atol=1e-15)


@given(st.integers(0, 2**32 - 1))
def test_half_axes_are_perpendicular_and_the_third_lies_along(seed: int) -> None:
    rng = np.random.default_rng(seed)
    base, tip, side = (tuple(rng.normal(size=3)) for _ in range(3))
    axes = half_axes_of(Shape(base, tip, tuple(rng.uniform(0.1, 1, 2)), tuple(rng.uniform(0.1, 2, 2)), side))
    products = axes @ axes.transpose(0, 2, 1)
    assert np.abs(products - products * np.eye(3)).max() < 1e-12
    assert np.linalg.norm(np.cross(axes[:, 2], np.subtract(tip, base))) < 1e-12
    assert (np.linalg.det(axes) > 0).all()


def test_a_side_along_the_cone_is_replaced() -> None:
    axes = half_axes_of(Shape((0, 0, 0), (0.3, 0, 0), (0.1, 0.1), side=(1, 0, 0)))
    np.testing.assert_allclose(np.linalg.norm(axes, axis=-1), 0.1, atol=1e-15)


def test_children_hang_where_they_are_said_to() -> None:
    cone = Shape((0, 0, 0), (0, 0, 1), (0.1, 0.1))
    at_tip = Segment("tip", parent="root", at_tip=True, offset=(0.5, 0, 0), shape=cone)
    at_origin = Segment("origin", parent="root", offset=(0.5, 0, 0))
    arrays = arrays_of((Segment("root", shape=cone), at_tip, at_origin))
    np.testing.assert_array_equal(arrays.fixed[1:, :, 3], [[0.5, 0, 1], [0.5, 0, 0]])
    np.testing.assert_array_equal(arrays.parent, [-1, 0, 0])
    np.testing.assert_array_equal(arrays.shaped, [0, 1])
    assert arrays.dof.max() == -1 and arrays.axis.max() == 0


@pytest.mark.parametrize("factor", [0.5, 1.0, 2.0])
def test_a_longer_round_cone_keeps_its_ends(factor: float) -> None:
    shape = Shape((0, 0, 0), (0, 0, 0.4), (0.1, 0.1), scale=(1.0, 0.7))
    np.testing.assert_allclose(half_axes_of(shape.resized(factor, 1, 1)), half_axes_of(shape), atol=1e-15)
