"""Calibration from boards: on pictures drawn with a known lens, and on published ones."""

from __future__ import annotations

from functools import cache

import cv2
import numpy as np
import pytest

from conftest import shared_data
from muybridge.cameras import Camera
from muybridge.cameras.calibrate import (
    BoardPose,
    board_points,
    camera_from_board,
    find_corners,
    fit_lens,
    lens_from_board,
    place_on_floor,
)
from muybridge.cameras.rotations import rotation_from_vector
from muybridge.errors import InputError

INNER, SQUARE = (7, 4), 0.06
MATRIX = np.array([[700.0, 0, 330], [0, 690, 235], [0, 0, 1]])
DISTORTION = np.array([-0.2, 0.08, 0.001, -0.0005, 0.0])
SIZE = (640, 480)
TILTS = [(0.5, 0, 0), (-0.5, 0.1, 0), (0, 0.6, 0.2), (0.1, -0.6, 0), (0.4, 0.4, 1.0), (-0.3, 0.4, -0.5), (0, 0, 0.1)]


def held(index: int) -> Camera:
    """The camera, in the world of a board held 0.8 m before it, about centred and tilted in the index-th way."""
    rotation = rotation_from_vector(np.array(TILTS[index]))
    middle = np.array([3 * SQUARE, 1.5 * SQUARE, 0])
    offset = np.array([0.05 * (index % 3 - 1), 0.04 * (index % 2) - 0.02, 0.8])
    return Camera(f"view {index}", SIZE, MATRIX, DISTORTION, rotation, offset - rotation @ middle)


@cache
def lines_of_sight() -> np.ndarray:
    """(H, W, 3): through every pixel; all views share the lens."""
    return held(0).pixel_to_camera(np.stack(np.meshgrid(*map(np.arange, SIZE)), axis=-1))


def drawn(camera: Camera) -> np.ndarray:
    """A picture of the board: what each pixel's line of sight meets in the plane z = 0, edges a pixel or two wide."""
    rays = lines_of_sight() @ camera.rotation
    meets = camera.position - rays * (camera.position[2] / rays[..., 2:])
    x, y = meets[..., 0] / SQUARE, meets[..., 1] / SQUARE
    stripes = [np.clip(15 * np.sin(np.pi * along), -1, 1) for along in (x, y)]
    on_board = (x > -1) & (x < INNER[0]) & (y > -1) & (y < INNER[1])
    return np.where(on_board, 125 - 105 * stripes[0] * stripes[1], 230).astype(np.uint8)


@cache
def drawn_views() -> tuple[np.ndarray, ...]:
    return tuple(drawn(held(index)) for index in range(len(TILTS)))


def exact_views() -> list[np.ndarray]:
    points = board_points(*INNER, SQUARE)
    return [held(index).world_to_pixel(points).reshape(4, 7, 2) for index in range(len(TILTS))]


class TestCorners:
    def test_drawn_board(self):
        """Corners lie within 0.1 px: refinement reaches some hundredths on a clean picture of 9 rays a pixel."""
        for index, (picture, exact) in enumerate(zip(drawn_views(), exact_views(), strict=True)):
            corners = find_corners(picture, INNER)
            assert corners is not None and corners.shape == (4, 7, 2), f"view {index}"
            np.testing.assert_allclose(corners, exact, atol=0.1)

    def test_starts_at_the_same_square_however_the_picture_is_turned(self):
        """The drawn board has black between its first corners; half a turn of the picture must not hide that."""
        picture = drawn_views()[0]
        turned = find_corners(picture[::-1, ::-1].copy(), INNER)
        np.testing.assert_allclose((639, 479) - turned, find_corners(picture, INNER), atol=0.1)

    def test_colour_pictures(self):
        picture = drawn_views()[0]
        in_colour = find_corners(cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR), INNER)
        np.testing.assert_allclose(in_colour, find_corners(picture, INNER), atol=1e-6)

    def test_no_board(self):
        assert find_corners(np.full((120, 160), 128, np.uint8), INNER) is None

    def test_impossible_board(self):
        with pytest.raises(InputError, match="3 x 3 inner corners, got 7 x 2"):
            find_corners(np.zeros((10, 10), np.uint8), (7, 2))


