from __future__ import annotations

import io
import json

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.io import disk
from muybridge.io.run_folder import (
    SUMMARY_KEYS,
    JointSeries,
    RunWriter,
    fixed,
    read_joints,
    read_pose,
    read_summary,
    write_joints,
    write_summary,
)

JOINTS, POSE = ("pelvis", "left_wrist"), ("root_x", "left_elbow_flexion", "spine")
SUMMARY = dict.fromkeys(SUMMARY_KEYS) | {"status": "done", "frames": 3}


def write_run(folder, frames=5, seed=0):
    rng = np.random.default_rng(seed)
    with RunWriter(folder, JOINTS, POSE) as run:
        written = [(rng.normal(size=(2, 3)), rng.random(2), rng.normal(size=3)) for _ in range(frames)]
        for frame, values in enumerate(written):
            run.write(frame, frame / 60, *values)
    return written


def test_what_is_written_is_read_back_to_the_written_decimals(tmp_path):
    written = write_run(tmp_path / "new" / "run")
    joints, pose = read_joints(tmp_path / "new" / "run"), read_pose(tmp_path / "new" / "run" / "pose.csv")
    assert (joints.names, pose.names) == (JOINTS, POSE)
    assert joints.frames.tolist() == pose.frames.tolist() == [0, 1, 2, 3, 4]
    # Half of the last decimal that is written.
    np.testing.assert_allclose(joints.positions, [values[0] for values in written], atol=0.5001e-6)
    np.testing.assert_allclose(joints.sd, [values[1] for values in written], atol=0.5001e-6)
    np.testing.assert_allclose(pose.poses, [values[2] for values in written], atol=0.5001e-8)
    np.testing.assert_allclose(pose.times, np.arange(5) / 60, atol=0.5001e-6)


def test_headers_are_the_stated_ones(tmp_path):
    write_run(tmp_path, 1)
    assert (tmp_path / "joints.csv").read_text().splitlines()[0] == "frame,time_s,joint,x_m,y_m,z_m,sd_m"
    assert (tmp_path / "pose.csv").read_text().splitlines()[0] == "frame,time_s,root_x,left_elbow_flexion,spine"


def test_equal_results_give_equal_bytes_and_others_do_not(tmp_path):
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        write_run(tmp_path / name, seed=seed)
    for file in ("joints.csv", "pose.csv"):
        a, b, c = ((tmp_path / name / file).read_bytes() for name in "abc")
        assert a == b != c


def test_every_frame_is_readable_while_the_run_goes_on(tmp_path):
    run = RunWriter(tmp_path, JOINTS, POSE)
    assert len(read_joints(tmp_path).frames) == 0
    run.write(0, 0.0, np.zeros((2, 3)), np.zeros(2), np.zeros(3))
    assert len(read_joints(tmp_path).frames) == len(read_pose(tmp_path).frames) == 1
    run.close()


@pytest.mark.parametrize("lost", [1, 20, 60])
def test_a_cut_off_end_is_left_out(tmp_path, lost):
    write_run(tmp_path)
    for name in ("joints.csv", "pose.csv"):
        path = tmp_path / name
        path.write_bytes(path.read_bytes()[:-lost])
    assert 3 <= len(read_joints(tmp_path).frames) <= 4 and 3 <= len(read_pose(tmp_path).frames) <= 4


def test_missing_estimates_stay_missing(tmp_path):
    series = JointSeries(JOINTS, np.arange(1), np.zeros(1), np.full((1, 2, 3), np.nan), np.full((1, 2), np.inf))
    write_joints(tmp_path / "joints.csv", series)
    read = read_joints(tmp_path)
    assert np.isnan(read.positions).all() and np.isnan(read.sd).all()


def test_a_number_never_shows_a_negative_zero():
    assert [fixed(value, 2) for value in (-0.0, -0.004, -0.006, 1e7)] == ["0.00", "0.00", "-0.01", "10000000.00"]


