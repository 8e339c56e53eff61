"""The 22 numbers of HumanEva and the 25 of bodytrack."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from conftest import shared_data
from muybridge.cameras.cal import read_cal
from muybridge.cameras.rotations import rotation_from_vector
from muybridge.errors import InputError

VECTOR = np.array([-1.7, 1.3, 0.3])


def values(**changes) -> np.ndarray:
    numbers = np.concatenate(
        [[580, 583, 332, 228, 0], [-0.3, 0.1, 0.001, 0.002, 0.01], rotation_from_vector(VECTOR).ravel()]
        + [[206, -197, 4524], VECTOR]
    )
    for index, value in changes.items():
        numbers[int(index[1:])] = value
    return numbers


def written(path, numbers) -> list:
    path.write_text("\n".join(f"{number:.10f}" for number in numbers))
    return [path]


class TestValues:
    def test_by_hand(self, tmp_path):
        (camera,) = read_cal(written(tmp_path / "Camera3.cal", values()))
        assert camera.name == "Camera3" and camera.size == (640, 480)
        np.testing.assert_allclose(camera.matrix, [[580, 0, 332], [0, 583, 228], [0, 0, 1]])
        np.testing.assert_allclose(camera.distortion, [-0.3, 0.1, 0.001, 0.002, 0.01])
        np.testing.assert_allclose(camera.rotation, rotation_from_vector(VECTOR), atol=1e-9)
        np.testing.assert_allclose(camera.translation, [0.206, -0.197, 4.524])

    def test_skew_is_a_share_of_the_focal_length(self, tmp_path):
        (camera,) = read_cal(written(tmp_path / "a.cal", values(_4=0.01)))
        assert camera.matrix[0, 1] == pytest.approx(5.8)

    def test_without_the_vector(self, tmp_path):
        (whole,) = read_cal(written(tmp_path / "a.cal", values()))
        assert read_cal(written(tmp_path / "a.cal", values()[:22])) == [whole]

    def test_humaneva_projects_as_its_calibration_toolbox_does(self, tmp_path):
        """Bouguet's model written out: x' = fx (xd + skew yd) + cx, xd from k1 k2 p1 p2 k3; a file of %f numbers.

        Six decimals: R off by up to 5e-7, of 5 m at a depth of 3 m and f = 583 px: below 0.01 px.
        """
        numbers = values(_4=0.003)[:22]
        (tmp_path / "C1.cal").write_text("".join(f"{number:f} \n" for number in numbers))
        (camera,) = read_cal([tmp_path / "C1.cal"])
        points = np.random.default_rng(2).uniform((-500, -500, 0), (500, 500, 1800), (50, 3))
        seen = points @ numbers[10:19].reshape(3, 3).T + numbers[19:]
        assert (seen[:, 2] > 2800).all() and np.abs(seen).max() < 7000
        (x, y), (k1, k2, p1, p2, k3) = (seen[:, :2] / seen[:, 2:]).T, numbers[5:10]
        r2 = x * x + y * y
        radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
        xd = radial * x + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
        yd = radial * y + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
        theirs = np.stack([580 * (xd + 0.003 * yd) + 332, 583 * yd + 228], axis=-1)
        np.testing.assert_allclose(camera.world_to_pixel(points / 1000), theirs, atol=0.01)

    def test_size_may_be_given(self, tmp_path):
        path = written(tmp_path / "a.cal", values(_2=900))
        with pytest.raises(InputError, match="size = "):
            read_cal(path)
        assert read_cal(path, size=(1600, 1200))[0].size == (1600, 1200)

    def test_real_recording(self):
        """Four ceiling cameras of an office: all above the floor, and projecting as OpenCV does."""
        folder = shared_data("bodytrack") / "sequenceB_2" / "CALIB"
        paths = sorted(folder.glob("*.cal"))
        for path, camera in zip(paths, read_cal(paths), strict=True):
            assert camera.name == path.stem
            assert 2 < camera.position[2] < 3
            raw = np.loadtxt(path)
            points = np.random.default_rng(1).uniform((-500, -500, 0), (500, 500, 1800), (50, 3))
            theirs, _ = cv2.projectPoints(points, raw[22:], raw[19:22], camera.matrix, raw[5:10])
            # Vector and matrix in the file agree to 1e-9; times 6 m over 4 m at f = 584 px.
            np.testing.assert_allclose(camera.world_to_pixel(points / 1000), theirs[:, 0], atol=1e-5)


class TestErrors:
    @pytest.mark.parametrize(
        ("numbers", "says"),
        [
            (values()[:24], "22 or 25 numbers, got 24"),
            ([], "22 or 25 numbers, got 0"),
            (np.concatenate([values()[:10], rotation_from_vector(VECTOR).T.ravel(), values()[19:]]), "Rodrigues"),
            (values(_10=5), "orthonormal"),
            (values(_0=-580), "positive focal"),
            (values(_19=np.inf), "finite"),
            (values(_24=np.nan), "Rodrigues"),
        ],
    )
    def test_one_line(self, tmp_path, numbers, says):
        with pytest.raises(InputError, match=says) as caught:
            read_cal(written(tmp_path / "a.cal", numbers))
        assert "\n" not in str(caught.value)

    def test_words(self, tmp_path):
        (tmp_path / "a.cal").write_text("fx fy")
        with pytest.raises(InputError, match="numbers"):
            read_cal([tmp_path / "a.cal"])
