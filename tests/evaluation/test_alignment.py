"""Alignments undo what they promise to forgive, and nothing else.

Exactness bounds: all steps are products and one 3 x 3 singular value decomposition of numbers of order 1, so errors
stay within some hundred units of double rounding; 1e-9 m leaves four digits of room.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from muybridge.errors import InputError
from muybridge.evaluation.alignment import ALIGNMENTS, align, fit_similarity

EXACT_M = 1e-9


def body(seed: int = 0, frames: int = 4, joints: int = 15) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(frames, joints, 3))


def rotation(seed: int) -> np.ndarray:
    turn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return turn * np.sign(np.linalg.det(turn))


class TestAlign:
    @pytest.mark.parametrize("alignment", ALIGNMENTS)
    def test_same_joints_stay(self, alignment):
        points = body()
        np.testing.assert_allclose(align(points, points, alignment), points, atol=EXACT_M)

    def test_none_leaves_the_estimate_and_copies_it(self):
        points = body()
        moved = align(points, points + 1, "none")
        np.testing.assert_array_equal(moved, points)
        assert moved is not points

    def test_root_forgives_place_only(self):
        points = body()
        np.testing.assert_allclose(align(points + [1, -2, 3], points, "root"), points, atol=EXACT_M)
        turned = points @ rotation(1).T
        assert np.abs(align(turned, points, "root") - points).max() > 0.1

    def test_root_of_two_hips(self):
        points = body()
        estimate = points.copy()
        estimate[:, 3] += [0.2, 0, 0]
        estimate[:, 4] -= [0.2, 0, 0]
        np.testing.assert_allclose(align(estimate, points, "root", (3, 4)), estimate, atol=EXACT_M)

    @settings(max_examples=30, deadline=None)
    @given(st.integers(0, 10_000), st.floats(0.5, 2.0))
    def test_similarity_forgives_place_turn_and_size(self, seed, size):
        points = body(seed)
        estimate = size * points @ rotation(seed + 1).T + [3, 1, -2]
        np.testing.assert_allclose(align(estimate, points, "similarity"), points, atol=EXACT_M)

    def test_rigid_does_not_forgive_size(self):
        points = body()
        moved = align(1.2 * points @ rotation(2).T, points, "rigid")
        # a body 1.2 times too large stays 0.2 of each joint's distance from the centroid away
        centred = points - points.mean(axis=1, keepdims=True)
        np.testing.assert_allclose(moved - points, 0.2 * centred, atol=EXACT_M)

    def test_a_mirror_image_is_not_forgiven(self):
        points = body()
        assert np.linalg.norm(align(points * [-1, 1, 1], points, "similarity") - points, axis=-1).mean() > 0.1
        turn, _, _ = fit_similarity(points * [-1, 1, 1], points)
        np.testing.assert_allclose(np.linalg.det(turn), 1.0)

    def test_each_frame_on_its_own(self):
        points = body()
        estimate = points + np.arange(4)[:, None, None]
        np.testing.assert_allclose(align(estimate, points, "rigid"), points, atol=EXACT_M)

    def test_missing_joints_take_no_part(self):
        points = body()
        estimate = points @ rotation(3).T
        estimate[:, 2] = np.nan
        moved = align(estimate, points, "rigid")
        kept = [j for j in range(15) if j != 2]
        np.testing.assert_allclose(moved[:, kept], points[:, kept], atol=EXACT_M)
        assert np.isnan(moved[:, 2]).all()

    def test_more_forgiveness_never_costs_squared_error(self):
        truth = body()
        estimate = truth + 0.1 * body(9)
        squared = {kind: ((align(estimate, truth, kind) - truth) ** 2).sum() for kind in ALIGNMENTS}
        assert squared["similarity"] <= squared["rigid"] + EXACT_M
        assert squared["rigid"] <= min(squared["none"], squared["root"]) + EXACT_M


class TestErrors:
    def test_unknown_alignment(self):
        with pytest.raises(InputError, match="none or root or rigid or similarity"):
            align(body(), body(), "procrustes")

    def test_shapes_differ(self):
        with pytest.raises(InputError, match="one shape"):
            align(body(joints=14), body(), "none")


class TestLimits:
    def test_too_few_joints_give_nan(self):
        points = body(joints=2)
        assert np.isnan(align(points, points, "rigid")).all()

    def test_all_joints_at_one_point_give_no_size(self):
        point = np.ones((1, 5, 3))
        assert np.isnan(align(point, point, "similarity")).all()
