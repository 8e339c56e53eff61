"""Things that stand in the room: boxes, pillars and tables, in the empty pictures as in the clip."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from muybridge.errors import InputError
from muybridge.synthetic.rasterise import Cloth, Mesh
from muybridge.synthetic.textures import PATTERNS, Colour, solid

KINDS = ("box", "table")
CELL = 0.06  # metres: sides are drawn in squares of this size, so that lens distortion bends their edges
TOP, LEG = 0.04, 0.06  # metres: thickness of a table's top and legs
NORMALS = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], dtype=np.float64)


@dataclass(frozen=True)
class Occluder:
    """A thing on the floor that hides what is behind it.

    Parameters
    ----------
    kind : "box" (a cupboard, a pillar, a crate: by its size) or "table"
    place : (x, y) metres, world: its middle
    size : (width, depth, height), metres
    turn : radians, counter-clockwise
    pattern, colour, second, tile : its surface, as a `Garment`'s
    since, until : seconds, from and until when it is there; None: always, in the empty frames too
    """

    kind: str = "box"
    place: tuple[float, float] = (0.0, 0.0)
    size: tuple[float, float, float] = (0.5, 0.5, 1.0)
    turn: float = 0.0
    pattern: str = "plain"
    colour: Colour = (88, 112, 138)
    second: Colour = (60, 80, 100)
    tile: float = 0.5
    since: float | None = None
    until: float | None = None

    def __post_init__(self) -> None:
        for name, value, known in (("kind", self.kind, KINDS), ("pattern", self.pattern, PATTERNS)):
            if value not in known:
                raise InputError(f"occluder: {name}", expected=f"one of {', '.join(known)}", got=repr(value))
        if not (np.isfinite(self.size).all() and min(self.size) > 0):
            raise InputError("occluder: size", expected="three positive lengths in metres", got=str(list(self.size)))
        if not np.isfinite((*self.place, self.turn)).all():
            raise InputError("occluder: place", expected="finite numbers", got=f"{self.place}, turn {self.turn}")

    def stands(self, time: float) -> bool:
        """Whether it is there at this time, seconds; before the clip begins time is negative."""
        return (self.since is None or self.since <= time) and (self.until is None or time < self.until)

    def distance(self, points: np.ndarray) -> np.ndarray:
        """(...,) metres, along the floor, from points (..., 2) to its outline; 0 inside."""
        cosine, sine = np.cos(self.turn), np.sin(self.turn)
        own = (np.asarray(points) - self.place) @ np.array([[cosine, -sine], [sine, cosine]])
        outside = np.maximum(np.abs(own) - np.array(self.size[:2]) / 2, 0.0)
        return np.linalg.norm(outside, axis=-1)

    def boxes(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Its boxes: middle (3,) and size (3,), metres, in its own frame, on z = 0."""
        width, depth, height = self.size
        if self.kind == "box":
            return [(np.array([0, 0, height / 2]), np.array([width, depth, height]))]
        found = [(np.array([0, 0, height - TOP / 2]), np.array([width, depth, TOP]))]
        for x in (-0.5, 0.5):
            for y in (-0.5, 0.5):
                foot = np.array([x * (width - LEG), y * (depth - LEG), (height - TOP) / 2])
                found.append((foot, np.array([LEG, LEG, height - TOP])))
        return found


def hides(thing: Occluder, eye: np.ndarray, points: np.ndarray) -> np.ndarray:
    """(...) bool: whether the line from the eye (3,) to each of points (..., 3), metres, passes through the thing."""
    cosine, sine = np.cos(thing.turn), np.sin(thing.turn)
    own = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1.0]])
    start = (np.asarray(eye) - (*thing.place, 0.0)) @ own
    way = (np.asarray(points) - (*thing.place, 0.0)) @ own - start
    found = np.zeros(way.shape[:-1], dtype=bool)
    for middle, size in thing.boxes():
        with np.errstate(divide="ignore", invalid="ignore"):
            sides = np.stack([(middle - size / 2 - start) / way, (middle + size / 2 - start) / way])
        enters, leaves = sides.min(axis=0).max(axis=-1), sides.max(axis=0).min(axis=-1)
        found |= (enters < leaves) & (leaves > 0) & (enters < 1)
    return found


def cloth_of(rng: np.random.Generator, occluders: Sequence[Occluder]) -> Cloth:
    """Their surfaces, one label each."""
    tiles = np.stack([solid(rng, thing.pattern, thing.colour, thing.second) for thing in occluders])
    return Cloth(np.ascontiguousarray(tiles), np.array([thing.tile for thing in occluders], dtype=np.float64))


def mesh_of(occluders: Sequence[Occluder], cell: float = CELL, time: float = -np.inf) -> Mesh | None:
    """Those that are there at `time`, seconds, as one mesh of squares up to `cell`, metres; None where none is.

    A face's part and label is its thing's index.
    """
    pieces = [
        (*_placed(thing, *_side(middle, size, normal, cell), normal), index)
        for index, thing in enumerate(occluders)
        if thing.stands(time)
        for middle, size in thing.boxes()
        for normal in NORMALS
    ]
    if not pieces:
        return None
    firsts = np.cumsum([0, *(len(piece[0]) for piece in pieces[:-1])])
    labels = np.concatenate([np.full(len(piece[3]), piece[4], dtype=np.int32) for piece in pieces])
    return Mesh(
        np.concatenate([piece[0] for piece in pieces]),
        np.concatenate([piece[2] for piece in pieces]),
        np.concatenate([piece[3] + first for piece, first in zip(pieces, firsts, strict=True)]).astype(np.int32),
        np.concatenate([piece[1] for piece in pieces]),
        labels,
        labels,
    )


def _side(middle: np.ndarray, size: np.ndarray, normal: np.ndarray, cell: float) -> tuple[np.ndarray, np.ndarray]:
    """One side of a box as a grid: vertices (V, 3), metres, and faces (F, 3), counter-clockwise seen from outside."""
    axis = int(np.argmax(np.abs(normal)))
    first, second = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3]
    if normal[axis] < 0:
        first, second = second, first
    counts = [max(1, int(np.ceil(abs(direction @ size) / cell))) for direction in (first, second)]
    u, v = np.meshgrid(*(np.linspace(-0.5, 0.5, count + 1) for count in counts), indexing="ij")
    vertices = middle + size * (0.5 * normal + u[..., None] * first + v[..., None] * second)
    corner = np.arange(vertices[..., 0].size).reshape(u.shape)
    a, b, c, d = (part.ravel() for part in (corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]))
    return vertices.reshape(-1, 3), np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def _placed(
    thing: Occluder, vertices: np.ndarray, faces: np.ndarray, normal: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """World vertices, material, normals (all (V, 3)), and the faces."""
    cosine, sine = np.cos(thing.turn), np.sin(thing.turn)
    turn = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1.0]])
    world = vertices @ turn.T + (*thing.place, 0.0)
    return world, vertices, np.tile(turn @ normal, (len(vertices), 1)), faces
