"""The bodytrack body is the chain of the recording it comes from, as the scene renderer beside the checkout has it."""

from __future__ import annotations

import runpy
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from conftest import SHARED
from muybridge.body import named_body
from muybridge.body.bodytrack import POSE_ORDER, bodytrack_body, bodytrack_pose

#: The renderer's order of segments, then of joints, in our names.
SEGMENTS = (
    *("torso", "left_thigh", "left_calf", "right_thigh", "right_calf"),
    *("left_upper_arm", "left_forearm", "right_upper_arm", "right_forearm", "head"),
)
JOINTS = (
    *("pelvis", "thorax", "left_hip", "left_knee", "left_ankle", "right_hip", "right_knee", "right_ankle"),
    *("left_shoulder", "left_elbow", "left_wrist", "right_shoulder", "right_elbow", "right_wrist", "head_top"),
)


@pytest.fixture(scope="module")
def scene() -> Mapping[str, Any]:
    path = SHARED / "tools" / "office_scene.py"
    if not path.is_file():
        pytest.skip("the office scenes' renderer is not beside this checkout")
    return runpy.run_path(str(path))


def test_frames_and_joints_equal_the_renderers(scene: Mapping[str, Any]) -> None:
    """Any measures, any angles. A micrometre of the original is 1e-6 m: 1e-9 m is nothing but rounding."""
    rng = np.random.default_rng(5)
    radii = np.column_stack([rng.uniform(0.03, 0.2, (10, 2)), rng.uniform(0.5, 1.5, (10, 2))])
    lengths = rng.uniform(0.1, 0.6, 18)
    body = bodytrack_body(radii, lengths)
    rows = [body.segment_names.index(name) for name in SEGMENTS]
    columns = [body.joint_names.index(name) for name in JOINTS]
    for pose in rng.uniform(-np.pi, np.pi, (10, 31)):
        theirs = scene["segments"](
            np.r_[pose[:3], 1000 * pose[3:6], pose[6:]], radii * [1e3, 1e3, 1, 1], 1000 * lengths
        )
        ordered = sorted(theirs, key=lambda row: row[0])
        frames = body.frames(bodytrack_pose(pose))[0]
        for (_, matrix, _, _, _), row in zip(ordered, rows, strict=True):
            np.testing.assert_allclose(frames[row, :, :3], matrix[:3, :3], atol=1e-12)
            np.testing.assert_allclose(frames[row, :, 3], matrix[:3, 3] / 1000, atol=1e-9)
        joints = body.joints(bodytrack_pose(pose))[columns]
        np.testing.assert_allclose(joints, scene["joints"](theirs) / 1000, atol=1e-9)


def test_measures_become_shapes() -> None:
    rng = np.random.default_rng(6)
    radii = np.column_stack([rng.uniform(0.03, 0.2, (10, 2)), rng.uniform(0.5, 1.5, (10, 2))])
    body = bodytrack_body(radii, rng.uniform(0.1, 0.6, 18))
    for name, (base, tip, across, deep) in zip(SEGMENTS, radii, strict=True):
        half_axes = body.arrays.half_axes[body.segment_names.index(name)]
        expected = np.outer([base, tip], [across, deep])
        np.testing.assert_allclose(np.linalg.norm(half_axes, axis=-1)[:, :2], expected, rtol=1e-12)


def test_every_number_of_a_pose_is_used_once() -> None:
    body = named_body("bodytrack")
    assert set(POSE_ORDER) == set(body.dof_names) and len(POSE_ORDER) == 31
    np.testing.assert_array_equal(np.sort(bodytrack_pose(np.arange(31))), np.arange(31))
    assert bodytrack_pose(np.zeros((4, 31))).shape == (4, 31)
