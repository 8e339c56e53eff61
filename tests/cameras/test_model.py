"""The camera model against OpenCV, against itself backwards, and against what it must refuse."""

from __future__ import annotations

import pickle

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from muybridge.cameras import Camera, Rig
from muybridge.cameras.rotations import rotation_from_vector
from muybridge.errors import InputError

MATRIX = np.array([[1680.0, 0.5, 540.0], [0.0, 1675.0, 950.0], [0.0, 0.0, 1.0]])
DISTORTION = np.array([-0.05, 0.14, 0.0006, -0.0007, 0.01])
ROTATION = rotation_from_vector(np.array([1.7, 1.0, -0.4]))
TRANSLATION = np.array([0.3, 0.9, 2.9])
BARREL = np.array([-0.28, 0.04, 0.002, -0.001, 0.02])  # an ordinary wide lens

small = st.floats(-1, 1, allow_nan=False)


def a_camera(**changes) -> Camera:
    parts = {"name": "a", "size": (1088, 1920), "matrix": MATRIX, "distortion": DISTORTION}
    return Camera(**(parts | {"rotation": ROTATION, "translation": TRANSLATION} | changes))


def points_in_view(camera: Camera, count: int = 200) -> np.ndarray:
    rng = np.random.default_rng(5)
    pixels = rng.uniform((0, 0), camera.size, (count, 2))
    return camera.camera_to_world(camera.pixel_to_camera(pixels, rng.uniform(1, 9, count)))


@st.composite
def cameras(draw) -> Camera:
    """Any pose; lenses from a strong barrel to a strong pincushion."""
    focal = draw(st.floats(200, 4000))
    return Camera(
        name="drawn",
        size=(1920, 1080),
        matrix=[[focal, 0, 960 + 50 * draw(small)], [0, focal * (1 + 0.1 * draw(small)), 540], [0, 0, 1]],
        distortion=np.array([draw(small), draw(small), draw(small), draw(small), draw(small)])
        * (0.3, 0.1, 0.003, 0.003, 0.02),
        rotation=rotation_from_vector(np.array([draw(small), draw(small), draw(small)]) * np.pi),
        translation=np.array([draw(small), draw(small), draw(small)]) * 10,
    )


class TestProjection:
    @pytest.mark.parametrize("distortion", [np.zeros(5), DISTORTION, BARREL])
    def test_equals_opencv(self, distortion):
        # OpenCV has no skew; sums of terms below 4000 px differ by some hundred roundings of 5e-13 px.
        matrix = MATRIX * [[1, 0, 1], [1, 1, 1], [1, 1, 1]]
        camera = a_camera(matrix=matrix, distortion=distortion)
        points = points_in_view(camera)
        theirs, _ = cv2.projectPoints(points, cv2.Rodrigues(ROTATION)[0], TRANSLATION, matrix, distortion)
        np.testing.assert_allclose(camera.world_to_pixel(points), theirs[:, 0], rtol=0, atol=1e-10)

    def test_by_hand(self):
        camera = Camera("a", (100, 100), [[10, 2, 50], [0, 20, 40], [0, 0, 1]], np.zeros(5), np.eye(3), (0, 0, 1))
        # (1, 2, 3) is (1, 2, 4) before the camera: u = 10/4 + 2 * 2/4 + 50, v = 20 * 2/4 + 40
        np.testing.assert_allclose(camera.world_to_pixel([1.0, 2.0, 3.0]), [53.5, 50.0])

    def test_centre_of_projection(self):
        camera = a_camera()
        np.testing.assert_allclose(camera.world_to_camera(camera.position), 0, atol=1e-14)

    @pytest.mark.parametrize("shape", [(3,), (0, 3), (7, 3), (2, 5, 3)])
    def test_shapes(self, shape):
        camera = a_camera()
        pixels = camera.world_to_pixel(np.zeros(shape))
        assert pixels.shape == (*shape[:-1], 2)
        origins, directions = camera.pixel_to_ray(pixels)
        assert origins.shape == directions.shape == shape

    def test_behind_and_in_the_focal_plane_is_nowhere(self):
        pixels = a_camera().camera_to_pixel(np.array([[0.1, 0.1, -2.0], [0.1, 0.1, 0.0], [0.1, 0.1, 2.0]]))
        np.testing.assert_array_equal(np.isnan(pixels).any(axis=-1), [True, True, False])

    def test_no_ghost_from_beyond_the_fold(self):
        """A barrel of k1 = -0.3 folds at r^2 = 1 / 0.9; a point at 72 degrees would reappear in the picture."""
        camera = a_camera(distortion=(-0.3, 0, 0, 0, 0))
        fold = np.sqrt(1 / 0.9)
        pixels = camera.camera_to_pixel(np.array([[fold * 0.999, 0, 1], [fold * 1.001, 0, 1], [3.0, 0, 1]]))
        np.testing.assert_array_equal(np.isnan(pixels[:, 0]), [False, True, True])

    def test_input_is_left_alone(self):
        points = points_in_view(a_camera(), 5)
        before = points.copy()
        a_camera().world_to_pixel(points)
        np.testing.assert_array_equal(points, before)


