"""Scenes by difficulty: `easy`, `studio`, `humaneva`, `hard`.

| preset | room | what makes it hard |
|---|---|---|
| `easy` | plain walls and carpet | little: low noise, no shadow, still light |
| `studio` | `indoor`, or a `bluescreen` (Du 2005, chapter 7) | ordinary noise, shadow, a light that drifts |
| `humaneva` | 3 x 2 m of floor, 60 Hz | as the studio; the person turns more, the cameras stand further off |
| `hard` | full of things | one in the way, somebody passes, a lamp, blur, exposure, compression, loose clothes |

The seed decides who it is, what is worn and how it is cut, the hair, how and where they move, where the cameras stand,
and the noise.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import numpy as np

from muybridge.cameras.model import Rig
from muybridge.errors import InputError
from muybridge.synthetic.description import Person, Scene
from muybridge.synthetic.motion import KINDS, Motion, perform
from muybridge.synthetic.obstacles import furnished, hardened
from muybridge.synthetic.outfits import outfit
from muybridge.synthetic.placing import in_room, side_camera, whole
from muybridge.synthetic.rigs import ring
from muybridge.synthetic.room import Room
from muybridge.synthetic.sensor import Sensor
from muybridge.synthetic.skinning import Figure, figure_names, load_figure
from muybridge.synthetic.wardrobe import dressed

if TYPE_CHECKING:
    from muybridge.synthetic.recorded import Recorded

View = Literal["ring", "side"]
Named = TypeVar("Named")
TRIES = 200
FRAMES = (2, 100_000)  # the least and the most of a clip
MOST_CAMERAS = 8
RADIUS = 3.9  # metres from the middle of the room to the cameras; up to twice that for ways that need it
SIDE_DISTANCE = 4.6
#: Radians a second to either side: a faster gait needs a tighter bend to stay in view.
TURNS = {"walk": (0.35, 0.6), "jog": (1.0, 1.4)}

INDOOR = Room()
ROOMS: dict[str, Room] = {
    "plain": Room(floor="carpet", wall=(196, 198, 200), floor_colour=(128, 134, 138), clutter=0),
    "indoor": INDOOR,
    "bluescreen": Room(floor="carpet", wall=(186, 92, 34), floor_colour=(170, 84, 32), clutter=0),
    "hall": Room(half_width=5.2, floor="carpet", wall=(150, 158, 160), floor_colour=(104, 112, 116), clutter=3),
    "office": Room(floor="tiles", wall=(168, 184, 190), clutter=7),
}


@dataclass(frozen=True)
class Preset:
    """What a difficulty means.

    Parameters
    ----------
    rate, duration : frames per second, seconds
    rooms : names in ROOMS, the first is the default
    outfits : names in `outfits.OUTFITS`
    noise, drift, shadow, sensor : as in `Scene`
    looseness : metres, from and to
    radius : metres from the middle of the floor to the cameras of a ring
    floor : (x, y) metres: the person's pelvis stays inside a rectangle of this size
    bend : factor on how fast a walk turns
    crowded : something in the way, somebody who passes, a lamp that switches
    """

    rate: float = 30.0
    duration: float = 3.0
    rooms: tuple[str, ...] = ("indoor",)
    outfits: tuple[str, ...] = ("striped", "checked", "green", "blotched", "red", "ochre")
    noise: float = 3.0
    drift: float = 0.015
    shadow: float = 0.45
    looseness: tuple[float, float] = (0.0, 0.0)
    sensor: Sensor = Sensor()
    radius: float = RADIUS
    floor: tuple[float, float] = (np.inf, np.inf)
    bend: float = 1.0
    crowded: bool = False


PRESETS: dict[str, Preset] = {
    "easy": Preset(rooms=("plain",), outfits=("striped", "green", "red"), noise=1.0, drift=0.0, shadow=0.0),
    "studio": Preset(rooms=("indoor", "bluescreen"), looseness=(0.0, 0.01)),
    "humaneva": Preset(rate=60.0, rooms=("hall",), noise=2.5, shadow=0.35, radius=4.3, floor=(3.0, 2.0), bend=2.0),
    "hard": Preset(
        rooms=("office",),
        noise=5.0,
        drift=0.04,
        shadow=0.55,
        looseness=(0.02, 0.03),
        sensor=Sensor(shutter=0.5, exposure=0.03, automatic=0.5, lag=0.35, readout=0.6, quality=32),
        crowded=True,
    ),
}
#: Against a blue screen, blue cloth is a hole in the mask.
BLUESCREEN_OUTFITS = ("green", "red", "ochre")


def preset_scene(
    preset: str,
    *,
    seed: int,
    figure: str | None = None,
    motion: Motion | Recorded | str | None = None,
    details: Mapping[str, Any] | None = None,
    cameras: int | None = None,
    view: View = "ring",
    room: str | None = None,
    outfit_name: str | None = None,
    cut: str | None = None,
    hair: str | None = None,
    duration: float | None = None,
    rate: float | None = None,
    rig: Rig | None = None,
) -> Scene:
    """A scene of a difficulty in which every camera sees the person whole, all the time.

    Parameters
    ----------
    preset : a key of PRESETS
    seed : decides all that is not given
    figure, outfit_name, cut, hair, room : who, what is worn and how, where (names)
    motion : what is done: a kind, or a whole motion, which then stays where it says
    details : fields of `Motion` that are not the seed's to decide, with a kind
    cameras : 1 to 8 in a ring, 3 where absent; the side view has one
    view : "ring", or "side": one camera at right angles to the way walked, which is straight
    duration, rate : seconds, frames per second; a whole motion has its own
    rig : cameras that stand already; then nobody checks what they see
    """
    kind = _named("preset", PRESETS, preset)
    _check(seed, cameras, view, motion, rig)
    rng = np.random.default_rng([seed, 30100 + list(PRESETS).index(preset)])
    room_name = room or kind.rooms[0]
    surroundings = replace(_named("room", ROOMS, room_name), seed=seed)
    worn = [name for name in kind.outfits if room_name != "bluescreen" or name in BLUESCREEN_OUTFITS]
    who = str(rng.choice(figure_names()))
    who, clothes = figure or who, outfit(outfit_name or str(rng.choice(worn)))
    draft = _Draft(
        kind, motion, view, cameras or 3, duration or kind.duration, rate or kind.rate, seed, rig, details or {}
    )
    done, rig, half_width = _placed(rng, load_figure(who), draft, surroundings.half_width)
    person = dressed([seed, 0], Person(who, done, clothes, cut=cut, hair=hair), kind.looseness)
    scene = Scene(
        rig, person, replace(surroundings, half_width=half_width), noise=kind.noise,
        drift=kind.drift, shadow=kind.shadow, seed=seed, sensor=kind.sensor,
    )  # fmt: skip
    if not kind.crowded:
        return scene
    scene = hardened(rng, furnished(rng, scene), figure_names(), kind.outfits)
    others = (dressed([seed, number], other, kind.looseness) for number, other in enumerate(scene.others, 1))
    return replace(scene, others=tuple(others))


@dataclass(frozen=True)
class _Draft:
    """What is asked for, as far as it decides where people and cameras go."""

    preset: Preset
    motion: Motion | Recorded | str | None
    view: View
    cameras: int
    duration: float
    rate: float
    seed: int
    rig: Rig | None
    details: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.motion is None or isinstance(self.motion, str):
            frames = self.duration * self.rate
            if not FRAMES[0] <= frames <= FRAMES[1]:
                raise InputError("scene: duration x rate", expected=f"{FRAMES[0]} to {FRAMES[1]} frames",
                                 got=f"{frames:g}")  # fmt: skip


def _placed(
    rng: np.random.Generator, figure: Figure, draft: _Draft, half_width: float
) -> tuple[Motion | Recorded, Rig, float]:
    """A motion and cameras that see it whole; ways that need it get cameras further off, in a larger room."""
    performed, joints = None, np.empty(0)
    for number in range(TRIES):
        wider = 1.0 + max(0.0, 2 * number / TRIES - 0.5)
        motion = _motion(rng, draft)
        if motion != performed:  # one that is given stays the same, and a recording takes long to perform
            performed, joints = motion, perform(figure, motion).joints
        if draft.rig is not None:
            return motion, draft.rig, max(half_width, _needed(draft.rig, joints))
        if not (np.ptp(joints[:, 0, :2], axis=0) <= draft.preset.floor).all():
            continue
        rig = _rig(rng, draft, motion, joints, wider)
        walls = max(half_width, _needed(rig, joints))
        if whole(rig, joints) and in_room(rig, joints, walls):
            return motion, rig, walls
    raise InputError("scene", expected="a motion that stays in every camera's picture", got="one that leaves it",
                     remedy="make it shorter, slower or on the spot, or place the cameras yourself")  # fmt: skip


def _motion(rng: np.random.Generator, draft: _Draft) -> Motion | Recorded:
    kind = draft.motion or "walk"
    heading, turn = rng.uniform(-np.pi, np.pi), float(rng.choice([-1.0, 1.0]))
    slow, fast = TURNS.get(kind, (0.0, 0.0)) if isinstance(kind, str) else (0.0, 0.0)
    turn *= rng.uniform(slow, fast) * draft.preset.bend
    cadence, vigour = rng.uniform(0.80, 0.92), rng.uniform(0.92, 1.05)
    if not isinstance(kind, str):
        return kind
    if kind != "walk":
        cadence = cadence / 0.86 * Motion.cadence
    if draft.view == "side":
        turn = 0.0
    drawn = {"heading": heading, "turn_rate": turn, "cadence": cadence, "vigour": vigour, "seed": draft.seed}
    return Motion(kind, draft.duration, draft.rate, **{**drawn, **draft.details})


def _rig(rng: np.random.Generator, draft: _Draft, motion: Motion | Recorded, joints: np.ndarray, wider: float) -> Rig:
    if draft.view == "ring":
        return ring(rng, draft.cameras, radius=draft.preset.radius * wider)
    lens = np.array([-0.10, 0.04, 0.0, 0.0, 0.0]) * rng.uniform(0.7, 1.1)
    camera = side_camera(
        joints, _direction(motion, joints), side=float(rng.choice([-1.0, 1.0])),
        distance=SIDE_DISTANCE * wider * rng.uniform(0.95, 1.05), height=rng.uniform(1.0, 1.4), distortion=lens,
    )  # fmt: skip
    return Rig((camera,))


def _direction(motion: Motion | Recorded, joints: np.ndarray) -> float:
    """Radians: the way that is walked; of somebody who stays, where they face."""
    way = joints[-1, 0, :2] - joints[0, 0, :2]
    return float(np.arctan2(way[1], way[0])) if np.linalg.norm(way) > 0.5 else motion.heading


def _needed(rig: Rig, joints: np.ndarray) -> float:
    """Metres: half the width of a room that holds cameras and people."""
    furthest = max(float(np.abs(camera.position[:2]).max()) for camera in rig)
    return max(furthest + 0.4, float(np.abs(joints[..., :2]).max()) + 0.5)


def _named(what: str, known: dict[str, Named], name: str) -> Named:
    if name not in known:
        raise InputError(what, expected=f"one of {', '.join(known)}", got=repr(name))
    return known[name]


def _check(seed: int, cameras: int | None, view: str, motion: Motion | Recorded | str | None, rig: Rig | None) -> None:
    if seed < 0:
        raise InputError("scene: seed", expected="0 or more", got=str(seed))
    if view not in ("ring", "side"):
        raise InputError("scene: view", expected="ring or side", got=repr(view))
    if cameras is not None and not 1 <= cameras <= MOST_CAMERAS:
        raise InputError("scene: cameras", expected=f"1 to {MOST_CAMERAS}", got=str(cameras))
    if cameras is not None and rig is not None:
        raise InputError("scene: cameras", expected="a number of cameras, or cameras one by one", got="both")
    if view == "side" and (rig is not None or cameras not in (None, 1)):
        raise InputError("scene: view", expected="side with one camera, which the view places", got="other cameras too",
                         remedy="leave cameras out, or the view")  # fmt: skip
    if isinstance(motion, str) and motion not in KINDS:
        raise InputError("motion: kind", expected=f"one of {', '.join(KINDS)}", got=repr(motion))
