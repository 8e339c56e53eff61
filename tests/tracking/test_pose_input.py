"""A job's first pose: from a file, from a reference's joints, or left to be found."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from muybridge.body import Body, named_body
from muybridge.errors import InputError
from muybridge.io import job as jobs
from muybridge.io.run_folder import RunWriter
from muybridge.tracking.pose_input import first_pose, pose_from_joints, poses_from_joints, read_first_pose
from tracking.made import walking

JOB = {"calibration": {"file": "c.json"}, "camera": [{"name": "a", "pictures": "a.mp4"}]}


@pytest.fixture
def run_folder(tmp_path: Path) -> tuple[Path, Body, np.ndarray]:
    """A run of three frames, its body and poses (T, D)."""
    body, poses = walking(8)
    poses = poses[5:]
    with RunWriter(tmp_path, body.joint_names, body.dof_names) as writer:
        for frame, pose in enumerate(poses):
            writer.write(frame, frame / 30, body.joints(pose), np.zeros(len(body.joint_names)), pose)
    return tmp_path, body, poses


class TestFile:
    def test_first_row_of_a_run(self, run_folder: tuple[Path, Body, np.ndarray]) -> None:
        folder, body, poses = run_folder
        np.testing.assert_allclose(read_first_pose(folder / "pose.csv", body), poses[0], atol=1e-6)  # decimals written

    def test_angles_by_name(self, tmp_path: Path) -> None:
        body = named_body("person")
        (tmp_path / "first.toml").write_text("root_z = 0.9\nleft_knee_flexion = 1\n")
        pose = dict(zip(body.dof_names, read_first_pose(tmp_path / "first.toml", body), strict=True))
        assert pose.pop("root_z") == 0.9 and pose.pop("left_knee_flexion") == 1.0
        assert set(pose.values()) == {0.0}

    @pytest.mark.parametrize(
        ("name", "text", "words"),
        [
            ("a.toml", "left_wing = 1", "left_wing"),
            ("a.toml", "root_z = nan", "finite"),
            ("a.toml", 'root_z = "high"', "number"),
            ("a.toml", "root_z = [1, 2]", "number"),
            ("a.toml", "root_z =", "TOML"),
            ("missing.toml", None, "TOML"),
            ("a.csv", "frame,time_s,root_z\n", "at least one row"),
            ("a.csv", "frame,time_s,root_zz\n0,0,1\n", "root_zz"),
            ("a.csv", "x,y\n0,0\n", "frame,time_s"),
            ("a.txt", "1 2 3", "pose.csv or a TOML"),
        ],
    )
    def test_errors(self, tmp_path: Path, name: str, text: str | None, words: str) -> None:
        if text is not None:
            (tmp_path / name).write_text(text)
        with pytest.raises(InputError, match=words) as error:
            read_first_pose(tmp_path / name, named_body("person"))
        assert "\n" not in str(error.value)


class TestJob:
    def test_left_to_be_found(self, tmp_path: Path) -> None:
        assert first_pose(jobs.from_table(JOB, tmp_path), named_body("person"), 0) is None

    def test_of_a_file_beside_the_job(self, run_folder: tuple[Path, Body, np.ndarray]) -> None:
        folder, body, poses = run_folder
        job = jobs.from_table(JOB | {"start": {"pose": "pose.csv"}}, folder)
        np.testing.assert_allclose(first_pose(job, body, 0), poses[0], atol=1e-6)

    @pytest.mark.parametrize(("start", "first", "row"), [({}, 1, 1), ({"frame": 2}, 0, 2)])
    def test_of_a_reference(self, run_folder, start: dict, first: int, row: int) -> None:
        """In the first frame, or in the one that the job names."""
        folder, body, poses = run_folder
        table = JOB | {"start": {"pose": "reference", **start}, "reference": {"file": "joints.csv"}}
        found = first_pose(jobs.from_table(table, folder), body, first)
        assert found is not None
        assert np.abs(body.joints(found) - body.joints(poses[row])).max() < 0.01

    def test_of_a_frame_without_reference(self, run_folder) -> None:
        table = JOB | {"start": {"pose": "reference"}, "reference": {"file": "joints.csv"}}
        with pytest.raises(InputError, match="frame 7"):
            first_pose(jobs.from_table(table, run_folder[0]), run_folder[1], 7)


class TestJoints:
    @pytest.mark.parametrize("heading", [0.0, 1.9, -2.8])
    def test_are_met(self, heading: float) -> None:
        """Joints are believed to 20 mm, angles to 1 radian round rest: what is given up for rest is a tenth of that."""
        body, poses = walking(8)
        pose = poses[7].copy()
        pose[body.dof_names.index("root_yaw")] = heading
        joints = dict(zip(body.joint_names, body.joints(pose), strict=True))
        found = pose_from_joints(body, joints)
        assert np.linalg.norm(body.joints(found) - body.joints(pose), axis=1).mean() < 0.002
        assert ((found >= body.lower) & (found <= body.upper)).all()

    def test_some_are_enough(self) -> None:
        body, poses = walking(8)
        joints = dict(zip(body.joint_names, body.joints(poses[7]), strict=True))
        for name in ("head_top", "left_wrist", "right_ankle"):
            del joints[name]
        found = body.joints(pose_from_joints(body, joints))
        known = [body.joint_names.index(name) for name in joints]
        assert np.linalg.norm(found[known] - body.joints(poses[7])[known], axis=1).mean() < 0.002

    def test_three_are_not(self) -> None:
        with pytest.raises(InputError, match="at least 4.*got 3"):
            pose_from_joints(named_body("person"), {name: np.zeros(3) for name in ("pelvis", "thorax", "head_top")})


class TestSequence:
    def test_joints_are_met(self) -> None:
        """Usual angles pull with sd of 7 degrees or more, joints of a 0.3 m limb with 4: a radian's tenth gives way by
        less than (4 / 7)^2 / (1 + (4 / 7)^2) = a quarter, 7 mm, and all joints of a limb hold it together: half."""
        body, poses = walking(8)
        joints = body.joints(poses)
        found = body.joints(poses_from_joints(body, body.joint_names, joints))
        assert np.linalg.norm(found - joints, axis=-1).mean() < 0.0035
        assert np.linalg.norm(joints[0] - joints[-1], axis=-1).mean() > 0.02, "the first pose alone would do"

    def test_no_memory(self) -> None:
        """A frame alone gives the same pose: steps end where they change less than 1e-4 radians."""
        body, poses = walking(8)
        joints = body.joints(poses)
        together = poses_from_joints(body, body.joint_names, joints)[6]
        alone = poses_from_joints(body, body.joint_names, joints[6:7])[0]
        np.testing.assert_allclose(alone, together, atol=5e-3)

    def test_missing_joints_are_left_out(self) -> None:
        body, poses = walking(8)
        joints = body.joints(poses)
        knee = body.joint_names.index("left_knee")
        joints[3:, knee] = np.nan
        names = [*body.joint_names, "tail"]
        found = poses_from_joints(body, names, np.concatenate([joints, np.zeros((8, 1, 3))], axis=1))
        others = np.delete(np.arange(len(body.joint_names)), knee)
        assert np.linalg.norm((body.joints(found) - joints)[:, others], axis=-1).mean() < 0.0035
