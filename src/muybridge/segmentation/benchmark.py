"""How fast background models are, learning and testing every picture: on one thread, and on all cores.

The scene changes: a lamp lights half of the picture for a second out of three, somebody crosses it, and there is noise,
so that pixels have more than one component, and some learn a new one at each picture.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from muybridge.segmentation.registry import BackgroundModel, build_background

SIZE = (320, 240)
MODELS = ("gaussian", "mixture", "spatial", "auto", "kde", "mog2", "knn")
NOISE = 3.0
"""Grey values."""
LEARNT, ROUNDS = 120, 5


@dataclass(frozen=True)
class BackgroundTiming:
    """Pictures that one thread learns and tests in a second of CPU time; and all threads in a second of the clock."""

    name: str
    frames_per_second: float
    on_all_cores: float


def time_backgrounds(
    names: Sequence[str] = MODELS, size: tuple[int, int] = SIZE, rounds: int = ROUNDS
) -> list[BackgroundTiming]:
    """Each model's median round, rounds of the models in turn, so that all meet the same machine."""
    import cv2
    import numba

    pictures = changing_pictures(size)
    threads, cv2_threads = numba.get_num_threads(), cv2.getNumThreads()
    clocks = {1: time.process_time, max(2, threads): time.perf_counter}
    seconds: dict[tuple[str, int], list[float]] = {(name, count): [] for name in names for count in clocks}
    try:
        models = {name: build_background(name, (pictures * 2)[:LEARNT]) for name in names}
        for turn in range(rounds + 1):
            for count, clock in clocks.items():
                numba.set_num_threads(min(count, threads))
                cv2.setNumThreads(min(count, threads))
                for name, model in models.items():
                    took = _seconds(model, pictures[turn % 3 * 30 :][:30], clock)
                    if turn:  # the first compiles
                        seconds[name, count].append(took)
    finally:
        numba.set_num_threads(threads)
        cv2.setNumThreads(cv2_threads)
    return [
        BackgroundTiming(name, *(1.0 / float(np.median(seconds[name, count])) for count in clocks)) for name in names
    ]


def _seconds(model: BackgroundModel, pictures: Sequence[NDArray], clock: Callable[[], float]) -> float:
    """Seconds a picture."""
    start = clock()
    for picture in pictures:
        model.apply(picture)
    return (clock() - start) / len(pictures)


def changing_pictures(size: tuple[int, int]) -> list[NDArray]:
    """Three seconds at 30 Hz, (H, W, 3) uint8 each."""
    rng = np.random.default_rng(0)
    width, height = size
    room = rng.uniform(40, 180, (height // 8 + 1, width // 8 + 1, 3)).repeat(8, 0).repeat(8, 1)[:height, :width]
    lit = room.copy()
    lit[:, : width // 2] *= 1.3
    pictures = []
    for number in range(90):
        picture = (lit if 30 <= number < 60 else room) + rng.normal(0, NOISE, room.shape)
        left = int(number / 90 * (width - width // 8))
        picture[height // 4 : -height // 8, left : left + width // 8] = rng.uniform(60, 200, 3)
        pictures.append(np.clip(np.rint(picture), 0, 255).astype(np.uint8))
    return pictures