class TestBackProjection:
    @given(cameras(), st.tuples(small, small), st.floats(0.05, 100))
    def test_undoes_projection(self, camera, direction, depth):
        """The inverse stops at 1e-10; where the lens still stretches by 0.1 that is 1e-9 of the depth."""
        flat = np.array(direction) * 0.6
        point = np.array([*flat, 1.0]) * depth
        pixel = camera.camera_to_pixel(point)
        np.testing.assert_allclose(camera.pixel_to_camera(pixel, depth), point, rtol=0, atol=1e-9 * depth)

    @given(cameras(), st.tuples(small, small), st.floats(0.05, 100))
    def test_rays_pass_through_their_points(self, camera, direction, depth):
        point = camera.camera_to_world(np.array([direction[0] * 0.6, direction[1] * 0.6, 1.0]) * depth)
        origin, ray = camera.pixel_to_ray(camera.world_to_pixel(point))
        assert np.linalg.norm(ray) == pytest.approx(1, abs=1e-12)
        off_ray = (point - origin) - ((point - origin) @ ray) * ray
        assert np.linalg.norm(off_ray) < 1e-8 * depth  # 1e-9 of above, and rotations about 10 m from the origin

    @given(cameras(), st.tuples(small, small, small))
    def test_world_to_camera_is_rigid(self, camera, point):
        point = np.array(point) * 50
        there = camera.world_to_camera(point)
        assert np.linalg.norm(there) == pytest.approx(np.linalg.norm(point - camera.position), abs=1e-11)
        np.testing.assert_allclose(camera.camera_to_world(there), point, atol=1e-11)

    def test_pixels_no_direction_reaches(self):
        camera = a_camera(distortion=(-0.3, 0, 0, 0, 0))  # its picture ends 0.703 focal lengths from the centre
        pixels = MATRIX[:2, 2] + np.array([[0.69 * 1680, 0], [0.72 * 1680, 0]])
        np.testing.assert_array_equal(np.isnan(camera.pixel_to_camera(pixels)[:, 0]), [False, True])

    def test_depth_is_broadcast(self):
        pixels = np.array([[500.0, 900.0], [10.0, 20.0]])
        np.testing.assert_allclose(a_camera().pixel_to_camera(pixels, 3.0)[:, 2], 3.0)
        np.testing.assert_allclose(a_camera().pixel_to_camera(pixels, [1.0, 2.0])[:, 2], [1.0, 2.0])


class TestOtherPictures:
    @given(st.floats(0.1, 4))
    def test_scaled(self, factor):
        camera = a_camera()
        points = points_in_view(camera, 20)
        expected = (camera.world_to_pixel(points) + 0.5) * factor - 0.5
        np.testing.assert_allclose(camera.scaled(factor).world_to_pixel(points), expected, atol=1e-9)

    def test_scaled_agrees_with_opencv_resize(self):
        """A dot's centre of mass in the reduced picture lies where the reduced camera says."""
        picture = np.zeros((200, 300), np.float32)
        picture[100:104, 200:204] = 1  # centre (201.5, 101.5)
        reduced = cv2.resize(picture, None, fx=0.25, fy=0.25, interpolation=cv2.INTER_AREA)
        y, x = np.argwhere(reduced > 0)[0]
        camera = Camera("a", (300, 200), [[300, 0, 201.5], [0, 300, 101.5], [0, 0, 1]], np.zeros(5), np.eye(3), [0] * 3)
        np.testing.assert_allclose(camera.scaled(0.25).world_to_pixel([0, 0, 1.0]), [x, y])
        assert camera.scaled(0.25).size == (75, 50)

    def test_shifted(self):
        camera = a_camera()
        points = points_in_view(camera, 20)
        moved = camera.shifted(3, -4).world_to_pixel(points) - camera.world_to_pixel(points)
        np.testing.assert_allclose(moved, np.broadcast_to([3.0, -4.0], moved.shape), atol=1e-9)

    def test_mapped(self):
        """u' = s u + tx, as for a recording that is stored scaled and with black bars."""
        camera = a_camera()
        points = points_in_view(camera, 20)
        stored = camera.mapped(0.99265, (0.0, 7.06), size=(1080, 1920))
        expected = camera.world_to_pixel(points) * 0.99265 + (0, 7.06)
        np.testing.assert_allclose(stored.world_to_pixel(points), expected, atol=1e-9)
        assert stored.size == (1080, 1920)
        assert camera.mapped(2.0, (0, 0)).size == camera.size

    def test_with_size_and_renamed_change_nothing_else(self):
        camera = a_camera()
        assert camera.with_size(10, 20).with_size(1088, 1920) == camera
        assert camera.with_size(10, 20).size == (10, 20)
        assert camera.renamed("b").name == "b" and camera.renamed("b").renamed("a") == camera

    @given(st.tuples(small, small, small), st.tuples(small, small, small))
    def test_in_world_moves_camera_and_points_together(self, vector, shift):
        camera, turn = a_camera(), rotation_from_vector(np.array(vector) * 3)
        points = points_in_view(camera, 10)
        moved = camera.in_world(turn, shift)
        np.testing.assert_allclose(
            moved.world_to_pixel(points @ turn.T + shift), camera.world_to_pixel(points), atol=1e-8
        )

    @pytest.mark.parametrize("factor", [0, -1, np.nan, np.inf])
    def test_impossible_scale(self, factor):
        with pytest.raises(InputError, match="scale"):
            a_camera().scaled(factor)


