"""How fast the parts are on this machine; a row of `BENCHMARKS` is all that a new measurement needs.

Each time is the median over repeats, after one call that compiles and warms the caches. One thread, unless a row says
otherwise.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache, partial

import numpy as np

from muybridge.body import Body, named_body
from muybridge.cameras.model import Rig
from muybridge.filters import METHODS, GaussianWalk
from muybridge.likelihood.benchmark import bench_scene, time_likelihood
from muybridge.likelihood.cues import CueWeights
from muybridge.likelihood.observation import ImageLikelihood, Observation
from muybridge.segmentation.benchmark import time_backgrounds
from muybridge.synthetic.benchmark import time_rendering
from muybridge.synthetic.scene import demo_scene, render, truth
from muybridge.tracking.tracker import Tracker, TrackerConfig

REDUCTION = 2
"""The demo's pictures of 640 x 480 become 320 x 240."""
REPEATS = 7


@dataclass(frozen=True)
class Measurement:
    """One number with its unit, and what it should at least reach (`floor`) and was hoped to reach (`aim`)."""

    what: str
    value: float
    unit: str
    floor: float | None = None
    aim: float | None = None


@dataclass(frozen=True, eq=False)
class Setting:
    """A body near a person seen by the demo's cameras at 320 x 240."""

    body: Body
    likelihood: ImageLikelihood
    masks: tuple[np.ndarray, ...]
    """At 640 x 480."""
    mean: np.ndarray


@lru_cache(maxsize=1)
def setting() -> Setting:
    """The demo's first frame."""
    scene, body = demo_scene(0), named_body("person")
    mean = np.zeros(len(body.dof_names))
    mean[:3] = truth(scene).joints[0, 0]
    likelihood = ImageLikelihood(body, scene.rig, (REDUCTION,) * len(scene.rig))
    return Setting(body, likelihood, render(scene, 0)[1], mean)


TARGETS = {"silhouette": (4.0, 2.0), "silhouette + colour + boundary": (30.0, 12.0)}
"""Microseconds per evaluation and camera: at least, aim."""


def likelihood(rng: np.random.Generator) -> Iterator[Measurement]:
    """Each cue and all together, and the same in OpenCV and NumPy; CPU time, see `muybridge.likelihood.benchmark`."""
    times = {timing.name: timing.microseconds for timing in time_likelihood()}
    for name, microseconds in times.items():
        floor, aim = TARGETS.get(name, (None, None))
        yield Measurement(f"{name}, an evaluation and camera", microseconds, "us", floor, aim)
    three = times["OpenCV + NumPy, three cues"] / times["silhouette + colour + boundary"]
    alone = times["OpenCV + NumPy, silhouette"] / times["silhouette"]
    yield Measurement("three cues, how many times faster than OpenCV + NumPy", three, "x", 40, 100)
    yield Measurement("silhouette, how many times faster than OpenCV + NumPy", alone, "x", 40, 100)


def printed_demc(rng: np.random.Generator) -> Iterator[Measurement]:
    """DE-MC as printed, 500 x 7, three cues, one camera of 320 x 240: whole frames, from mask and picture to joints."""
    scene = bench_scene("bodytrack")
    three = CueWeights(silhouette=1, colour=1, boundary=1, silhouette_kind="iou")
    model = ImageLikelihood(scene.body, Rig((scene.camera,)), (1,), cues=three)
    tracker = Tracker(model, 1 / 30, TrackerConfig("demc", METHODS["demc"].PRINTED))
    mean = np.clip(scene.poses.mean(axis=0), scene.body.lower, scene.body.upper)
    for label, threads in (("one thread", 1), ("all threads", None)):
        state, _ = tracker.step(rng, tracker.init(rng, mean), [scene.mask], [scene.image])
        with limited_threads(threads):
            seconds = median_seconds(partial(tracker.step, rng, state, [scene.mask], [scene.image]), 3)
        yield Measurement(f"DE-MC 500 x 7, three cues, one camera, {label}", 1 / seconds, "frames/s", 12, 30)


def observation(rng: np.random.Generator) -> Iterator[Measurement]:
    """What a frame costs before its first pose is measured."""
    made = setting()
    with limited_threads(1):
        seconds = median_seconds(lambda: _prepared(made.likelihood.observe(made.masks)))
    yield Measurement("reducing and packing the masks of 3 cameras, a frame", 1e3 * seconds, "ms")


def filters(rng: np.random.Generator) -> Iterator[Measurement]:
    """One frame of each filter at its working settings, silhouettes of one camera."""
    made = setting()
    rig = made.likelihood.rig.subset([0])
    observed = ImageLikelihood(made.body, rig, (REDUCTION,)).observe(made.masks[:1])
    dynamics = GaussianWalk(np.full(len(made.mean), 0.02), made.body.lower, made.body.upper)
    for name, method in METHODS.items():
        config = method.WORKING
        mean = np.clip(made.mean, made.body.lower, made.body.upper)
        state = method.init(rng, mean, np.full(len(mean), 0.02), config)
        with limited_threads(1):
            seconds = median_seconds(partial(method.step, rng, state, observed, dynamics, config), 3)
        yield Measurement(f"{name}, silhouette of one camera", 1 / seconds, "frames/s")


RENDERED = 20.0
"""Frames of one camera in a second, at least."""


def rendering(rng: np.random.Generator) -> Iterator[Measurement]:
    """A person as tall as the picture of 640 x 480, CPU time of one thread; see `muybridge.synthetic.benchmark`."""
    for timing in time_rendering():
        yield Measurement(f"{timing.name}, 640 x 480", timing.frames_per_second, "frames/s", RENDERED)


BACKGROUNDS = {"spatial": (30.0, 100.0), "mixture": (60.0, 200.0)}
"""Frames a second on two cores, at least and aim."""


def backgrounds(rng: np.random.Generator) -> Iterator[Measurement]:
    """Learning and testing a picture of 320 x 240, on all cores and on one; see `muybridge.segmentation.benchmark`."""
    for timing in time_backgrounds():
        floor, aim = BACKGROUNDS.get(timing.name, (None, None))
        what = f"{timing.name} background, 320 x 240"
        yield Measurement(f"{what}, all cores", timing.on_all_cores, "frames/s", floor, aim)
        yield Measurement(f"{what}, CPU time of one thread", timing.frames_per_second, "frames/s")


BENCHMARKS: dict[str, Callable[[np.random.Generator], Iterator[Measurement]]] = {
    "likelihood": likelihood,
    "demc": printed_demc,
    "observation": observation,
    "filters": filters,
    "render": rendering,
    "background": backgrounds,
}


def median_seconds(work: Callable[[], object], repeats: int = REPEATS) -> float:
    """The median time of one call, after one that is not counted."""
    work()
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return float(np.median(times))


@contextmanager
def limited_threads(count: int | None) -> Iterator[None]:
    """Kernels use that many threads within this context; None is all."""
    import numba

    before = numba.get_num_threads()
    numba.set_num_threads(count or before)
    try:
        yield
    finally:
        numba.set_num_threads(before)


def _prepared(observed: Observation) -> np.ndarray:
    """Make the parts of an observation that are made when first asked for."""
    return observed.areas
