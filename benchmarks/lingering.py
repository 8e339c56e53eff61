"""Whether somebody who stands on one spot for a minute stays foreground.

    python benchmarks/lingering.py [--seeds 44] [--models gaussian mixture spatial auto kde mog2 knn]

Rendered halls of 160 x 120 at 10 Hz, three people, the first of whom stands for 60 s of 120. Every model learns 60
pictures of the empty hall, then learns and tests all. Prints the share of the pixels of the one who stands that is in
the masks with default settings, for every ten seconds that they have stood.
"""

from __future__ import annotations

import argparse

import numpy as np

from muybridge.segmentation import build_background, settings_at
from muybridge.synthetic.crowd import shoot_people
from muybridge.synthetic.scene import empty
from muybridge.synthetic.surveillance import surveillance_scene

RATE, SECONDS, STANDS, EMPTY, STRETCH = 10.0, 120.0, 60.0, 60, 10
STILL = 6.0  # pixels that the middle of their box moves in a stretch, at most: they sway


def clip(seed: int) -> tuple[list[np.ndarray], list[np.ndarray], list[tuple[int, int]]]:
    """Pictures, the empty ones first; the lingerer's pixels in the others; and the ten seconds that they stand for."""
    scene = surveillance_scene(seed=seed, duration=SECONDS, rate=RATE, people=3, size=(160, 120), events=("linger",),
                               linger=STANDS)  # fmt: skip
    shots = [shoot_people(scene, frame) for frame in range(scene.frame_count)]
    pictures = [views[0] for views in empty(scene, EMPTY)][::-1] + [shot.image for shot in shots]
    places = np.array([_place(shot.numbers, shot.boxes) for shot in shots])
    step, stretches, begin = int(STRETCH * RATE), [], 0
    while begin + step <= len(shots):
        if np.ptp(places[begin : begin + step], axis=0).max() <= STILL:  # not while they are away: NaN
            stretches.append((begin, begin + step))
            begin += step
        else:
            begin += 1
    return pictures, [shot.ids == 1 for shot in shots], stretches


def _place(numbers: np.ndarray, boxes: np.ndarray) -> np.ndarray:
    here = np.flatnonzero(numbers == 1)
    return boxes[here[0], :2] + boxes[here[0], 2:] / 2 if len(here) else np.full(2, np.nan)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs="+", default=[44])
    parser.add_argument("--models", nargs="+", default=["gaussian", "mixture", "spatial", "auto", "kde", "mog2", "knn"])
    arguments = parser.parse_args()
    for seed in arguments.seeds:
        pictures, theirs, stretches = clip(seed)
        print(f"seed {seed}: stands from {', '.join(f'{begin / RATE:.0f} s' for begin, _ in stretches)}")
        for name in arguments.models:
            model = build_background(name, pictures[:EMPTY], **settings_at(name, RATE))
            masks = [model.apply(picture) for picture in pictures[EMPTY:]]
            found = [
                sum(int((masks[n] & theirs[n]).sum()) for n in range(*stretch))
                / max(1, sum(int(theirs[n].sum()) for n in range(*stretch)))
                for stretch in stretches
            ]
            print(f"  {name:9s}", *(f"{share:.2f}" for share in found), flush=True)


if __name__ == "__main__":
    main()
