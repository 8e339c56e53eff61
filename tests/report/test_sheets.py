"""Contact sheets show the worst frame, and the person rather than the room."""

from __future__ import annotations

import numpy as np

from muybridge.cameras.model import Camera
from muybridge.evaluation import JOINTS, joint_errors
from muybridge.io.run_folder import JointSeries
from muybridge.report.sheets import cut_out, worth_seeing

# A camera at the origin that looks along +y with z up; one metre at 5 m is 100 pixels.
CAMERA = Camera(
    name="cam01",
    size=(640, 480),
    matrix=np.array([[500.0, 0, 319.5], [0, 500.0, 239.5], [0, 0, 1]]),
    distortion=np.zeros(5),
    rotation=np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
    translation=np.zeros(3),
)


def person(x: float) -> np.ndarray:
    """Two joints 1 m apart in both directions, 5 m before the camera."""
    return np.array([[x - 0.5, 5.0, -0.5], [x + 0.5, 5.0, 0.5]])


def picture(height: int = 480, width: int = 640) -> np.ndarray:
    """The column number, in hundredths of the width, at every pixel."""
    return np.repeat(np.tile((np.arange(width) * 100 // width).astype(np.uint8), (height, 1))[..., None], 3, axis=2)


class TestCutOut:
    def test_size_and_place(self):
        """100 x 100 pixels of joints, times the margin of 1.4; the centre follows the person by 100 pixels a metre."""
        left, right = cut_out([picture()] * 2, CAMERA, np.stack([person(-1.0), person(1.0)]))
        assert left.shape == right.shape == (140, 140, 3)
        np.testing.assert_allclose([left[70, 70, 0], right[70, 70, 0]], [220 * 100 // 640, 420 * 100 // 640], atol=1)

    def test_reduced_pictures(self):
        (cut,) = cut_out([picture(240, 320)], CAMERA, person(0.0)[None])
        assert cut.shape == (70, 70, 3)

    def test_at_the_edge_it_stays_inside(self):
        (cut,) = cut_out([picture()], CAMERA, person(2.9)[None])
        assert cut.shape[0] > 0
        assert cut[0, -1, 0] == picture()[0, -1, 0]

    def test_a_person_who_fills_the_picture(self):
        (cut,) = cut_out([picture()], CAMERA, 4 * person(0.0)[None] * [1, 0.25, 1])
        assert cut.shape == (480, 640, 3)

    def test_nobody_in_view(self):
        for points in (np.full((1, 2, 3), np.nan), -person(0.0)[None]):
            assert cut_out([picture()], CAMERA, points)[0].shape == (480, 640, 3)
        assert cut_out([], CAMERA, np.zeros((0, 2, 3))) == []


class TestWorthSeeing:
    def test_even_and_with_the_worst_frame(self):
        points = np.zeros((30, 15, 3))
        frames, nothing = 100 + np.arange(30), np.full((30, 15), np.nan)
        moved = points.copy()
        moved[11] += 1.0
        errors = joint_errors(
            JointSeries(JOINTS, frames, frames / 50, moved, nothing),
            JointSeries(JOINTS, frames, frames / 50, points, nothing),
        )
        assert 11 not in worth_seeing(frames)
        shown = worth_seeing(frames, errors)
        assert 11 in shown
        assert (shown[0], shown[-1], len(shown)) == (0, 29, 8)

    def test_short_runs(self):
        assert worth_seeing(np.arange(0)) == ()
        assert worth_seeing(np.arange(1)) == (0,)
        assert worth_seeing(np.arange(3)) == (0, 1, 2)
