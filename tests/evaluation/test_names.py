"""Names of other people's files lead to ours."""

from __future__ import annotations

import pytest

from muybridge.evaluation.names import JOINTS, joint_of_marker, mirrored, root_joints


@pytest.mark.parametrize(
    ("marker", "joint"),
    [
        ("RHip", "right_hip"),
        ("LWrist", "left_wrist"),
        ("Neck", "thorax"),
        ("Head", "head_top"),
        ("MidHip", "pelvis"),
        ("Hip", "pelvis"),
        ("Left Knee", "left_knee"),
        ("right_ankle", "right_ankle"),
        ("head_top", "head_top"),
        ("Nose", None),
        ("RBigToe", None),
    ],
)
def test_markers(marker, joint):
    assert joint_of_marker(marker) == joint


def test_fifteen_joints_and_their_mirrors():
    assert len(JOINTS) == len(set(JOINTS)) == 15
    assert all(mirrored(mirrored(name)) == name and mirrored(name) in JOINTS for name in JOINTS)


def test_root():
    assert root_joints(JOINTS) == (0,)
    assert root_joints(("left_hip", "left_knee", "right_hip")) == (0, 2)
    assert root_joints(("left_hip",)) == ()
