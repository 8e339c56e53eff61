"""A scene whose truth is known: a person who moves in a room, seen by cameras.

`demo_scene(seed)` is the scene of `muybridge demo`; `presets.preset_scene` makes easier and harder ones. Every picture
depends on the scene and the frame alone, so frames may be rendered in any order. The person is a skinned mesh, so no
cone model fits exactly, and lens, noise, shadow and a light that drifts are those of an ordinary room and camera.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from muybridge.cameras.model import Camera
from muybridge.errors import InputError
from muybridge.synthetic.compose import depth_map, lay_over
from muybridge.synthetic.description import Person, Scene
from muybridge.synthetic.light import Lamp, drift_gain
from muybridge.synthetic.motion import Motion, Track, perform
from muybridge.synthetic.outfits import DEMO_OUTFITS
from muybridge.synthetic.placing import whole
from muybridge.synthetic.rasterise import Layer, Mesh, draw
from muybridge.synthetic.rigs import ring
from muybridge.synthetic.room import Room
from muybridge.synthetic.sensor import exposed
from muybridge.synthetic.shadow import FloorShade
from muybridge.synthetic.skinning import Figure, load_figure
from muybridge.synthetic.stage import Actor, Stage, actors, stage, things
from muybridge.synthetic.visibility import segment_of_bone, visible_shares

EMPTY_FRAMES = -(2**20)  # frames of the empty scene draw their noise from here on, apart from the clip's
#: Pixels: where the single sample of each of an open shutter's pictures lies, so that together they smooth edges.
JITTER = ((-0.25, -0.25), (0.25, 0.25), (0.25, -0.25), (-0.25, 0.25))


@dataclass(frozen=True, eq=False)
class Shot:
    """One frame of one camera.

    Parameters
    ----------
    image : (H, W, 3) uint8 BGR
    mask : (H, W) bool: the person to be tracked is seen in at least half of the pixel
    visible : (S,) float64 in 0-1, the visible share of each of `skinning.SEGMENTS`; none where it was not asked for
    """

    image: np.ndarray
    mask: np.ndarray
    visible: np.ndarray


def demo_scene(seed: int = 0, *, duration: float = 3.0, rate: float = 30.0) -> Scene:
    """Somebody walks a bend through a room, seen whole by three cameras of 640 x 480.

    The seed decides who it is, what is worn, how and where they walk, where the cameras stand, and the noise.
    """
    rng = np.random.default_rng([seed, 20051])
    name = str(rng.choice(["man", "woman"]))
    outfit = DEMO_OUTFITS[rng.integers(len(DEMO_OUTFITS))]
    figure = load_figure(name)
    for _ in range(200):
        motion = Motion(
            "walk",
            duration,
            rate,
            heading=rng.uniform(-np.pi, np.pi),
            turn_rate=float(rng.choice([-1.0, 1.0])) * rng.uniform(0.35, 0.6),
            cadence=rng.uniform(0.80, 0.92),
            vigour=rng.uniform(0.92, 1.05),
            seed=seed,
        )
        rig = ring(rng, 3)
        if whole(rig, perform(figure, motion).joints):
            room = Room(floor=str(rng.choice(["planks", "planks", "tiles"])), seed=seed)
            return Scene(rig, Person(name, motion, outfit), room, seed=seed)
    raise InputError("demo scene", expected="a clip short enough to stay in view", got=f"{duration:g} s")


def truth(scene: Scene) -> Track:
    """The true joints and bone frames of the clip."""
    return actors(scene)[0].track


def figure_of(scene: Scene) -> Figure:
    """The person in the scene."""
    return actors(scene)[0].figure


def render(scene: Scene, frame: int) -> tuple[tuple[np.ndarray, ...], tuple[np.ndarray, ...]]:
    """One frame.

    Returns
    -------
    images : one (H, W, 3) uint8 BGR a camera
    masks : one (H, W) bool a camera: the person is seen in at least half of the pixel
    """
    shots = shoot(scene, frame)
    return tuple(shot.image for shot in shots), tuple(shot.mask for shot in shots)


def shoot(scene: Scene, frame: int, *, visibility: bool = False) -> tuple[Shot, ...]:
    """One frame of every camera, with the visible share of each segment where it is asked for."""
    if not 0 <= frame < scene.frame_count:
        raise InputError("frame", expected=f"0 to {scene.frame_count - 1}", got=str(frame))
    made = stage(scene)
    now = [actor.mesh(frame) for actor in made.actors]
    shade = made.decors[scene.epoch(frame / scene.rate)].shade(now, _lamp(scene, frame), scene.shadow)
    shots = []
    for index, camera in enumerate(scene.rig):
        image, shares, layers = film(scene, made, index, frame, now, shade)
        things = made.decors[scene.epoch(frame / scene.rate)].things[index]
        visible = _visible(camera, made, now, layers, things) if visibility else np.zeros(0)
        shots.append(Shot(image, shares[0] >= 0.5, visible))
    return tuple(shots)


def film(
    scene: Scene, made: Stage, index: int, frame: int, now: list[Mesh], shade: FloorShade
) -> tuple[np.ndarray, np.ndarray, list[Layer]]:
    """One frame of one camera.

    Parameters
    ----------
    made : the scene's stage, with the actors that are to be drawn
    index : of the camera
    now : the actors in the middle of the exposure; shade : their shadow

    Returns
    -------
    image : (H, W, 3) uint8 BGR
    shares : (L, H, W) float32 in 0-1: how much of each pixel shows each actor, and then each layer of things
    layers : the actors, drawn; none for an open shutter
    """
    time = frame / scene.rate
    decor = made.decors[scene.epoch(time)]
    backdrop = shade.applied(decor.rooms[index], made.floors[index])
    moments = _moments(scene, made, frame, now)
    colours, shares, layers = _filmed(
        scene.rig[index], made, moments, backdrop, decor.things[index], _lamp(scene, frame)
    )
    return _developed(scene, colours, index, frame, time), shares, layers


def _lamp(scene: Scene, frame: int) -> Lamp:
    return scene.light.lamps[scene.light.state(frame / scene.rate)]


def silhouettes(scene: Scene, frame: int) -> tuple[np.ndarray, ...]:
    """One (H, W) bool a camera: the person is seen in at least half of the pixel in the middle of the exposure.

    The masks of `render` for a shutter that is not open, without the pictures and in a fraction of the time.
    """
    people, standing = actors(scene), things(scene, scene.epoch(frame / scene.rate))
    now = [actor.mesh(frame) for actor in people]
    masks = []
    for index, camera in enumerate(scene.rig):
        layers = [*_drawn(camera, people, now, _lamp(scene, frame)), *standing[index]]
        width, height = camera.size
        masks.append(lay_over(np.zeros((height, width, 3), dtype=np.float32), layers)[0] >= 0.5)
    return tuple(masks)


def empty(scene: Scene, count: int = 1) -> Iterator[tuple[np.ndarray, ...]]:
    """`count` frames of the scene without people, as the cameras see them just before the clip, the latest first."""
    made = stage(scene)
    for frame in range(count):
        time = -(frame + 1) / scene.rate
        yield tuple(
            _developed(scene, plate, index, EMPTY_FRAMES + frame, time) for index, plate in enumerate(made.plates)
        )


def _moments(scene: Scene, made: Stage, frame: int, now: list[Mesh]) -> list[list[Mesh]]:
    """Everybody's mesh at each moment of the open shutter."""
    if scene.sensor.shutter == 0:
        return [now]
    return [[actor.mesh(frame + moment) for actor in made.actors] for moment in scene.sensor.moments]


