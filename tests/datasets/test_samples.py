"""The beam sample: fetched, checked, completed; without a network, on a small package made here."""

from __future__ import annotations

import hashlib
import subprocess
import zipfile
from dataclasses import replace

import numpy as np
import pytest

from conftest import shared_data
from made_folders import CONFIG, moving_square, qualisys_text, write_picture, write_video
from muybridge.datasets import samples
from muybridge.errors import InputError, MuybridgeError
from muybridge.io import job as jobs
from muybridge.io.image_sequence import read_image

SIZE = (480, 320)


def scene(n):
    """The empty scene: long after the square has left it."""
    return moving_square(SIZE[0] // 4 + 1, SIZE, n)[-1]


@pytest.fixture
def wheel(tmp_path, monkeypatch):
    """A package like the real one, whose person is a square, and which `samples` takes for the real one."""
    root = tmp_path / "made"
    for n in (1, 2):
        write_video(root / "videos" / f"cam{n:02d}.mp4", moving_square(12, SIZE, n))
        empty = scene(n)
        empty[180:300, 300:380] = (40, 200, 40)  # somebody else, elsewhere
        write_picture(root / "calibration" / "extrinsics" / f"cam{n:02d}_ext.png", empty)
    (root / "calibration" / "Calib.qca.txt").write_text(qualisys_text(["cam01", "cam02"], SIZE))
    (root / "Config.toml").write_text(CONFIG.format(height="'auto'", frames="'auto'"))
    path = tmp_path / "made.whl"
    with zipfile.ZipFile(path, "w") as archive:
        for file in root.rglob("*"):
            archive.write(file, samples.PACKAGE.inside + file.relative_to(root).as_posix())
        archive.writestr("Pose2Sim/other.py", "")
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    monkeypatch.setattr(samples, "PACKAGE", replace(samples.PACKAGE, sha256=digest))
    return path


def test_the_recording_is_complete_and_made_once(wheel, tmp_path):
    told = []
    recording = samples.beam(tmp_path / "kept", wheel=wheel, progress=told.append)
    assert recording.name == "beam" and recording.rig.names == ("cam01", "cam02") and recording.frame_count == 12
    assert len(told) == 3 and wheel.is_file()
    assert not (tmp_path / "kept" / "other.py").exists()
    again = samples.beam(tmp_path / "kept", progress=told.append)
    assert again == recording and len(told) == 3


def test_the_plate_is_the_empty_scene(wheel, tmp_path):
    recording = samples.beam(tmp_path / "kept", wheel=wheel)
    for n, camera in enumerate(recording.cameras, 1):
        difference = np.abs(read_image(camera.plate).astype(int) - scene(n)).max(2)
        # coded video and block edges: single pixels; the squares of video and picture differ by 100 and more
        assert np.mean(difference > 40) < 0.002


def test_the_job_folder(wheel, tmp_path, monkeypatch):
    monkeypatch.setenv("MUYBRIDGE_CACHE", str(tmp_path / "cache"))
    samples.beam(wheel=wheel)
    text = samples.write_beam_job(tmp_path / "job")
    job = jobs.read(tmp_path / "job" / "JOB.toml")
    assert job.name == "beam" and "beam" in text
    assert all(camera.background.file.is_file() for camera in job.cameras)


def test_another_file_is_refused(wheel, tmp_path):
    wheel.write_bytes(wheel.read_bytes() + b"x")
    with pytest.raises(InputError, match="sha256"):
        samples.beam(tmp_path / "kept", wheel=wheel)
    assert not (tmp_path / "kept" / "trial").exists()
    with pytest.raises(InputError, match="wheel of pose2sim"):
        samples.beam(tmp_path / "kept", wheel=tmp_path / "none.whl")


def test_an_archive_may_not_write_elsewhere(tmp_path):
    with zipfile.ZipFile(tmp_path / "bad.whl", "w") as archive:
        archive.writestr("inside/../../evil.txt", "x")
    with pytest.raises(InputError, match="inside its own folder"):
        samples.unpack(tmp_path / "bad.whl", "inside/", tmp_path / "out")
    assert not (tmp_path / "evil.txt").exists()


def test_without_a_network_it_says_so_in_one_line(tmp_path, monkeypatch):
    failed = subprocess.CompletedProcess([], 1, "", "WARNING: Retrying\nERROR: No matching distribution found for it\n")
    monkeypatch.setattr(samples.subprocess, "run", lambda *args, **kwargs: failed)
    with pytest.raises(MuybridgeError, match="No matching distribution") as error:
        samples.beam(tmp_path / "kept")
    assert "\n" not in str(error.value)


def test_the_real_folder_has_the_cameras_that_were_measured():
    """Against the cameras derived by hand: the Qualisys file and the bars give them to rounding."""
    import json

    import cv2

    folder = shared_data("beam")
    recording = samples.beam_from_folder(folder)
    derived = json.loads((folder / "calibration" / "derived_cameras.json").read_text())
    assert recording.frame_count == 100 and recording.reference is not None
    for camera in recording.rig:
        known = derived[camera.name]
        np.testing.assert_allclose(camera.rotation, cv2.Rodrigues(np.array(known["rvec"]))[0], atol=1e-9)
        np.testing.assert_allclose(camera.translation, known["tvec_m"], atol=1e-9)
        np.testing.assert_allclose(camera.distortion[:4], known["dist"], atol=1e-12)
        stored = np.vstack([known["frame_to_video"]["single"], [0, 0, 1]]) @ np.array(known["K"])
        np.testing.assert_allclose(camera.matrix, stored, atol=0.01)  # they scaled about the corner, not the centre


def test_plates_of_the_real_folder_are_fitted_to_its_videos(tmp_path):
    recording = samples.beam_from_folder(shared_data("beam"))
    fitted = samples.fitted_plates(recording, tmp_path)
    for camera, calibrated in zip(fitted.cameras, fitted.rig, strict=True):
        assert read_image(camera.plate).shape[:2] == calibrated.size[::-1]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cam01.png", "cam02.png"]
