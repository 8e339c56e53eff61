"""TRC files: what is written is read back, axes and units are turned at the rim, and bad files say what is wrong."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from conftest import shared_data
from muybridge.errors import InputError
from muybridge.io.trc import columns_to_world, guess_axes, read_trc, world_to_columns, write_trc

NAMES = ("Head", "RAnkle", "LAnkle")
POINTS = np.array([[[0.1, 0.2, 1.7], [0.0, -0.1, 0.1], [0.05, 0.1, 0.1]]] * 3) + np.arange(3)[:, None, None] * [
    0.01,
    0.02,
    0.0,
]


class TestRoundTrip:
    @pytest.mark.parametrize("units", ["m", "cm", "mm"])
    @pytest.mark.parametrize("axes", ["xyz", "yzx", "zxy"])
    def test_written_is_read(self, tmp_path, axes, units):
        write_trc(tmp_path / "m.trc", NAMES, POINTS, 50.0, axes=axes, units=units, first_frame=7)
        found = read_trc(tmp_path / "m.trc")
        assert (found.names, found.axes) == (NAMES, axes)
        np.testing.assert_allclose(found.positions, POINTS, rtol=1e-6)  # seven digits are written
        np.testing.assert_array_equal(found.frames, [7, 8, 9])
        np.testing.assert_allclose(found.times, [0.14, 0.16, 0.18])

    def test_missing_markers(self, tmp_path):
        points = POINTS.copy()
        points[1, 2] = np.nan  # the last cells of a line, which some programs cut off
        write_trc(tmp_path / "m.trc", NAMES, points, 50.0)
        text = (tmp_path / "m.trc").read_text()
        (tmp_path / "cut.trc").write_text("\n".join(line.rstrip("\t") for line in text.splitlines()))
        for name in ("m.trc", "cut.trc"):
            np.testing.assert_allclose(read_trc(tmp_path / name).positions, points, rtol=1e-6)


class TestAxes:
    @given(st.permutations("xyz").map("".join))
    def test_world_and_columns_are_inverse(self, axes):
        np.testing.assert_array_equal(columns_to_world(world_to_columns(POINTS, axes), axes), POINTS)

    def test_yzx_means_file_x_is_world_y(self):
        np.testing.assert_array_equal(columns_to_world(np.array([1.0, 2.0, 3.0]), "yzx"), [3.0, 1.0, 2.0])

    def test_a_guessed_axis_keeps_right_handed_frames_right_handed(self):
        for axes in ("xyz", "yzx", "zxy"):
            assert np.linalg.det(columns_to_world(np.eye(3), axes)) == pytest.approx(1.0)

    def test_names_that_say_nothing_mean_y_up(self):
        assert guess_axes(("A", "B"), POINTS[:, :2]) == "yzx"

    def test_given_axes_win(self, tmp_path):
        write_trc(tmp_path / "m.trc", NAMES, POINTS, 50.0, axes="yzx")
        assert read_trc(tmp_path / "m.trc", axes="xyz").axes == "xyz"


class TestErrors:
    def test_not_a_trc_file(self, tmp_path):
        (tmp_path / "m.trc").write_text("frame,x\n0,1\n")
        with pytest.raises(InputError, match="PathFileType"):
            read_trc(tmp_path / "m.trc")

    def test_absent(self, tmp_path):
        with pytest.raises(InputError, match="readable file"):
            read_trc(tmp_path / "absent.trc")

    def test_unknown_unit(self, tmp_path):
        write_trc(tmp_path / "m.trc", NAMES, POINTS, 50.0)
        text = (tmp_path / "m.trc").read_text().replace("\tm\t", "\tinch\t")
        (tmp_path / "m.trc").write_text(text)
        with pytest.raises(InputError, match="m or cm or mm"):
            read_trc(tmp_path / "m.trc")

    def test_no_number(self, tmp_path):
        write_trc(tmp_path / "m.trc", NAMES, POINTS, 50.0)
        (tmp_path / "m.trc").write_text((tmp_path / "m.trc").read_text().replace("\t1.7\t", "\tlost\t"))
        with pytest.raises(InputError, match="numbers"):
            read_trc(tmp_path / "m.trc")

    def test_no_frame_number(self, tmp_path):
        write_trc(tmp_path / "m.trc", NAMES, POINTS, 50.0)
        (tmp_path / "m.trc").write_text((tmp_path / "m.trc").read_text().replace("\n2\t", "\n\t"))
        with pytest.raises(InputError, match="frame number"):
            read_trc(tmp_path / "m.trc")

    def test_bad_axes(self):
        with pytest.raises(InputError, match="permutation"):
            columns_to_world(POINTS, "xxz")

    def test_wrong_shape(self, tmp_path):
        with pytest.raises(InputError, match="shape"):
            write_trc(tmp_path / "m.trc", NAMES, POINTS[:, :2], 50.0)


class TestRealFile:
    def test_beam_reference(self):
        """The README of the recording: 21 markers, metres, 60 Hz, columns X, Y, Z are world y, z, x."""
        found = read_trc(shared_data("beam") / "reference" / "S00_P00_T01_BalancingTrial_0-100_filt_butterworth.trc")
        assert found.axes == "yzx"
        assert found.positions.shape == (100, 21, 3)
        np.testing.assert_allclose(found.positions[0, 0], [-1.400573592601662, -0.06499776880731573, 0.901513220141693])
