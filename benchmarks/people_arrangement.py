"""How well head, torso and hip-leg lie on the truth, and how they usually lie on a body.

    python benchmarks/people_arrangement.py [--halls calm hard] [--seeds 9200 9201] [--learn]

The halls of `muybridge experiment zhao-2009`: calm, or five people and a pillar. Prints, for parts that are one state,
for the thesis' own (`tracker.held=false`, with repair), and for parts that are simply where their shares of the body's
box have them: per cent right (half of the box on the part) while the body is right, the centre's deviation in per cent
of the body's height and in pixels, and intersection over union in per cent, of each part; means over people, then
seeds. With `--learn` also the covariances that `muybridge.people.arrangement` has.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping
from functools import partial

import numpy as np

from muybridge.experiments.zhao_2009.parts import LEAST_PIXELS, RIGHT
from muybridge.experiments.zhao_2009.people_clips import ClipPictures, PeopleClip
from muybridge.people.blobs import BlobConfig
from muybridge.people.box import boxes_from_states, states_from_boxes
from muybridge.people.failure import detector_named
from muybridge.people.labelled import WHOLE, coverage
from muybridge.people.masks import Masks
from muybridge.people.part_filters import boxes_of
from muybridge.people.scene import describe
from muybridge.people.tracker import PeopleTracker, TrackerConfig

HALLS = {"calm": PeopleClip, "hard": partial(PeopleClip, people=5, events=("pillar",))}
FEWEST = 20  # frames; who is followed for less is not counted
START = 10  # frames over which a part's own offset is taken: cuts and true parts do not end at the same rows


Rows = Mapping[str, np.ndarray]
"""Of one person, T frames: body (T, 6), true body (T, 4), true parts and each kind of parts (T, 3, 4)."""


def follow(clip: PeopleClip, pictures: ClipPictures) -> Iterator[Rows]:
    """Everybody whose body is right for long enough; parts of both kinds on the same bodies."""
    masks = Masks.train([pictures.empty])
    found = [masks.apply(shot.image) for shot in pictures.shots]
    scene = describe(pictures.empty, found[::4], BlobConfig(smallest=LEAST_PIXELS))
    trackers = {
        name: PeopleTracker(scene, TrackerConfig(held=name == "one state"), frame_rate=clip.rate, seed=clip.seed,
                            detector=detector_named("shipped"))
        for name in ("one state", "free, repair")
    }  # fmt: skip
    rows: dict[int, list[Rows]] = {}
    whose: dict[int, int] = {}
    for number, (shot, mask) in enumerate(zip(pictures.shots, found, strict=True)):
        for tracker in trackers.values():
            tracker.step(number, shot.image, mask)
        for people in zip(*(tracker.people for tracker in trackers.values()), strict=True):
            body = people[0].body.box  # the other's is the same: parts draw random numbers of their own
            right = coverage(boxes_from_states(body)[0], shot.boxes) >= RIGHT
            identity = people[0].identity
            for k in np.flatnonzero(right):
                if any(person.sightings[-1].parts is None for person in people):
                    continue
                if shot.visible[k] >= WHOLE:
                    whose.setdefault(identity, int(shot.numbers[k]))
                if whose.get(identity) != shot.numbers[k]:
                    continue
                now = {name: person.sightings[-1].parts[:, :4] for name, person in zip(trackers, people, strict=True)}
                now["fixed shares"] = boxes_of(people[0].parts.shares, body)
                now |= {"body": body, "true body": shot.boxes[k]}
                now["true parts"] = states_from_boxes(shot.parts[k])[:, :4]
                rows.setdefault(identity, []).append(now)
    for track in rows.values():
        if len(track) >= FEWEST:
            yield {name: np.array([now[name] for now in track]) for name in track[0]}


def scores(person: Rows, kind: str) -> np.ndarray:
    """(4, 3) right, deviation over the height, deviation in pixels, intersection over union; of each part."""
    found, true = person[kind], person["true parts"]
    off = np.hypot(*np.moveaxis(found[..., :2] - true[..., :2], -1, 0))
    boxes, truth = (np.array([boxes_from_states(states) for states in both]) for both in (found, true))
    inside = coverage(boxes, truth)
    shared = inside * boxes[..., 2:].prod(axis=-1)
    overlap = shared / (boxes[..., 2:].prod(axis=-1) + truth[..., 2:].prod(axis=-1) - shared)
    height = person["true body"][:, 3:]
    return np.array(
        [(inside >= RIGHT).mean(axis=0), (off / height).mean(axis=0), off.mean(axis=0), overlap.mean(axis=0)]
    )


def usual(person: Rows) -> np.ndarray:
    """(T, 6) how far the true parts are from where their shares have them, heights, against the beginning."""
    height = person["body"][:, 3]
    off = (person["true parts"] - person["fixed shares"])[..., :2] / height[:, None, None]
    off -= np.median(off[:START], axis=0)
    return np.concatenate([off[..., 0], off[..., 1]], axis=1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--halls", nargs="+", choices=HALLS, default=list(HALLS))
    parser.add_argument("--seeds", type=int, nargs="+", default=[9200, 9201])
    parser.add_argument("--learn", action="store_true", help="print covariances, (heights / 100)^2")
    arguments = parser.parse_args()
    everybody: list[Rows] = []
    for hall in arguments.halls:
        clips = [HALLS[hall](seed) for seed in arguments.seeds]
        people = [list(follow(clip, clip.render())) for clip in clips]
        everybody += [person for group in people for person in group]
        for kind in ("one state", "free, repair", "fixed shares"):
            mean = np.mean([np.mean([scores(person, kind) for person in group], axis=0) for group in people], axis=0)
            columns = mean * np.array([100, 100, 1, 100])[:, None]
            print(f"{hall:5s} {kind:13s}", " | ".join(" ".join(f"{value:5.1f}" for value in row) for row in columns))
    if arguments.learn:
        off = np.concatenate([usual(person) for person in everybody])
        for name, block in (("across", off[:, :3]), ("along", off[:, 3:])):
            print(name, (100**2 * block.T @ block / len(block)).round(1).tolist())


if __name__ == "__main__":
    main()