@pytest.mark.parametrize("names", [("a,b",), ("a", "a"), ("",), ('q"',), ("line\nend",)])
def test_names_that_would_break_a_table_are_refused(tmp_path, names):
    with pytest.raises(InputError):
        RunWriter(tmp_path, names, POSE)


def test_shapes_are_checked(tmp_path):
    with RunWriter(tmp_path, JOINTS, POSE) as run, pytest.raises(InputError, match="positions"):
        run.write(0, 0.0, np.zeros((3, 3)), np.zeros(2), np.zeros(3))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "no whole line"),
        ("a,b\n", "frame,time_s,joint"),
        ("frame,time_s,joint,x_m,y_m,z_m,sd_m\n0,0,pelvis,1,2\n", "line 2"),
        ("frame,time_s,joint,x_m,y_m,z_m,sd_m\n0,0,pelvis,1,2,x,4\n", "numbers"),
        ("frame,time_s,joint,x_m,y_m,z_m,sd_m\n" + "0,0,a,1,2,3,4\n1,0,b,1,2,3,4\n", "frames mixed up"),
    ],
)
def test_foreign_tables_are_refused_in_one_line(tmp_path, text, said):
    (tmp_path / "joints.csv").write_text(text)
    with pytest.raises(InputError, match=said) as caught:
        read_joints(tmp_path)
    assert "\n" not in str(caught.value)


def test_a_missing_or_binary_table_is_refused(tmp_path):
    with pytest.raises(InputError, match="No such file"):
        read_joints(tmp_path)
    (tmp_path / "pose.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="UTF-8"):
        read_pose(tmp_path)


def test_the_summary_holds_plain_json(tmp_path):
    extra = {"seed": np.int64(7), "settings": {"a": np.arange(2), "b": float("nan"), "c": tmp_path}}
    write_summary(tmp_path, SUMMARY | extra)
    read = read_summary(tmp_path)
    assert list(read)[: len(SUMMARY_KEYS)] == list(SUMMARY_KEYS)
    assert read["seed"] == 7 and read["settings"] == {"a": [0, 1], "b": None, "c": str(tmp_path)}
    assert json.loads((tmp_path / "run.json").read_text()) == read
    assert [file.name for file in tmp_path.iterdir()] == ["run.json"]


def test_a_summary_must_be_complete_and_be_json(tmp_path):
    with pytest.raises(InputError, match="no seed"):
        write_summary(tmp_path, {key: None for key in SUMMARY_KEYS if key != "seed"})
    (tmp_path / "run.json").write_text("{")
    with pytest.raises(InputError, match="expected JSON"):
        read_summary(tmp_path)


def test_a_full_disk_is_one_line_and_leaves_the_old_summary(tmp_path, monkeypatch):
    write_summary(tmp_path, SUMMARY)

    def refuse(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(disk.os, "fsync", refuse)
    with pytest.raises(InputError, match=r"run\.json: .*No space left on device; free some space") as caught:
        write_summary(tmp_path, SUMMARY | {"status": "other"})
    assert "\n" not in str(caught.value)
    assert read_summary(tmp_path)["status"] == "done" and len(list(tmp_path.iterdir())) == 1


def test_a_full_disk_stops_the_tables_in_one_line(tmp_path):
    run = RunWriter(tmp_path, JOINTS, POSE)
    try:
        run._poses._file = io.TextIOWrapper(open("/dev/full", "wb"))
    except OSError:
        pytest.skip("this system has no /dev/full")
    with pytest.raises(InputError, match=r"pose\.csv: .*No space left"):
        run.write(0, 0.0, np.zeros((2, 3)), np.zeros(2), np.zeros(3))
    with pytest.raises(InputError):
        run.close()


def test_a_folder_that_cannot_be_made_is_one_line(tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(InputError, match="file/run"):
        RunWriter(tmp_path / "file" / "run", JOINTS, POSE)
