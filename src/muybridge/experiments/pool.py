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
from typing import Any, Protocol

from threadpoolctl import threadpool_limits

from muybridge.experiments.runnable import RunnableClip, RunnableTrial

ONE_THREAD = {name: "1" for name in ("NUMBA_NUM_THREADS", "OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")}
Keep = Callable[[Any, Any], None]
"""Takes a trial and its result."""
Groups = dict[Any, list[Any]]
"""Trials by their clip."""


class Progress(Protocol):
    """Told after every trial how many of how many are done."""

    def __call__(self, done: int, total: int) -> None: ...


def run_trials(
    trials: Sequence[RunnableTrial], folder: Path, keep: Keep, *, workers: int = 1, progress: Progress | None = None
) -> None:
    """Run trials and hand each result to `keep`, as it comes; clip by clip, in the order given."""
    groups = by_clip(trials)
    if workers <= 1 or len(trials) < 2:
        _here(groups, folder, keep, progress, len(trials))
    else:
        _beside(groups, folder, keep, progress, len(trials), workers)


def by_clip(trials: Sequence[RunnableTrial]) -> Groups:
    """The trials of each clip, both in the order of their first appearance; what appears twice is run once."""
    groups: Groups = {}
    for trial in dict.fromkeys(trials):
        groups.setdefault(trial.clip, []).append(trial)
    return groups


def _here(groups: Groups, folder: Path, keep: Keep, progress: Progress | None, total: int) -> None:
    done = 0
    with threadpool_limits(limits=1, user_api="blas"):
        for clip, trials in groups.items():
            clip.prepare(folder, trials)
            for trial in trials:
                keep(trial, trial.run(folder))
                done += 1
                if progress:
                    progress(done, total)
            clip.drop(folder)


def _beside(groups: Groups, folder: Path, keep: Keep, progress: Progress | None, total: int, workers: int) -> None:
    """The same on `workers` processes: a window of clips is prepared ahead of their trials."""
    waiting = list(groups.items())
    left = {clip: len(trials) for clip, trials in groups.items()}
    preparing: dict[Future, RunnableClip] = {}
    running: dict[Future, RunnableTrial] = {}
    done = 0
    with _executor(workers) as executor:
        try:
            while waiting or preparing or running:
                while waiting and len(preparing) + len(running) < 2 * workers:
                    clip, trials = waiting.pop(0)
                    preparing[executor.submit(prepare_clip, clip, folder, trials)] = clip
                finished, _ = wait([*preparing, *running], return_when=FIRST_COMPLETED)
                for future in finished:
                    if future in preparing:
                        future.result()
                        trials = groups[preparing.pop(future)]
                        running |= {executor.submit(run_trial, trial, folder): trial for trial in trials}
                        continue
                    trial = running.pop(future)
                    keep(trial, future.result())
                    done, left[trial.clip] = done + 1, left[trial.clip] - 1
                    if not left[trial.clip]:
                        trial.clip.drop(folder)
                    if progress:
                        progress(done, total)
        except BaseException:
            _keep_finished(executor, running, keep)
            raise


def _keep_finished(executor: ProcessPoolExecutor, running: dict[Future, RunnableTrial], keep: Keep) -> None:
    """Start nothing new, wait for what runs, and keep what came of it."""
    executor.shutdown(wait=True, cancel_futures=True)
    for future, trial in running.items():
        if not future.cancelled() and future.exception() is None:
            keep(trial, future.result())


def prepare_clip(clip: RunnableClip, folder: Path, trials: Sequence[RunnableTrial]) -> None:
    """In a worker: what the trials need of their clip."""
    clip.prepare(folder, trials)


def run_trial(trial: RunnableTrial, folder: Path) -> Any:
    """In a worker: the result."""
    return trial.run(folder)


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
