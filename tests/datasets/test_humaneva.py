"""A folder in HumanEva's layout, from files to a job that track accepts and a reference that evaluate reads."""

from __future__ import annotations

import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest

from made_humaneva import (
    HEIGHT,
    WIDTH,
    cal_numbers,
    empty_picture,
    humaneva_folder,
    made_track,
    number_of,
    numbered_pictures,
    write_avi,
    write_lines,
    write_mat,
)
from muybridge.cli import app
from muybridge.datasets import humaneva_frames, write_job
from muybridge.datasets.humaneva import humaneva_recording
from muybridge.datasets.humaneva_joints import Person, humaneva_joints, torso_radius
from muybridge.errors import InputError
from muybridge.evaluation import evaluate, read_truth
from muybridge.evaluation.names import JOINTS
from muybridge.io import job as jobs
from muybridge.io.run_folder import JointSeries, write_joints
from muybridge.tracking.evidence import open_eyes
from muybridge.tracking.prepare import rig_of_job


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return humaneva_folder(tmp_path_factory.mktemp("made") / "HumanEva")


@pytest.fixture
def folder(made: Path, tmp_path: Path) -> Path:
    """A copy that a test may change."""
    return shutil.copytree(made, tmp_path / "HumanEva")


def test_a_motion(folder):
    """C1's picture 4 and C2's 3 are mocap frame 7, BW1's picture 6 is frame 11, which is C2's 5: it began before C2.

    So frame 0 is C2's first picture, C1's second and BW1's second, and row 2 of the motion capture.
    """
    recording = humaneva_recording(folder)
    assert recording.name == "S1_Walking_1" and recording.height_m == 1.79
    assert [(c.name, c.frames) for c in recording.cameras] == [("C1", (1, 13)), ("C2", (0, 12))]
    assert recording.frame_count == 13 and recording.frames == (5, 12)
    assert recording.rig[0].size == (WIDTH, HEIGHT)
    numbers = cal_numbers(2)
    np.testing.assert_allclose(recording.rig["C2"].rotation.ravel(), numbers[10:19], atol=1e-6)
    np.testing.assert_allclose(recording.rig["C2"].translation, np.array(numbers[19:]) / 1000, atol=1e-9)
    truth = recording.truth
    person = Person(torso_radius(made_track(4)), (0.044, 0.046))
    expected = humaneva_joints(made_track(60), 2.0 + 2 * np.arange(13), person)
    assert truth.names == JOINTS and truth.frames.tolist() == list(range(13))
    np.testing.assert_allclose(truth.positions, expected, atol=1e-9)  # written as doubles, in millimetres
    np.testing.assert_allclose(truth.times, np.arange(13) / 60)


def test_all_cameras_number_the_frames_even_where_some_are_used(folder):
    recording = humaneva_recording(folder, cameras="BW1, C2")
    assert [(c.name, c.frames) for c in recording.cameras] == [("BW1", (1, 13)), ("C2", (0, 12))]
    (folder / "S1" / "Sync_Data" / "Walking_1_(C2).ofs").unlink()  # now C1's and BW1's second picture is the first
    assert humaneva_recording(folder, cameras="BW1").cameras[0].frames == (0, 13)


def test_the_job_is_one_that_track_accepts(folder, tmp_path):
    """Its cameras show one moment at a time, in the sizes of its calibration, and their empty scenes train."""
    write_job("humaneva", folder, tmp_path / "job", cameras="C1,C2,BW1")
    job = jobs.read(tmp_path / "job" / "JOB.toml")
    jobs.check_settings(job)
    assert job.name == "S1_Walking_1" and job.frames == (5, 12) and job.body.height_m == 1.79
    assert job.calibration.file == tmp_path / "job" / "cameras.json"
    rig = rig_of_job(job)
    with open_eyes(job, rig, (1,) * 3) as eyes:
        for frame in range(eyes.sources[0].frame_count):
            c1, c2, bw1 = (number_of(picture) for picture in eyes.read(frame))
            # Their own equations: C1's 4 is C2's 3; BW1's 6 is two pictures after these.
            assert c1 - 3 == c2 - 2 == bw1 - 5 + 2 == frame - 2
        assert all(eye.segmenter is not None for eye in eyes.eyes)
    truth = read_truth(job.reference.file)
    np.testing.assert_allclose(truth.positions, humaneva_recording(folder).truth.positions, atol=1e-6)


