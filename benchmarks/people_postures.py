"""Whether somebody who goes down and comes up again, among people who walk by, is followed on.

    python benchmarks/people_postures.py [--motions crouch bend lie] [--seeds 9302 9303 9304 9305] [--upright]

They walk in, go down where they stop (crouch, bend, or fall and lie), stay, get up and walk out. Prints for each
rendered hall how far down they went, the frames in which they were below 85 % of their height, the share of those in
which a box overlaps theirs by half or more, its mean overlap then and while they are upright, the identities that they
had, and the share of the frames down in which a second box lay on them. The clip is all that is known of the hall. With
--upright boxes keep the size of somebody who stands.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace

import numpy as np

from muybridge.evaluation.boxes import overlaps
from muybridge.io.boxes import BoxSeries
from muybridge.people.run import PeopleConfig, look_over
from muybridge.people.tracker import PeopleTracker
from muybridge.synthetic.crowd import PeopleShot, shoot_people
from muybridge.synthetic.motion import perform
from muybridge.synthetic.scene import Scene, truth
from muybridge.synthetic.skinning import load_figure
from muybridge.synthetic.stage import actors
from muybridge.synthetic.surveillance import surveillance_scene

DURATION, RATE, SIZE = 22.0, 25.0, (384, 288)
STAYS = {"crouch": 3.0, "bend": 4.0, "lie": 9.0}  # seconds, going down and coming up included
DOWN = 0.85  # of the usual height
ON = 0.5  # of a second box, within the person's
PERSON = 1
TRIES, APART = 500, 0.3  # metres from others' middles to any joint: nobody walks through who lies


@dataclass(frozen=True)
class Shots:
    """The pictures of a hall, as `look_over` reads them."""

    shots: list[PeopleShot]
    name: str = "hall"
    size: tuple[int, int] = SIZE

    def __len__(self) -> int:
        return len(self.shots)

    def read(self, index: int) -> np.ndarray:
        """(H, W, 3) uint8 BGR."""
        return self.shots[index].image


@dataclass(frozen=True)
class Result:
    """One hall: (T,) of each frame.

    height : the highest joint's, as a share of its usual one
    clear : upright, inside the picture and seen by half or more
    overlap, identity : of the best box with the true one
    second : whether another box lies on the person
    """

    height: np.ndarray
    clear: np.ndarray
    overlap: np.ndarray
    identity: np.ndarray
    second: np.ndarray

    @property
    def down(self) -> np.ndarray:
        return self.height < DOWN

    def line(self) -> str:
        down, clear = self.down, self.clear
        ids = [int(number) for number in np.unique(self.identity[(self.overlap >= 0.5) & (down | clear)])]
        followed = 100 * (self.overlap[down] >= 0.5).mean()
        return (f"down to {self.height.min():.2f}, {down.sum()} frames down, {followed:.0f} % followed, "
                f"overlap {self.overlap[down].mean():.2f} ({self.overlap[clear].mean():.2f} upright), "
                f"identities {ids}, second box {100 * self.second[down].mean():.0f} %")  # fmt: skip


def hall(kind: str, seed: int) -> Scene:
    """The first person walks in, goes down where they stop, gets up and walks out; three others walk by."""
    scene = surveillance_scene(seed=seed, duration=DURATION, rate=RATE, people=4, size=SIZE, events=())
    rng, figure = np.random.default_rng([seed, 1]), load_figure(scene.person.figure)
    others = [actor.track.joints[:, 0, :2] for actor in actors(scene)[1:]]
    for _ in range(TRIES):
        side = float(rng.choice([-1.0, 1.0]))
        x, y, faces = rng.uniform((0.6, -1.2, 0.0), (2.4, 1.2, 2 * np.pi)).tolist()
        before = (x - 0.8 * np.cos(faces), y - 0.8 * np.sin(faces), 0.0)  # so that they lie any way
        way = ((x, 5.0 * side, 0.3), before, (x, y, STAYS[kind]), (float(rng.uniform(0.5, 2.5)), -5.0 * side, 0.0))
        motion = replace(scene.person.motion, kind=kind, way=way)
        own = perform(figure, motion).joints[..., :2]
        if all((np.linalg.norm(own - other[:, None], axis=2) > APART).all() for other in others):
            return replace(scene, person=replace(scene.person, motion=motion))
    raise SystemExit(f"seed {seed}: nowhere to {kind}")


def follow(shots: list[PeopleShot], seed: int, config: PeopleConfig) -> BoxSeries:
    """Everybody's boxes."""
    masks, scene = look_over(Shots(shots), config)
    tracker = PeopleTracker(scene, config.tracker, frame_rate=RATE, seed=seed)
    for frame, shot in enumerate(shots):
        picture = masks.relit(shot.image)
        tracker.step(frame, picture, masks.apply(picture))
    return tracker.tracks().inside(SIZE).boxes


def judged(scene: Scene, shots: list[PeopleShot], found: BoxSeries) -> Result:
    """How the first person was followed."""
    highest = truth(scene).joints[..., 2].max(axis=1)
    rows = [_row(shot, found.where(found.frames == frame)) for frame, shot in enumerate(shots)]
    overlap, identity, second, seen = np.array(rows).T
    height = highest / np.median(highest)
    return Result(height, (height >= DOWN) & (seen > 0), overlap, identity.astype(int), second > 0)


def _row(shot: PeopleShot, now: BoxSeries) -> tuple[float, int, bool, bool]:
    """The overlap with the best box and whose that is, whether there is a second one, and whether one can be seen."""
    own = np.flatnonzero(shot.numbers == PERSON)
    if not len(own):
        return 0.0, 0, False, False
    true = shot.boxes[own[0]].astype(np.float64)
    inside = (true[:2] >= 0).all() and (true[:2] + true[2:] <= SIZE).all()
    seen = bool(inside and shot.visible[own[0]] >= 0.5)
    if not len(now):
        return 0.0, 0, False, seen
    shared = overlaps(shot.boxes.astype(np.float64), now.boxes)
    best = int(shared[own[0]].argmax())
    on = _within(now.boxes, true) > ON
    on[best] = False
    others = np.delete(shared, own[0], axis=0).max(axis=0, initial=0.0)  # who stands before or behind them is no second
    return float(shared[own[0], best]), int(now.ids[best]), bool((on & (others < 0.3)).any()), seen


def _within(boxes: np.ndarray, true: np.ndarray) -> np.ndarray:
    """(N,) share of each box that is within the true one."""
    low = np.maximum(boxes[:, :2], true[:2])
    high = np.minimum(boxes[:, :2] + boxes[:, 2:], true[:2] + true[2:])
    return np.maximum(high - low, 0).prod(axis=1) / boxes[:, 2:].prod(axis=1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--motions", nargs="+", default=list(STAYS), choices=list(STAYS))
    parser.add_argument("--seeds", type=int, nargs="+", default=[9302, 9303, 9304, 9305])
    parser.add_argument("--upright", action="store_true", help="tracker.down=false")
    arguments = parser.parse_args()
    config = PeopleConfig().with_settings([f"tracker.down={str(not arguments.upright).lower()}"])
    for kind in arguments.motions:
        for seed in arguments.seeds:
            scene = hall(kind, seed)
            shots = [shoot_people(scene, frame) for frame in range(scene.frame_count)]
            print(f"{kind} {seed}: {judged(scene, shots, follow(shots, seed, config)).line()}", flush=True)


if __name__ == "__main__":
    main()
