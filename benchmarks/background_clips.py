"""Clips of changing scenes with exact masks, for `background_models.py`: rendered people before backgrounds that move.

A clip is a background (a rendered room, or a texture made here, as a function of time) over which the package's own
figures are drawn. Everything follows from the seed. Truth is what a person covers by at least half; pixels that a
person covers in part (5 to 95 %) count nowhere. Some of the people wear the colours of what is behind them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import cv2
import numpy as np

from muybridge.cameras.model import Camera, Rig
from muybridge.synthetic.compose import lay_over
from muybridge.synthetic.description import Person, Scene
from muybridge.synthetic.motion import Motion
from muybridge.synthetic.outfits import Garment
from muybridge.synthetic.presets import preset_scene
from muybridge.synthetic.rasterise import draw
from muybridge.synthetic.rigs import looking_at
from muybridge.synthetic.sensor import exposed
from muybridge.synthetic.stage import Actor, stage

SIZE = (320, 240)
RATE = 30.0
PASS = 5.0  # seconds of a walk through the picture
LAMP = np.array([0.35, -0.45, 0.82])


class Frame(NamedTuple):
    """One picture with its truth."""

    image: np.ndarray
    """(H, W, 3) uint8 BGR."""
    truth: np.ndarray
    """(H, W) bool."""
    counted: np.ndarray
    """(H, W) bool: False on the outline, where a pixel is both."""


@dataclass(frozen=True)
class Clip:
    """Frames to learn from, in which people may pass, then frames to be scored."""

    name: str
    learn: int
    test: int
    make: Callable[[], Iterator[Frame]]


@dataclass(frozen=True)
class Visit:
    """Somebody in the picture from `start` (seconds) on; `slow`: how fast the motion is played."""

    start: float
    actor: Actor
    duration: float = PASS
    speed: float = 1.0

    def frame(self, time: float) -> float | None:
        """The frame number of the motion, which goes to and fro where the visit is longer; None where nobody is
        there."""
        if not self.start <= time < self.start + self.duration:
            return None
        last = len(self.actor.track.times) - 1
        along = (time - self.start) * RATE * self.speed
        return float(last - abs(last - along % (2 * last)))


def camera_of(rng: np.random.Generator) -> Camera:
    place = np.array([rng.uniform(-0.4, 0.4), -4.3, rng.uniform(1.7, 2.4)])
    return looking_at("cam1", place, np.array([0.0, 0.0, 0.9]), focal=0.92 * SIZE[0], size=SIZE)


def room_of(seed: int) -> Scene:
    """A studio with one camera; its person is not used."""
    rng = np.random.default_rng([seed, 77])
    motion = Motion("wave", 1.0, RATE)
    return preset_scene("studio", seed=seed, motion=motion, rig=Rig((camera_of(rng),)))


def actor_of(scene: Scene, seed: int, motion: Motion, plate: np.ndarray | None = None) -> Actor:
    """Somebody else; with a `plate` (H, W, 3) dressed in two of its colours."""
    made = preset_scene("studio", seed=seed, motion=motion, rig=scene.rig)
    person: Person = made.person
    if plate is not None:
        rng = np.random.default_rng([seed, 78])
        rows = plate[40:200].reshape(-1, 3)
        picks = np.clip(rows[rng.integers(len(rows), size=3)] + rng.normal(0, 8, (3, 3)), 0, 255)
        colours = [tuple(int(v) for v in pick) for pick in picks]
        person = replace(person, outfit=(
            *person.outfit,
            Garment("shirt", "plain", colours[0], colours[1], 0.4),
            Garment("trousers", "denim", colours[1], colours[2], 0.4),
        ))  # fmt: skip
    return stage(replace(made, person=person)).actors[0]


def walk(rng: np.random.Generator, seed: int) -> Motion:
    """Across the picture, one way or the other, out of sight at both ends."""
    heading = float(rng.choice([0.0, np.pi])) + rng.uniform(-0.15, 0.15)
    place = (float(rng.uniform(-0.3, 0.3)), float(rng.uniform(-0.9, 1.2)))
    return Motion("walk", PASS, RATE, heading=heading, place=place, seed=seed)


def visits(scene: Scene, seed: int, starts: list[float], plate: np.ndarray) -> list[Visit]:
    """Walks from these times on, in the colours of the plate."""
    rng = np.random.default_rng([seed, 79])
    return [
        Visit(start, actor_of(scene, 1000 * seed + number, walk(rng, number), plate))
        for number, start in enumerate(starts)
    ]


def play(
    seed: int,
    seconds: float,
    scene: Scene,
    background: Callable[[float], np.ndarray],
    people: list[Visit],
    *,
    noise: float = 3.0,
    shadow: float = 0.0,
    gain: Callable[[float], float] = lambda time: 1.0,
) -> Iterator[Frame]:
    """Draw people over the background, frame by frame, and let the sensor add its noise."""
    made = stage(scene)
    camera = scene.rig.cameras[0]
    for number in range(round(seconds * RATE)):
        time = number / RATE
        picture = background(time).astype(np.float32, copy=True)
        covered = np.zeros(picture.shape[:2], np.float32)
        for visit in people:
            moment = visit.frame(time)
            if moment is None:
                continue
            mesh = visit.actor.mesh(moment)
            if shadow:
                picture = made.shade([mesh], _lamp(), shadow).applied(picture, made.floors[0])
            covered = np.maximum(covered, lay_over(picture, [draw(camera, mesh, visit.actor.cloth, light=LAMP)]))
        image = exposed(picture, np.float32(gain(time)), noise, np.random.default_rng([seed, 80, number]))
        yield Frame(image, covered >= 0.5, (covered <= 0.05) | (covered >= 0.95))


def _lamp():
    from muybridge.synthetic.light import Lamp

    return Lamp(direction=tuple(LAMP))


def calm(seed: int, learn: float = 20.0, test: float = 10.0) -> Clip:
    """A room whose light drifts by 2 %."""

    def make() -> Iterator[Frame]:
        scene = room_of(seed)
        plate = stage(scene).plates[0]
        people = visits(scene, seed, [learn, learn + PASS], plate)
        return play(seed, learn + test, scene, lambda t: plate, people, shadow=0.25,
                    gain=lambda t: 1 + 0.02 * np.sin(2 * np.pi * t / 17))  # fmt: skip

    return Clip(f"calm-{seed}", round(learn * RATE), round(test * RATE), make)


def _grid() -> tuple[np.ndarray, np.ndarray]:
    return np.meshgrid(np.arange(SIZE[0], dtype=np.float32), np.arange(SIZE[1], dtype=np.float32))


def _toggles(rng: np.random.Generator, seconds: float, shortest: float, longest: float) -> np.ndarray:
    """Times of switching, evenly spread by chance."""
    return np.cumsum(rng.uniform(shortest, longest, int(seconds / shortest) + 2))


def lamp(seed: int, learn: float = 20.0, test: float = 10.0) -> Clip:
    """A lamp beside a wall that somebody switches on and off, off most of the time."""

    def make() -> Iterator[Frame]:
        rng = np.random.default_rng([seed, 81])
        scene = room_of(seed)
        plate = stage(scene).plates[0]
        x, y = _grid()
        at = rng.uniform(0.2, 0.8) * SIZE[0], rng.uniform(0.15, 0.45) * SIZE[1]
        glow = np.exp(-((x - at[0]) ** 2 + (y - at[1]) ** 2) / (2 * (0.28 * SIZE[0]) ** 2))
        tint = np.array([0.55, 0.9, 1.15]) * rng.uniform(0.4, 0.7)
        lit = plate * (1 + glow[..., None] * tint).astype(np.float32)
        pairs = _toggles(rng, learn + test, 1.2, 2.8)
        people = visits(scene, seed, [6.0, learn, learn + PASS], plate)
        return play(seed, learn + test, scene, lambda t: lit if (pairs <= t).sum() % 3 == 1 else plate, people)

    return Clip(f"lamp-{seed}", round(learn * RATE), round(test * RATE), make)


def _texture(rng: np.random.Generator, size: tuple[int, int], grain: float, octaves: int = 3) -> np.ndarray:
    """(H, W) float32 in about [-1, 1]: blots of `grain` pixels and finer."""
    total = np.zeros((size[1], size[0]), np.float32)
    for octave in range(octaves):
        noise = rng.standard_normal(total.shape).astype(np.float32)
        soft = cv2.GaussianBlur(noise, (0, 0), grain / 2**octave)
        total += soft / soft.std() / 2**octave
    return total / np.abs(total).max() * 1.6


def door(seed: int, learn: float = 20.0, test: float = 10.0) -> Clip:
    """A door that swings open and shut; behind it a bright corridor."""

    def make() -> Iterator[Frame]:
        rng = np.random.default_rng([seed, 82])
        scene = room_of(seed)
        plate = stage(scene).plates[0].copy()
        left, top = int(rng.uniform(0.2, 0.55) * SIZE[0]), int(0.12 * SIZE[1])
        width, height = int(rng.uniform(0.2, 0.27) * SIZE[0]), int(0.62 * SIZE[1])
        leaf = np.array(rng.uniform(40, 130, 3)) * (1 + 0.08 * _texture(rng, (width, height), 6.0)[..., None])
        beyond = np.array(rng.uniform(120, 215, 3)) * (1 + 0.12 * _texture(rng, (width, height), 12.0)[..., None])
        beyond[:, : width // 3] *= 0.8
        times = _toggles(rng, learn + test, 1.0, 2.6)
        spot = slice(top, top + height), slice(left, left + width)

        def background(t: float) -> np.ndarray:
            """Open by 1 after an odd number of switches; a swing takes 0.4 s."""
            count = int((times <= t).sum())
            since = t - times[count - 1] if count else 9.0
            part = min(since / 0.4, 1.0)
            opened = part if count % 2 else 1 - part
            seen = max(2, round(width * (1 - 0.9 * opened)))
            picture = plate.copy()
            picture[spot] = beyond
            narrow = cv2.resize(leaf.astype(np.float32), (seen, height), interpolation=cv2.INTER_AREA)
            picture[top : top + height, left : left + seen] = narrow * (1 - 0.25 * opened)
            return picture

        people = visits(scene, seed, [6.0, learn, learn + PASS], plate)
        return play(seed, learn + test, scene, background, people)

    return Clip(f"door-{seed}", round(learn * RATE), round(test * RATE), make)


def leaves(seed: int, learn: float = 20.0, test: float = 10.0) -> Clip:
    """Foliage that sways in gusts over most of the picture; people in its colours walk before it."""

    def make() -> Iterator[Frame]:
        rng = np.random.default_rng([seed, 83])
        scene = room_of(seed)
        wide = (SIZE[0] + 40, SIZE[1] + 40)
        tone, gap = _texture(rng, wide, rng.uniform(5, 9)), _texture(rng, wide, rng.uniform(8, 14), 2)
        leaf = np.array([45.0, 105.0, 70.0]) * (1 + 0.45 * tone[..., None])
        tree = np.where(gap[..., None] > 0.25, np.array([205.0, 200.0, 185.0]), np.clip(leaf, 5, 220))
        tree = cv2.GaussianBlur(tree.astype(np.float32), (0, 0), 0.8)
        x, y = _grid()
        bend = np.clip((0.8 * SIZE[1] - y) / SIZE[1], 0, 1).astype(np.float32)
        phases, speeds = rng.uniform(0, 2 * np.pi, (2, 4)), rng.uniform(0.25, 1.1, (2, 4))
        patch = [[_texture(rng, SIZE, 40.0, 1) for _ in range(2)] for _ in range(2)]

        def background(t: float) -> np.ndarray:
            sway = np.sin(2 * np.pi * speeds * t + phases)
            across = 7 * sway[0, 0] + 4 * sway[0, 1] * patch[0][0] + 3 * sway[0, 2] * patch[0][1]
            down = 2 * sway[1, 0] + 2 * sway[1, 1] * patch[1][0] + 1.5 * sway[1, 2] * patch[1][1]
            column, line = (x + 20 + bend * across), (y + 20 + bend * down)
            return cv2.remap(tree, column.astype(np.float32), line.astype(np.float32), cv2.INTER_LINEAR)

        people = visits(scene, seed, [6.0, learn, learn + PASS], background(0.0))
        return play(seed, learn + test, scene, background, people)

    return Clip(f"leaves-{seed}", round(learn * RATE), round(test * RATE), make)


def water(seed: int, learn: float = 20.0, test: float = 10.0) -> Clip:
    """A pool over the lower two thirds: waves move through it, with bright crests."""

    def make() -> Iterator[Frame]:
        rng = np.random.default_rng([seed, 84])
        scene = room_of(seed)
        plate = stage(scene).plates[0]
        x, y = _grid()
        waves = []
        for _ in range(7):
            angle, length = rng.uniform(-0.6, 0.6) + np.pi / 2, rng.uniform(9, 40)
            waves.append((2 * np.pi / length * np.cos(angle), 2 * np.pi / length * np.sin(angle),
                          2 * np.pi * rng.uniform(0.3, 1.0), rng.uniform(0, 7), rng.uniform(0.5, 1)))  # fmt: skip
        base = np.array([120.0, 105.0, 80.0]) * rng.uniform(0.8, 1.2)
        edge = np.clip((y - 0.35 * SIZE[1]) / 6, 0, 1)[..., None]

        def background(t: float) -> np.ndarray:
            level = sum(a * np.sin(kx * x + ky * y - w * t + p) for kx, ky, w, p, a in waves) / 2.2
            pool = base * (1 + 0.30 * level[..., None]) + 70 * np.clip(level - 0.75, 0, 1)[..., None]
            return plate * (1 - edge) + pool * edge

        people = visits(scene, seed, [6.0, learn, learn + PASS], background(0.0))
        return play(seed, learn + test, scene, background, people)

    return Clip(f"water-{seed}", round(learn * RATE), round(test * RATE), make)


def linger(seed: int, learn: float = 20.0, stay: float = 60.0, still: bool = False) -> Clip:
    """Somebody comes into a room whose lamp flickers a little, and stays for a minute; then the room is empty again."""

    def make() -> Iterator[Frame]:
        scene = room_of(seed)
        plate = stage(scene).plates[0]
        actor = actor_of(scene, 1000 * seed, Motion("turn" if not still else "wave", 4.0, RATE, turn_rate=0.5))
        people = [Visit(learn + 1.0, actor, stay, 0.0 if still else 0.35)]
        return play(seed, learn + stay + 3.0, scene, lambda t: plate, people, shadow=0.2,
                    gain=lambda t: 1 + 0.01 * np.sin(2 * np.pi * t / 7))  # fmt: skip

    return Clip(f"linger{'-still' * still}-{seed}", round(learn * RATE), round((stay + 3.0) * RATE), make)


CLIPS: dict[str, Callable[[int], Clip]] = {
    "calm": calm,
    "lamp": lamp,
    "door": door,
    "leaves": leaves,
    "water": water,
    "linger": linger,
}
