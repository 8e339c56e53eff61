"""The preset `surveillance`: a hall seen by one fixed camera under the ceiling, and people who come and go.

People walk in from the sides, in pairs that cross, stand for a moment here and there, pass before and behind a pillar,
and leave. One stays and lingers; a door in the far wall opens and stays open; a lamp goes off and on again. The seed
decides who, where, when, and what they wear: everybody something else.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from muybridge.cameras.model import Camera, Rig
from muybridge.errors import InputError
from muybridge.synthetic.description import Person, Scene
from muybridge.synthetic.light import Lamp, Light, Switch
from muybridge.synthetic.motion import Motion
from muybridge.synthetic.occluders import Occluder
from muybridge.synthetic.outfits import OUTFITS, outfit
from muybridge.synthetic.rigs import looking_at
from muybridge.synthetic.room import Room
from muybridge.synthetic.route import plan
from muybridge.synthetic.sensor import Sensor
from muybridge.synthetic.skinning import figure_names
from muybridge.synthetic.wardrobe import dressed

Way = tuple[tuple[float, float, float], ...]
EVENTS = ("pillar", "linger", "door", "lamp")
MOST_PEOPLE = 6
TRIES, RETRIES = 100, 40  # of a person's whole way, and of each point on it
ROOM = Room(half_width=6.0, height=4.5, wall=(168, 178, 182), floor_colour=(112, 124, 132), clutter=3)
CAMERA, AIM = (-4.0, 0.0, 3.2), (1.6, 0.0, 0.8)  # metres; people are 60 to 110 rows of 240 tall
FOCAL = 0.9  # widths of the picture
LANES = (0.0, 3.0)  # metres along the camera's view: where people walk
OUTSIDE = 5.55  # metres to either side: out of the picture, for every lane
IN_VIEW = 0.42  # metres to the side in the picture, a metre of distance
PILLAR = (0.42, 0.42, 4.0)
APART = 0.6  # metres between two people's middles
CLEAR = 0.35  # metres between somebody's middle and the pillar
SPEED, PLAN_RATE = 1.2, 10.0  # metres and pictures a second of plans that keep people apart
DOOR = (0.95, 0.05, 2.15)
SWING, STEPS = 1.2, 8  # seconds and pictures of a door that opens
PAUSE = (1.0, 5.0)  # seconds that people stand for, at half of their stops


def surveillance_scene(
    *,
    seed: int,
    duration: float = 60.0,
    rate: float = 25.0,
    people: int = MOST_PEOPLE,
    size: tuple[int, int] = (320, 240),
    events: tuple[str, ...] = EVENTS,
    linger: float | None = None,
) -> Scene:
    """A scene of people who come and go.

    Parameters
    ----------
    seed : decides all that is not given
    duration, rate : seconds, frames per second
    people : 1 to 6
    size : (width, height), pixels, 4 to 3
    events : which of EVENTS there are; () is a calm, empty hall
    linger : seconds for which the first person stands, with that event; half of the clip where None
    """
    _check(seed, people, size, events, linger)
    rng = np.random.default_rng([seed, 30200])
    camera = _camera(rng, size)
    pillar = _pillar(rng) if "pillar" in events else None
    linger = (0.5 * duration if linger is None else linger) if "linger" in events else 0.0
    ways = _ways(rng, camera, pillar, people, duration, linger)
    names, worn = rng.permutation(figure_names()), rng.permutation(list(OUTFITS))
    crowd = []
    for number, way in enumerate(ways):
        motion = Motion("walk", duration, rate, cadence=rng.uniform(0.84, 0.94), seed=1000 * seed + number, way=way)
        person = Person(str(names[number % len(names)]), motion, outfit(str(worn[number % len(worn)])))
        crowd.append(dressed([seed, number], person, (0.0, 0.015)))
    things = (*_door(rng, duration, "door" in events), *([pillar] if pillar else []))
    floor = str(rng.choice(["planks", "tiles", "carpet"]))
    return Scene(
        Rig((camera,)), crowd[0], replace(ROOM, floor=floor, seed=seed), noise=3.0, drift=0.02, shadow=0.35, seed=seed,
        others=tuple(crowd[1:]), occluders=things, light=_light(rng, duration) if "lamp" in events else Light(),
        sensor=Sensor(automatic=0.3, lag=0.5, quality=23), follow="people",
    )  # fmt: skip


def _camera(rng: np.random.Generator, size: tuple[int, int]) -> Camera:
    place = np.array(CAMERA) + rng.uniform(-0.15, 0.15, 3)
    aim = np.array(AIM) + rng.uniform(-0.15, 0.15, 3)
    lens = np.array([-0.10, 0.04, 0.0, 0.0, 0.0]) * rng.uniform(0.7, 1.1)
    return looking_at("cam1", place, aim, focal=FOCAL * size[0], size=size, distortion=lens)


def _pillar(rng: np.random.Generator) -> Occluder:
    place = (float(rng.uniform(0.4, 1.0)), float(rng.choice([-1.0, 1.0]) * rng.uniform(0.3, 1.0)))
    tone = int(rng.integers(120, 190))
    return Occluder("box", place, PILLAR, 0.0, "plain", (tone, tone, tone))


def _door(rng: np.random.Generator, duration: float, opens: bool) -> list[Occluder]:
    """A doorway in the far wall, and its leaf: in front of it, or picture by picture further open."""
    wall = ROOM.half_width - 0.06
    side = float(rng.uniform(-2.5, 2.5))
    wood, begin = (62, 84, 108), float(rng.uniform(0.25, 0.4)) * duration
    beyond = Occluder(
        "box", (wall + 0.04, side), (0.04, DOOR[0], DOOR[2]), 0.0, "blotches", (196, 206, 210), (168, 184, 190)
    )
    leaves = []
    for step in range(STEPS + 1):
        turn = 1.1 * step / STEPS
        hinge = np.array([wall, side - DOOR[0] / 2])
        middle = hinge + DOOR[0] / 2 * np.array([-np.sin(turn), np.cos(turn)])
        since = None if step == 0 else begin + SWING * (step - 1) / STEPS
        until = None if step == STEPS else begin + SWING * step / STEPS
        leaves.append(Occluder("box", (float(middle[0]), float(middle[1])), DOOR, turn + np.pi / 2, "denim", wood,
                               (52, 70, 92), since=since, until=until))  # fmt: skip
    return [beyond, *(leaves if opens else [replace(leaves[0], until=None)])]


def _light(rng: np.random.Generator, duration: float) -> Light:
    """A lamp goes off, and on again a while later."""
    off, on = rng.uniform(0.5, 0.6) * duration, rng.uniform(0.7, 0.8) * duration
    usual = Lamp()
    return Light(usual, (Switch(float(off), replace(usual, gain=0.6, spot=(-2.0, 1.5))), Switch(float(on), usual)))


def _ways(
    rng: np.random.Generator, camera: Camera, pillar: Occluder | None, people: int, duration: float, linger: float
) -> list[Way]:
    """Ways on which people keep clear of each other and the pillar; two and two come from opposite sides at a time."""
    ways: list[Way] = []
    walked: list[np.ndarray] = []
    pairs = (people + 1) // 2
    for number in range(people):
        for _ in range(TRIES):
            begin = duration * (0.02 + 0.5 * (number // 2) / pairs + rng.uniform(0, 0.04))
            waits = [linger] if linger and number == 0 else _waits(rng, duration)
            way = _way(rng, camera, pillar, walked, (1.0 if number % 2 else -1.0, begin, duration), waits)
            if way is not None:
                ways.append(way)
                walked.append(_planned(way, duration)[0])
                break
        else:
            raise InputError("scene", expected="room for everybody", got=f"none left for person {number + 1}",
                             remedy="fewer people, or another seed")  # fmt: skip
    return ways


def _waits(rng: np.random.Generator, duration: float) -> list[float]:
    """Seconds stood at each of the points on the way in the picture: more points in a longer clip."""
    count = int(rng.integers(1, 3)) + min(5, int(duration / 12))
    return [float(rng.uniform(*PAUSE)) if rng.uniform() < 0.5 else 0.0 for _ in range(count)]


def _way(
    rng: np.random.Generator,
    camera: Camera,
    pillar: Occluder | None,
    others: list[np.ndarray],
    course: tuple[float, float, float],
    waits: list[float],
) -> Way | None:
    """In on one side, through points of the floor, standing at some, and out; None where others are in the way.

    course : the side, when it begins, and how long the clip lasts, seconds
    """
    side, begin, duration = course
    way: Way = ((float(rng.uniform(*LANES)), side * OUTSIDE, float(begin)),)
    for wait in (*waits, None):
        for _ in range(RETRIES):
            if wait is None:
                leaves = -side if rng.uniform() < 0.7 else side
                further = (*way, (float(rng.uniform(*LANES)), leaves * OUTSIDE, 0.0))
            else:
                further = (*way, (*_spot(rng, camera), wait))
            places, until = _planned(further, duration)
            if _free(places[:until], pillar, [other[:until] for other in others]):
                way = further
                break
        else:
            return None
    return way


def _planned(way: Way, duration: float) -> tuple[np.ndarray, int]:
    """(T, 2) metres at PLAN_RATE, and the frame up to which the way as it is decides them."""
    planned = plan(Motion("walk", duration, PLAN_RATE, way=way), SPEED)
    arrives = int(np.argmax(planned.walked >= planned.walked[-1] - 1e-6))
    return planned.places, arrives + int(np.ceil(way[-1][2] * PLAN_RATE)) + 1


def _free(places: np.ndarray, pillar: Occluder | None, others: list[np.ndarray]) -> bool:
    """Whether somebody (T, 2) metres is clear of the pillar, and apart from others while both may be in the picture."""
    if pillar is not None and not (pillar.distance(places) > CLEAR).all():
        return False
    inside = np.abs(places[:, 1]) < OUTSIDE - 0.05
    for other in others:
        both = inside & (np.abs(other[:, 1]) < OUTSIDE - 0.05)
        if not (np.linalg.norm(places - other, axis=1)[both] > APART).all():
            return False
    return True


def _spot(rng: np.random.Generator, camera: Camera) -> tuple[float, float]:
    """(x, y) metres: somewhere in the picture."""
    x = rng.uniform(*LANES)
    reach = IN_VIEW * (x - camera.position[0])
    return float(x), float(rng.uniform(-reach, reach))


def _check(seed: int, people: int, size: tuple[int, int], events: tuple[str, ...], linger: float | None) -> None:
    if seed < 0:
        raise InputError("scene: seed", expected="0 or more", got=str(seed))
    if not 1 <= people <= MOST_PEOPLE:
        raise InputError("scene: people", expected=f"1 to {MOST_PEOPLE}", got=str(people))
    if min(size) < 16 or 3 * size[0] != 4 * size[1]:
        raise InputError("scene: size", expected="width to height as 4 to 3, at least 16", got=f"{size[0]} x {size[1]}")
    unknown = [event for event in events if event not in EVENTS]
    if unknown:
        raise InputError("scene: events", expected=f"some of {', '.join(EVENTS)}", got=repr(unknown[0]))
    if linger is not None and not (np.isfinite(linger) and linger > 0):
        raise InputError("scene: linger", expected="positive seconds", got=str(linger))