def _filmed(
    camera: Camera,
    made: Stage,
    moments: list[list[Mesh]],
    backdrop: np.ndarray,
    things: tuple[Layer, ...],
    lamp: Lamp,
) -> tuple[np.ndarray, np.ndarray, list[Layer]]:
    """Light (H, W, 3) and how much of each pixel is each layer (L, H, W), over the open shutter; a moment's layers."""
    if len(moments) == 1:
        layers = _drawn(camera, made.actors, moments[0], lamp)
        return backdrop, lay_over(backdrop, [*layers, *things]), layers
    light = np.zeros_like(backdrop)
    seen = np.zeros((len(made.actors) + len(things), *backdrop.shape[:2]), dtype=np.float32)
    for number, meshes in enumerate(moments):
        shifted = camera.shifted(*JITTER[number % len(JITTER)])
        layers = _drawn(shifted, made.actors, meshes, lamp, samples=1)
        picture = backdrop.copy()
        seen += lay_over(picture, [*layers, *things])
        light += picture
    share = np.float32(1 / len(moments))
    return light * share, seen * share, []


def _drawn(camera: Camera, people: tuple[Actor, ...], meshes: list[Mesh], lamp: Lamp, samples: int = 2) -> list[Layer]:
    light = np.array(lamp.direction)
    return [
        draw(camera, mesh, actor.cloth, light=light, samples=samples)
        for mesh, actor in zip(meshes, people, strict=True)
    ]


def _visible(
    camera: Camera, made: Stage, meshes: list[Mesh], layers: list[Layer], things: tuple[Layer, ...]
) -> np.ndarray:
    """(S,) visible shares in the middle of the exposure."""
    layers = layers or _drawn(camera, made.actors, meshes, Lamp())
    before = depth_map([*layers[1:], *things], camera.size)
    return visible_shares(camera, meshes[0], layers[0], before, segment_of_bone(made.actors[0].figure.bone_names))


def _developed(scene: Scene, colours: np.ndarray, camera: int, frame: int, time: float) -> np.ndarray:
    """(H, W, 3) uint8: the picture under the light and exposure of its time, with its own noise."""
    rng = np.random.default_rng([scene.seed, camera, frame - EMPTY_FRAMES])
    return exposed(colours, _gain(scene, camera, time, len(colours)), scene.noise, rng)


def _gain(scene: Scene, camera: int, time: float, height: int) -> np.ndarray | np.float32:
    """Light times exposure: one number, or one a row where the exposure wanders while the rows are read."""
    sensor, light = scene.sensor, scene.light
    gain = drift_gain(scene.drift, max(time, 0.0), scene.person.motion.duration)
    gain *= light.lamps[light.state(time)].gain
    gain *= (light.lagged_gain(time, sensor.lag) / light.lamp.gain) ** -sensor.automatic
    if sensor.exposure == 0:
        return np.float32(gain)
    times = sensor.row_times(time, scene.rate, height)
    rows = gain * sensor.wander(scene.seed, camera, times)
    return rows.astype(np.float32)[:, None, None]
