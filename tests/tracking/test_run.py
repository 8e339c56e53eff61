"""A whole job, small and made: masks of the body itself on two cameras, from the job file to the run folder."""

from __future__ import annotations

import gc
import json
import shutil
import tracemalloc
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import cv2
import numpy as np
import pytest

from muybridge.cameras import write_rig
from muybridge.errors import InputError
from muybridge.io import job as jobs
from muybridge.io.run_folder import RunWriter, read_joints, read_pose, read_summary
from muybridge.tracking import RunSummary, run
from muybridge.tracking.fit import Fit
from muybridge.tracking.prepare import Preparation, prepare
from muybridge.tracking.run import CHECKPOINT_EVERY
from muybridge.tracking.start import Start
from tracking.made import PIXEL, exact_masks, ring, walking

FRAMES = 30
WARM, SHORT, LONG = 20, 80, 300  # frames; the short part goes there and back, so that every size of box has been seen
TABLES = ("joints.csv", "pose.csv", "diagnostics.csv", "body.toml", "cameras.json")
JOB = """
name = "made"
{frames}
[calibration]
file = "rig.json"
{cameras}
[body]
fit = false
[start]
pose = "first/pose.csv"
[likelihood]
reduction = 1
[filter]
name = "{method}"
particles = 40
"""
CAMERA = '[[camera]]\nname = "{0}"\npictures = "{0}_%03d.png"\nmasks = "{0}_%03d.png"\nframe_rate = 30\n'


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with masks, calibration and first pose."""
    folder = tmp_path_factory.mktemp("made")
    body, poses = walking(FRAMES)
    rig = ring((0.2, 1.6))
    write_rig(folder / "rig.json", rig)
    for frame, pose in enumerate(poses):
        for camera, mask in zip(rig, exact_masks(body, pose, rig), strict=True):
            cv2.imwrite(str(folder / f"{camera.name}_{frame:03d}.png"), mask.astype(np.uint8) * 255)
    (folder / "first").mkdir()
    with RunWriter(folder / "first", body.joint_names, body.dof_names) as writer:
        writer.write(0, 0.0, body.joints(poses[0]), np.zeros(len(body.joint_names)), poses[0])
    return folder


def job(made: Path, *overrides: str, method: str = "guided", cameras: int = 2, frames: str = "") -> jobs.Job:
    text = JOB.format(
        cameras="".join(CAMERA.format(f"c{i}") for i in range(cameras)),
        method=method,
        frames=frames and f"frames = {frames}",
    )
    path = made / "job.toml"
    path.write_text(text)
    return jobs.read(path, overrides)


class Interrupt:
    """Progress that a person breaks off after some frames."""

    def __init__(self, after: int) -> None:
        self.after = after

    def __call__(self, done: int, total: int) -> None:
        if done == self.after:
            raise KeyboardInterrupt


def tables(folder: Path) -> dict[str, bytes]:
    return {name: (folder / name).read_bytes() for name in TABLES}


def found_out(plain: Preparation) -> Preparation:
    """The same as if the start had been searched, the body fitted and the camera checked: quick, with one camera."""
    fit = Fit({"arm": 1.02}, {"arm": 0.9}, {"arm": 1.1}, np.array([[1.5, -2.0]]), plain.pose[None], 0.008)
    return replace(plain, start=Start(plain.pose, 0.1, np.inf), start_frame=2, fit=fit, check=fit)


@pytest.fixture(scope="module")
def whole(made: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, RunSummary]:
    out = tmp_path_factory.mktemp("runs") / "whole"
    return out, run(job(made), out)


class TestRunFolder:
    def test_is_complete(self, whole: tuple[Path, RunSummary]) -> None:
        out, summary = whole
        assert set(TABLES) | {"run.json", "track.log", "checkpoint.npz"} <= {path.name for path in out.iterdir()}
        assert not list(out.glob("*unfinished*"))
        record = json.loads((out / "run.json").read_text())
        assert summary.status == record["status"] == "done" and summary.frames == record["frames"] == FRAMES
        assert record["settings"]["filter"]["particles"] == 40 and record["settings"]["reductions"] == [1, 1]
        assert set(record["cameras"]) == {"c0", "c1"} and record["lost_frames"] == 0

    def test_says_where_the_person_was(self, whole: tuple[Path, RunSummary]) -> None:
        """Two cameras at right angles: each joint to two pixels in the median."""
        body, poses = walking(FRAMES)
        joints = read_joints(whole[0] / "joints.csv")
        assert joints.frames.tolist() == list(range(FRAMES))
        away = np.linalg.norm(joints.positions - body.joints(poses), axis=-1)
        assert np.median(away) < 2 * PIXEL
        assert read_pose(whole[0] / "pose.csv").poses.shape == poses.shape

    def test_the_same_seed_the_same_bytes(self, made: Path, whole: tuple[Path, RunSummary], tmp_path: Path) -> None:
        run(job(made), tmp_path)
        assert tables(tmp_path) == tables(whole[0])

    def test_some_of_the_frames(self, made: Path, tmp_path: Path) -> None:
        assert run(job(made, frames="[0, 4]"), tmp_path).frames == 5
        assert read_joints(tmp_path / "joints.csv").frames.tolist() == [0, 1, 2, 3, 4]

    def test_more_frames_than_there_are(self, made: Path, tmp_path: Path) -> None:
        with pytest.raises(InputError, match=f"at most {FRAMES - 1}, got 99"):
            run(job(made, frames="[0, 99]"), tmp_path)


@pytest.fixture(scope="module")
def single(made: Path) -> jobs.Job:
    """A job with one camera: nothing is looked at ahead, so that it is quick."""
    return job(made, cameras=1)


@pytest.fixture(scope="module")
def uninterrupted(single: jobs.Job, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Its run folder, whole."""
    out = tmp_path_factory.mktemp("single")
    run(single, out)
    return out


