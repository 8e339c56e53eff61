"""How fast boxes are compared by colour: cumulative maps against counting, and both likelihoods.

    python benchmarks/people_colour.py [--particles 600] [--repeats 7]

Prints one table: microseconds of processor time, best of the repeats, one thread.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np

from muybridge.experiments.machine import describe_machine
from muybridge.filters import condensation
from muybridge.people.box import BoxMotion, states_from_boxes
from muybridge.people.colour_likelihood import ColourTarget, pixel_boxes
from muybridge.people.histograms import BinMap, count_histograms, cumulative_map, to_luma_chroma
from muybridge.people.nummiaro import NummiaroTarget

SIZE = (384, 288)
BOXES = ((20, 25), (40, 90), (60, 150))
"""Width and height of a head, a body and a large body, pixels."""


def best(repeats: int, work: Callable[[], object], often: int = 20) -> float:
    """Microseconds of processor time of the fastest repeat: what else runs here counts little."""
    work()
    times = []
    for _ in range(repeats):
        started = time.thread_time()
        for _ in range(often):
            work()
        times.append((time.thread_time() - started) / often)
    return 1e6 * min(times)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--particles", type=int, default=600)
    parser.add_argument("--repeats", type=int, default=7)
    options = parser.parse_args()
    rng = np.random.default_rng(0)
    picture = rng.integers(0, 256, (SIZE[1], SIZE[0], 3), dtype=np.uint8)
    background = np.roll(picture, 50, axis=1)
    luma, empty = to_luma_chroma(picture), to_luma_chroma(background)
    print(describe_machine())
    print(f"{options.particles} particles; box, maps, counting, ratio; one frame of ours, of Nummiaro's filter")
    for width, height in BOXES:
        box = states_from_boxes(np.array([[192 - width / 2, 144 - height / 2, width, height]]))[0]
        motion = BoxMotion.within(SIZE)
        states = motion.sample(rng, np.repeat(box[None], options.particles, axis=0))
        pixels, hull = pixel_boxes(states)
        bins = BinMap.equalising(luma[100:190, 170:210])
        maps = best(options.repeats, lambda: cumulative_map(luma, bins, hull).histograms(pixels))  # noqa: B023
        counting = best(options.repeats, lambda: count_histograms(luma, bins, pixels), 2)  # noqa: B023
        start = motion, options.particles, box
        ours = best(options.repeats, frame(rng, ColourTarget.learn(luma, box), luma, empty, *start))
        theirs = best(options.repeats, frame(rng, NummiaroTarget.learn(picture, box), picture, empty, *start), 3)
        print(f"{width} x {height}: {maps:.0f}, {counting:.0f}, {counting / maps:.1f}; {ours:.0f}, {theirs:.0f}")


def frame(rng, target, picture, background, motion, particles, box) -> Callable[[], object]:
    """One frame of a filter over one box: select, predict, weigh, estimate, learn."""
    config = condensation.Config(estimate="mean", resampling="systematic", particles=particles)
    state = condensation.init(rng, box, np.array([0, 0, 0, 0, 1.0, 1.0]), config, motion.lower, motion.upper)

    def work() -> None:
        likelihood = target.observe(picture, background)
        after, _ = condensation.step(rng, state, likelihood, motion, config)
        target.updated(likelihood.histogram(after.estimate))

    return work


if __name__ == "__main__":
    main()
