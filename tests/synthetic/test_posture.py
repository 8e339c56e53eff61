"""Moments between two frames."""

from __future__ import annotations

import numpy as np

from muybridge.synthetic.motion import Motion, perform
from muybridge.synthetic.posture import mesh_at, posture_at
from muybridge.synthetic.skinning import load_figure

FIGURE = load_figure("man")
FINE = perform(FIGURE, Motion(duration=1.0, rate=60.0, seed=2))
#: Every second frame of the fine track: what lies between is known.
COARSE = type(FINE)(FINE.times[::2], FINE.rotations[::2], FINE.places[::2], FINE.joints[::2])


def test_whole_frames_are_the_track() -> None:
    for frame in (0, 7, 29):
        rotations, places = posture_at(COARSE, frame)
        assert np.array_equal(rotations, COARSE.rotations[frame]) and np.array_equal(places, COARSE.places[frame])


def test_halves_are_the_frames_left_out() -> None:
    """Linear interpolation errs by h^2 / 8 times the acceleration; the fastest end, a foot, is below 60 m/s^2: 9 mm.

    Holding the last frame instead is the control: it errs by centimetres.
    """
    worst, held = 0.0, 0.0
    for frame in range(29):
        found = FIGURE.skin(*posture_at(COARSE, frame + 0.5))
        true = FIGURE.skin(FINE.rotations[2 * frame + 1], FINE.places[2 * frame + 1])
        worst = max(worst, np.linalg.norm(found - true, axis=1).max())
        late = FIGURE.skin(*posture_at(COARSE, frame))
        held = max(held, np.linalg.norm(late - true, axis=1).max())
    assert worst < 0.009 < 0.03 < held


def test_rotations_stay_rotations() -> None:
    rotations, _ = posture_at(COARSE, 3.3)
    np.testing.assert_allclose(rotations @ np.swapaxes(rotations, 1, 2), np.tile(np.eye(3), (21, 1, 1)), atol=1e-12)
    assert (np.linalg.det(rotations) > 0).all()


def test_the_motion_goes_on_at_the_ends() -> None:
    _, before = posture_at(COARSE, -0.25)
    np.testing.assert_allclose(before, 1.25 * COARSE.places[0] - 0.25 * COARSE.places[1], atol=1e-12)
    _, after = posture_at(COARSE, 29.25)
    np.testing.assert_allclose(after, 1.25 * COARSE.places[29] - 0.25 * COARSE.places[28], atol=1e-12)


def test_a_track_of_one_frame_stands_still() -> None:
    one = type(FINE)(FINE.times[:1], FINE.rotations[:1], FINE.places[:1], FINE.joints[:1])
    for frame in (-0.5, 0.0, 3.0):
        rotations, places = posture_at(one, frame)
        assert np.array_equal(rotations, one.rotations[0]) and np.array_equal(places, one.places[0])


def test_cloth_lags_behind_a_frame_of_the_clip_and_none_before_it() -> None:
    """At the first frame cloth hangs as that of somebody who stands; later it does not."""
    for frame, still in ((0, True), (10, False)):
        mesh = mesh_at(FIGURE, COARSE, frame, 0.03)
        hanging = FIGURE.mesh(*posture_at(COARSE, frame), looseness=0.03)
        assert np.array_equal(mesh.vertices, hanging.vertices) == still
