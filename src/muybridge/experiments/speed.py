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
from muybridge.experiments.peer import silhouette_costs
from muybridge.filters import METHODS, GaussianWalk
from muybridge.likelihood.observation import ImageLikelihood, Observation
from muybridge.synthetic.scene import demo_scene, render, truth

REDUCTION = 2
"""The demo's pictures of 640 x 480 become 320 x 240."""
POSES, PEER_POSES = 2000, 100
REPEATS = 7
SPREAD = 0.05
"""Standard deviation of the poses around a standing person, radians and metres."""


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

    def poses(self, rng: np.random.Generator, count: int) -> np.ndarray:
        """(count, D) float64 around the person."""
        return self.mean + rng.normal(0, SPREAD, (count, len(self.mean)))


@lru_cache(maxsize=1)
def setting() -> Setting:
    """The demo's first frame."""
    scene, body = demo_scene(0), named_body("person")
    mean = np.zeros(len(body.dof_names))
    mean[:3] = truth(scene).joints[0, 0]
    likelihood = ImageLikelihood(body, scene.rig, (REDUCTION,) * len(scene.rig))
    return Setting(body, likelihood, render(scene, 0)[1], mean)


def silhouette(rng: np.random.Generator) -> Iterator[Measurement]:
    """The silhouette likelihood's kernel, and its peer in OpenCV and NumPy, on the same poses."""
    made = setting()
    observed = made.likelihood.observe(made.masks)
    cameras = len(made.masks)
    poses = made.poses(rng, POSES)
    with one_thread():
        ours = 1e6 * median_seconds(lambda: observed.costs(poses)) / (POSES * cameras)
        yield Measurement("silhouette, 320 x 240, a pose and camera", ours, "us", floor=4, aim=2)
        peer = 1e6 * median_seconds(lambda: peer_costs(made, poses[:PEER_POSES]), 3) / (PEER_POSES * cameras)
    yield Measurement("the same with OpenCV and NumPy, a pose at a time", peer, "us")
    yield Measurement("how many times faster", peer / ours, "x", floor=40, aim=100)


def observation(rng: np.random.Generator) -> Iterator[Measurement]:
    """What a frame costs before its first pose is measured."""
    made = setting()
    with one_thread():
        seconds = median_seconds(lambda: _prepared(made.likelihood.observe(made.masks)))
    yield Measurement("reducing and packing the masks of 3 cameras, a frame", 1e3 * seconds, "ms")


def filters(rng: np.random.Generator) -> Iterator[Measurement]:
    """One frame of each filter at its working settings, silhouettes of one camera, and the printed DE-MC 500 x 7."""
    made = setting()
    rig = made.likelihood.rig.subset([0])
    observed = ImageLikelihood(made.body, rig, (REDUCTION,)).observe(made.masks[:1])
    dynamics = GaussianWalk(np.full(len(made.mean), 0.02), made.body.lower, made.body.upper)
    rows = [(name, method.WORKING, name) for name, method in METHODS.items()]
    rows.append(("demc", METHODS["demc"].PRINTED, "demc, 500 x 7 as printed"))
    for name, config, label in rows:
        method = METHODS[name]
        mean = np.clip(made.mean, made.body.lower, made.body.upper)
        state = method.init(rng, mean, np.full(len(mean), 0.02), config)
        with one_thread():
            seconds = median_seconds(partial(method.step, rng, state, observed, dynamics, config), 3)
        yield Measurement(f"{label}, silhouette of one camera", 1 / seconds, "frames/s")


BENCHMARKS: dict[str, Callable[[np.random.Generator], Iterator[Measurement]]] = {
    "silhouette": silhouette,
    "observation": observation,
    "filters": filters,
}


def peer_costs(made: Setting, poses: np.ndarray) -> np.ndarray:
    """The peer's costs (N, C) at the reduced size."""
    cameras = [camera.scaled(1 / REDUCTION) for camera in made.likelihood.rig]
    return silhouette_costs(made.body, poses, cameras, [mask[::REDUCTION, ::REDUCTION] for mask in made.masks])


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
def one_thread() -> Iterator[None]:
    """Kernels use one thread within this context."""
    import numba

    before = numba.get_num_threads()
    numba.set_num_threads(1)
    try:
        yield
    finally:
        numba.set_num_threads(before)


def _prepared(observed: Observation) -> np.ndarray:
    """Make the parts of an observation that are made when first asked for."""
    return observed.areas
