"""What makes a scene hard: furniture, something in the way, somebody who passes, a lamp that switches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from muybridge.cameras.model import Rig
from muybridge.errors import InputError
from muybridge.synthetic.description import Person, Scene
from muybridge.synthetic.light import Lamp, Light, Switch
from muybridge.synthetic.motion import Motion, perform
from muybridge.synthetic.occluders import Occluder, hides
from muybridge.synthetic.outfits import OUTFITS
from muybridge.synthetic.placing import apart, clear_of
from muybridge.synthetic.skinning import load_figure
from muybridge.synthetic.textures import Colour

TRIES = 300
Size = tuple[float, float, float]
#: Kind, least and largest size of what may stand in the way: a pillar, a crate or counter, a table.
BARRIERS: tuple[tuple[str, Size, Size], ...] = (
    ("box", (0.12, 0.12, 2.6), (0.20, 0.20, 2.6)),
    ("box", (0.45, 0.35, 0.7), (0.9, 0.5, 1.15)),
    ("table", (1.0, 0.6, 0.72), (1.5, 0.8, 0.9)),
)
WOODS: tuple[Colour, ...] = ((88, 112, 138), (62, 84, 108), (120, 134, 142), (84, 92, 78), (66, 66, 96))


def furnished(rng: np.random.Generator, scene: Scene, count: int = 6) -> Scene:
    """The scene with cupboards, crates and tables along its walls, behind all cameras."""
    things: list[Occluder] = []
    for _ in range(count):
        for _ in range(TRIES):
            thing = _furniture(rng, scene.room.half_width)
            if _out_of_the_way(thing, scene.rig, things):
                things.append(thing)
                break
    return replace(scene, occluders=scene.occluders + tuple(things))


def hardened(rng: np.random.Generator, scene: Scene, figures: Sequence[str], outfits: Sequence[str]) -> Scene:
    """The scene with something in one camera's way, somebody who passes, and a lamp that switches."""
    joints = perform(scene.person.load(), scene.person.motion).joints
    scene = replace(scene, occluders=(*scene.occluders, _in_the_way(rng, scene, joints)))
    scene = replace(scene, others=(_passer_by(rng, scene, joints, figures, outfits),))
    return replace(scene, light=_switched(rng, scene))


def _furniture(rng: np.random.Generator, half_width: float) -> Occluder:
    """Something with its back to a wall."""
    wall = int(rng.integers(4))
    kind = str(rng.choice(["box", "box", "table"]))
    tall = kind == "box" and rng.uniform() < 0.4
    width, depth = rng.uniform(0.6, 1.4), rng.uniform(0.35, 0.55)
    height = rng.uniform(1.5, 2.0) if tall else rng.uniform(0.45, 0.85)
    along, off = rng.uniform(-1, 1) * (half_width - 0.8), half_width - depth / 2 - 0.03
    turn = wall * np.pi / 2
    place = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]) @ (along, -off)
    first, second = (WOODS[index] for index in rng.choice(len(WOODS), 2, replace=False))
    pattern = str(rng.choice(["denim", "plain", "blotches"]))
    return Occluder(kind, (float(place[0]), float(place[1])), (width, depth, height), turn, pattern, first, second)


def _out_of_the_way(thing: Occluder, rig: Rig, others: Sequence[Occluder]) -> bool:
    """Whether it is behind every camera, or across the room, and no other thing stands there."""
    for camera in rig:
        if thing.distance(camera.position[:2]) < 0.6:
            return False
    reach = np.hypot(*thing.size[:2]) / 2
    return all(other.distance(np.array(thing.place)) > reach for other in others)


def _in_the_way(rng: np.random.Generator, scene: Scene, joints: np.ndarray) -> Occluder:
    """A pillar, crate or table between one camera and the person's way."""
    middle = joints[:, 0, :2].mean(axis=0)
    shapes = np.repeat(rng.permutation(len(BARRIERS)), TRIES // len(BARRIERS))
    for shape in shapes:
        camera = scene.rig[int(rng.integers(len(scene.rig)))]
        share, aside = rng.uniform(0.30, 0.75), rng.normal(0, 0.3)
        line = middle - camera.position[:2]
        across = np.array([-line[1], line[0]]) / np.linalg.norm(line)
        place = camera.position[:2] + share * line + aside * across
        kind, low, high = BARRIERS[shape]
        width, depth, height = (float(side) for side in rng.uniform(low, high))
        woods = rng.choice(len(WOODS), 2, replace=False)
        thing = Occluder(kind, (float(place[0]), float(place[1])), (width, depth, height), rng.uniform(0, np.pi),
                         str(rng.choice(["denim", "plain"])), WOODS[woods[0]], WOODS[woods[1]])  # fmt: skip
        clear = all(thing.distance(other.position[:2]) > 0.8 for other in scene.rig)
        if clear and clear_of([thing], joints, 0.15) and _hides_some(thing, scene.rig, joints):
            return thing
    raise InputError("scene", expected="room for something in the way", got="a motion that is everywhere",
                     remedy="make the motion shorter")  # fmt: skip


def _hides_some(thing: Occluder, rig: Rig, joints: np.ndarray) -> bool:
    """Whether it hides a good part of the person from some camera for a while, and from none nearly all for long."""
    shares = np.array([hides(thing, camera.position, joints).mean(axis=1) for camera in rig])  # (C, T)
    worst = (shares > 0.6).mean(axis=1).max()
    return bool((shares > 0.12).mean(axis=1).max() > 0.2 and worst < 0.12)


def _passer_by(
    rng: np.random.Generator, scene: Scene, joints: np.ndarray, figures: Sequence[str], outfits: Sequence[str]
) -> Person:
    """Somebody who walks by without running into person, things or cameras."""
    who, worn = str(rng.choice(list(figures))), OUTFITS[str(rng.choice(list(outfits)))]
    figure, given = load_figure(who), scene.person.motion
    for _ in range(TRIES):
        reach, angle = rng.uniform(0.9, 2.4), rng.uniform(-np.pi, np.pi)
        motion = Motion("walk", given.duration, given.rate, heading=angle + np.pi / 2 + rng.normal(0, 0.3),
                        place=(reach * np.cos(angle), reach * np.sin(angle)), cadence=rng.uniform(0.8, 0.95),
                        seed=scene.seed + 1)  # fmt: skip
        own = perform(figure, motion).joints
        free = (
            all(np.linalg.norm(own[..., :2] - camera.position[:2], axis=-1).min() > 1.1 for camera in scene.rig)
            and (np.abs(own[..., :2]) < scene.room.half_width - 0.5).all()
        )
        if free and apart(own, joints, 0.75) and clear_of(scene.occluders, own, 0.1):
            return Person(who, motion, worn)
    raise InputError("scene", expected="room for somebody who passes", got="none left",
                     remedy="make the motion shorter, or the room larger")  # fmt: skip


def _switched(rng: np.random.Generator, scene: Scene) -> Light:
    """A lamp goes off, or a second one on, in the middle part of the clip."""
    time = float(rng.uniform(0.35, 0.65)) * scene.duration
    azimuth = rng.uniform(-np.pi, np.pi)
    direction = (0.6 * float(np.cos(azimuth)), 0.6 * float(np.sin(azimuth)), 0.8)
    spot = (2.0 * float(np.cos(azimuth)), 2.0 * float(np.sin(azimuth)))
    gain = 0.65 if rng.uniform() < 0.6 else 1.25
    return Light(Lamp(), (Switch(time, Lamp(direction, gain, spot)),))
