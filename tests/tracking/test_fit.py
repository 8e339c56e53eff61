"""Body and cameras are recovered from exact masks of a body with other measures, seen by cameras that are shifted.

An outline of whole pixels lies within half a pixel (7.4 mm) of the true one. So widths, depths and what many outlines
share, such as a camera's shift, are bounded by half a pixel; a length between two joints, both of which are told from
how limbs bend, by one and a half at each end together.
"""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.body import Body
from muybridge.cameras.model import Rig
from muybridge.tracking.fit import Fit, FitConfig, fit_body
from tracking.made import PIXEL, errors, exact_masks, likelihood, ring, walking

LENGTHS = {"thigh": 1.08, "upper_arm": 0.9, "torso": 1.08}
WIDTHS, DEPTHS = {"torso": 1.1, "thigh": 0.9, "shank": 1.2}, {"torso": 0.9, "thigh": 0.88, "shank": 1.2}
SHIFTS = np.array([[2.0, -1.5], [-1.0, 2.0], [1.5, 1.0], [-2.0, 0.0]])  # pixels
CAMERAS_ONLY = FitConfig(lengths=False, girths=False, cameras=True)


@pytest.fixture(scope="module")
def walk() -> tuple[Body, np.ndarray, np.ndarray]:
    """Body, six poses of a walk, and the same as far off as tracking with a wrong body leaves them: 20 mm, 1 degree."""
    body, poses = walking(30)
    poses = poses[::5]
    return body, poses, poses + np.random.default_rng(0).normal(0, 0.02, poses.shape)


@pytest.fixture(scope="module")
def fitted(walk) -> tuple[Body, Body, Body, Fit, np.ndarray]:
    """Body as given, true and found; the fit; true poses."""
    body, poses, given = walk
    true, model = body.scaled(lengths=LENGTHS, widths=WIDTHS, depths=DEPTHS), likelihood(body, ring())
    found, fit = fit_body(
        model, [model.observe(exact_masks(true, pose, model.rig)) for pose in poses], given, FitConfig()
    )
    return body, true, found.body, fit, poses


def half_axis(body: Body, group: str, axis: int) -> float:
    """Metres; the larger of a segment's two ends."""
    segment = [s.radius_group for s in body.segments].index(group)
    return float(np.linalg.norm(body.arrays.half_axes[segment, :, axis], axis=-1).max())


def length(body: Body, first: str, second: str) -> float:
    joints = body.joints(np.zeros(len(body.dof_names)))
    return float(np.linalg.norm(np.subtract(*(joints[body.joint_names.index(name)] for name in (first, second)))))


class TestBody:
    @pytest.mark.parametrize(
        ("first", "second"),
        [
            ("left_hip", "left_knee"),
            ("left_shoulder", "left_elbow"),
            ("pelvis", "thorax"),
            ("right_knee", "right_ankle"),
        ],
    )
    def test_lengths(self, fitted, first: str, second: str) -> None:
        body, true, found, _, _ = fitted
        assert abs(length(found, first, second) - length(true, first, second)) < 1.5 * PIXEL
        changed = (first, second) != ("right_knee", "right_ankle")
        assert changed == (abs(length(body, first, second) - length(true, first, second)) > 1.5 * PIXEL)

    @pytest.mark.parametrize("group", WIDTHS)
    def test_widths_and_depths(self, fitted, group: str) -> None:
        """The body as given is further off, as half axes: 15 mm (torso), 8 mm (thigh) and 11 mm (shank)."""
        body, _, _, fit, _ = fitted
        for axis, factors, true in ((0, fit.widths, WIDTHS), (1, fit.depths, DEPTHS)):
            assert abs(factors[group] - true[group]) * half_axis(body, group, axis) < 0.5 * PIXEL

    def test_joints(self, fitted) -> None:
        _, true, found, fit, poses = fitted
        away = np.linalg.norm(found.joints(fit.poses) - true.joints(poses), axis=-1)
        assert away.mean() < 0.5 * PIXEL

    def test_residual_is_of_pixels(self, fitted) -> None:
        assert fitted[3].residual < 0.5 * PIXEL

    def test_right_from_the_start_stays(self, walk) -> None:
        body, poses, _ = walk
        model = likelihood(body, ring())
        observations = [model.observe(exact_masks(body, pose, model.rig)) for pose in poses]
        found, fit = fit_body(model, observations, poses, FitConfig())
        for group in WIDTHS:
            assert abs(fit.widths[group] - 1.0) * half_axis(body, group, 0) < 0.5 * PIXEL
        assert abs(length(found.body, "left_hip", "left_ankle") - length(body, "left_hip", "left_ankle")) < PIXEL
        assert not fit.shifts.any()


@pytest.fixture(scope="module")
def observed(walk):
    """The model with the cameras as they should be, and the walk as shifted ones see it."""
    body, poses, _ = walk
    rig = ring()
    model = likelihood(body, rig)
    moved = Rig(tuple(camera.shifted(*shift) for camera, shift in zip(rig, SHIFTS, strict=True)))
    return model, [model.observe(exact_masks(body, pose, moved)) for pose in poses]


class TestCameras:
    def test_shifts(self, walk, observed) -> None:
        """All but what moving the whole world would do as well: the person's place is not the cameras' matter."""
        _, poses, given = walk
        model, observations = observed
        _, fit = fit_body(model, observations, given, CAMERAS_ONLY)
        centre, step = poses[:, :3].mean(axis=0), 1e-3
        world = np.column_stack(
            [
                np.concatenate([c.world_to_pixel(centre + step * e) - c.world_to_pixel(centre) for c in model.rig])
                for e in np.eye(3)
            ]
        )
        away = fit.shifts.ravel() - SHIFTS.ravel()
        away -= world @ np.linalg.lstsq(world, away, rcond=None)[0]
        assert np.abs(away).max() < 0.5
        assert np.abs(SHIFTS).max() > 1.0, "not shifting would do"
        assert fit.lengths == fit.widths == fit.depths == {}

    def test_explains_what_poses_alone_cannot(self, walk, observed) -> None:
        """Measured: 5 mm with shifts, 15 mm without."""
        model, observations = observed
        nothing = FitConfig(lengths=False, girths=False)
        with_shifts, without = (fit_body(model, observations, walk[2], c)[1].residual for c in (CAMERAS_ONLY, nothing))
        assert with_shifts < 0.5 * PIXEL < 0.7 * without

    def test_the_rig_given_back_is_shifted(self, walk, observed) -> None:
        model, observations = observed
        found, fit = fit_body(model, observations, walk[2], CAMERAS_ONLY)
        for before, after, shift in zip(model.rig, found.rig, fit.shifts, strict=True):
            np.testing.assert_allclose(after.matrix[:2, 2] - before.matrix[:2, 2], shift, atol=1e-12)


def test_one_frame_alone(walk) -> None:
    """One frame can be fitted too; the priors hold what it does not show."""
    body, poses, given = walk
    model = likelihood(body, ring())
    found, fit = fit_body(model, [model.observe(exact_masks(body, poses[2], model.rig))], given[2:3], FitConfig())
    assert errors(body, fit.poses[0], poses[2]).mean() < 2 * PIXEL
    assert all(0.8 < factor < 1.25 for factor in fit.lengths.values()) and np.isfinite(fit.residual)
