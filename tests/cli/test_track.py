"""Commands around a tracker that only pretends: what is written and said, and with which exit code."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import muybridge.tracking
from conftest import shared_data
from muybridge.body import Body, named_body
from muybridge.cameras import Camera, Rig
from muybridge.cameras.json_format import write_rig
from muybridge.cli import app
from muybridge.io import job as jobs
from muybridge.io.run_folder import RunWriter, write_summary
from muybridge.io.video_writer import VideoWriter

FRAMES = 3
LOOKING_ALONG_Y = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])


@dataclass(frozen=True)
class Summary:
    """What the pretended tracker returns."""

    status: str = "done"
    frames: int = FRAMES


def body() -> Body:
    return named_body("person")


def write_run(out: Path, frames: int = FRAMES, shift: float = 0.0) -> None:
    """A person who stands still, `shift` metres too high."""
    pose = np.zeros(len(body().dof_names))
    pose[2] = 0.95 + shift
    joints = body().joints(pose)
    with RunWriter(out, body().joint_names, body().dof_names) as writer:
        for frame in range(frames):
            writer.write(frame, frame / 25, joints, np.full(len(joints), 0.01), pose)
    write_summary(out, {
        "status": "done", "frames": frames, "seed": 1, "settings": {}, "versions": {}, "evaluations_per_frame": 0,
        "ms_per_frame": {"median": 1.0, "p95": 1.0}, "peak_memory_mb": 1,
    })  # fmt: skip


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """A job with one grey video and a reference 30 mm above what the pretended tracker finds."""
    matrix = np.array([[150.0, 0, 79.5], [0, 150.0, 59.5], [0, 0, 1]])
    camera = Camera("front", (160, 120), matrix, np.zeros(5), LOOKING_ALONG_Y, np.array([0, 0.9, 4.0]))
    write_rig(tmp_path / "cameras.json", Rig((camera,)))
    with VideoWriter(tmp_path / "front.mp4", 25) as video:
        for _ in range(FRAMES):
            video.write(np.full((120, 160, 3), 90, np.uint8))
    write_run(tmp_path / "truth", shift=0.03)
    job = jobs.Job(
        calibration=jobs.CalibrationInput(file=tmp_path / "cameras.json"),
        cameras=(jobs.CameraInput(name="front", pictures=tmp_path / "front.mp4"),),
        filter=jobs.FilterInput(name="annealed"),
        reference=jobs.ReferenceInput(file=tmp_path / "truth" / "joints.csv"),
    )
    jobs.write(tmp_path / "job.toml", job)
    return tmp_path


def pretend(monkeypatch: pytest.MonkeyPatch, summary: Summary) -> list[jobs.Job]:
    """Replace the tracker; the list fills with the jobs that it was given."""
    given: list[jobs.Job] = []

    def run(job: jobs.Job, out: Path, progress: object = None, *, resume: bool = False) -> Summary:
        given.append(job)
        write_run(out)
        return summary

    monkeypatch.setattr(muybridge.tracking, "run", run, raising=False)
    return given


class TestTrack:
    def test_a_run_leaves_everything_and_says_how_far_off_it_is(
        self, scene: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture
    ) -> None:
        pretend(monkeypatch, Summary())
        out = scene / "run"
        assert app.run(["track", str(scene / "job.toml"), "--out", str(out), "--json"]) == 0
        said, complaints = capfd.readouterr()
        record = json.loads(said.splitlines()[-1])
        assert "mean joint error 30.0 mm (alignment none)" in said and complaints == ""
        assert record["errors"]["mean_mm"] == pytest.approx(30.0, abs=1e-3)  # joints.csv has micrometres
        assert record["status"] == "done" and record["frames"] == FRAMES
        for name in ("joints.csv", "overlay_front.mp4", "report.html", "errors.txt", "plots/angles.png"):
            assert (out / name).stat().st_size > 0, name

    def test_a_lost_person_is_code_3(self, scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        pretend(monkeypatch, Summary(status="lost"))
        assert app.run(["track", str(scene / "job.toml"), "--out", str(scene / "run"), "--no-overlay", "--quiet"]) == 3
        assert not (scene / "run/overlay_front.mp4").exists()

    def test_settings_and_seed_win_over_the_file(self, scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        given = pretend(monkeypatch, Summary())
        arguments = [
            "--seed",
            "7",
            "--set",
            "filter.particles=50",
            "--set",
            "body.fit=false",
            "--no-overlay",
            "--quiet",
        ]
        assert app.run(["track", str(scene / "job.toml"), "--out", str(scene / "run"), *arguments]) == 0
        assert given[0].seed == 7 and given[0].filter.settings == {"particles": 50} and not given[0].body.fit

    def test_interrupted(self, scene: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture) -> None:
        def run(job: jobs.Job, out: Path, progress: object = None, *, resume: bool = False) -> Summary:
            write_run(out, frames=2)
            raise KeyboardInterrupt

        monkeypatch.setattr(muybridge.tracking, "run", run, raising=False)
        assert app.run(["track", str(scene / "job.toml"), "--out", str(scene / "run")]) == 130
        line = capfd.readouterr().err
        assert line.count("\n") == 1 and str(scene / "run") in line
        assert (scene / "run/joints.csv").is_file()

    @pytest.mark.parametrize(
        ("setting", "words"),
        [
            ("filter.particle=3", "did you mean particles?"),
            ("filter.name=anealed", "did you mean annealed?"),
            ("camera.front.background.kind=plait", "camera.front.background"),
        ],
    )
    def test_a_wrong_setting_is_said_before_anything_is_done(
        self, scene: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture, setting: str, words: str
    ) -> None:
        given = pretend(monkeypatch, Summary())
        assert app.run(["track", str(scene / "job.toml"), "--out", str(scene / "run"), "--set", setting]) == 2
        assert given == [] and not (scene / "run").exists()
        assert capfd.readouterr().err.count("\n") == 1


class TestReport:
    def test_a_run_alone(self, tmp_path: Path, capfd: pytest.CaptureFixture) -> None:
        write_run(tmp_path / "run")
        assert app.run(["report", str(tmp_path / "run"), "--json"]) == 0
        record = json.loads(capfd.readouterr().out.splitlines()[-1])
        assert Path(record["report"]).is_file() and all(Path(plot).is_file() for plot in record["plots"])

    def test_no_run(self, tmp_path: Path, capfd: pytest.CaptureFixture) -> None:
        assert app.run(["report", str(tmp_path / "none")]) == 2
        assert capfd.readouterr().err.count("\n") == 1


class TestEvaluate:
    def test_values(self, tmp_path: Path, capfd: pytest.CaptureFixture) -> None:
        write_run(tmp_path / "run")
        write_run(tmp_path / "truth", shift=0.05)
        run, truth, out = (str(tmp_path / name) for name in ("run", "truth", "compared"))
        assert app.run(["evaluate", run, "--truth", truth, "--out", out, "--json", "--quiet"]) == 0
        (line,) = capfd.readouterr().out.splitlines()
        assert json.loads(line)["mean_mm"] == pytest.approx(50.0, abs=1e-3)
        assert json.loads((tmp_path / "compared/errors.json").read_text())["alignment"] == "none"

    def test_alignment_forgives(self, tmp_path: Path, capfd: pytest.CaptureFixture) -> None:
        write_run(tmp_path / "run")
        write_run(tmp_path / "truth", shift=0.05)
        run, truth = str(tmp_path / "run"), str(tmp_path / "truth")
        assert app.run(["evaluate", run, "--truth", truth, "--alignment", "root", "--json", "--quiet"]) == 0
        assert json.loads(capfd.readouterr().out)["mean_mm"] == pytest.approx(0.0, abs=1e-2)


class TestJobs:
    def test_a_known_layout(self, tmp_path: Path, capfd: pytest.CaptureFixture) -> None:
        folder = shared_data("bodytrack") / "sequenceB_2"
        assert app.run(["job", "bodytrack", str(folder), "--out", str(tmp_path), "--json"]) == 0
        written = json.loads(capfd.readouterr().out.splitlines()[-1])["job"]
        assert len(jobs.read(written).cameras) == 4

    @pytest.mark.parametrize("arguments", [["job", "humaneva", "x"], ["job", "pose2sim", "none"], ["sample", "bean"]])
    def test_errors(self, capfd: pytest.CaptureFixture, arguments: list[str]) -> None:
        assert app.run(arguments) == 2
        assert capfd.readouterr().err.count("\n") == 1
