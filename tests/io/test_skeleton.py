"""Skeletons and recordings: turns in any order, units by size, axes that keep left on the left."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from muybridge.errors import InputError
from muybridge.io.skeleton import Recording, Skeleton, guess_metres, numbers, to_world, turns


def standing(extent: float) -> Skeleton:
    """Two bones, one on the other, `extent` units high."""
    offsets = np.array([[0.0, 0, 0], [0, 0.5 * extent, 0]])
    tips = np.array([[0.0, 0.5 * extent, 0], [0, 0.5 * extent, 0]])
    return Skeleton(("hips", "head"), np.array([-1, 0]), offsets, tips)


class TestTurns:
    @pytest.mark.parametrize("order", ["XYZ", "ZYX", "YXZ", "ZXY", "YZX", "XZY", "XY", "Z"])
    def test_every_order(self, order):
        """scipy's capital letters are turns about moving axes: a product from left to right."""
        angles = np.random.default_rng(3).uniform(-3, 3, (20, len(order)))
        expected = Rotation.from_euler(order, angles).as_matrix()
        np.testing.assert_allclose(turns(["XYZ".index(a) for a in order], angles), expected, atol=1e-12)

    def test_none(self):
        assert np.array_equal(turns([], np.empty((2, 0))), [np.eye(3)] * 2)


class TestUnit:
    @pytest.mark.parametrize(
        ("extent", "metres"), [(1.7, 1.0), (170, 0.01), (1700, 0.001), (67, 0.0254), (29.4, 0.0254 / 0.45)]
    )
    def test_known_units(self, extent, metres):
        assert guess_metres(standing(extent), "file") == metres

    @pytest.mark.parametrize("extent", [0.0, 0.2, 8.0, 3e6])
    def test_no_unit_fits(self, extent):
        with pytest.raises(InputError, match=r"unit of some\.bvh: expected a person .* units large; give the unit"):
            guess_metres(standing(extent), "some.bvh")


class TestWorld:
    def test_y_up(self):
        """In files with Y up people face Z and have X on their left; in the world that is z, x and y."""
        turned = Rotation.from_euler("Y", 90, degrees=True).as_matrix()[None, None].repeat(2, axis=1)
        recording = Recording(standing(2.0), np.zeros(1), turned, np.array([[1.0, 2.0, 3.0]]))
        world = to_world(recording, "yzx", 0.5)
        np.testing.assert_allclose(world.root_places, [[1.5, 0.5, 1.0]])
        np.testing.assert_allclose(world.skeleton.offsets[1], [0, 0, 0.5])
        # A quarter turn about the vertical takes what is ahead to the left.
        np.testing.assert_allclose(world.rotations[0, 0] @ [1, 0, 0], [0, 1, 0], atol=1e-12)

    def test_poses_are_the_same_in_both(self):
        rng = np.random.default_rng(0)
        turned = Rotation.random(6, random_state=1).as_matrix().reshape(3, 2, 3, 3)
        recording = Recording(standing(2.0), np.arange(3.0), turned, rng.normal(size=(3, 3)))
        before, after = recording.posed()[1], to_world(recording, "yzx", 0.1).posed()[1]
        np.testing.assert_allclose(after, 0.1 * before[..., [2, 0, 1]], atol=1e-12)

    def test_mirrors_are_refused(self):
        with pytest.raises(InputError, match="mirror the body, got 'xzy'"):
            to_world(Recording(standing(2.0), np.zeros(1), np.eye(3)[None, None], np.zeros((1, 3))), "xzy", 1.0)


class TestNumbers:
    @pytest.mark.parametrize(
        ("words", "message"),
        [
            (["1"], "expected 2 numbers, got 1"),
            (["1", "x"], "got '1 x'"),
            (["1", "nan"], "finite"),
            (["1", "inf"], "finite"),
        ],
    )
    def test_errors(self, words, message):
        with pytest.raises(InputError, match=message):
            numbers(words, "line 3", 2)

    def test_values(self):
        assert numbers(["1", "-2.5e-3"], "line 3", 2) == [1.0, -2.5e-3]