class TestResume:
    def interrupted(self, single: jobs.Job, out: Path, after: int) -> None:
        with pytest.raises(KeyboardInterrupt):
            run(single, out, Interrupt(after))

    @pytest.mark.parametrize("after", [3, CHECKPOINT_EVERY, CHECKPOINT_EVERY + 3])
    def test_gives_the_same_bytes(self, single: jobs.Job, uninterrupted: Path, tmp_path: Path, after: int) -> None:
        """Broken off before a checkpoint, at one, and after it."""
        self.interrupted(single, tmp_path, after)
        assert len(read_joints(tmp_path / "joints.csv").frames) == after
        done: list[int] = []
        summary = run(single, tmp_path, lambda count, total: done.append(count), resume=True)
        assert done[0] == (CHECKPOINT_EVERY + 1 if after >= CHECKPOINT_EVERY else 1)
        assert tables(tmp_path) == tables(uninterrupted) and summary.frames == FRAMES

    def test_tells_what_was_found_before_the_first_frame(
        self, single: jobs.Job, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """Start, body and cameras stand in run.json whether the run was broken off or not."""
        module = import_module("muybridge.tracking.run")
        monkeypatch.setattr(module, "prepare", lambda *given: found_out(prepare(*given)))
        run(single, tmp_path / "whole")
        self.interrupted(single, tmp_path / "broken", CHECKPOINT_EVERY)
        broken = read_summary(tmp_path / "broken")
        run(single, tmp_path / "broken", resume=True)
        whole, resumed = read_summary(tmp_path / "whole"), read_summary(tmp_path / "broken")
        assert (broken["status"], resumed["status"]) == ("interrupted", "done")
        assert whole["start"] == {"frame": 2, "cost": 0.1, "rival_cost": None}
        for facts in ("start", "body_fit", "cameras"):
            assert whole[facts] == broken[facts] == resumed[facts]

    def test_without_those_facts_goes_on(self, single: jobs.Job, uninterrupted: Path, tmp_path: Path) -> None:
        """A folder of an older version has none, and a disk may have damaged them."""
        for damage in ("missing", "{", "[]"):
            folder = tmp_path / damage
            shutil.copytree(uninterrupted, folder)
            (folder / "preparation.json").unlink()
            if damage != "missing":
                (folder / "preparation.json").write_text(damage)
            assert run(single, folder, resume=True).frames == FRAMES
            assert tables(folder) == tables(uninterrupted)

    def test_of_a_whole_run_changes_nothing(self, single: jobs.Job, uninterrupted: Path) -> None:
        before = tables(uninterrupted)
        run(single, uninterrupted, resume=True)
        assert tables(uninterrupted) == before

    def test_other_settings_are_refused(self, made: Path, single: jobs.Job, tmp_path: Path) -> None:
        self.interrupted(single, tmp_path, CHECKPOINT_EVERY)
        with pytest.raises(InputError, match="another job"):
            run(job(made, "filter.particles=41", cameras=1), tmp_path, resume=True)

    def test_a_log_cut_short_is_said(self, single: jobs.Job, tmp_path: Path) -> None:
        """After a power cut the log may hold fewer frames than the checkpoint."""
        self.interrupted(single, tmp_path, CHECKPOINT_EVERY)
        log = tmp_path / "track.log"
        log.write_bytes(log.read_bytes()[: log.stat().st_size // 2])
        with pytest.raises(InputError, match="without --resume"):
            run(single, tmp_path, resume=True)


@pytest.fixture(scope="module")
def long(made: Path) -> Path:
    """The same masks again and again, there and back, so that nobody jumps."""
    order = [*range(FRAMES), *range(FRAMES - 2, 0, -1)]
    for frame in range(FRAMES, LONG):
        (made / f"long_{frame:03d}.png").symlink_to(made / f"c0_{order[frame % len(order)]:03d}.png")
    for frame in range(FRAMES):
        (made / f"long_{frame:03d}.png").symlink_to(made / f"c0_{frame:03d}.png")
    return made


class TestMemory:
    """What is held does not grow with the clip: the highest use over sixty frames is that over all others, to 5 %.

    Counted by Python, with NumPy's arrays; a single mask (192 x 144) kept a frame would be 5 % after a few frames.
    """

    def peaks(self, made: Path, out: Path, leak: int = 0) -> list[int]:
        """Bytes: the highest use in frames WARM to SHORT, and from there to LONG."""
        read = job(
            made, "camera.c0.masks=long_%03d.png", "camera.c0.pictures=long_%03d.png", method="condensation", cameras=1
        )
        found: list[int] = []
        kept: list[bytes] = []

        def progress(done: int, total: int) -> None:
            kept.append(bytes(leak))
            gc.collect()  # cycles would otherwise wait for a moment that other tests' objects decide
            if done in (WARM, SHORT, LONG):
                found.append(tracemalloc.get_traced_memory()[1])
                tracemalloc.reset_peak()

        gc.collect()
        gc.freeze()
        tracemalloc.start()
        try:
            run(read, out, progress)
        finally:
            tracemalloc.stop()
            gc.unfreeze()
        return found[1:]

    def test_does_not_grow(self, long: Path, tmp_path: Path) -> None:
        short, whole = self.peaks(long, tmp_path / "run")
        assert whole < 1.05 * short

    def test_growing_would_be_noticed(self, long: Path, tmp_path: Path) -> None:
        short, whole = self.peaks(long, tmp_path / "run", leak=192 * 144)
        assert whole > 1.05 * short
