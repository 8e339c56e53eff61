"""`muybridge synth`: a folder that `track` takes, or one line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from muybridge.cli import app
from muybridge.evaluation.truth import read_truth
from muybridge.io import job as jobs
from muybridge.io.video import open_masks, open_pictures
from muybridge.segmentation.pictures import with_channels

SCENE = """
seed = 2
duration = 0.2

[[camera]]
name = "left"
position = [3.6, 0.5, 1.6]
look_at = [0, 0, 0.9]
size = [160, 120]

[[camera]]
name = "right"
position = [0.5, -3.6, 1.9]
look_at = [0, 0, 0.9]
size = [160, 120]
distortion = [-0.1, 0.05, 0, 0]
"""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    (tmp_path / "walk.toml").write_text(SCENE)
    return tmp_path / "walk.toml"


def test_a_folder_that_track_takes(scene: Path, capfd: pytest.CaptureFixture) -> None:
    out = scene.parent / "made"
    assert app.run(["synth", str(scene), "--out", str(out), "--quiet", "--json", "--seed", "5"]) == 0
    said, complaints = capfd.readouterr()
    record = json.loads(said)
    assert not complaints and record["frames"] == 6 and record["cameras"] == ["left", "right"] and record["seed"] == 5
    job = jobs.read(record["job"])
    jobs.check_settings(job)
    for camera in job.cameras:
        assert camera.background is not None and camera.background.file is not None
        assert open_pictures(camera.pictures).frame_count == 6
        assert with_channels(next(iter(open_pictures(camera.background.file).frames()))[2]).shape == (120, 160, 3)
        assert next(iter(open_masks(out / f"{camera.name}_mask.mp4").frames()))[2].any()
    assert read_truth(out).positions.shape == (6, 15, 3)


def test_the_written_scene_renders_the_same_again(scene: Path, capfd: pytest.CaptureFixture) -> None:
    first, second = scene.parent / "first", scene.parent / "second"
    assert app.run(["synth", str(scene), "--out", str(first), "--set", "sensor.quality=30"]) == 0
    assert app.run(["synth", str(first / "scene.toml"), "--out", str(second)]) == 0
    names = sorted(path.name for path in first.iterdir())
    assert names == sorted(path.name for path in second.iterdir())
    for name in names:
        if name != "job.toml":  # it has the folder's name
            assert (first / name).read_bytes() == (second / name).read_bytes(), name
    capfd.readouterr()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--set", "prest=easy"], "did you mean preset?"),
        (["--set", "camera.left.look_at=[9, 0, 1]"], "camera left: expected to see the person"),
        (["--set", "cameras=3"], "got both"),
        (["--set", "sensor.quality=99"], "quality"),
        (["--set", "person.figure=nobody"], "figure"),
        (["--seed", "-1"], "seed"),
    ],
)
def test_bad_input_is_one_line_and_nothing_written(
    scene: Path, capfd: pytest.CaptureFixture, arguments: list[str], words: str
) -> None:
    assert app.run(["synth", str(scene), "--out", str(scene.parent / "made"), *arguments]) == 2
    said, line = capfd.readouterr()
    assert not said and line.count("\n") == 1 and words in line, line
    assert [path.name for path in scene.parent.iterdir()] == ["walk.toml"]


def test_a_folder_of_something_else(scene: Path, capfd: pytest.CaptureFixture) -> None:
    """Its own folder holds the scene file, so it is not replaced."""
    assert app.run(["synth", str(scene), "--out", str(scene.parent)]) == 2
    line = capfd.readouterr().err
    assert line.count("\n") == 1 and "new or empty folder" in line and scene.exists()


def test_no_such_scene(tmp_path: Path, capfd: pytest.CaptureFixture) -> None:
    assert app.run(["synth", str(tmp_path / "none.toml"), "--out", str(tmp_path / "made")]) == 2
    assert capfd.readouterr().err.count("\n") == 1
