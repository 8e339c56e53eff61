"""A made scene whose ground and silhouette are known, and what a tracker makes of walkers in it."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from made_people import Walker, empty_scene, mask_of, picture_of, truth_of
from muybridge.evaluation.boxes import overlaps
from muybridge.io.boxes import BoxSeries
from muybridge.people.blobs import BlobConfig
from muybridge.people.box import CountConfig
from muybridge.people.scene import Scene, describe
from muybridge.people.tracker import PeopleTracker, TrackerConfig

EMPTY = empty_scene()
PASSING = [Walker((10, feet), (310, feet), 60 * k, 60 * k + 59) for k, feet in enumerate((120, 150, 180))]
SMALL = TrackerConfig(smallest=30.0, counts=CountConfig(fewest=100, most=200))


@lru_cache(maxsize=1)
def known() -> Scene:
    """Learnt from three who pass, one after the other."""
    return describe(EMPTY, [mask_of(PASSING, frame) for frame in range(0, 180, 2)], BlobConfig(smallest=100))


def tracked(
    walkers: list[Walker],
    frames: int,
    hidden: np.ndarray | None = None,
    config: TrackerConfig = SMALL,
    seed: int = 0,
) -> PeopleTracker:
    """After so many frames at 10 a second, with the truth's own masks."""
    scene = Scene(EMPTY, known().ground, known().silhouette, hidden)
    tracker = PeopleTracker(scene, config, frame_rate=10.0, seed=seed)
    for frame in range(frames):
        tracker.step(frame, *picture_of(walkers, frame, EMPTY, hidden))
    return tracker


def identities(boxes: BoxSeries, walkers: list[Walker], frames: int) -> list[list[int]]:
    """Per walker and frame they are there: the identity that overlaps by half, 0 for none."""
    found: list[list[int]] = [[] for _ in walkers]
    for frame, who, box in truth_of(walkers, frames):
        rows = boxes.frames == frame
        shared = overlaps(box[None], boxes.boxes[rows])[0]
        hit = bool(shared.size and shared.max() > 0.5)
        found[who].append(int(boxes.ids[rows][shared.argmax()]) if hit else 0)
    return found
