"""A scene whose truth is known: a person who moves in a room, seen by cameras.

`demo_scene(seed)` is the scene of `muybridge demo`. Every picture depends on the scene and the frame alone, so frames
may be rendered in any order. The person is a skinned mesh, so no cone model fits exactly, and lens, noise, shadow and a
light that drifts are those of an ordinary room and camera.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from muybridge.cameras.model import Rig
from muybridge.errors import InputError
from muybridge.synthetic.motion import Motion, Recorded, Track, perform
from muybridge.synthetic.rasterise import LIGHT, Cloth, Layer, draw
from muybridge.synthetic.rigs import ring
from muybridge.synthetic.room import Room, picture
from muybridge.synthetic.shadow import floor_shade
from muybridge.synthetic.skinning import Figure, load_figure
from muybridge.synthetic.textures import Colour, clothing

EMPTY_FRAMES = -(2**20)  # frames of the empty scene draw their noise from here on, apart from the clip's


@dataclass(frozen=True)
class Garment:
    """Cloth on one label of the figure: pattern of `textures.PATTERNS`, BGR colours, tile size in metres."""

    label: str
    pattern: str
    colour: Colour
    second: Colour = (0, 0, 0)
    tile: float = 0.3


BARE = (
    Garment("skin", "smooth", (150, 176, 220), tile=0.5),
    Garment("hair", "denim", (42, 58, 84), tile=0.25),
    Garment("eyes", "plain", (90, 90, 90)),
    Garment("soles", "plain", (70, 74, 78)),
)
DEMO_OUTFIT = (
    Garment("shirt", "stripes", (58, 46, 176), (206, 210, 214), tile=0.28),
    Garment("trousers", "denim", (104, 66, 44), tile=0.4),
    Garment("shoes", "plain", (40, 40, 44)),
)
OUTFITS = (
    DEMO_OUTFIT,
    (
        Garment("shirt", "checks", (120, 84, 36), (70, 40, 24), tile=0.24),
        Garment("trousers", "plain", (58, 62, 66), tile=0.4),
        Garment("shoes", "plain", (150, 152, 158)),
    ),
    (
        Garment("shirt", "plain", (70, 116, 62), tile=0.4),
        Garment("trousers", "denim", (56, 50, 46), tile=0.4),
        Garment("shoes", "plain", (30, 36, 60)),
    ),
    (
        Garment("shirt", "blotches", (64, 44, 92), (150, 120, 176), tile=0.5),
        Garment("trousers", "denim", (120, 84, 58), tile=0.4),
        Garment("shoes", "plain", (60, 50, 46)),
    ),
)


@dataclass(frozen=True)
class Person:
    """Who does what, and what is worn.

    Parameters
    ----------
    figure : a baked person, "man" or "woman"
    motion : what is done
    outfit : garments; together with BARE they cover every label of the figure
    """

    figure: str = "man"
    motion: Motion | Recorded = field(default_factory=Motion)
    outfit: tuple[Garment, ...] = DEMO_OUTFIT


@dataclass(frozen=True)
class Scene:
    """Everything a scene is made from.

    Parameters
    ----------
    rig, room : who looks on, and where
    person : who is to be tracked
    noise : standard deviation of a grey value of 128, in grey values; it grows with the square root of the light
    drift : relative change of the light, up and down, over the clip
    shadow : 0 (none) to 1 (black): how dark the cast shadow is
    """

    rig: Rig
    person: Person = field(default_factory=Person)
    room: Room = field(default_factory=Room)
    noise: float = 3.0
    drift: float = 0.015
    shadow: float = 0.45
    seed: int = 0

    @property
    def frame_count(self) -> int:
        """How many frames the clip has."""
        return len(self.person.motion.times)


@dataclass(frozen=True, eq=False)
class Stage:
    """What `Scene` describes, made: figure, cloth, track, and the empty room of each camera."""

    figure: Figure
    cloth: Cloth
    track: Track
    plates: tuple[np.ndarray, ...]
    floors: tuple[np.ndarray, ...]


def demo_scene(seed: int = 0, *, duration: float = 3.0, rate: float = 30.0) -> Scene:
    """Somebody walks a bend through a room, seen whole by three cameras of 640 x 480.

    The seed decides who it is, what is worn, how and where they walk, where the cameras stand, and the noise.
    """
    rng = np.random.default_rng([seed, 20051])
    name = str(rng.choice(["man", "woman"]))
    outfit = OUTFITS[rng.integers(len(OUTFITS))]
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
        if _whole(rig, perform(figure, motion).joints):
            room = Room(floor=str(rng.choice(["planks", "planks", "tiles"])), seed=seed)
            return Scene(rig, Person(name, motion, outfit), room, seed=seed)
    raise InputError("demo scene", expected="a clip short enough to stay in view", got=f"{duration:g} s")


def _whole(rig: Rig, joints: np.ndarray, margin: float = 24.0) -> bool:
    """Whether all joints (T, J, 3) stay `margin` pixels inside every picture."""
    for camera in rig:
        pixels = camera.world_to_pixel(joints)
        if not ((pixels > margin) & (pixels < np.array(camera.size) - margin)).all():
            return False
    return True


def truth(scene: Scene) -> Track:
    """The true joints and bone frames of the clip."""
    return stage(scene).track


def figure_of(scene: Scene) -> Figure:
    """The person in the scene."""
    return stage(scene).figure


def render(scene: Scene, frame: int) -> tuple[tuple[np.ndarray, ...], tuple[np.ndarray, ...]]:
    """One frame.

    Returns
    -------
    images : one (H, W, 3) uint8 BGR a camera
    masks : one (H, W) bool a camera: the person covers at least half of the pixel
    """
    if not 0 <= frame < scene.frame_count:
        raise InputError("frame", expected=f"0 to {scene.frame_count - 1}", got=str(frame))
    made = stage(scene)
    figure, track = made.figure, made.track
    mesh = figure.mesh(track.rotations[frame], track.places[frame])
    shade = floor_shade(mesh.vertices, mesh.faces, LIGHT, scene.shadow)
    images, masks = [], []
    for index, camera in enumerate(scene.rig):
        layer = draw(camera, mesh, made.cloth)
        colours = shade.applied(made.plates[index], made.floors[index])
        images.append(_exposed(scene, _over(colours, layer), index, frame))
        masks.append(_mask(layer, camera.size))
    return tuple(images), tuple(masks)


def empty(scene: Scene, count: int = 1) -> Iterator[tuple[np.ndarray, ...]]:
    """`count` frames of the room without the person, as the cameras see them just before the clip."""
    made = stage(scene)
    for frame in range(count):
        yield tuple(_exposed(scene, plate, index, EMPTY_FRAMES + frame) for index, plate in enumerate(made.plates))


@lru_cache(maxsize=4)
def stage(scene: Scene) -> Stage:
    """Make everything that does not change from frame to frame; the last few scenes are kept."""
    figure = load_figure(scene.person.figure)
    rng = np.random.default_rng([scene.seed, 1])
    garments = {
        item.label: (item.pattern, item.colour, item.second, item.tile) for item in (*BARE, *scene.person.outfit)
    }
    cloth = clothing(rng, garments, figure.label_names)
    rooms = [picture(scene.room, camera) for camera in scene.rig]
    return Stage(
        figure,
        cloth,
        perform(figure, scene.person.motion),
        tuple(plate for plate, _ in rooms),
        tuple(floor for _, floor in rooms),
    )


def _over(background: np.ndarray, layer: Layer) -> np.ndarray:
    """The layer laid over a picture (H, W, 3) float32, which it changes."""
    left, top, right, bottom = layer.window
    part = background[top:bottom, left:right]
    part *= 1.0 - layer.coverage[..., None]
    part += layer.colours
    return background


def _mask(layer: Layer, size: tuple[int, int]) -> np.ndarray:
    """(H, W) bool."""
    mask = np.zeros((size[1], size[0]), dtype=bool)
    left, top, right, bottom = layer.window
    mask[top:bottom, left:right] = layer.coverage >= 0.5
    return mask


def _exposed(scene: Scene, colours: np.ndarray, camera: int, frame: int) -> np.ndarray:
    """(H, W, 3) uint8: the light's drift, then a sensor's noise: its variance grows with the light, plus a floor."""
    rng = np.random.default_rng([scene.seed, camera, frame - EMPTY_FRAMES])
    time = max(frame, 0) / scene.person.motion.rate
    gain = 1.0 + scene.drift * np.sin(2 * np.pi * time / max(scene.person.motion.duration, 1e-9))
    light = colours * np.float32(gain)
    deviation = np.sqrt(light * np.float32(0.75 / 128) + np.float32(0.25)) * np.float32(scene.noise)
    noise = rng.standard_normal(light.shape, dtype=np.float32)
    return np.clip(light + deviation * noise + 0.5, 0, 255).astype(np.uint8)
