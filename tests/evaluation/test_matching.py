"""Matching pairs what belongs together and says what it left out."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.evaluation.matching import match
from muybridge.io.run_folder import JointSeries


def track(frames, names=("pelvis", "left_knee"), rate=50.0, shift_s=0.0) -> JointSeries:
    frames = np.asarray(frames)
    positions = np.zeros((len(frames), len(names), 3)) + frames[:, None, None]
    return JointSeries(tuple(names), frames, frames / rate + shift_s, positions, np.full(positions.shape[:2], np.nan))


class TestMatchByFrame:
    def test_partial_overlap_is_stated(self):
        estimate, truth, overlap = match(track(range(5, 15)), track(range(10), names=("left_knee", "right_knee")))
        np.testing.assert_array_equal(estimate.frames, [5, 6, 7, 8, 9])
        np.testing.assert_array_equal(truth.frames, estimate.frames)
        assert overlap.is_partial
        assert overlap.joints == ("left_knee",)
        assert "not in the truth: pelvis" in overlap.describe()
        assert "not estimated: right_knee" in overlap.describe()

    def test_joints_come_in_the_estimate_s_order(self):
        _, truth, _ = match(track(range(3)), track(range(3), names=("left_knee", "pelvis")))
        assert truth.names == ("pelvis", "left_knee")

    def test_offset(self):
        estimate, truth, _ = match(track(range(3)), track(range(100, 103)), offset=-100)
        np.testing.assert_array_equal(truth.frames, [100, 101, 102])
        np.testing.assert_array_equal(estimate.frames, [0, 1, 2])

    def test_complete_overlap(self):
        assert not match(track(range(3)), track(range(3)))[2].is_partial


class TestMatchByTime:
    def test_different_rates(self):
        estimate, truth, overlap = match(track(range(50), rate=50.0), track(range(100), rate=100.0), by="time")
        assert overlap.frames == 50
        np.testing.assert_allclose(estimate.times, truth.times)

    def test_too_far_in_time_is_no_match(self):
        _, _, overlap = match(track(range(10)), track(range(10), shift_s=0.1), by="time")
        assert overlap.frames == 5
        with pytest.raises(InputError, match="times are"):
            match(track(range(10)), track(range(10), shift_s=9.0), by="time")

    def test_no_times(self):
        timeless = JointSeries(("pelvis",), np.arange(3), np.full(3, np.nan), np.zeros((3, 1, 3)), np.zeros((3, 1)))
        with pytest.raises(InputError, match="match by frame"):
            match(track(range(3)), timeless, by="time")


class TestErrors:
    def test_no_common_joint(self):
        with pytest.raises(InputError, match="the truth's joints are right_knee"):
            match(track(range(3)), track(range(3), names=("right_knee",)))

    def test_empty(self):
        with pytest.raises(InputError, match="empty"):
            match(track([]), track(range(3)))
