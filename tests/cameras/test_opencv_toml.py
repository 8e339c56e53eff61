"""TOML of Pose2Sim and Anipose: the same tables with other units and lengths."""

from __future__ import annotations

import json

import numpy as np
import pytest

from conftest import shared_data
from muybridge.cameras.opencv_toml import read_opencv_toml
from muybridge.cameras.rotations import rotation_from_vector
from muybridge.errors import InputError

POSE2SIM = """
[cam_01]
name = "front"
size = [ 1088.0, 1920.0]
matrix = [ [ 1681.2, 0.0, 532.9], [ 0.0, 1681.0, 948.1], [ 0.0, 0.0, 1.0]]
distortions = [ -0.05, 0.14, 0.001, 0.002]
rotation = [ 1.6, 1.0, -0.4]
translation = [ 0.3, 0.9, 2.8]
fisheye = false

[cam_02]
size = [ 640, 480]
matrix = [ [ 600, 0, 320], [ 0, 600, 240], [ 0, 0, 1]]
distortions = [ 0.0, 0.0, 0.0, 0.0]
rotation = [ 0, 0, 0]
translation = [ 0.0, 0.0, 4]
fisheye = false

[metadata]
adjusted = false
error = 0.0
"""
ANIPOSE = """
[cam_0]
name = "A"
size = [ 640, 480,]
matrix = [ [ 600.0, 0.0, 320.0,], [ 0.0, 600.0, 240.0,], [ 0.0, 0.0, 1.0,],]
distortions = [ -0.2, 0.1, 0.0, 0.0, 0.05,]
rotation = [ 0.0, 0.0, 0.0,]
translation = [ 0.0, 0.0, 0.0,]

[cam_1]
name = "B"
size = [ 640, 480,]
matrix = [ [ 600.0, 0.0, 320.0,], [ 0.0, 600.0, 240.0,], [ 0.0, 0.0, 1.0,],]
distortions = [ -0.2, 0.1, 0.0, 0.0, 0.05,]
rotation = [ 0.0, 0.5, 0.0,]
translation = [ -1200.0, 0.0, 900.0,]

[metadata]
adjusted = true
error = 0.4
"""


def cameras_in(tmp_path, text, **settings):
    path = tmp_path / "rig.toml"
    path.write_text(text)
    return read_opencv_toml([path], **settings)


class TestValues:
    def test_pose2sim(self, tmp_path):
        front, second = cameras_in(tmp_path, POSE2SIM)
        assert (front.name, second.name) == ("front", "cam_02")  # the table's name where the camera has none
        assert front.size == (1088, 1920) and second.size == (640, 480)
        assert front.distortion.tolist() == [-0.05, 0.14, 0.001, 0.002, 0.0]
        np.testing.assert_allclose(front.rotation, rotation_from_vector(np.array([1.6, 1.0, -0.4])))
        np.testing.assert_allclose(front.translation, [0.3, 0.9, 2.8])

    def test_anipose_in_millimetres(self, tmp_path):
        first, second = cameras_in(tmp_path, ANIPOSE)
        assert first.distortion[4] == 0.05
        np.testing.assert_allclose(first.position, 0, atol=1e-15)
        np.testing.assert_allclose(second.translation, [-1.2, 0, 0.9])

    def test_a_unit_that_is_named_is_believed(self, tmp_path):
        np.testing.assert_allclose(cameras_in(tmp_path, POSE2SIM, unit="mm")[1].translation, [0, 0, 0.004])
        np.testing.assert_allclose(cameras_in(tmp_path, ANIPOSE, unit="cm")[1].translation, [-12, 0, 9])

    def test_a_unit_that_could_be_either_is_asked_for(self, tmp_path):
        doubtful = ANIPOSE.replace("-1200.0", "-120.0").replace("900.0", "90.0")
        with pytest.raises(InputError, match="say which with unit"):
            cameras_in(tmp_path, doubtful)
        assert len(cameras_in(tmp_path, doubtful, unit="mm")) == 2

    def test_real_recording(self):
        """Against the same cameras written down by another road; Pose2Sim's world is z up: all stand above 0."""
        folder = shared_data("beam") / "calibration"
        derived = json.loads((folder / "derived_cameras.json").read_text())
        for camera in read_opencv_toml([folder / "Calib_qualisys.toml"]):
            other = derived[camera.name.replace("_", "")]
            np.testing.assert_array_equal(camera.matrix, other["K"])
            np.testing.assert_allclose(camera.rotation, rotation_from_vector(np.array(other["rvec"])), atol=1e-15)
            np.testing.assert_array_equal(camera.translation, other["tvec_m"])
            assert 1.5 < camera.position[2] < 2.5


class TestErrors:
    @pytest.mark.parametrize(
        ("old", "new", "says"),
        [
            ("fisheye = false", "fisheye = true", "fisheye"),
            ("size = [ 1088.0, 1920.0]\n", "", "'size'"),
            ("size = [ 1088.0, 1920.0]", "size = [ 1088.5, 1920.0]", "whole numbers"),
            ("size = [ 1088.0, 1920.0]", "size = [ 1088.0]", "2 numbers, got 1"),
            ("size = [ 1088.0, 1920.0]", 'size = "large"', "numbers, got 'large'"),
            ("rotation = [ 1.6, 1.0, -0.4]\n", "", "'rotation'"),
            ("rotation = [ 1.6, 1.0, -0.4]", "rotation = [ 1.6, nan, -0.4]", "finite"),
            ("translation = [ 0.3, 0.9, 2.8]", "translation = [ inf, 0, 0]", "finite"),
            ("distortions = [ -0.05, 0.14, 0.001, 0.002]", "distortions = [1, 2, 3, 4, 5, 6]", "at most 5"),
            ("matrix = [ [ 1681.2,", "matrix = [ [ -1681.2,", "positive focal"),
            ("[cam_01]", "[cam_01", "TOML"),
            ("[cam_02]", "[cam_01]", "TOML"),
            ("matrix = [ [ 1681.2,", "matrix = [ [", "9 numbers|numbers"),
        ],
    )
    def test_one_line(self, tmp_path, old, new, says):
        assert old in POSE2SIM
        with pytest.raises(InputError, match=says) as caught:
            cameras_in(tmp_path, POSE2SIM.replace(old, new, 1))
        assert "\n" not in str(caught.value) and "rig.toml" in str(caught.value) or "camera" in str(caught.value)

    @pytest.mark.parametrize("text", ["", "[metadata]\nerror = 0\n", "x = 1\n"])
    def test_no_cameras(self, tmp_path, text):
        with pytest.raises(InputError, match="for each camera"):
            cameras_in(tmp_path, text)

    def test_rational_model_of_zeros_is_the_plain_one(self, tmp_path):
        text = POSE2SIM.replace("0.001, 0.002]", "0.001, 0.002, 0.0, 0.0, 0.0, 0.0]")
        assert cameras_in(tmp_path, text)[0].distortion.tolist() == [-0.05, 0.14, 0.001, 0.002, 0.0]

    def test_unknown_unit(self, tmp_path):
        with pytest.raises(InputError, match="'m', 'cm' or 'mm', got 'inch'"):
            cameras_in(tmp_path, POSE2SIM, unit="inch")
