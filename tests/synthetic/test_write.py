"""What is written can be read by everything that reads such things."""

from __future__ import annotations

import shutil
import tomllib
from dataclasses import replace

import numpy as np
import pytest

from muybridge.cameras.json_format import read_json
from muybridge.cameras.model import Rig
from muybridge.errors import InputError
from muybridge.evaluation.angles import ANGLES, joint_angles
from muybridge.evaluation.names import JOINTS
from muybridge.evaluation.truth import read_truth
from muybridge.io import job as jobs
from muybridge.io.video import open_masks, open_pictures
from muybridge.synthetic.motion import Motion
from muybridge.synthetic.scene import demo_scene, render, shoot, truth
from muybridge.synthetic.scene_file import read
from muybridge.synthetic.skinning import SEGMENTS
from muybridge.synthetic.write import measures, stature, write_scene


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """A scene of four frames in two small cameras, and its folder."""
    scene = demo_scene(1)
    scene = replace(
        scene,
        rig=Rig(tuple(c.scaled(0.25) for c in scene.rig.cameras[:2])),
        person=replace(scene.person, motion=Motion(duration=4 / 30)),
    )
    folder = tmp_path_factory.mktemp("scene")
    seen: list[tuple[int, int]] = []
    job = write_scene(scene, folder, progress=lambda done, of: seen.append((done, of)))
    assert seen == [(1, 4), (2, 4), (3, 4), (4, 4)]
    return scene, folder, job


def test_truth(written):
    scene, folder, _ = written
    track = read_truth(folder)
    assert tuple(track.names) == JOINTS
    np.testing.assert_allclose(track.positions, truth(scene).joints, atol=1e-6)
    np.testing.assert_allclose(track.times, np.arange(4) / 30, atol=1e-6)


def test_truth_columns(written):
    lines = (written[1] / "truth_joints.csv").read_text().splitlines()
    assert lines[0] == "frame,time_s,joint,x_m,y_m,z_m,sd_m"
    assert (
        len(lines) == 1 + 4 * 15 and lines[1].startswith("0,0.000000,pelvis,") and float(lines[1].split(",")[-1]) == 0
    )


def test_true_angles(written):
    """Four decimals of a degree."""
    scene, folder, _ = written
    header, *rows = (folder / "truth_angles.csv").read_text().splitlines()
    assert header.split(",") == ["frame", "time_s", *(f"{name}_deg" for name in ANGLES)]
    table = np.array([[float(cell) for cell in row.split(",")] for row in rows])
    expected = np.degrees(joint_angles(truth(scene).joints, JOINTS))
    np.testing.assert_allclose(table[:, 2:], expected, atol=6e-5)
    np.testing.assert_allclose(table[:, :2], np.stack([np.arange(4), np.arange(4) / 30], axis=1), atol=1e-6)


def test_true_visibility(written):
    scene, folder, _ = written
    header, *rows = (folder / "truth_visibility.csv").read_text().splitlines()
    assert header == "frame,camera,segment,visible" and len(rows) == 4 * 2 * len(SEGMENTS)
    found = {tuple(row.split(",")[:3]): float(row.split(",")[3]) for row in rows}
    for camera, shot in zip(scene.rig.names, shoot(scene, 3, visibility=True), strict=True):
        for segment, share in zip(SEGMENTS, shot.visible, strict=True):
            assert found["3", camera, segment] == pytest.approx(share, abs=6e-5)


def test_the_scene_itself(written):
    scene, folder, _ = written
    assert read(folder / "scene.toml") == replace(scene, person=scene.person.complete())


def test_an_earlier_scene_is_replaced_whole(written, tmp_path):
    scene, folder, _ = written
    shutil.copytree(folder, tmp_path / "scene")
    (tmp_path / "scene" / "cam9.mp4").write_text("of the earlier scene")
    job = write_scene(scene, tmp_path / "scene")
    assert not (tmp_path / "scene" / "cam9.mp4").exists() and job == tmp_path / "scene" / "job.toml"
    assert [path.name for path in tmp_path.iterdir()] == ["scene"]
    assert (tmp_path / "scene" / "cam1.mp4").read_bytes() == (folder / "cam1.mp4").read_bytes()
    assert jobs.read(job).name == "scene"


def test_other_files_are_left_alone(written, tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match="a new or empty folder"):
        write_scene(written[0], tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


def test_what_is_interrupted_leaves_nothing(written, tmp_path):
    def stop(done: int, of: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_scene(written[0], tmp_path / "scene", progress=stop)
    assert not list(tmp_path.iterdir())


def test_cameras(written):
    scene, folder, _ = written
    assert tuple(read_json([folder / "calibration.json"])) == scene.rig.cameras


def test_videos(written):
    """H.264 at this quality is within a few grey values on average; the mask comes back but for its border."""
    scene, folder, _ = written
    for index, name in enumerate(scene.rig.names):
        pictures = [picture for _, _, picture in open_pictures(folder / f"{name}.mp4").frames()]
        masks = [mask for _, _, mask in open_masks(folder / f"{name}_mask.mp4").frames()]
        assert len(pictures) == len(masks) == 4
        images, truths = render(scene, 2)
        assert np.abs(pictures[2].astype(float) - images[index]).mean() < 5
        assert (masks[2] == truths[index]).mean() > 0.99
        assert open_pictures(folder / f"{name}_empty.mp4").frame_count == 30


def test_job(written):
    scene, folder, path = written
    job = jobs.read(path)
    assert path == folder / "job.toml"
    assert [camera.pictures for camera in job.cameras] == [folder / "cam1.mp4", folder / "cam2.mp4"]
    assert job.body.height_m == pytest.approx(stature(scene), abs=0.005)
    for camera in job.cameras:
        jobs.background_config(camera)


def test_measures(written):
    scene, folder, _ = written
    lengths = tomllib.loads((folder / "measures.toml").read_text())
    assert lengths == pytest.approx(measures(scene), abs=1e-4)
    assert lengths["left_thigh"] == lengths["right_thigh"] and 0.2 < lengths["left_forearm"] < 0.3
    assert 0 < stature(scene) - {"man": 1.79, "woman": 1.67}[scene.person.figure] < 0.03  # hair and soles