class TestValidation:
    @pytest.mark.parametrize(
        ("changes", "says"),
        [
            ({"name": ""}, "name"),
            ({"size": (0, 10)}, "size"),
            ({"size": (10.5, 10)}, "size"),
            ({"size": (np.inf, 10)}, "size"),
            ({"size": 10}, "size"),
            ({"matrix": np.full((3, 3), np.nan)}, "finite"),
            ({"matrix": np.eye(2)}, "shape"),
            ({"matrix": [["x"] * 3] * 3}, "numbers"),
            ({"matrix": np.diag([-1.0, 1, 1])}, "positive focal"),
            ({"matrix": np.diag([0.0, 1, 1])}, "positive focal"),
            ({"matrix": np.diag([500.0, 500, 2])}, "0 0 1"),
            ({"matrix": [[500, 0, 0], [3, 500, 0], [0, 0, 1]]}, "0 0 1"),
            ({"distortion": np.zeros(8)}, "shape"),
            ({"distortion": [np.inf, 0, 0, 0, 0]}, "finite"),
            ({"rotation": np.eye(3) * 1.001}, "orthonormal"),
            ({"rotation": np.diag([1.0, 1, -1])}, "right-handed"),
            ({"rotation": np.zeros(3)}, "shape"),
            ({"translation": [0, 0, np.nan]}, "finite"),
            ({"translation": [0, 0]}, "shape"),
        ],
    )
    def test_refuses_in_one_line(self, changes, says):
        with pytest.raises(InputError, match=says) as caught:
            a_camera(**changes)
        assert "\n" not in str(caught.value)

    def test_is_immutable(self):
        matrix = MATRIX.copy()
        camera = a_camera(matrix=matrix)
        matrix[0, 0] = 1  # the caller's array, not the camera's
        assert camera.matrix[0, 0] == 1680
        with pytest.raises(ValueError):
            camera.rotation[0, 0] = 2
        with pytest.raises(AttributeError):
            camera.size = (1, 1)

    def test_equality_hash_and_pickle(self):
        camera = a_camera()
        assert camera == a_camera() and hash(camera) == hash(a_camera())
        assert camera != camera.shifted(1, 0) and camera != "a"
        assert pickle.loads(pickle.dumps(camera)) == camera

    def test_four_coefficients(self):
        assert a_camera(distortion=DISTORTION[:4]).distortion.tolist() == [*DISTORTION[:4], 0.0]


class TestRig:
    rig = Rig((a_camera(name="left"), a_camera(name="right"), a_camera(name="top")))

    def test_is_a_collection(self):
        assert len(self.rig) == 3 and self.rig.names == ("left", "right", "top")
        assert [camera.name for camera in self.rig] == list(self.rig.names)
        assert self.rig["right"] is self.rig[1] and self.rig[-1].name == "top"

    def test_subset_keeps_the_order_asked_for(self):
        assert self.rig.subset(["top", "left"]).names == ("top", "left")

    def test_refuses(self):
        with pytest.raises(InputError, match="left, right, top, got 'bottom'"):
            self.rig["bottom"]
        with pytest.raises(InputError, match="at least one"):
            Rig(())
        with pytest.raises(InputError, match="'a' twice"):
            Rig((a_camera(), a_camera()))
        with pytest.raises(InputError, match="at least one"):
            self.rig.subset([])
