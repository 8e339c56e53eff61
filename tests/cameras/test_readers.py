"""The one door: formats told apart, folders opened, and worlds turned upright."""

from __future__ import annotations

import numpy as np
import pytest

from conftest import shared_data
from muybridge.cameras import Camera, Rig, read_rig, write_rig
from muybridge.cameras.readers import TO_Z_UP
from muybridge.cameras.rotations import rotation_from_vector
from muybridge.errors import InputError

RIG = Rig(
    tuple(
        Camera(name, (640, 480), [[600, 0, 320], [0, 600, 240], [0, 0, 1]], np.zeros(5), rotation_from_vector(
            np.array([1.0, 0.2, 0.3])), (0, 0.5, 3))
        for name in ("a", "b")
    )
)  # fmt: skip


@pytest.fixture
def rig_file(tmp_path):
    write_rig(tmp_path / "rig.json", RIG)
    return tmp_path / "rig.json"


class TestFormats:
    def test_real_files(self):
        beam, office = shared_data("beam") / "calibration", shared_data("bodytrack") / "sequenceB_2" / "CALIB"
        assert len(read_rig(beam / "Calib_qualisys.toml")) == 4
        assert len(read_rig(str(beam / "Calib.qca.txt"))) == 4
        assert read_rig(office).names == ("Camera1", "Camera2", "Camera3", "Camera4")
        assert read_rig([office / "Camera3.cal", office / "Camera1.cal"]).names == ("Camera3", "Camera1")

    @pytest.mark.parametrize("source", ["Calib_qualisys.toml", "Calib.qca.txt"])
    def test_content_decides_where_the_name_does_not(self, tmp_path, source):
        path = shared_data("beam") / "calibration" / source
        (tmp_path / "calibration").write_bytes(path.read_bytes())
        assert read_rig(tmp_path / "calibration").cameras == read_rig(path).cameras

    def test_our_own(self, rig_file):
        assert read_rig(rig_file) == RIG
        assert read_rig(rig_file.parent) == RIG
        bare = rig_file.rename(rig_file.with_name("rig"))
        assert read_rig([bare]) == RIG

    def test_folders_are_read_in_counting_order(self, tmp_path):
        vector = np.array([1.0, 0.2, 0.3])
        numbers = [600, 600, 320, 240, *[0] * 6, *rotation_from_vector(vector).ravel(), 0, 0, 3000, *vector]
        for index in (10, 2, 1):
            (tmp_path / f"cam{index}.cal").write_text(" ".join(map(str, numbers)))
        assert read_rig(tmp_path).names == ("cam1", "cam2", "cam10")


class TestWorld:
    @pytest.mark.parametrize("up", TO_Z_UP)
    def test_up_becomes_z(self, rig_file, up):
        axis = np.eye(3)["xyz".index(up[-1])] * (-1 if up.startswith("-") else 1)
        np.testing.assert_array_equal(TO_Z_UP[up] @ axis, [0, 0, 1])
        assert np.linalg.det(TO_Z_UP[up]) == pytest.approx(1)
        turned = read_rig(rig_file, up=up)["a"]
        point = np.array([0.3, -0.2, 0.4])
        np.testing.assert_allclose(turned.world_to_pixel(TO_Z_UP[up] @ point), RIG["a"].world_to_pixel(point))

    def test_unknown_axis(self, rig_file):
        with pytest.raises(InputError, match="up axis"):
            read_rig(rig_file, up="w")

    def test_our_own_file_is_in_metres(self, rig_file):
        with pytest.raises(InputError, match="unit"):
            read_rig(rig_file, unit="mm")


class TestErrors:
    @pytest.mark.parametrize("name", ["no.toml", "no.yml", "no.cal", "no.json", "no.qca.txt", "no", "a\0b", "x" * 5000])
    def test_missing_file(self, tmp_path, name):
        with pytest.raises(InputError, match="calibration") as caught:
            read_rig(tmp_path / name)
        assert "\n" not in str(caught.value)

    @pytest.mark.parametrize("suffix", [".toml", ".yml", ".cal", ".json", ".qca.txt", ""])
    @pytest.mark.parametrize(
        "content", [b"", b"\x89PNG\r\n\x1a\n\0\0", b"\xff\xfe", b"hello", b"<a/>", b"[1]", b"null"]
    )
    def test_other_content(self, tmp_path, suffix, content):
        path = tmp_path / f"rig{suffix}"
        path.write_bytes(content)
        with pytest.raises(InputError, match="calibration") as caught:
            read_rig(path)
        assert "\n" not in str(caught.value)

    def test_empty_folder_and_list(self, tmp_path):
        with pytest.raises(InputError, match="files in this folder"):
            read_rig(tmp_path)
        with pytest.raises(InputError, match="at least one file"):
            read_rig([])
        with pytest.raises(InputError, match="a path or a list"):
            read_rig(5)

    def test_folder_in_a_list(self, tmp_path):
        with pytest.raises(InputError, match="calibration"):
            read_rig([tmp_path])

    def test_mixed_formats(self, rig_file):
        other = rig_file.with_name("x.cal")
        other.write_text("1")
        with pytest.raises(InputError, match="one format, got cal and json"):
            read_rig([rig_file, other])

    def test_same_camera_twice(self, rig_file):
        with pytest.raises(InputError, match="'a' twice"):
            read_rig([rig_file, rig_file])
