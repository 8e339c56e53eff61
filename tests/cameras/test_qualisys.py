"""Qualisys files: 64ths, millimetres, and cameras that look along -z."""

from __future__ import annotations

import json

import numpy as np
import pytest

from conftest import shared_data
from muybridge.cameras.qualisys import read_qualisys
from muybridge.cameras.rotations import rotation_from_vector
from muybridge.errors import InputError

# Looks along world y from (0, -4, 1) m: camera axes x = world x, y up = world z, backwards = -y.
FILE = """<?xml version='1.0' encoding='ASCII'?>
<calibration type="regular"><cameras>
 <camera active="1" serial="c1" viewrotation="0">
  <fov_video bottom="489" left="20" right="659" top="10"/>
  <transform r11="1" r12="0" r13="0" r21="0" r22="0" r23="1" r31="0" r32="-1" r33="0" x="0" y="-4000" z="1000"/>
  <intrinsic focalLengthU="38400" focalLengthV="38400" centerPointU="21760" centerPointV="16000"
   radialDistortion1="-0.1" radialDistortion2="0.2" radialDistortion3="0.3" skew="0"
   tangentalDistortion1="0.01" tangentalDistortion2="0.02"/>
 </camera>
 <camera active="0" serial="off"/>
</cameras></calibration>"""


def cameras_in(tmp_path, text):
    path = tmp_path / "rig.qca.txt"
    path.write_text(text)
    return read_qualisys([path])


class TestValues:
    def test_by_hand(self, tmp_path):
        (camera,) = cameras_in(tmp_path, FILE)  # the inactive one is left out
        assert camera.name == "c1" and camera.size == (640, 480)
        np.testing.assert_allclose(camera.matrix, [[600, 0, 320], [0, 600, 240], [0, 0, 1]])
        np.testing.assert_allclose(camera.distortion, [-0.1, 0.2, 0.01, 0.02, 0.3])
        np.testing.assert_allclose(camera.position, [0, -4, 1])
        # A point ahead and up and to the right: depth 4, x right, y down.
        np.testing.assert_allclose(camera.world_to_camera([0.5, 0, 1.25]), [0.5, -0.25, 4], atol=1e-12)

    def test_the_right_spelling_of_tangential(self, tmp_path):
        camera = cameras_in(tmp_path, FILE.replace("tangental", "tangential"))[0]
        np.testing.assert_allclose(camera.distortion[2:4], [0.01, 0.02])

    def test_real_recording(self):
        """Agrees with the converter's output, but for the distortion, which that divided by 64."""
        folder = shared_data("beam") / "calibration"
        derived = json.loads((folder / "derived_cameras.json").read_text())
        cameras = read_qualisys([folder / "Calib.qca.txt"])
        assert [camera.name for camera in cameras] == ["cam01", "cam02", "cam03", "cam04"]
        for camera in cameras:
            other = derived[camera.name]
            assert list(camera.size) == other["size"]
            np.testing.assert_allclose(camera.matrix, other["K"], atol=1e-9)
            np.testing.assert_allclose(camera.distortion, [*other["dist"], 0], atol=1e-12)
            np.testing.assert_allclose(camera.rotation, rotation_from_vector(np.array(other["rvec"])), atol=1e-12)
            np.testing.assert_allclose(camera.translation, other["tvec_m"], atol=1e-12)


class TestErrors:
    @pytest.mark.parametrize(
        ("old", "new", "says"),
        [
            ("<calibration", "<!DOCTYPE x [<!ENTITY a 'b'>]><calibration", "DOCTYPE"),
            ("</calibration>", "", "XML"),
            ('serial="c1"', "", "serial"),
            ("<transform", "<place", "XML|transform"),
            ('focalLengthU="38400"', "", "focalLengthU"),
            ('focalLengthU="38400"', 'focalLengthU="wide"', "a number, got 'wide'"),
            ('focalLengthU="38400"', 'focalLengthU="nan"', "a number"),
            ('focalLengthU="38400"', 'focalLengthU="-1"', "positive focal"),
            ('r11="1"', 'r11="-1"', "right-handed"),
            ('r11="1"', 'r11="0.5"', "orthonormal"),
            ('right="659"', 'right="3"', "size"),
            ('type="regular"', 'type="fisheye"', "fisheye"),
            ('active="1"', 'active="0"', "<camera>"),
        ],
    )
    def test_one_line(self, tmp_path, old, new, says):
        assert old in FILE
        with pytest.raises(InputError, match=says) as caught:
            cameras_in(tmp_path, FILE.replace(old, new, 1))
        assert "\n" not in str(caught.value)

    def test_missing_element(self, tmp_path):
        with pytest.raises(InputError, match="<transform>, got fov_video, intrinsic"):
            cameras_in(tmp_path, "\n".join(line for line in FILE.splitlines() if "<transform" not in line))
