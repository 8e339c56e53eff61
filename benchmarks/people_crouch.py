"""Whether somebody who goes down on their heels and comes up again, among people who walk by, is followed on.

    python benchmarks/people_crouch.py [--seeds 9302 9303 9304] [--seconds 3]

Prints, for each rendered hall, the frames in which the true box is below 85 % of its usual height, the share of them in
which a followed box overlaps it by half or more, the mean overlap, and the identities it had while it was overlapped.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np

from muybridge.evaluation.boxes import overlaps
from muybridge.people.blobs import BlobConfig
from muybridge.people.masks import Masks
from muybridge.people.scene import describe
from muybridge.people.tracker import PeopleTracker
from muybridge.synthetic.crowd import shoot_people
from muybridge.synthetic.motion import Motion
from muybridge.synthetic.scene import empty
from muybridge.synthetic.surveillance import surveillance_scene

DURATION, RATE, SIZE, PLACE = 14.0, 25.0, (384, 288), (1.5, 0.8)
DOWN = 0.85  # of the usual height


def follow(seed: int, seconds: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(T,) the first person's true height in pixels, overlap with the best box, and whose that is."""
    hall = surveillance_scene(seed=seed, duration=DURATION, rate=RATE, people=4, size=SIZE, events=())
    heading = float(np.random.default_rng(seed).uniform(0, 2 * np.pi))
    motion = Motion(
        "crouch", DURATION, RATE, cadence=2.4 / seconds, vigour=1.1, place=PLACE, heading=heading, seed=seed
    )
    hall = replace(hall, person=replace(hall.person, motion=motion))
    bare = np.median([pictures[0] for pictures in empty(hall, 15)], axis=0).astype(np.uint8)
    shots = [shoot_people(hall, frame) for frame in range(hall.frame_count)]
    model = Masks.train([bare])
    masks = [model.apply(shot.image) for shot in shots]
    tracker = PeopleTracker(describe(bare, masks[::4], BlobConfig(smallest=250)), frame_rate=RATE, seed=seed)
    for frame, (shot, mask) in enumerate(zip(shots, masks, strict=True)):
        tracker.step(frame, shot.image, mask)
    found, rows = tracker.tracks().boxes, []
    for frame, shot in enumerate(shots):
        true = shot.boxes[shot.numbers == 1].astype(np.float64)
        now = found.where(found.frames == frame)
        shared = overlaps(true, now.boxes)[0] if len(now) else np.zeros(1)
        best = int(shared.argmax())
        rows.append((true[0, 3], shared[best], now.ids[best] if len(now) else 0))
    height, overlap, identity = np.array(rows).T
    return height, overlap, identity


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs="+", default=[9302, 9303, 9304])
    parser.add_argument("--seconds", type=float, default=3.0, help="down and up again")
    arguments = parser.parse_args()
    for seed in arguments.seeds:
        height, overlap, identity = follow(seed, arguments.seconds)
        down = height < DOWN * np.median(height)
        kept = sorted({int(number) for number in identity[overlap > 0.5]})
        print(f"seed {seed}: down to {height.min() / np.median(height):.2f} of the height, {down.sum()} frames down, "
              f"{100 * (overlap[down] >= 0.5).mean():.0f} % followed, overlap {overlap[down].mean():.2f} "
              f"({overlap[~down].mean():.2f} upright), identities {kept}")  # fmt: skip


if __name__ == "__main__":
    main()
