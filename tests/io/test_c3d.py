"""C3D files; those that ezc3d writes are read by it again, and without it there is one clear line."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.io.c3d import read_c3d


@pytest.fixture
def written(tmp_path):
    ezc3d = pytest.importorskip("ezc3d", reason="the optional package ezc3d is not installed")
    content = ezc3d.c3d()
    point = content["parameters"]["POINT"]
    point["LABELS"]["value"], point["UNITS"]["value"], point["RATE"]["value"] = ["LSHO", " C7 "], ["mm"], [120.0]
    points = np.ones((4, 2, 3))
    points[:3, 0] = [[100, 200, 300], [400, 500, 600], [700, 800, 900]]
    points[:3, 1] = [[0, 1, 5], [0, 2, np.nan], [0, 3, 7]]
    content["data"]["points"] = points
    content.write(str(tmp_path / "a.c3d"))
    return tmp_path / "a.c3d"


def test_names_metres_times_and_what_was_not_seen(written):
    track = read_c3d(written)
    assert track.names == ("LSHO", "C7")
    np.testing.assert_allclose(track.positions[:, 0], [[0.1, 0.4, 0.7], [0.2, 0.5, 0.8], [0.3, 0.6, 0.9]], rtol=1e-6)
    assert np.isnan(track.positions[:, 1]).any(axis=1).tolist() == [True, False, True]  # at the origin; not a number
    np.testing.assert_allclose(track.times, np.arange(3) / 120)


def test_axes_are_turned(written):
    np.testing.assert_allclose(read_c3d(written, "yzx").positions[0, 0], [0.7, 0.1, 0.4], rtol=1e-6)


def test_files_that_are_none(tmp_path):
    pytest.importorskip("ezc3d", reason="the optional package ezc3d is not installed")
    (tmp_path / "a.c3d").write_bytes(b"hello" * 100)
    for name, words in [("a.c3d", "points over time"), ("b.c3d", "nothing at this path")]:
        with pytest.raises(InputError, match=words) as caught:
            read_c3d(tmp_path / name)
        assert "\n" not in str(caught.value)


def test_without_the_package(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "ezc3d", None)
    with pytest.raises(InputError, match=r"the package ezc3d, got none; pip install 'muybridge\[io\]'"):
        read_c3d(tmp_path / "a.c3d")
