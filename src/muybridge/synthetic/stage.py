"""A scene's parts, made once: people who move, and the empty room of each camera between the scene's changes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from muybridge.cameras.model import Camera
from muybridge.synthetic.compose import lay_over
from muybridge.synthetic.description import Person, Scene
from muybridge.synthetic.light import Lamp
from muybridge.synthetic.motion import Track, perform
from muybridge.synthetic.occluders import cloth_of, mesh_of
from muybridge.synthetic.outfits import completed
from muybridge.synthetic.posture import mesh_at
from muybridge.synthetic.rasterise import Cloth, Layer, Mesh, draw
from muybridge.synthetic.room import picture, relit
from muybridge.synthetic.shadow import CELL, FloorShade, floor_shade
from muybridge.synthetic.skinning import Figure
from muybridge.synthetic.textures import clothing


@dataclass(frozen=True, eq=False)
class Actor:
    """A person, made: figure, cloth, and where each bone is in each frame."""

    figure: Figure
    cloth: Cloth
    track: Track
    looseness: float

    def mesh(self, frame: float) -> Mesh:
        """The person at a frame number that need not be whole."""
        return mesh_at(self.figure, self.track, frame, self.looseness)


@dataclass(frozen=True, eq=False)
class Decor:
    """What does not move, between two changes of the scene; one entry a camera.

    Parameters
    ----------
    rooms : (H, W, 3) float32 each: the bare room
    things : the occluders, drawn; none where there are none
    plates : (H, W, 3) float32 each: room, occluders and their shadows: what an empty frame shows
    solids : vertices (V, 3) and faces (F, 3) of the occluders, for their shadows; none where there are none
    """

    rooms: tuple[np.ndarray, ...]
    things: tuple[tuple[Layer, ...], ...]
    plates: tuple[np.ndarray, ...]
    solids: tuple[tuple[np.ndarray, np.ndarray], ...]

    def shade(self, meshes: list[Mesh], lamp: Lamp, strength: float, cell: float = CELL) -> FloorShade:
        """The shadow of people and things together on the floor, in cells of this size, metres."""
        return _shade([*((mesh.vertices, mesh.faces) for mesh in meshes), *self.solids], lamp, strength, cell)


@dataclass(frozen=True, eq=False)
class Stage:
    """What a scene describes, made.

    Parameters
    ----------
    actors : the person to be tracked first
    decors : before the first change of the scene (`Scene.changes`), and after each
    floors : (H, W, 2) float32 a camera, metres: the floor's x and y in each pixel; NaN off the floor
    """

    actors: tuple[Actor, ...]
    decors: tuple[Decor, ...]
    floors: tuple[np.ndarray, ...]

    @property
    def plates(self) -> tuple[np.ndarray, ...]:
        """(H, W, 3) float32 a camera: the empty scene before anything is switched."""
        return self.decors[0].plates


@lru_cache(maxsize=4)
def stage(scene: Scene) -> Stage:
    """Make everything that does not change from frame to frame; the last few scenes are kept."""
    rooms = [picture(scene.room, camera) for camera in scene.rig]
    floors = tuple(floor for _, floor in rooms)
    bare = tuple(plate for plate, _ in rooms)
    decors = tuple(_decor(scene, epoch, bare, floors) for epoch in range(len(scene.changes) + 1))
    return Stage(actors(scene), decors, floors)


@lru_cache(maxsize=4)
def actors(scene: Scene) -> tuple[Actor, ...]:
    """The people of a scene alone, the person to be tracked first: without rooms, in a fraction of the time."""
    return tuple(_actor(scene, index, person) for index, person in enumerate(scene.people))


@lru_cache(maxsize=64)
def things(scene: Scene, epoch: int) -> tuple[tuple[Layer, ...], ...]:
    """The occluders between two changes of the scene, drawn for each camera; none where there are none."""
    time = _begin(scene, epoch)
    mesh = mesh_of(scene.occluders, time=time)
    if mesh is None:
        return tuple(() for _ in scene.rig)
    cloth = cloth_of(np.random.default_rng([scene.seed, 2]), scene.occluders)
    light = np.array(scene.light.lamps[scene.light.state(time)].direction)
    return tuple((draw(camera, mesh, cloth, light=light),) for camera in scene.rig)


def _begin(scene: Scene, epoch: int) -> float:
    """Seconds: when an epoch of the scene begins; the first has no beginning."""
    return scene.changes[epoch - 1] if epoch else -np.inf


def _actor(scene: Scene, index: int, person: Person) -> Actor:
    figure = person.load()
    rng = np.random.default_rng([scene.seed, 1, index] if index else [scene.seed, 1])
    garments = {item.label: (item.pattern, item.colour, item.second, item.tile) for item in completed(person.outfit)}
    cloth = clothing(rng, garments, figure.label_names)
    return Actor(figure, cloth, perform(figure, person.motion), person.looseness)


def _decor(scene: Scene, epoch: int, bare: tuple[np.ndarray, ...], floors: tuple[np.ndarray, ...]) -> Decor:
    time = _begin(scene, epoch)
    lamp, drawn = scene.light.lamps[scene.light.state(time)], things(scene, epoch)
    rooms = tuple(_under(scene, camera, plate, lamp) for camera, plate in zip(scene.rig, bare, strict=True))
    coarse = mesh_of(scene.occluders, cell=np.inf, time=time)
    if coarse is None:
        return Decor(rooms, drawn, rooms, ())
    solids = ((coarse.vertices, coarse.faces),)
    shade = _shade(list(solids), lamp, scene.shadow)
    plates = tuple(shade.applied(room, floor) for room, floor in zip(rooms, floors, strict=True))
    for plate, layers in zip(plates, drawn, strict=True):
        lay_over(plate, layers)
    return Decor(rooms, drawn, plates, solids)


def _shade(pieces: list[tuple[np.ndarray, np.ndarray]], lamp: Lamp, strength: float, cell: float = CELL) -> FloorShade:
    return floor_shade(*_joined(pieces), np.array(lamp.direction), strength, cell)


def _under(scene: Scene, camera: Camera, plate: np.ndarray, lamp: Lamp) -> np.ndarray:
    """The bare room with its lamps where this lamp's spot is."""
    return plate if lamp.spot == (0.0, 0.0) else plate * relit(scene.room, camera, lamp.spot)[..., None]


def _joined(pieces: list[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Several meshes as one: vertices (V, 3) and faces (F, 3)."""
    if not pieces:
        return np.zeros((1, 3)), np.zeros((0, 3), dtype=np.int32)
    if len(pieces) == 1:
        return pieces[0]
    firsts = np.cumsum([0, *(len(vertices) for vertices, _ in pieces[:-1])])
    faces = [faces + first for (_, faces), first in zip(pieces, firsts, strict=True)]
    return np.concatenate([vertices for vertices, _ in pieces]), np.concatenate(faces).astype(np.int32)
