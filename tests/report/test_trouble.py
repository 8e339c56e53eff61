"""Trouble is found where it was put, and nowhere else."""

from __future__ import annotations

import numpy as np

from muybridge.evaluation import JOINTS, joint_errors
from muybridge.io.run_folder import JointSeries
from muybridge.report.trouble import find_trouble, mean_deviation


def calm(frames: int = 50, first: int = 0) -> JointSeries:
    """A still person at 50 Hz who is sure to 10 mm; joints a metre apart, so that no legs can be confused."""
    points = np.tile(np.arange(15.0)[:, None] * [1.0, 0, 0], (frames, 1, 1))
    return JointSeries(JOINTS, first + np.arange(frames), np.arange(frames) / 50, points, np.full((frames, 15), 0.01))


def spans(found):
    return [(trouble.first, trouble.last, trouble.what.split()[0]) for trouble in found]


def test_a_calm_run_has_none():
    assert find_trouble(calm(), np.full(50, 90.0), 100, joint_errors(calm(), calm())) == ()


def test_no_estimate():
    series = calm(first=100)
    series.positions[[3, 4, 9], 0] = np.nan
    assert spans(find_trouble(series)) == [(103, 104, "no"), (109, 109, "no")]


def test_a_jump_is_too_fast():
    series = calm()
    series.positions[10:, 3] += [0, 0.5, 0]  # half a metre in a 50th of a second: 25 m/s
    assert spans(find_trouble(series)) == [(10, 10, "a")]
    series.positions[10:, 3] -= [0, 0.25, 0]  # 12.5 m/s
    assert find_trouble(series) == ()


def test_unsure_frames():
    series = calm()
    series.sd[20:23] = 0.05
    assert spans(find_trouble(series)) == [(20, 22, "uncertainty")]


def test_collapse():
    sizes = np.full(50, 90.0)
    sizes[5] = 1.0
    assert spans(find_trouble(calm(), sizes, 100)) == [(5, 5, "effective")]
    assert find_trouble(calm(), sizes, None) == ()


def test_lost_against_the_truth():
    estimate = calm()
    estimate.positions[30:40] += [0, 0.25, 0]
    assert spans(find_trouble(estimate, errors=joint_errors(estimate, calm()))) == [(30, 39, "lost:")]


def test_one_frame_and_none():
    assert find_trouble(calm(1)) == ()
    assert find_trouble(calm(0)) == ()


def test_deviations_that_nobody_stated():
    series = calm()
    series.sd[:] = np.nan
    assert np.isnan(mean_deviation(series)).all()
    assert find_trouble(series) == ()
