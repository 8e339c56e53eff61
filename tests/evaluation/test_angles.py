"""Joint angles of a made person with known bends, whichever way the person faces.

Exactness: a few products and an arc tangent of numbers of order 1; 1e-9 rad leaves six digits of room.
"""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.evaluation.angles import ANGLES, angle_deviations, joint_angles
from muybridge.evaluation.names import JOINTS

EXACT_RAD = 1e-9
UPPER, LOWER, THIGH, SHANK = 0.3, 0.25, 0.42, 0.4
"""Bone lengths, metres."""


def swing(angle: float, length: float) -> np.ndarray:
    """A bone that hangs down at 0 and points forward (x) at a right angle."""
    return length * np.array([np.sin(angle), 0.0, -np.cos(angle)])


def person(angles: dict[str, float], yaw: float = 0.0) -> np.ndarray:
    """Joints (15, 3) of a person who faces x (turned by `yaw`), left at +y, with the given angles in radians."""
    at = {"pelvis": [0, 0, 0.9], "thorax": [0, 0, 1.4], "head_top": [0, 0, 1.8]}
    for side, y in (("left", 0.2), ("right", -0.2)):
        bends = {joint: angles.get(f"{side}_{joint}", 0.0) for joint in ("shoulder", "elbow", "hip", "knee")}
        at[f"{side}_shoulder"], at[f"{side}_hip"] = np.array([0, y, 1.4]), np.array([0, y, 0.9])
        at[f"{side}_elbow"] = at[f"{side}_shoulder"] + swing(bends["shoulder"], UPPER)
        at[f"{side}_wrist"] = at[f"{side}_elbow"] + swing(bends["shoulder"] + bends["elbow"], LOWER)
        at[f"{side}_knee"] = at[f"{side}_hip"] + swing(bends["hip"], THIGH)
        at[f"{side}_ankle"] = at[f"{side}_knee"] + swing(bends["hip"] + bends["knee"], SHANK)
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([at[name] for name in JOINTS]) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]]).T + [1.0, -2.0, 0.0]


BENT = {
    "left_shoulder": 0.5,
    "right_shoulder": -0.4,
    "left_elbow": 1.2,
    "right_elbow": 0.3,
    "left_hip": 0.6,
    "right_hip": -0.2,
    "left_knee": -0.8,
    "right_knee": -0.1,
}


class TestJointAngles:
    def test_standing_is_zero(self):
        np.testing.assert_allclose(joint_angles(person({}), JOINTS), 0.0, atol=EXACT_RAD)

    @pytest.mark.parametrize("yaw", [0.0, 1.0, -2.5])
    def test_known_bends(self, yaw):
        found = joint_angles(person(BENT, yaw), JOINTS)
        np.testing.assert_allclose(found, [BENT[name] for name in ANGLES], atol=EXACT_RAD)

    def test_many_frames_at_once(self):
        people = np.stack([person(BENT), person({})])
        np.testing.assert_allclose(joint_angles(people, JOINTS)[1], 0.0, atol=EXACT_RAD)
        assert joint_angles(people, JOINTS).shape == (2, 8)

    def test_a_missing_joint_takes_its_angles_only(self):
        points = person(BENT)
        points[JOINTS.index("left_wrist")] = np.nan
        found = dict(zip(ANGLES, joint_angles(points, JOINTS), strict=True))
        assert [name for name in ANGLES if np.isnan(found[name])] == ["left_elbow"]

    def test_a_body_without_arms(self):
        with pytest.raises(InputError, match="no left_shoulder"):
            joint_angles(np.zeros((2, 3)), ("thorax", "pelvis"))


class TestAngleDeviations:
    def test_against_drawn_joints(self):
        """4000 draws: a standard deviation is known to 1 / sqrt(8000) = 1.1 %; 5 of them are 5.6 %, and 2 % more for
        the curvature: joints of 5 mm on bones of 250 mm turn by .03 rad, whose square is .001."""
        rng, points = np.random.default_rng(2), person(BENT)
        draws = joint_angles(points + 0.005 * rng.normal(size=(4000, 15, 3)), JOINTS)
        found = angle_deviations(points[None], np.full((1, 15), 0.005), JOINTS)[0]
        near = [
            ANGLES.index(name) for name in ANGLES if name != "right_knee"
        ]  # near zero an unsigned bend is not normal
        np.testing.assert_allclose(found[near], draws.std(axis=0)[near], rtol=0.076)
        # negative control: twice the deviation is outside the bound
        double = angle_deviations(points[None], np.full((1, 15), 0.01), JOINTS)[0]
        assert np.all(np.abs(double[near] / draws.std(axis=0)[near] - 1) > 0.076)
