"""OpenCV's YAML, written by OpenCV itself."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from conftest import shared_data
from muybridge.cameras.opencv_yaml import read_opencv_yaml
from muybridge.cameras.rotations import rotation_from_vector
from muybridge.errors import InputError

MATRIX = np.array([[600.0, 0, 320], [0, 610, 240], [0, 0, 1]])
DISTORTION = np.array([-0.2, 0.1, 0.001, 0.002, 0.03])
VECTOR = np.array([0.1, -0.7, 0.4])
TRANSLATION = np.array([0.5, 1.0, 3.0])


def write(path, **entries):
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    for key, value in entries.items():
        if isinstance(value, list):
            storage.startWriteStruct(key, cv2.FILE_NODE_SEQ)
            for item in value:
                storage.write("", item)
            storage.endWriteStruct()
        else:
            storage.write(key, value)
    storage.release()
    return path


def single(path, **changes):
    entries = {
        "image_width": 640,
        "image_height": 480,
        "camera_matrix": MATRIX,
        "distortion_coefficients": DISTORTION,
        "R": rotation_from_vector(VECTOR),
        "T": TRANSLATION,
    } | changes
    return write(path, **{key: value for key, value in entries.items() if value is not None})


def check(camera):
    np.testing.assert_array_equal(camera.matrix, MATRIX)
    np.testing.assert_array_equal(camera.distortion, DISTORTION)
    np.testing.assert_allclose(camera.rotation, rotation_from_vector(VECTOR), atol=1e-15)
    np.testing.assert_array_equal(camera.translation, TRANSLATION)
    assert camera.size == (640, 480)


class TestOneFileACamera:
    def test_names_come_from_the_files(self, tmp_path):
        paths = [single(tmp_path / "left.yml"), single(tmp_path / "right.yaml", T=TRANSLATION.reshape(3, 1))]
        cameras = read_opencv_yaml(paths)
        assert [camera.name for camera in cameras] == ["left", "right"]
        for camera in cameras:
            check(camera)

    def test_names_come_from_the_folders_where_files_are_named_alike(self, tmp_path):
        for name in ("cam1", "cam2"):
            (tmp_path / name).mkdir()
        paths = [single(tmp_path / name / "calib.yml") for name in ("cam1", "cam2")]
        assert [camera.name for camera in read_opencv_yaml(paths)] == ["cam1", "cam2"]

    @pytest.mark.parametrize(
        "changes",
        [
            {"R": VECTOR},
            {"R": None, "rvec": VECTOR.reshape(3, 1)},
            {"camera_matrix": None, "K": MATRIX},
            {"distortion_coefficients": None, "dist": DISTORTION.reshape(1, 5)},
            {"T": None, "tvec": TRANSLATION},
            {"image_width": None, "image_height": None, "image_size": [640, 480]},
        ],
    )
    def test_spellings(self, tmp_path, changes):
        check(read_opencv_yaml([single(tmp_path / "a.yml", **changes)])[0])

    def test_size_may_be_given(self, tmp_path):
        path = single(tmp_path / "a.yml", image_width=None, image_height=None)
        with pytest.raises(InputError, match="size = "):
            read_opencv_yaml([path])
        assert read_opencv_yaml([path], size=(640, 480))[0].size == (640, 480)

    def test_millimetres(self, tmp_path):
        path = single(tmp_path / "a.yml", T=TRANSLATION * 1000)
        np.testing.assert_allclose(read_opencv_yaml([path])[0].translation, TRANSLATION)


class TestNames:
    def test_easymocap_pair(self, tmp_path):
        """Matrices in one file, poses in another, keys ended by a name; R is the vector, Rot the matrix."""
        lens = {f"{key}_{name}": value for name in "12" for key, value in (("K", MATRIX), ("dist", DISTORTION))}
        place = {
            f"{key}_{name}": value
            for name in "12"
            for key, value in (("R", VECTOR), ("Rot", rotation_from_vector(VECTOR)), ("T", TRANSLATION))
        }
        size = {"H_1": 480, "W_1": 640, "H_2": 480, "W_2": 640}
        paths = [
            write(tmp_path / "extri.yml", names=["1", "2"], **place),
            write(tmp_path / "intri.yml", names=["1", "2"], **lens, **size),
        ]
        cameras = read_opencv_yaml(paths)
        assert [camera.name for camera in cameras] == ["1", "2"]
        for camera in cameras:
            check(camera)

    def test_one_file(self, tmp_path):
        entries = {"K_top": MATRIX, "dist_top": DISTORTION, "rvec_top": VECTOR, "T_top": TRANSLATION}
        path = write(tmp_path / "rig.yml", names=["top"], image_width=640, image_height=480, **entries)
        check(read_opencv_yaml([path])[0])

    def test_a_camera_without_entries(self, tmp_path):
        path = write(tmp_path / "rig.yml", names=["top", "side"], K_top=MATRIX)
        with pytest.raises(InputError, match="camera top.*'Rot_top'"):
            read_opencv_yaml([path])


class TestErrors:
    @pytest.mark.parametrize(
        ("changes", "says"),
        [
            ({"R": np.eye(3) * 2}, "orthonormal"),
            ({"R": np.diag([1.0, 1, -1])}, "right-handed"),
            ({"T": np.zeros(2)}, "3 numbers, got 2"),
            ({"camera_matrix": "none"}, "numbers, got 'none'"),
            ({"camera_matrix": None}, "'camera_matrix'"),
            ({"distortion_coefficients": np.arange(8.0)}, "at most 5"),
            ({"T": np.array([0, np.nan, 0])}, "finite"),
        ],
    )
    def test_one_line(self, tmp_path, changes, says):
        with pytest.raises(InputError, match=says) as caught:
            read_opencv_yaml([single(tmp_path / "a.yml", **changes)])
        assert "\n" not in str(caught.value)

    @pytest.mark.parametrize("text", ["", "%YAML:1.0\n---\n", "%YAML:1.0\n---\nK: [1, 2\n", "%YAML:1.0\n\tx\n", "\0\0"])
    def test_broken(self, tmp_path, text):
        path = tmp_path / "a.yml"
        path.write_text(text)
        with pytest.raises(InputError, match="calibration") as caught:
            read_opencv_yaml([path])
        assert "\n" not in str(caught.value)

    def test_a_lens_alone_is_no_camera(self):
        with pytest.raises(InputError, match="'rvec'"):
            read_opencv_yaml([shared_data("checkerboards") / "left_intrinsics.yml"])
