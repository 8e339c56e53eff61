"""The empty room: a box with a floor of planks, tiles or carpet, painted walls with pictures, a door, and its light."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from muybridge.cameras.model import Camera
from muybridge.errors import InputError
from muybridge.synthetic.textures import Colour, smooth_noise

FLOORS = ("planks", "tiles", "carpet")


@dataclass(frozen=True)
class Room:
    """A box-shaped room around the world's origin, floor on z = 0.

    Parameters
    ----------
    half_width : metres: walls at x = +-half_width and y = +-half_width
    height : metres
    floor : "planks", "tiles" or "carpet"
    wall, floor_colour : BGR, 0-255
    clutter : how many things hang on each wall
    """

    half_width: float = 4.6
    height: float = 3.0
    floor: str = "planks"
    wall: Colour = (176, 190, 196)
    floor_colour: Colour = (96, 132, 164)
    clutter: int = 4
    seed: int = 0

    def __post_init__(self) -> None:
        if self.floor not in FLOORS:
            raise InputError("room: floor", expected=f"one of {', '.join(FLOORS)}", got=repr(self.floor))
        for name in ("half_width", "height"):
            if not (np.isfinite(getattr(self, name)) and getattr(self, name) > 0):
                raise InputError(f"room: {name}", expected="positive metres", got=str(getattr(self, name)))
        if self.clutter < 0:
            raise InputError("room: clutter", expected="0 or more things", got=str(self.clutter))


def picture(room: Room, camera: Camera, samples: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """The empty room in one camera.

    Returns
    -------
    colours : (H, W, 3) float32 BGR, 0-255
    floor : (H, W, 2) float32, metres: the floor's x and y in each pixel; NaN off the floor
    """
    width, height = camera.size
    fine = camera.scaled(samples)
    _, rays = fine.pixel_to_ray(_pixel_grid(width * samples, height * samples))
    colours = _traced(room, camera.position, rays.reshape(-1, 3))
    colours = colours.reshape(height, samples, width, samples, 3).mean(axis=(1, 3))
    _, rays = camera.pixel_to_ray(_pixel_grid(width, height))
    place, surface = _hits(room, camera.position, rays.reshape(-1, 3))
    floor = np.where((surface == 4)[:, None], place[:, :2], np.nan).reshape(height, width, 2)
    return colours.astype(np.float32), floor.astype(np.float32)


def relit(room: Room, camera: Camera, spot: tuple[float, float]) -> np.ndarray:
    """(H, W) float32: brightness with the lamps above `spot`, (x, y) metres, over that with the lamps in the middle."""
    width, height = camera.size
    _, rays = camera.pixel_to_ray(_pixel_grid(width, height))
    place, _ = _hits(room, camera.position, rays.reshape(-1, 3))
    return (_light(room, place, spot) / _light(room, place)).reshape(height, width).astype(np.float32)


def _pixel_grid(width: int, height: int) -> np.ndarray:
    """(H, W, 2) float64: the centre of every pixel."""
    return np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1).astype(np.float64)


def _hits(room: Room, origin: np.ndarray, rays: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where rays leave the box, (N, 3), and through which side: 0-3 walls -x +x -y +y, 4 floor, 5 ceiling."""
    low = np.array([-room.half_width, -room.half_width, 0.0])
    high = np.array([room.half_width, room.half_width, room.height])
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = np.where(rays > 0, (high - origin) / rays, (low - origin) / rays)
    reach = np.where(np.isfinite(reach), reach, np.inf)
    axis = reach.argmin(axis=1)
    rows = np.arange(len(rays))
    place = origin + rays * reach[rows, axis][:, None]
    return place, 2 * axis + (rays[rows, axis] > 0)


