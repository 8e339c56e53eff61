"""Pose2Sim trials: names, levels, calibration files, sizes."""

from __future__ import annotations

import numpy as np
import pytest

from made_folders import (
    HEIGHT,
    WIDTH,
    camera_toml,
    look_from,
    moving_square,
    pose2sim_folder,
    qualisys_text,
    write_picture,
    write_video,
)
from muybridge.datasets import write_job
from muybridge.datasets.pose2sim import participant_mass, pose2sim_recording, read_config
from muybridge.errors import InputError
from muybridge.io import job as jobs


def test_a_trial(tmp_path):
    folder = pose2sim_folder(tmp_path / "trial", frames="[1, 3]")
    recording = pose2sim_recording(folder)
    assert recording.rig.names == ("cam_01", "cam_02") and recording.frame_count == 4
    assert [camera.pictures.name for camera in recording.cameras] == ["cam01.mp4", "cam02.mp4"]
    assert recording.height_m == 1.72 and participant_mass(folder) == 71.5
    assert recording.frames == (1, 2)  # Pose2Sim leaves the end out
    assert recording.calibration == (folder / "calibration" / "Calib.toml",)


@pytest.mark.parametrize("height, expected", [("'auto'", None), ("[1.6, 1.8]", 1.6), ("-1", None)])
def test_heights(tmp_path, height, expected):
    assert pose2sim_recording(pose2sim_folder(tmp_path / "trial", height=height)).height_m == expected


def test_videos_go_with_their_namesakes_whatever_the_order_of_the_calibration(tmp_path):
    folder = pose2sim_folder(tmp_path / "trial", names=("cam_2", "cam_1"))
    recording = pose2sim_recording(folder)
    assert [(camera.name, camera.pictures.name) for camera in recording.cameras] == [
        ("cam_2", "cam02.mp4"), ("cam_1", "cam01.mp4"),
    ]  # fmt: skip
    np.testing.assert_allclose(recording.rig["cam_2"].rotation, look_from(1)[0], atol=1e-9)


def test_names_that_do_not_agree_go_by_order(tmp_path):
    recording = pose2sim_recording(pose2sim_folder(tmp_path / "trial", names=("left", "right")))
    assert [camera.pictures.name for camera in recording.cameras] == ["cam01.mp4", "cam02.mp4"]


def test_a_trial_takes_from_the_levels_above(tmp_path):
    session = pose2sim_folder(tmp_path / "session")
    trial = session / "participant" / "trial"
    trial.mkdir(parents=True)
    (session / "videos").rename(trial / "videos")
    (trial / "Config.toml").write_text("[project]\nparticipant_height = 1.5\n")
    recording = pose2sim_recording(trial)
    assert recording.height_m == 1.5 and participant_mass(trial) == 71.5
    assert recording.calibration[0].parent == session / "calibration"
    assert read_config(trial)["project"]["frame_rate"] == "auto"


def test_the_qualisys_file_wins_over_the_one_converted_from_it(tmp_path):
    folder = pose2sim_folder(tmp_path / "trial", names=("cam01", "cam02"))
    (folder / "calibration" / "Calib.qca.txt").write_text(qualisys_text(["cam01", "cam02"]))
    camera = pose2sim_recording(folder).rig["cam02"]
    assert camera.distortion[0] == -0.05
    rotation, translation = look_from(2)
    np.testing.assert_allclose(camera.rotation, rotation, atol=1e-6)
    np.testing.assert_allclose(camera.translation, translation, atol=1e-6)


def test_folders_of_pictures(tmp_path):
    folder = pose2sim_folder(tmp_path / "trial")
    for video in (folder / "videos").glob("*.mp4"):
        video.unlink()
    for n in (1, 2):
        for frame, picture in enumerate(moving_square(3)):
            write_picture(folder / "videos" / f"cam{n:02d}" / f"{frame:03d}.png", picture)
    write_job("pose2sim", folder)
    camera = jobs.read(folder / "JOB.toml").cameras[0]
    assert camera.pictures == folder / "videos" / "cam01" and camera.frame_rate == 60


def test_plates_are_found_and_used(tmp_path):
    folder = pose2sim_folder(tmp_path / "trial")
    for n in (1, 2):
        write_picture(folder / "plates" / f"cam{n:02d}.png", moving_square(1)[0])
    write_job("pose2sim", folder)
    job = jobs.read(folder / "JOB.toml")
    assert job.cameras[1].background.file == folder / "plates" / "cam02.png"
    assert job.body.height_m == 1.72 and job.start.pose == "auto"


def test_a_video_between_black_bars_gets_a_fitted_camera_in_the_job(tmp_path):
    """64 x 48 calibrated, 48 x 48 stored: scaled by 3/4, bars of 6 rows at top and bottom."""
    from muybridge.cameras.readers import read_rig
    from muybridge.datasets.fitting import fit_picture

    folder = pose2sim_folder(tmp_path / "trial")
    write_video(folder / "videos" / "cam02.mp4", [fit_picture(picture, (48, 48)) for picture in moving_square(4)])
    recording = pose2sim_recording(folder)
    assert recording.calibration == () and recording.rig["cam_02"].size == (48, 48)
    write_job("pose2sim", folder, tmp_path / "job")
    rig = read_rig(jobs.read(tmp_path / "job" / "JOB.toml").calibration.file)
    assert rig["cam_02"] == recording.rig["cam_02"]
    point = np.array([0.2, 0.1, 0.9])
    before = look_from(2)[0] @ point + look_from(2)[1]
    pixel = 60 * before[:2] / before[2] + [WIDTH / 2 - 0.5, HEIGHT / 2 - 0.5]
    np.testing.assert_allclose(rig["cam_02"].world_to_pixel(point), (pixel + 0.5) * 0.75 - 0.5 + [0, 6], atol=1e-6)


def no_config(folder):
    (folder / "Config.toml").unlink()


def bad_config(folder):
    (folder / "Config.toml").write_text("[project\n")


def no_calibration(folder):
    (folder / "calibration" / "Calib.toml").unlink()


def no_videos(folder):
    for video in (folder / "videos").glob("*"):
        video.unlink()


def one_video(folder):
    (folder / "videos" / "cam02.mp4").unlink()


def other_size(folder):
    write_video(folder / "videos" / "cam02.mp4", moving_square(3, (48, 48)))


def broken_video(folder):
    (folder / "videos" / "cam02.mp4").write_bytes(b"no video")


@pytest.mark.parametrize("damage, words", [
    (no_config, "Config.toml"), (bad_config, "TOML"), (no_calibration, "calibration/"), (no_videos, "neither"),
    (one_video, "2, as many as calibrated cameras, got 1"), (other_size, "64 x 48 pixels as calibrated"),
    (broken_video, "cam02.mp4"),
])  # fmt: skip
def test_damaged_folders_are_one_line(tmp_path, damage, words):
    folder = pose2sim_folder(tmp_path / "deep" / "er" / "trial")
    damage(folder)
    with pytest.raises(InputError) as error:
        pose2sim_recording(folder)
    assert words in str(error.value) and "\n" not in str(error.value)


def test_unknown_layout(tmp_path):
    with pytest.raises(InputError, match="bodytrack or pose2sim"):
        write_job("vicon", tmp_path)


def test_calibration_for_another_number_of_cameras(tmp_path):
    folder = pose2sim_folder(tmp_path / "trial")
    with (folder / "calibration" / "Calib.toml").open("a") as file:
        file.write(camera_toml("cam_03", 3))
    with pytest.raises(InputError, match="3, as many as calibrated cameras, got 2"):
        pose2sim_recording(folder)
