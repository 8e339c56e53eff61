"""HumanEva's motion capture files: the release code's .mat, the C3D beside it, the person's measures."""

from __future__ import annotations

import numpy as np
import pytest

from made_humaneva import made_track, write_c3d, write_mat
from muybridge.datasets.humaneva_mocap import find_mocap, measure, read_mat, read_measures, read_mocap
from muybridge.errors import InputError


@pytest.fixture
def track():
    track = made_track(rows=3)
    track.positions[1, 4] = np.nan
    return track


def test_mat_is_read_back(tmp_path, track):
    write_mat(tmp_path / "Walking_1.mat", track)
    found = read_mocap(tmp_path / "Walking_1.mat")
    assert found.names == track.names
    np.testing.assert_allclose(found.positions, track.positions, atol=1e-12)
    np.testing.assert_allclose(found.times, track.times)


def test_c3d_and_mat_say_the_same(tmp_path, track):
    pytest.importorskip("ezc3d", reason="the optional package ezc3d is not installed")
    write_mat(tmp_path / "a.mat", track)
    write_c3d(tmp_path / "a.c3d", track)
    one, other = read_mocap(tmp_path / "a.mat"), read_mocap(tmp_path / "a.c3d")
    assert one.names == other.names
    np.testing.assert_allclose(one.positions, other.positions, atol=2e-7)  # a C3D has 24 bits for up to 2000 mm


def test_mat_comes_first(tmp_path, track):
    assert find_mocap(tmp_path, "a") is None
    (tmp_path / "a.c3d").touch()
    assert find_mocap(tmp_path, "a") == tmp_path / "a.c3d"
    write_mat(tmp_path / "a.mat", track)
    assert find_mocap(tmp_path, "a") == tmp_path / "a.mat"


def test_metres_stay(tmp_path, track):
    write_mat(tmp_path / "a.mat", track, units="m")
    np.testing.assert_allclose(read_mat(tmp_path / "a.mat").positions, 1000 * track.positions, atol=1e-9)
    write_mat(tmp_path / "a.mat", track, units="inch")
    with pytest.raises(InputError, match="units: expected m or cm or mm, got 'inch'"):
        read_mat(tmp_path / "a.mat")


def save(path, **content):
    from scipy.io import savemat

    savemat(path, content)


@pytest.mark.parametrize("write, words", [
    (lambda path: path.write_bytes(b"x" * 600), "a .mat file"),
    (lambda path: path.write_bytes(b""), "a .mat file"),
    (lambda path: path.write_bytes(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM" + b"\0" * 400), "version 7.3"),
    (lambda path: save(path, a=1), "no Markers"),
    (lambda path: save(path, Markers="text", ParameterGroup=1), "frames x points x 3"),
    (lambda path: save(path, Markers=np.zeros((2, 3, 3)), ParameterGroup=1), "0 labels"),
    (lambda path: None, "a .mat file"),
])  # fmt: skip
def test_files_that_are_none(tmp_path, write, words):
    write(tmp_path / "a.mat")
    with pytest.raises(InputError, match=words) as caught:
        read_mat(tmp_path / "a.mat")
    assert "\n" not in str(caught.value)


def test_a_file_cut_off_is_one_line(tmp_path, track):
    write_mat(tmp_path / "a.mat", track)
    whole = (tmp_path / "a.mat").read_bytes()
    for share in (0.2, 0.5, 0.9):
        (tmp_path / "a.mat").write_bytes(whole[: int(share * len(whole))])
        with pytest.raises(InputError) as caught:
            read_mat(tmp_path / "a.mat")
        assert "\n" not in str(caught.value)


def test_measures(tmp_path):
    path = tmp_path / "S1.mp"
    path.write_text("$LKneeWidth = 105.5\n$S1LShoulderOffset= 44\nnonsense\n")
    values = read_measures(path)
    assert values == {"LKneeWidth": 105.5, "S1LShoulderOffset": 44}
    assert measure(values, "LShoulderOffset", path) == 44
    with pytest.raises(InputError, match=r"S1.mp: expected a line \$RShoulderOffset"):
        measure(values, "RShoulderOffset", path)
    with pytest.raises(InputError, match="a Vicon .mp file"):
        read_measures(tmp_path / "S2.mp")
