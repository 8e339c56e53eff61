"""Trials on several processes, and what an interruption leaves."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from muybridge.experiments.pool import by_clip, run_trials
from muybridge.experiments.running import Result
from muybridge.experiments.trial import Clip, Trial

CLIPS = [Clip(frames=2, reduction=8, seed=seed) for seed in (0, 1)]
TRIALS = [Trial(clip, "condensation", seed=seed).with_settings(particles=20) for clip in CLIPS for seed in (0, 1)]


def outcomes(folder: Path, workers: int) -> dict[Trial, Result]:
    found: dict[Trial, Result] = {}
    counts: list[tuple[int, int]] = []
    run_trials(
        TRIALS, folder, found.__setitem__, workers=workers, progress=lambda done, total: counts.append((done, total))
    )
    assert counts == [(done, len(TRIALS)) for done in range(1, len(TRIALS) + 1)]
    return found


def test_results_do_not_depend_on_the_number_of_workers(tmp_path: Path) -> None:
    """All but the processor's time, to the bit."""
    alone, beside = (outcomes(tmp_path / str(workers), workers) for workers in (1, 2))
    assert alone.keys() == beside.keys() == set(TRIALS)
    for trial in TRIALS:
        assert alone[trial].frame_mm == beside[trial].frame_mm
        assert alone[trial].inside == beside[trial].inside
    assert alone[TRIALS[0]].frame_mm != alone[TRIALS[1]].frame_mm


@pytest.mark.parametrize("workers", [1, 2])
def test_an_interruption_keeps_what_was_finished(tmp_path: Path, workers: int) -> None:
    found: dict[Trial, Result] = {}

    def keep(trial: Trial, result: Result) -> None:
        found[trial] = result
        if len(found) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_trials(TRIALS, tmp_path, keep, workers=workers)
    assert len(found) >= 2


def test_clip_by_clip_and_nothing_twice() -> None:
    mixed = [TRIALS[2], TRIALS[0], TRIALS[2], TRIALS[1], TRIALS[3]]
    groups = by_clip(mixed)
    assert list(groups) == [CLIPS[1], CLIPS[0]]
    assert groups[CLIPS[1]] == [TRIALS[2], TRIALS[3]]


CHILD = "import os; from muybridge.experiments.pool import end_with; print('here', flush=True); end_with(os.getppid())"
PARENT = """
import subprocess, sys
child = subprocess.Popen([sys.executable, "-c", sys.argv[1]], stdout=subprocess.PIPE, text=True)
child.stdout.readline()
print(child.pid, flush=True)
sys.stdin.readline()
"""


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="looks into /proc")
def test_a_worker_leaves_when_its_parent_is_killed() -> None:
    """It looks once a second; ten are given."""
    parent = subprocess.Popen(
        [sys.executable, "-c", PARENT, CHILD],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert parent.stdout is not None
    worker = Path("/proc") / parent.stdout.readline().strip()
    time.sleep(1.5)
    assert worker.exists(), "it stays while its parent lives"
    parent.kill()
    parent.wait()
    for _ in range(100):
        if not worker.exists() or (worker / "stat").read_text().rpartition(")")[2].split()[0] == "Z":
            return
        time.sleep(0.1)
    pytest.fail("the worker is still there")