def test_the_command(folder, tmp_path, capfd):
    chosen = ["--subject", "S1", "--motion", "Walking_1", "--cameras", "C2,BW1"]
    assert app.run(["job", "humaneva", str(folder), *chosen, "--out", str(tmp_path / "job")]) == 0
    assert [camera.name for camera in jobs.read(tmp_path / "job" / "JOB.toml").cameras] == ["C2", "BW1"]
    capfd.readouterr()
    assert app.run(["job", "humaneva", str(folder), "--part", "train"]) == 2
    line = "muybridge: S1 Walking_1: expected pictures of 1203 frames, got 13; take another part, or see whether the "
    assert capfd.readouterr().err == line + "files are whole\n"


def test_the_background_is_the_one_of_that_day(folder):
    """The motion's pictures are 90 bright, the two empty scenes 40 and 92."""
    for camera in humaneva_recording(folder).cameras:
        assert camera.empty == folder / "Background" / f"Background_2_({camera.name}).avi"


def test_pictures_in_folders_as_in_humaneva_ii(folder, tmp_path):
    """Begin at number 7, have a background beside them, and nothing is left out at the beginning."""
    person = folder / "S1"
    for path in [*(person / "Image_Data").glob("*.avi")]:
        path.unlink()
        path.with_suffix("").mkdir()
        for number, picture in enumerate(numbered_pictures(14)):
            cv2.imwrite(str(path.with_suffix("") / f"frame{7 + number}.png"), picture)
    shutil.rmtree(folder / "Background")
    for name in ("C1", "C2"):
        background = person / "Background" / f"Background_1_({name})"
        background.mkdir(parents=True)
        for number in range(5):
            cv2.imwrite(str(background / f"{number}.png"), empty_picture(90))
    write_job("humaneva", person, tmp_path / "job")
    job = jobs.read(tmp_path / "job" / "JOB.toml")
    assert job.frames == (0, 12) and job.cameras[0].frame_rate == 60
    with open_eyes(job, rig_of_job(job), (1, 1)) as eyes:
        assert [number_of(picture) for picture in eyes.read(4)] == [5, 4]


def test_invalid_motion_capture_is_left_empty_and_evaluate_skips_it(folder, tmp_path):
    """Row 18 lacks a toe: frame 8 (rows 2, 4, ...) is not compared; the others are 20 mm off."""
    track = made_track(60)
    track.positions[18, track.names.index("LTOE")] = np.nan
    write_mat(folder / "S1" / "Mocap_Data" / "Walking_1.mat", track)
    with pytest.warns(UserWarning, match="1 of 8 frames have no valid motion capture"):
        write_job("humaneva", folder, tmp_path / "job")
    truth = read_truth(tmp_path / "job" / "reference.csv")
    assert np.flatnonzero(np.isnan(truth.positions).all(axis=(1, 2))).tolist() == [8]
    guess = np.nan_to_num(truth.positions, nan=7.0) + [0.02, 0, 0]
    write_joints(tmp_path / "joints.csv", JointSeries(JOINTS, truth.frames, truth.times, guess, truth.sd))
    errors = evaluate(tmp_path / "joints.csv", tmp_path / "job" / "reference.csv")
    assert errors.mean_mm == pytest.approx(20.0, abs=2e-3) and errors.missing == 15  # files have micrometres
    assert errors.joints[0].count == 12
    assert evaluate(tmp_path / "joints.csv", tmp_path / "job" / "reference.csv", "root").mean_mm < 2e-3


def test_without_motion_capture_there_is_no_reference(folder, tmp_path):
    (folder / "S1" / "Mocap_Data" / "Walking_1.mat").unlink()
    with pytest.warns(UserWarning, match="S1 Walking_1 has no motion capture"):
        text = write_job("humaneva", folder, tmp_path / "job")
    assert "[reference]" not in text and not (tmp_path / "job" / "reference.csv").exists()