def _traced(room: Room, origin: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """(N, 3) colours seen along rays."""
    place, surface = _hits(room, origin, rays)
    colours = np.empty_like(place)
    for side in range(6):
        chosen = surface == side
        # The room looks the same from every camera: each surface has its own generator.
        rng = np.random.default_rng([room.seed, side])
        if side < 4:
            along = place[chosen][:, 1 if side < 2 else 0]
            colours[chosen] = _wall(rng, room, along, place[chosen][:, 2])
        elif side == 4:
            colours[chosen] = _floor(rng, room, place[chosen][:, :2])
        else:
            colours[chosen] = 215.0
    return np.clip(colours * _light(room, place)[:, None], 0, 255)


def _light(room: Room, place: np.ndarray, spot: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """(N,) brightness: lamps above a spot, corners and edges darker."""
    distance = np.linalg.norm(place - (*spot, room.height), axis=1)
    inward = np.sort(np.minimum(room.half_width - np.abs(place[:, :2]), 1.0), axis=1)
    edge = np.minimum(np.where(inward[:, 0] < 1e-6, inward[:, 1], inward[:, 0]), 1.0)
    corner = np.where(place[:, 2] < 1e-6, edge, np.minimum(edge, np.minimum(place[:, 2], 1.0)))
    return np.maximum(1.12 - 0.035 * distance, 0.4) * (0.80 + 0.20 * np.sqrt(np.clip(corner, 0, 1)))


def _floor(rng: np.random.Generator, room: Room, at: np.ndarray) -> np.ndarray:
    """(N, 3) colours of the floor at (N, 2) metres: boards with grain, tiles with joints, or carpet."""
    base = np.array(room.floor_colour, dtype=np.float64)
    if room.floor == "tiles":
        cell = np.floor(at / 0.5).astype(int)
        shade = 1 + 0.10 * np.where((cell.sum(axis=1) % 2) == 0, 1.0, -1.0)
        gap = (np.abs(at / 0.5 - np.round(at / 0.5)) < 0.012).any(axis=1)
        shade = shade + 0.06 * smooth_noise(rng, at, 0.2)
    elif room.floor == "carpet":
        shade = 1 + 0.04 * smooth_noise(rng, at, 0.03, 2) + 0.03 * smooth_noise(rng, at, 0.7)
        gap = np.zeros(len(at), dtype=bool)
    else:
        row = np.floor(at[:, 1] / 0.16).astype(int)
        offset = rng.uniform(0, 1.6, 512)[row % 512]
        board = np.floor((at[:, 0] + offset) / 1.6).astype(int)
        tone = rng.uniform(-1, 1, (512, 64))[row % 512, board % 64]
        shade = 1 + 0.11 * tone + 0.07 * smooth_noise(rng, at * (0.12, 1.0), 0.04) + 0.05 * smooth_noise(rng, at, 0.5)
        across = np.abs(at[:, 1] / 0.16 - np.round(at[:, 1] / 0.16)) < 0.02
        gap = across | (np.abs((at[:, 0] + offset) / 1.6 - np.round((at[:, 0] + offset) / 1.6)) < 0.0025)
    return base * np.where(gap, 0.62 * shade, shade)[:, None]


def _wall(rng: np.random.Generator, room: Room, along: np.ndarray, up: np.ndarray) -> np.ndarray:
    """(N, 3) colours of a wall: plaster, a skirting board, a door or shelf, and framed pictures."""
    at = np.stack([along, up], axis=1)
    colours = np.array(room.wall, dtype=np.float64) * (1 + 0.05 * smooth_noise(rng, at, 0.9, 4))[:, None]
    colours[up < 0.11] = np.array(room.wall) * 0.55
    for slot in range(room.clutter):
        middle = (slot + rng.uniform(0.25, 0.75)) / room.clutter * 2 * room.half_width - room.half_width
        tall = rng.uniform() < 0.35
        half, low, high = (rng.uniform(0.35, 0.5), 0.0, rng.uniform(1.7, 2.1)) if tall else (
            rng.uniform(0.2, 0.55), rng.uniform(0.9, 1.4), rng.uniform(1.7, 2.3))  # fmt: skip
        _hang(rng, colours, at, (middle - half, low, middle + half, high), tall)
    return colours


def _hang(rng: np.random.Generator, colours: np.ndarray, at: np.ndarray, box: tuple[float, ...], tall: bool) -> None:
    """Paint a rectangle (left, low, right, high) on the wall: a cupboard or door if `tall`, else a framed picture."""
    left, low, right, high = box
    inside = (at[:, 0] > left) & (at[:, 0] < right) & (at[:, 1] > low) & (at[:, 1] < high)
    edge = np.minimum.reduce([at[:, 0] - left, right - at[:, 0], at[:, 1] - low, high - at[:, 1]])
    first, second = _muted(rng.uniform(50, 200, 3)), _muted(rng.uniform(40, 220, 3))
    blots = smooth_noise(rng, at[inside], 0.5 if tall else 0.18)
    share = 0.06 * blots if tall else np.clip(0.5 + 1.2 * blots, 0, 1)
    colours[inside] = first + (second - first) * share[:, None]
    colours[inside & (edge < 0.035)] = first * 0.5


def _muted(colour: np.ndarray) -> np.ndarray:
    """A colour half way to its own grey: rooms are not painted in pure colours."""
    return 0.5 * (colour + colour.mean())