class TestLens:
    def test_exact_corners_give_the_exact_lens(self):
        """Corners pass through float32, 3e-5 px at 640: thousandths of a pixel in the focal length."""
        lens = fit_lens(exact_views(), SIZE, SQUARE)
        np.testing.assert_allclose(lens.matrix, MATRIX, atol=0.01)
        np.testing.assert_allclose(lens.distortion, DISTORTION, atol=1e-3)
        assert lens.rms_px < 1e-3 and lens.size == SIZE

    def test_drawn_pictures(self):
        """Within four of its own standard deviations, and those are below 2 px."""
        lens = lens_from_board(drawn_views(), INNER, SQUARE)
        assert (lens.focal_sd_px < 2).all()
        assert (np.abs(np.diag(lens.matrix)[:2] - (700, 690)) < 4 * lens.focal_sd_px).all()
        assert np.isfinite(lens.view_errors_px).all()
        # A root mean square over all equals that over the views, which have equally many corners.
        assert lens.rms_px == pytest.approx(np.sqrt(np.mean(lens.view_errors_px**2)))

    def test_noise_is_seen_in_the_error(self):
        """Corners off by 0.3 px in x and y are 0.42 px apart, less the 50 parameters fitted to 392 numbers: 0.40."""
        rng = np.random.default_rng(3)
        views = [view + rng.normal(0, 0.3, view.shape) for view in exact_views()]
        expected = 0.3 * np.sqrt(2) * np.sqrt(1 - 50 / 392)
        spread = expected / np.sqrt(2 * (392 - 50))
        assert abs(fit_lens(views, SIZE, SQUARE).rms_px - expected) < 4 * spread

    def test_a_view_read_askew_is_left_out(self):
        views = exact_views()
        views[2] = views[2].copy()
        views[2][1, :-1] = views[2][1, 1:]  # one row is off by one corner
        lens = fit_lens(views, SIZE, SQUARE)
        assert np.isnan(lens.view_errors_px).tolist() == [False, False, True, False, False, False, False]
        np.testing.assert_allclose(lens.matrix, MATRIX, atol=0.01)

    @pytest.mark.parametrize("terms", [0, 1, 2, 3])
    def test_radial_terms(self, terms):
        distortion = fit_lens(exact_views(), SIZE, SQUARE, radial_terms=terms).distortion
        assert [bool(distortion[index]) for index in (0, 1, 4)] == [terms > 0, terms > 1, terms > 2]

    def test_errors(self):
        views = exact_views()
        with pytest.raises(InputError, match="at least 3, got 2 of 3; check the number"):
            fit_lens([*views[:2], None], SIZE, SQUARE)
        with pytest.raises(InputError, match="radial terms"):
            fit_lens(views, SIZE, SQUARE, radial_terms=4)
        with pytest.raises(InputError, match="side in metres > 0, got -1"):
            fit_lens(views, SIZE, -1)
        with pytest.raises(InputError, match="one size, got 10 x 20, 20 x 20"):
            lens_from_board([np.zeros((20, 20), np.uint8), np.zeros((20, 10), np.uint8)], INNER, SQUARE)
        with pytest.raises(InputError, match="got none"):
            lens_from_board([], INNER, SQUARE)


class TestPlace:
    floor_camera = Camera("floor", SIZE, MATRIX, DISTORTION, rotation_from_vector(np.array([2.2, 0.3, 0.2])), (0, 0, 1))

    def test_exact(self):
        """A camera above the floor is found where it is: world x along a row, z up."""
        points = board_points(*INNER, SQUARE) * (1, -1, 1)
        corners = self.floor_camera.world_to_pixel(points).reshape(4, 7, 2)
        assert self.floor_camera.position[2] > 0
        pose = place_on_floor(corners, SQUARE, MATRIX, DISTORTION)
        np.testing.assert_allclose(pose.rotation, self.floor_camera.rotation, atol=1e-6)
        np.testing.assert_allclose(pose.translation, self.floor_camera.translation, atol=1e-6)
        assert pose.rms_px < 1e-4

    def test_drawn_views(self):
        """Every view of a board is from above it, at 0.8 m; corners good to 0.1 px in squares of 50: millimetres."""
        for index, picture in enumerate(drawn_views()):
            pose = place_on_floor(find_corners(picture, INNER), SQUARE, MATRIX, DISTORTION)
            camera = Camera("a", SIZE, MATRIX, DISTORTION, pose.rotation, pose.translation)
            # The board was drawn with y down and z away; the floor's world is that turned about x.
            np.testing.assert_allclose(camera.position, held(index).position * (1, -1, -1), atol=0.01)

    def test_mirrored_corners(self):
        points = board_points(*INNER, SQUARE)
        corners = self.floor_camera.world_to_pixel(points * (1, -1, 1)).reshape(4, 7, 2)
        with pytest.raises(InputError, match="mirrored"):
            place_on_floor(corners[:, ::-1], SQUARE, MATRIX, DISTORTION)

    def test_both_halves_make_a_camera(self):
        lens = fit_lens(exact_views(), SIZE, SQUARE)
        camera = camera_from_board("hall", lens, BoardPose(np.eye(3), np.array([0, 0, 3.0]), 0.1))
        assert camera.name == "hall" and camera.size == SIZE


class TestPublished:
    def test_opencv_checkerboards(self):
        """Published: f = 535.9 px, error 0.393 px, with a refinement window that reached over neighbouring corners.

        One that does not lowers the error to half; f must stay within one percent.
        """
        paths = sorted(shared_data("checkerboards").glob("left[0-9][0-9].jpg"))
        lens = lens_from_board([cv2.imread(str(path)) for path in paths], (9, 6), 0.025)
        assert lens.rms_px < 0.393 and np.isfinite(lens.view_errors_px).sum() == 13
        np.testing.assert_allclose(np.diag(lens.matrix)[:2], 535.9, rtol=0.01)

    @pytest.mark.parametrize(
        ("camera", "focal", "rms"), [(1, 1671, 0.21), (2, 1676, 0.21), (3, 1679, 0.21), (4, 1691, 0.92)]
    )
    def test_beam(self, camera, focal, rms):
        """Within four standard deviations of the figures given, whose own are alike (cam04's 8.5 px: error 0.92 px)."""
        folder = shared_data("beam") / "calibration" / "intrinsics" / f"int_cam0{camera}_img"
        lens = lens_from_board([cv2.imread(str(path)) for path in sorted(folder.glob("*.jpg"))], (4, 7), 0.06)
        given_sd = 8.5 if camera == 4 else 2.5
        assert np.isfinite(lens.view_errors_px).sum() >= 6
        assert lens.rms_px < rms + 0.02
        assert abs(lens.matrix[0, 0] - focal) < 4 * np.hypot(given_sd, lens.focal_sd_px[0])