def test_motion_capture_that_ends_early_ends_the_job_but_not_a_published_part(folder, monkeypatch):
    """A validation part of frames 6 to 8, a training part of 9 to 12, counted from 1 as published."""
    monkeypatch.setitem(humaneva_frames.HUMANEVA_I, "S1", {"Walking": (8, 12, 20)})
    assert humaneva_recording(folder, part="validate").frames == (5, 7)
    assert humaneva_recording(folder, part="train").frames == (8, 11)
    write_mat(folder / "S1" / "Mocap_Data" / "Walking_1.mat", made_track(20))  # rows 2, 4, ..., 18: frames 0 to 8
    assert humaneva_recording(folder).frames == (5, 8)
    assert humaneva_recording(folder, part="validate").frames == (5, 7)
    with pytest.raises(InputError, match="S1 Walking_1: expected motion capture of 12 frames, got 9"):
        humaneva_recording(folder, part="train")


def drop(*parts):
    def damage(folder: Path) -> None:
        path = folder.joinpath(*parts)
        shutil.rmtree(path) if path.is_dir() else path.unlink()

    return damage


def add_person(folder: Path) -> None:
    (folder / "S2" / "Image_Data").mkdir(parents=True)


def add_motion(folder: Path) -> None:
    write_avi(folder / "S1" / "Image_Data" / "Jog_1_(C1).avi", numbered_pictures(2))


def cut_mocap(folder: Path) -> None:
    write_mat(folder / "S1" / "Mocap_Data" / "Walking_1.mat", made_track(2))


def cut_video(folder: Path) -> None:
    write_avi(folder / "S1" / "Image_Data" / "Walking_1_(C2).avi", numbered_pictures(4))


def wrong_calibration(folder: Path) -> None:
    write_lines(folder / "S1" / "Calibration_Data" / "C2.cal", cal_numbers(2)[:19])


@pytest.mark.parametrize("damage, words", [
    (drop("S1", "Calibration_Data", "C2.cal"), "C2.cal: expected a file"),
    (wrong_calibration, "22 or 25 numbers, got 19"),
    (drop("S1", "Sync_Data"), r"Walking_1_\(C1\).ofs"),
    (drop("S1", "Image_Data", "Walking_1_(C2).avi"), r"Walking_1_\(C2\).avi, or a folder of pictures, got neither"),
    (drop("S1", "Image_Data"), "S1/Image_Data"), (drop("Background"), r"Background_1_\(C1\).avi"),
    (drop("S1", "Mocap_Data", "Static.mat"), "the standing trial"), (drop("S1", "Mocap_Data", "S1.mp"), "S1.mp"),
    (cut_mocap, "more than 2 frames, where the videos begin, got 2"),
    (cut_video, "pictures of 6 frames, got 4"), (add_person, "one of S1, S2, got several; choose with --subject"),
    (add_motion, "one of Jog_1, Walking_1, got several; choose with --motion"),
])  # fmt: skip
def test_damaged_folders_are_one_line(folder, tmp_path, damage, words):
    damage(folder)
    with pytest.raises(InputError, match=words) as caught:
        write_job("humaneva", folder, tmp_path / "job")
    assert "\n" not in str(caught.value) and not (tmp_path / "job").exists()


@pytest.mark.parametrize("options, words", [
    ({"subject": "S7"}, "one of S1, got 'S7'"), ({"motion": "Walking_3"}, "one of Walking_1, got 'Walking_3'"),
    ({"cameras": "C9"}, "some of C1, C2, BW1, each once, got C9"), ({"cameras": "C1,C1"}, "each once"),
    ({"cameras": ","}, "got none"), ({"part": "test"}, "train or validate"),
    ({"part": "train"}, "pictures of 1203 frames, got 13"),
])  # fmt: skip
def test_choices_that_there_are_not(folder, tmp_path, options, words):
    with pytest.raises(InputError, match=words) as caught:
        write_job("humaneva", folder, tmp_path / "job", **options)
    assert "\n" not in str(caught.value) and not (tmp_path / "job").exists()


def test_other_layouts_have_nothing_to_choose(tmp_path):
    with pytest.raises(InputError, match="layout pose2sim: expected nothing to choose, got --motion"):
        write_job("pose2sim", tmp_path, motion="Walking_1")
