"""The contour as a least-squares problem; its distances and derivatives are held to small steps with the kernel."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from muybridge.cameras.model import Rig
from muybridge.likelihood.contour import SHORTEST_BORDER, mask_borders, no_borders, robust_weights
from muybridge.likelihood.observation import MINIMUM_SD, UNCOVERED_SPREAD, ImageLikelihood
from muybridge.likelihood.pictures import FULL, HALF, camera_rows
from reference.scene import camera, standing
from reference.silhouette import model_mask

SIZE = (160, 120)


@pytest.fixture(scope="module")
def scene():
    """Likelihood of two cameras, the pose (D,) whose masks they see, and the masks."""
    body, pose = standing()
    for name in ("left_shoulder_abduction", "right_shoulder_abduction"):
        pose[body.dof_names.index(name)] = 0.5
    rig = Rig(tuple(replace(camera(angle, SIZE), name=f"c{i}") for i, angle in enumerate((0.2, 1.6))))
    masks = [model_mask(pose, body.arrays, row) for row in camera_rows(rig)]
    return ImageLikelihood(body, rig, (1, 1)), pose, masks


class TestResiduals:
    def test_none_where_the_mask_is_the_bodys_own(self, scene) -> None:
        """Pixels whose middle is inside are drawn: the border lies within half a pixel, along axes and diagonals .71.

        Points at corners between segments are further from it; nine in ten are not.
        """
        model, pose, masks = scene
        rows = model.observe(masks).contour(pose, 0.05)
        pixels = np.abs(rows.distance / rows.metres)
        assert len(pixels) > 200
        assert np.quantile(pixels, 0.9) < np.sqrt(0.5)
        assert abs(np.median(rows.distance / rows.metres)) < 0.25, "no bias inwards or outwards"

    @pytest.mark.parametrize("dof", ["root_x", "root_y", "root_z"])
    def test_a_body_beside_its_mask_is_pulled_back(self, scene, dof: str) -> None:
        """One Gauss-Newton step from 30 mm (2 pixels) beside: what is left is below half a pixel."""
        model, pose, masks = scene
        place = model.body.dof_names.index(dof)
        moved = pose.copy()
        moved[place] += 0.03
        seen = model.observe(masks).normal_equations(moved, 0.1)
        change = np.linalg.solve(seen.curvature[:3, :3], seen.gradient[:3])
        pixel = 1.8 / (0.85 * SIZE[1])
        assert np.abs(moved[:3] + change - pose[:3]).max() < 0.5 * pixel < 0.03

    def test_only_within_reach(self, scene) -> None:
        """Borders are looked for up to 1.5 spreads away, at least 2 pixels."""
        model, pose, masks = scene
        moved = pose + np.r_[0.1, np.zeros(len(pose) - 1)]
        for spread in (0.03, 0.06, 0.12):
            rows = model.observe(masks).contour(moved, spread, side_points=4)
            tolerance = 1.5 * rows.metres  # steps, and the depth of a point that is not the root's
            assert (np.abs(rows.distance) <= np.maximum(1.5 * spread * 1.15, 2 * rows.metres) + tolerance).all()

    def test_of_one_limb(self, scene) -> None:
        """The rows of the segments that it moves, as among all; its derivatives are those of these rows."""
        model, pose, masks = scene
        observation, arm = model.observe(masks), model.body.blocks["left_arm"]
        limb = np.flatnonzero(model.body.moved_by[:, arm].any(axis=1))
        for spread in (2 * UNCOVERED_SPREAD, 0.5 * UNCOVERED_SPREAD):
            whole, part = observation.contour(pose, spread), observation.contour(pose, spread, moved=arm)
            own = np.isin(whole.segment, limb)
            assert 0 < own.sum() < len(own)
            np.testing.assert_array_equal(part.distance, whole.distance[own])
            np.testing.assert_array_equal(part.slopes, whole.slopes[own])
            seen = observation.normal_equations(pose, spread, arm)
            slopes = part.slopes[:, arm] * (robust_weights(part.distance, spread) / model.row_sd**2)[:, None]
            np.testing.assert_allclose(seen.gradient, slopes.T @ part.distance)
            np.testing.assert_allclose(seen.curvature, slopes.T @ part.slopes[:, arm])

    def test_nothing_seen(self, scene) -> None:
        model, pose, masks = scene
        seen = model.observe([np.zeros_like(mask) for mask in masks]).normal_equations(pose, 0.05)
        assert seen.points == 0 and not seen.curvature.any() and not seen.gradient.any() and seen.noise == 1.0

    def test_behind_the_camera(self, scene) -> None:
        model, pose, masks = scene
        away = pose.copy()
        away[:3] += 50.0
        assert model.observe(masks).normal_equations(away, 0.05).points == 0

    def test_noise_is_the_residuals(self, scene) -> None:
        """Relative to the variance assumed; no better than MINIMUM_SD."""
        model, pose, masks = scene
        rows = model.observe(masks).contour(pose, 0.05)
        weights = robust_weights(rows.distance, 0.05)
        expected = max(np.average(rows.distance**2, weights=weights), MINIMUM_SD**2) / model.row_sd**2
        assert model.observe(masks).normal_equations(pose, 0.05).noise == pytest.approx(expected)

    def test_a_camera_without_weight_says_nothing(self, scene) -> None:
        model, pose, masks = scene
        spoilt = [masks[0], np.roll(masks[1], 9, axis=1)]
        first = replace(model, weights=(1.0, 0.0))
        one, two = (first.observe(m).normal_equations(pose, 0.1).gradient for m in (masks, spoilt))
        np.testing.assert_array_equal(one, two)
        assert not np.array_equal(model.observe(masks).normal_equations(pose, 0.1).gradient, one)


class TestRobustWeights:
    def test_values(self) -> None:
        """(s^2 / (s^2 + d^2))^2: 1 at nothing, 1/4 at one spread, 1/100 at three."""
        distance = np.array([0.0, 0.1, -0.1, 0.3])
        np.testing.assert_allclose(robust_weights(distance, 0.1), [1.0, 0.25, 0.25, 0.01])

    def test_far_residuals_pull_less_and_less(self) -> None:
        """d w(d) is largest at d = s / sqrt(3)."""
        distance = np.linspace(0.0, 1.0, 10001)
        pull = distance * robust_weights(distance, 0.1)
        assert distance[np.argmax(pull)] == pytest.approx(0.1 / np.sqrt(3), abs=1e-4)


class TestBorders:
    def test_of_a_rectangle(self) -> None:
        """20 x 10 pixels have 2 (20 + 10) - 4 on their border; every sixth is taken, and lies on it."""
        share = np.zeros((2, 40, 50), np.uint8)
        share[0, 5:15, 10:30] = FULL
        borders = mask_borders(share)
        assert borders.counts.tolist() == [-(-56 // 6), 0]
        x, y = borders.points[0, : borders.counts[0]].T
        assert (((x == 10) | (x == 29)) | ((y == 5) | (y == 14))).all()
        assert mask_borders(share, spacing=1).counts[0] == 56

    def test_speckle_is_left_out(self) -> None:
        side = SHORTEST_BORDER // 4  # 4 side - 4 pixels long
        share = np.zeros((1, 40, 50), np.uint8)
        share[0, 10 : 10 + side, 10 : 10 + side] = FULL
        assert mask_borders(share).counts.tolist() == [0]
        share[0, 10 : 12 + side, 10 : 12 + side] = FULL
        assert mask_borders(share, spacing=1).counts.tolist() == [4 * (side + 2) - 4]

    def test_half_covered_pixels_belong_to_the_mask(self) -> None:
        share = np.zeros((1, 40, 50), np.uint8)
        share[0, 5:25, 5:25], share[0, 5:25, 25] = FULL, HALF - 1
        points = mask_borders(share, spacing=1).points[0]
        assert points[:, 0].max() == 24

    def test_no_cameras_no_borders(self) -> None:
        assert no_borders(3).counts.tolist() == [0, 0, 0]
        assert mask_borders(np.zeros((0, 4, 4), np.uint8)).counts.size == 0

    def test_pull_limbs_only_while_the_search_is_coarse(self, scene) -> None:
        """A raised arm's border, which a body with its arms down leaves uncovered."""
        model, pose, masks = scene
        down = pose.copy()
        down[model.body.dof_names.index("left_shoulder_abduction")] = -0.3
        observation = model.observe(masks)
        for spread in (2 * UNCOVERED_SPREAD, 0.9 * UNCOVERED_SPREAD):
            extra = len(observation.contour(down, spread).distance) - len(_without_borders(observation, down, spread))
            assert (extra > 0) == (spread > UNCOVERED_SPREAD)


def _without_borders(observation, pose: np.ndarray, spread: float) -> np.ndarray:
    from muybridge.likelihood.contour import contour_rows

    model = observation.model
    none = no_borders(len(model.rig))
    return contour_rows(model.body, model.cameras, observation.shares, none, pose, spread).distance


def test_moved_by_is_what_moves(scene) -> None:
    """A degree of freedom moves a segment if its ends go anywhere when it is changed."""
    model, pose, _ = scene
    body, moved = model.body, model.body.moved_by
    before = body.frames(pose[None])[0]
    for dof in range(len(pose)):
        changed = pose.copy()
        changed[dof] += 0.01
        differs = np.abs(body.frames(changed[None])[0] - before).max(axis=(1, 2)) > 1e-9
        np.testing.assert_array_equal(differs, moved[:, dof])
