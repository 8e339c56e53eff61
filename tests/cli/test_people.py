"""`muybridge people`: a folder of results, from a video and from pictures, or one line."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from made_people import Walker, empty_scene, picture_of, truth_of
from muybridge.cameras import Rig, write_rig
from muybridge.cli import app
from muybridge.io.boxes import BoxSeries
from muybridge.io.mot import write_mot
from muybridge.io.video import open_pictures
from muybridge.people.marks import Marks, write_marks
from muybridge.synthetic.rigs import looking_at

EMPTY = empty_scene()
WALKERS = [Walker((10, 150), (310, 150), 0, 29, 0), Walker((310, 200), (10, 200), 5, 34, 1)]
FRAMES = 40
OPTIONS = [
    "--set",
    "tracker.smallest=30",
    "--set",
    "tracker.counts.most=200",
    "--set",
    "moments=20",
    "--set",
    "plate_moments=20",
]


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("made") / "pictures"
    folder.mkdir()
    for frame in range(FRAMES):
        cv2.imwrite(str(folder / f"{frame:03d}.png"), picture_of(WALKERS, frame, EMPTY)[0])
    rows = truth_of(WALKERS, FRAMES)
    truth = BoxSeries(
        np.array([r[0] for r in rows]),
        np.array([r[1] for r in rows]),
        np.array([r[2] for r in rows]),
        np.ones(len(rows)),
    )
    write_mot(folder.parent / "gt.txt", truth)
    return folder


def test_a_folder_of_pictures(pictures: Path, tmp_path: Path, capfd: pytest.CaptureFixture) -> None:
    out, calibration = tmp_path / "out", tmp_path / "camera.json"
    camera = looking_at("hall", np.array([-4.0, 0.0, 3.2]), np.array([1.6, 0.0, 0.8]), focal=288.0, size=(320, 240))
    write_rig(calibration, Rig((camera,)))
    options = ["--frame-rate", "10", "--calibration", str(calibration), "--quiet", "--json", *OPTIONS]
    assert app.run(["people", str(pictures), "--out", str(out), *options]) == 0
    said, complaints = capfd.readouterr()
    record = json.loads(said)
    assert not complaints and record["frames"] == FRAMES and record["people"] == 2 and record["status"] == "done"
    assert sorted(path.name for path in out.iterdir()) == [
        "ground.csv", "map.png", "parts.csv", "paths.png", "people.mp4", "run.json", "scene.png", "tracks.txt"
    ]  # fmt: skip
    with open_pictures(out / "people.mp4") as video:
        assert video.frame_count == FRAMES and video.frame_rate == 10


def test_scores_against_a_truth(pictures: Path, tmp_path: Path, capfd: pytest.CaptureFixture) -> None:
    pytest.importorskip("trackeval", reason="the scorer trackeval is not installed")
    arguments = ["people", str(pictures), "--out", str(tmp_path), "--truth", str(pictures.parent / "gt.txt"), "--json"]
    assert app.run([*arguments, "--frame-rate", "10", "--no-overlay", *OPTIONS]) == 0
    said = capfd.readouterr().out.splitlines()
    scores = json.loads(said[-1])["scores"]
    assert scores["mota"] > 0.8 and scores["idf1"] > 0.8 and scores["switches"] == 0
    assert any("HOTA" in line for line in said) and "MOTA" in (tmp_path / "scores.txt").read_text()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["none.mp4"], "none.mp4"),
        (["PICTURES", "--set", "tracker.smalest=3"], "did you mean smallest"),
        (["PICTURES", "--truth", "none.txt"], "none.txt"),
        (["PICTURES", "--occluders", "none.png"], "none.png"),
        (["PICTURES", "--frame-rate", "-1"], "frame rate"),
        (["PICTURES", "--occluders", "SMALL"], "occluders"),
        (["PICTURES", "--marks", "none"], "none"),
        (["PICTURES", "--marks", "a", "--occluders", "SMALL"], "--occluders or --marks"),
        (["PICTURES", "--seconds", "3"], "a camera, or --live"),
        (["97"], "camera 97"),
        (["http://127.0.0.1:1/"], "127.0.0.1:1"),
    ],
)
def test_bad_input_is_one_line_and_nothing_written(
    pictures: Path, tmp_path: Path, capfd: pytest.CaptureFixture, arguments: list[str], words: str
) -> None:
    cv2.imwrite(str(tmp_path / "small.png"), np.zeros((5, 5), np.uint8))
    names = {"PICTURES": str(pictures), "SMALL": str(tmp_path / "small.png")}
    out = tmp_path / "out"
    assert app.run(["people", *(names.get(word, word) for word in arguments), "--out", str(out), *OPTIONS]) == 2
    said, line = capfd.readouterr()
    assert line.count("\n") == 1 and words in line, line
    assert not out.exists() or not list(out.iterdir())


def test_pictures_as_a_camera(pictures: Path, tmp_path: Path, capfd: pytest.CaptureFixture) -> None:
    """Two seconds are learnt from; what is marked is taken up."""
    write_marks(tmp_path / "marks", Marks(smallest=31.0), (320, 240))
    options = ["--live", "--frame-rate", "10", "--json", "--set", "learning.first_s=2", "--seconds", "3"]
    out = tmp_path / "out"
    assert app.run(["people", str(pictures), "--out", str(out), "--marks", str(tmp_path / "marks"), *options]) == 0
    record = json.loads(capfd.readouterr().out.splitlines()[-1])
    assert record["frames"] == 31 and record["stream"]["dropped"] == 0
    written = ["parts.csv", "paths.png", "run.json", "scene.png", "tracks.txt"]
    assert sorted(path.name for path in out.iterdir()) == written
    assert json.loads((out / "run.json").read_text())["settings"]["tracker"]["smallest"] == 31


def test_a_window_where_there_is_none(
    pictures: Path, tmp_path: Path, capfd: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    def headless(name: str) -> None:
        raise cv2.error("no GUI")

    monkeypatch.setattr(cv2, "namedWindow", headless)
    options = ["--live", "--frame-rate", "10", "--show", "--out", str(tmp_path)]
    assert app.run(["people", str(pictures), *options]) == 2
    line = capfd.readouterr().err
    assert "an OpenCV with windows" in line and line.count("\n") == 1
