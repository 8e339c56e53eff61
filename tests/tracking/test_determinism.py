"""The same job gives the same bytes: again, with one thread or two, and after a pause, by every named filter."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import cv2
import numba
import numpy as np
import pytest

from muybridge.cameras import write_rig
from muybridge.filters import METHODS
from muybridge.io.job import Job, from_table
from muybridge.tracking import run
from tracking.made import INTERVAL, exact_masks, ring, walking

FRAMES, PAUSE, EVERY = 6, 4, 3  # frames in all, after which the run is stopped, between checkpoints
TABLES = ("joints.csv", "pose.csv", "diagnostics.csv")
#: Enough particles for several chunks of a parallel loop, few enough for a fast test.
SETTINGS = {
    "guided": {"particles": 40, "redraws": 20},
    "annealed": {"particles": 40, "layers": 7},
    "agp-pf": {"particles": 40, "layers": 7},
    "demc": {"particles": 20, "layers": 10},
    "tempered": {"particles": 20, "layers": 10},
    "condensation": {"particles": 200},
}


class Stopped(Exception):
    """As if the power had failed."""


@contextmanager
def threads(count: int) -> Iterator[None]:
    before = numba.get_num_threads()
    numba.set_num_threads(count)
    try:
        yield
    finally:
        numba.set_num_threads(before)


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with masks of two cameras, their calibration and the first pose."""
    folder = tmp_path_factory.mktemp("scene")
    body, poses = walking(FRAMES)
    rig = ring((0.2, 1.4))
    write_rig(folder / "rig.json", rig)
    rows = [f"{name} = {value!r}" for name, value in zip(body.dof_names, poses[0].tolist(), strict=True)]
    (folder / "start.toml").write_text("\n".join(rows))
    for frame, pose in enumerate(poses):
        for camera, mask in zip(rig, exact_masks(body, pose, rig), strict=True):
            (folder / camera.name).mkdir(exist_ok=True)
            path = folder / camera.name / f"{frame:04d}.png"
            path.write_bytes(cv2.imencode(".png", mask.astype(np.uint8) * 255)[1].tobytes())
    return folder


def job_of(scene: Path, method: str) -> Job:
    pattern = "{}/%04d.png"
    table = {
        "calibration": {"file": "rig.json"},
        "camera": [
            {"name": name, "pictures": pattern.format(name), "masks": pattern.format(name), "frame_rate": 1 / INTERVAL}
            for name in ("c0", "c1")
        ],
        "body": {"name": "person", "fit": False},
        "start": {"pose": "start.toml"},
        "filter": {"name": method, **SETTINGS[method]},
    }
    return from_table(table, scene)


def bytes_of(folder: Path) -> dict[str, bytes]:
    return {name: (folder / name).read_bytes() for name in TABLES}


def tracked(job: Job, out: Path, **kwargs: bool) -> dict[str, bytes]:
    run(job, out, **kwargs)
    return bytes_of(out)


@pytest.mark.parametrize("method", METHODS)
def test_same_bytes_by_any_number_of_threads_and_after_a_pause(
    scene: Path, tmp_path: Path, method: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(importlib.import_module("muybridge.tracking.run"), "CHECKPOINT_EVERY", EVERY)
    job = job_of(scene, method)
    with threads(1):
        whole = tracked(job, tmp_path / "one")

    def stop(done: int, total: int) -> None:
        if done == PAUSE:
            raise Stopped

    with threads(min(2, numba.config.NUMBA_NUM_THREADS)):
        with pytest.raises(Stopped):
            run(job, tmp_path / "paused", stop)
        assert bytes_of(tmp_path / "paused") != whole, "the pause has to come before the end"
        assert tracked(job, tmp_path / "paused", resume=True) == whole


def test_another_seed_gives_other_bytes(scene: Path, tmp_path: Path) -> None:
    """The control: what is compared above does depend on the draws."""
    import msgspec

    job = job_of(scene, "annealed")
    other = msgspec.structs.replace(job, seed=job.seed + 1)
    assert tracked(job, tmp_path / "a")["joints.csv"] != tracked(other, tmp_path / "b")["joints.csv"]
