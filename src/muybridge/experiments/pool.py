"""Trials on several processes; what comes out does not depend on how many.

The evidence of a clip is made once, by whoever is free, and its trials wait for it. Large pictures are deleted when the
last trial of their clip is done. Ctrl-C waits for the few trials that are running and keeps them.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path
from typing import Protocol

from threadpoolctl import threadpool_limits

from muybridge.experiments.clips import drop_pictures, evidence_of
from muybridge.experiments.running import EVIDENCE, Result, run_trial
from muybridge.experiments.trial import Clip, Trial

ONE_THREAD = {name: "1" for name in ("NUMBA_NUM_THREADS", "OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")}
Keep = Callable[[Trial, Result], None]


class Progress(Protocol):
    """Told after every trial how many of how many are done."""

    def __call__(self, done: int, total: int) -> None: ...


def run_trials(
    trials: Sequence[Trial], folder: Path, keep: Keep, *, workers: int = 1, progress: Progress | None = None
) -> None:
    """Run trials and hand each result to `keep`, as it comes; clip by clip, in the order given."""
    groups = by_clip(trials)
    if workers <= 1 or len(trials) < 2:
        _here(groups, folder, keep, progress, len(trials))
    else:
        _beside(groups, folder, keep, progress, len(trials), workers)


def by_clip(trials: Sequence[Trial]) -> dict[Clip, list[Trial]]:
    """The trials of each clip, both in the order of their first appearance; what appears twice is run once."""
    groups: dict[Clip, list[Trial]] = {}
    for trial in dict.fromkeys(trials):
        groups.setdefault(trial.clip, []).append(trial)
    return groups


def _here(groups: dict[Clip, list[Trial]], folder: Path, keep: Keep, progress: Progress | None, total: int) -> None:
    done = 0
    with threadpool_limits(limits=1, user_api="blas"):
        for clip, trials in groups.items():
            prepare_clip(clip, folder, _need_pictures(trials))
            for trial in trials:
                keep(trial, run_trial(trial, folder))
                done += 1
                if progress:
                    progress(done, total)
            drop_pictures(clip, folder / EVIDENCE)


def _beside(
    groups: dict[Clip, list[Trial]], folder: Path, keep: Keep, progress: Progress | None, total: int, workers: int
) -> None:
    """The same on `workers` processes: a window of clips is prepared ahead of their trials."""
    waiting = list(groups.items())
    left = {clip: len(trials) for clip, trials in groups.items()}
    running: dict[Future, Clip | Trial] = {}
    done = 0
    with _executor(workers) as executor:
        try:
            while waiting or running:
                while waiting and len(running) < 2 * workers:
                    clip, trials = waiting.pop(0)
                    running[executor.submit(prepare_clip, clip, folder, _need_pictures(trials))] = clip
                finished, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in finished:
                    task = running.pop(future)
                    if isinstance(task, Clip):
                        future.result()
                        running |= {executor.submit(run_trial, trial, folder): trial for trial in groups[task]}
                        continue
                    keep(task, future.result())
                    done, left[task.clip] = done + 1, left[task.clip] - 1
                    if not left[task.clip]:
                        drop_pictures(task.clip, folder / EVIDENCE)
                    if progress:
                        progress(done, total)
        except BaseException:
            _keep_finished(executor, running, keep)
            raise


def _keep_finished(executor: ProcessPoolExecutor, running: dict[Future, Clip | Trial], keep: Keep) -> None:
    """Start nothing new, wait for what runs, and keep what came of it."""
    executor.shutdown(wait=True, cancel_futures=True)
    for future, task in running.items():
        if isinstance(task, Trial) and not future.cancelled() and future.exception() is None:
            keep(task, future.result())


def prepare_clip(clip: Clip, folder: Path, pictures: bool) -> None:
    """Make a clip's evidence where it is not there yet."""
    evidence_of(clip, folder / EVIDENCE, pictures=pictures)


def _need_pictures(trials: Sequence[Trial]) -> bool:
    return any(trial.cues.need_pictures for trial in trials)


@contextmanager
def _executor(workers: int) -> Iterator[ProcessPoolExecutor]:
    """Fresh processes of one thread each, which leave Ctrl-C to their parent."""
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update(ONE_THREAD)  # read by libraries as they are imported: before any process starts
    executor = ProcessPoolExecutor(
        workers, mp_context=get_context("spawn"), initializer=_begin, initargs=(os.getpid(),)
    )
    try:
        yield executor
    finally:
        executor.shutdown(wait=True, cancel_futures=True)
        for name, value in before.items():
            os.environ.pop(name) if value is None else os.environ.update({name: value})


def _begin(parent: int) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threadpool_limits(limits=1, user_api="blas")
    threading.Thread(target=end_with, args=(parent,), daemon=True).start()


def end_with(parent: int) -> None:
    """Leave when the parent process is gone: one that was killed cannot send its workers home."""
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)
