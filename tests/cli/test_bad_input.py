"""What a person can get wrong: each gives one line on stderr that says what, and exit code 2, never a traceback."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from muybridge.cli import app
from muybridge.io.run_folder import read_joints
from muybridge.io.video_writer import VideoWriter
from muybridge.synthetic.motion import Motion
from muybridge.synthetic.rigs import ring
from muybridge.synthetic.scene import Person, Scene, render
from muybridge.synthetic.write import write_scene

SOURCES = Path(__file__).resolve().parents[2] / "src"
SIZE, RATE = (160, 120), 25.0


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A scene of ten small frames from two cameras, with its job."""
    folder = tmp_path_factory.mktemp("made") / "scene"
    write_scene(small_scene(), folder)
    return folder


@pytest.fixture
def scene(made: Path, tmp_path: Path) -> Path:
    """A copy of it that may be spoiled."""
    return Path(shutil.copytree(made, tmp_path / "scene"))


def small_scene() -> Scene:
    return Scene(ring(np.random.default_rng(3), 2, size=SIZE), Person(motion=Motion("walk", 0.4, RATE)))


def grey_video(path: Path, frames: int = 10, size: tuple[int, int] = SIZE, rate: float = RATE) -> None:
    with VideoWriter(path, rate) as video:
        for _ in range(frames):
            video.write(np.full((size[1], size[0], 3), 90, np.uint8))


def calibration(scene: Path, key: str, value: object) -> None:
    """Change one value of the first camera."""
    path = scene / "calibration.json"
    table = json.loads(path.read_text())
    table["cameras"][0][key] = value
    path.write_text(json.dumps(table))


def missing(scene: Path) -> None:
    (scene / "cam1.mp4").unlink()


def no_video(scene: Path) -> None:
    (scene / "cam1.mp4").write_text("this is no video\n" * 100)


def truncated(scene: Path) -> None:
    whole = (scene / "cam1.mp4").read_bytes()
    (scene / "cam1.mp4").write_bytes(whole[: len(whole) // 2])


def short(scene: Path) -> None:
    grey_video(scene / "cam1.mp4", frames=7)


def slow(scene: Path) -> None:
    grey_video(scene / "cam1.mp4", rate=RATE / 2)


def large(scene: Path) -> None:
    grey_video(scene / "cam1.mp4", size=(320, 240))


def empty(scene: Path) -> None:
    """Nobody is ever there."""
    for name in ("cam1", "cam2"):
        shutil.copy(scene / f"{name}_empty.mp4", scene / f"{name}.mp4")


def unnamed(scene: Path) -> None:
    calibration(scene, "name", "elsewhere")


def infinite(scene: Path) -> None:
    calibration(scene, "rotation_world_to_camera", [[float("nan"), 0, 0], [0, 1, 0], [0, 0, 1]])


def left_handed(scene: Path) -> None:
    calibration(scene, "rotation_world_to_camera", [[-1, 0, 0], [0, 1, 0], [0, 0, 1]])


def no_calibration(scene: Path) -> None:
    (scene / "calibration.json").write_text("{")


def no_reference(scene: Path) -> None:
    (scene / "truth_joints.csv").unlink()


def body(scene: Path, text: str) -> None:
    (scene / "body.toml").write_text(text)
    job = (scene / "job.toml").read_text().replace('name = "person"\n', 'file = "body.toml"\n')
    (scene / "job.toml").write_text(job)


def cycle(scene: Path) -> None:
    body(scene, 'name = "b"\n[[segment]]\nname = "a"\nparent = "c"\n[[segment]]\nname = "c"\nparent = "a"\n')


def inverted(scene: Path) -> None:
    turn = '{name = "bend", axis = "x", limits_deg = [90, -90]}'
    body(scene, f'name = "b"\n[[segment]]\nname = "a"\nrotations = [{turn}]\n')


def unknown_key(scene: Path) -> None:
    with (scene / "job.toml").open("a") as file:
        file.write("\n[filter]\nparticels = 3\n")


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (missing, "cam1.mp4"),
        (no_video, "cam1.mp4"),
        (truncated, "cam1"),
        (short, "cam1"),
        (slow, "frame rate"),
        (large, "320 x 240"),
        (empty, "cam"),
        (unnamed, "cam1"),
        (infinite, "finite numbers"),
        (left_handed, "cam"),
        (no_calibration, "calibration.json"),
        (no_reference, "truth_joints.csv"),
        (cycle, "cycle"),
        (inverted, "bend"),
        (unknown_key, "did you mean particles?"),
    ],
    ids=lambda value: getattr(value, "__name__", ""),
)
def test_one_line_and_code_2(scene: Path, capfd: pytest.CaptureFixture, spoil: object, words: str) -> None:
    spoil(scene)  # type: ignore[operator]
    out = scene.parent / "run"
    assert app.run(["track", str(scene / "job.toml"), "--out", str(out), "--no-overlay"]) == 2
    said, line = capfd.readouterr()
    assert line.count("\n") == 1 and words in line, line
    assert "results" not in said


def test_a_full_disk(scene: Path, capfd: pytest.CaptureFixture) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("this system has no /dev/full")
    (scene.parent / "run").mkdir()
    (scene.parent / "run" / "joints.csv").symlink_to("/dev/full")
    assert app.run(["track", str(scene / "job.toml"), "--out", str(scene.parent / "run"), "--no-overlay"]) == 2
    line = capfd.readouterr().err
    assert line.count("\n") == 1 and "joints.csv" in line and "space" in line.lower()


def test_a_person_who_leaves_is_code_3(scene: Path, capfd: pytest.CaptureFixture) -> None:
    """Eight frames with the person, then twenty with nobody: more than the tracker's patience, and more than half."""
    made = small_scene()
    masks = [render(made, frame)[1] for frame in range(8)]
    for index, name in enumerate(("cam1", "cam2")):
        with VideoWriter(scene / f"{name}_mask.mp4", RATE) as video:
            for frame in range(28):
                video.write(masks[frame][index] if frame < 8 else np.zeros(SIZE[::-1], bool))
    options = [f"--set=camera.{name}.masks={name}_mask.mp4" for name in ("cam1", "cam2")]
    arguments = ["track", str(scene / "job.toml"), "--out", str(scene.parent / "run"), "--no-overlay", *options]
    assert app.run(arguments) == 3
    assert "lost" in capfd.readouterr().out
    assert len(read_joints(scene.parent / "run").frames) == 28


def test_ctrl_c_keeps_what_was_finished(scene: Path) -> None:
    """Interrupted as soon as a frame is in the table: one line, code 130, and the table can be read."""
    out = scene.parent / "run"
    command = [sys.executable, "-m", "muybridge", "track", str(scene / "job.toml"), "--out", str(out)]
    # Many particles make a frame slow enough to be interrupted.
    command += ["--set", "filter.name=condensation", "--set", "filter.particles=100000"]
    environment = {**os.environ, "PYTHONPATH": str(SOURCES)}
    process = subprocess.Popen(
        command,
        env=environment,
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        # A shell's background job ignores the interrupt, and so would everything started from it.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    joints = out / "joints.csv"
    deadline = time.monotonic() + 120
    while process.poll() is None and time.monotonic() < deadline:
        if joints.exists() and joints.read_text().count("\n") > 15:
            process.send_signal(signal.SIGINT)
            break
        time.sleep(0.02)
    _, complaint = process.communicate(timeout=60)
    assert process.returncode == 130, complaint
    assert complaint.count("\n") == 1 and str(out) in complaint
    assert len(read_joints(out).frames) >= 1
    assert json.loads((out / "run.json").read_text())["status"] == "interrupted"
