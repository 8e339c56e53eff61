"""The bodytrack layout, on a made folder and on the published one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from conftest import shared_data
from made_folders import HEIGHT, WIDTH, bodytrack_folder, look_from
from muybridge.datasets import write_job
from muybridge.datasets.bodytrack import bodytrack_recording, read_bodytrack, read_measures, read_poses
from muybridge.errors import InputError
from muybridge.io import job as jobs


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return bodytrack_folder(tmp_path / "scene")


def test_everything_of_a_rendered_scene(folder):
    whole = read_bodytrack(folder)
    recording = whole.recording
    assert recording.rig.names == ("Camera1", "Camera2") and recording.frame_count == 3
    assert recording.rig[0].size == (WIDTH, HEIGHT)
    rotation, translation = look_from(2)
    np.testing.assert_allclose(recording.rig[1].rotation, rotation, atol=1e-9)
    np.testing.assert_allclose(recording.rig[1].translation, translation, atol=1e-9)  # mm -> m
    assert recording.cameras[1].plate == folder / "plate2.bmp"
    assert recording.reference == folder / "truth_joints.csv"
    assert whole.truth_poses.shape == (3, 31)


def test_lengths_become_metres_and_angles_and_ratios_stay(folder):
    whole = read_bodytrack(folder)
    np.testing.assert_allclose(whole.measures["radii"][1], [0.005, 0.006, 7, 8])
    np.testing.assert_allclose(whole.measures["lengths"], np.arange(41, 59) / 1000)
    np.testing.assert_allclose(whole.initial_pose[2:7], [0.2, 0.1, 0.2, 0.9, 0.6])
    np.testing.assert_allclose(whole.pose_sd[3:6], [0.01, 0.02, 0.09])
    assert (whole.pose_minimum < whole.pose_maximum).all()


def test_a_folder_without_extras(tmp_path):
    whole = read_bodytrack(bodytrack_folder(tmp_path / "bare", masks=False, extras=False))
    assert whole.pose_sd is None and whole.truth_poses is None
    assert all(camera.masks is None and camera.plate is None for camera in whole.recording.cameras)


def test_the_job_is_read_back_and_its_folder_may_move(folder, tmp_path):
    text = write_job("bodytrack", folder)
    assert str(tmp_path) not in text  # every path is relative
    moved = folder.rename(tmp_path / "moved")
    job = jobs.read(moved / "JOB.toml")
    assert job.body.name == "bodytrack" and job.start.file == moved / "InitialPose.txt"
    assert job.cameras[0].masks == moved / "FG1" / "image%04d.bmp" and job.cameras[0].background is None
    assert job.reference.file == moved / "truth_joints.csv" and len(job.calibration.files) == 2


def test_without_masks_the_job_uses_the_plates(tmp_path):
    folder = bodytrack_folder(tmp_path / "scene", masks=False)
    write_job("bodytrack", folder, tmp_path / "job")
    camera = jobs.read(tmp_path / "job" / "JOB.toml").cameras[1]
    assert camera.masks is None
    assert camera.background.kind == "plate" and camera.background.file == folder / "plate2.bmp"


def remove_calibration(folder):
    (folder / "CALIB" / "Camera2.cal").unlink()


def remove_picture(folder):
    (folder / "CAM2" / "image0002.bmp").unlink()


def remove_mask(folder):
    (folder / "FG1" / "image0001.bmp").unlink()


def remove_cameras(folder):
    for n in (1, 2):
        (folder / f"CAM{n}").rename(folder / f"view{n}")


@pytest.mark.parametrize("damage, words", [
    (remove_calibration, "Camera2.cal"), (remove_picture, "CAM1 3, CAM2 2"), (remove_mask, "FG1 2"),
    (remove_cameras, "CAM1"),
])  # fmt: skip
def test_damaged_folders_are_one_line(folder, damage, words):
    damage(folder)
    with pytest.raises(InputError) as error:
        bodytrack_recording(folder)
    assert words in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize("text, words", [
    ("1 2 3", "58 numbers, got 3"), ("a b", "58 numbers"), ("nan " * 58, "finite"), ("0 " * 58, "radii above 0"),
])  # fmt: skip
def test_measures_that_are_none(tmp_path, text, words):
    (tmp_path / "shape.txt").write_text(text)
    with pytest.raises(InputError, match=words):
        read_measures(tmp_path / "shape.txt")


def test_files_that_are_not_there(tmp_path):
    with pytest.raises(InputError, match="31 numbers"):
        read_poses(tmp_path / "InitialPose.txt")
    with pytest.raises(InputError, match="a folder"):
        bodytrack_recording(tmp_path / "nowhere")


def test_the_published_folder():
    whole = read_bodytrack(shared_data("bodytrack") / "sequenceB_2")
    assert whole.recording.frame_count == 2 and len(whole.recording.rig) == 4
    assert whole.recording.rig[0].size == (640, 480)
    assert 0.3 < whole.measures["lengths"][2] < 0.5  # a thigh, metres
    outside = (whole.initial_pose < whole.pose_minimum) | (whole.initial_pose > whole.pose_maximum)
    assert outside.sum() == 14  # as its description says: the limits are to be ignored


def test_the_first_pose_of_the_published_folder_falls_on_its_masks():
    """Units, order and calibration together: the projected pelvis lies on the mask in every camera."""
    from muybridge.io.video import open_masks

    whole = read_bodytrack(shared_data("bodytrack") / "sequenceB_2")
    for camera, files in zip(whole.recording.rig, whole.recording.cameras, strict=True):
        x, y = camera.world_to_pixel(whole.initial_pose[3:6]).round().astype(int)
        mask = open_masks(files.masks).read(0)
        assert mask[y - 4 : y + 5, x - 4 : x + 5].mean() > 0.5
