"""Errors in millimetres, and the events that a mean hides. Made tracks, so that every number is known beforehand."""

from __future__ import annotations

import json

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.evaluation.joints import joint_errors, swapped_legs
from muybridge.evaluation.names import JOINTS, mirrored
from muybridge.io.run_folder import JointSeries


def track(
    positions: np.ndarray, names: tuple[str, ...] = JOINTS, first: int = 0, deviation: float | None = None
) -> JointSeries:
    frames = first + np.arange(len(positions))
    spread = np.full(positions.shape[:2], np.nan if deviation is None else deviation)
    return JointSeries(names, frames, frames / 50.0, positions, spread)


def standing(frames: int = 10) -> np.ndarray:
    """A person made of well separated joints: left at +0.2 m, right at -0.2 m."""
    heights = {
        "pelvis": 0.9,
        "thorax": 1.4,
        "head_top": 1.8,
        "shoulder": 1.4,
        "elbow": 1.1,
        "wrist": 0.8,
        "hip": 0.9,
        "knee": 0.5,
        "ankle": 0.1,
    }
    side = [0.2 * (name.startswith("left") - name.startswith("right")) for name in JOINTS]
    height = [heights[name.removeprefix("left_").removeprefix("right_")] for name in JOINTS]
    return np.tile(np.column_stack([np.zeros(15), side, height]), (frames, 1, 1))


class TestValues:
    def test_a_shift_of_ten_millimetres(self):
        truth = standing()
        result = joint_errors(track(truth + [0.006, 0.008, 0]), track(truth))
        assert result.alignment == "none"
        np.testing.assert_allclose([result.mean_mm, result.median_mm, result.p95_mm, result.worst_joint_mm], 10.0)
        for joint in result.joints:
            np.testing.assert_allclose(joint.bias_mm, (6, 8, 0), atol=1e-9)
            assert joint.count == 10
        np.testing.assert_allclose(
            joint_errors(track(truth + [0.006, 0.008, 0]), track(truth), "root").mean_mm, 0, atol=1e-9
        )

    def test_worst_frame_and_joint(self):
        truth = standing()
        estimate = truth.copy()
        estimate[7, JOINTS.index("left_wrist")] += [0, 0, 0.3]
        result = joint_errors(track(estimate, first=100), track(truth, first=100))
        assert result.worst_frame == 107
        np.testing.assert_allclose(result.worst_frame_mm, 300 / 15)
        assert result.lost_wrists == {"left_wrist": 0.1, "right_wrist": 0.0}
        wrist = next(joint for joint in result.joints if joint.joint == "left_wrist")
        assert wrist.worst_frame == 107
        np.testing.assert_allclose(wrist.worst_mm, 300)

    def test_lost_frames(self):
        truth = standing()
        estimate = truth.copy()
        estimate[:3] += [0.201, 0, 0]
        estimate[3:5] += [0.199, 0, 0]
        assert joint_errors(track(estimate), track(truth)).lost_share == 0.3

    def test_missing_joints_are_left_out_and_counted(self):
        truth = standing()
        estimate = truth + [0.01, 0, 0]
        estimate[0, 0] = np.nan
        result = joint_errors(track(estimate), track(truth))
        assert result.missing == 1
        np.testing.assert_allclose(result.mean_mm, 10.0)
        assert "1 joints missing" in result.to_table()

    def test_a_joint_never_seen_has_no_statistics(self):
        truth = standing()
        truth[:, 4] = np.nan
        joint = joint_errors(track(standing()), track(truth)).joints[4]
        assert joint.count == 0
        assert np.isnan(joint.mean_mm)


class TestSwappedLegs:
    def test_swapped_in_two_frames(self):
        truth = standing()
        estimate = truth.copy()
        exchanged = [
            JOINTS.index(mirrored(name)) if any(part in name for part in ("hip", "knee", "ankle")) else j
            for j, name in enumerate(JOINTS)
        ]
        estimate[4:6] = truth[4:6][:, exchanged]
        assert joint_errors(track(estimate), track(truth)).swapped_frames == (4, 5)

    def test_legs_that_pass_each_other_are_not_swapped(self):
        """Knees and ankles 40 mm apart: exchanging them can gain 40 mm at the most, less than the margin."""
        truth = standing()
        truth[..., 1] *= 0.1
        estimate = truth.copy()
        estimate[..., 1] *= -1
        assert joint_errors(track(estimate), track(truth)).swapped_frames == ()

    def test_one_side_alone_cannot_be_swapped(self):
        points = standing()[:, [JOINTS.index("left_knee")]]
        assert not swapped_legs(points, points, ("left_knee",)).any()


class TestDeviations:
    def test_stated_deviations_of_a_normal_error_are_calibrated(self):
        """2000 frames x 15 joints = 30000 independent cases: a share p has a deviation of at most .5 / sqrt(30000) =
        .0029; 5 of them are .0145. The factor has a relative deviation of 1 / sqrt(6 x 30000) = .0024; 5 of them are
        .012."""
        truth = standing(2000)
        noise = 0.02 * np.random.default_rng(3).normal(size=truth.shape)
        fit = joint_errors(track(truth + noise, deviation=0.02), track(truth)).calibration
        np.testing.assert_allclose(fit.coverage, (0.5, 0.8, 0.95), atol=0.0145)
        np.testing.assert_allclose(fit.scale, 1.0, atol=0.012)

    def test_negative_control_an_overconfident_track_is_found_out(self):
        truth = standing(2000)
        noise = 0.02 * np.random.default_rng(3).normal(size=truth.shape)
        fit = joint_errors(track(truth + noise, deviation=0.01), track(truth)).calibration
        assert fit.coverage[2] < 0.95 - 0.0145
        np.testing.assert_allclose(fit.scale, 2.0, atol=0.024)

    def test_no_deviations_no_statement(self):
        assert joint_errors(track(standing()), track(standing())).calibration is None
        assert joint_errors(track(standing(), deviation=0.0), track(standing())).calibration is None


class TestSmoke:
    def test_the_table_names_alignment_frames_and_joints(self):
        table = joint_errors(track(standing(), deviation=0.02), track(standing(12)), "rigid").to_table()
        assert "alignment rigid" in table
        assert "partial overlap: 10 frames matched by frame (of 10 estimated and 12 true)" in table
        assert all(name in table for name in JOINTS)
        assert "uncertainty" in table

    def test_the_dictionary_is_json(self):
        text = json.dumps(joint_errors(track(standing(), deviation=0.02), track(standing())).to_dict())
        assert json.loads(text)["joints"]["left_knee"]["mean_mm"] == 0.0


class TestErrors:
    def test_root_without_a_root(self):
        points = standing()[:, :1]
        with pytest.raises(InputError, match="pelvis or both hips"):
            joint_errors(track(points, ("head_top",)), track(points, ("head_top",)), "root")

    def test_nothing_in_common(self):
        with pytest.raises(InputError, match="give an offset"):
            joint_errors(track(standing()), track(standing(), first=50))

    def test_nothing_known(self):
        with pytest.raises(InputError, match="known in both"):
            joint_errors(track(np.full((2, 15, 3), np.nan)), track(standing(2)))
