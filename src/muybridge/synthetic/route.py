"""A walk through points of the floor, with stops: who comes in, lingers, and goes.

A stop is a point at which one stands for a while; between two stops lies a leg, a line whose corners are rounded. Along
a leg people speed up, walk at the pace of their legs, and slow down. The strides done follow from the distance, so feet
slip little; standing still, the gait's angles fade to those of standing. At the longest stop one may go down and up
again (`lowered`): the feet then stay where they are.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from muybridge.synthetic.angles import rotations
from muybridge.synthetic.clip import LOWERED, Motion
from muybridge.synthetic.gaits import standing, walk
from muybridge.synthetic.limbs import SIDES
from muybridge.synthetic.lowered import lower
from muybridge.synthetic.planting import lowest, planted, smoothed, sole
from muybridge.synthetic.skinning import Figure

ACCELERATION = 1.2  # metres a second squared
STEP = 0.05  # metres between the points of a leg
ROUNDING = 0.25  # metres, standard deviation with which corners are rounded
TURNING = 0.2  # seconds, standard deviation with which a change of heading is spread
STRIDES = 3  # walked to measure one


@dataclass(frozen=True, eq=False)
class Plan:
    """Where somebody is on a route.

    Parameters
    ----------
    places : (T, 2) metres, world
    headings : (T,) radians
    walked : (T,) metres since the beginning
    pace : (T,) in 0-1: speed as a share of the walking speed
    stops : (begin, seconds) of those between two legs
    """

    places: np.ndarray
    headings: np.ndarray
    walked: np.ndarray
    pace: np.ndarray
    stops: tuple[tuple[float, float], ...]


def route(rng: np.random.Generator, figure: Figure, motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """World rotations (T, B, 3, 3) and places (T, B, 3), metres, of a figure on its way."""
    stride = stride_length(figure, motion)
    path = plan(motion, stride * motion.cadence)
    seed = int(rng.integers(2**32))
    gait, _ = walk(np.random.default_rng(seed), motion, path.walked / stride)
    still = standing(np.random.default_rng(seed), motion)
    share = path.pace[:, None]
    angles = {bone: share * turned + (1 - share) * still.get(bone, np.zeros(3)) for bone, turned in gait.items()}
    depth = np.zeros(len(path.pace))
    if motion.kind in LOWERED and path.stops:
        depth = lower(rng, motion, angles, *max(path.stops, key=lambda stop: stop[1]))
    worlds, places = _posed(figure, rotations(figure, angles, path.headings))
    soles = np.concatenate([sole(figure, worlds, places, side) for side in SIDES], axis=1)
    places[..., 2] -= smoothed(soles[..., 2].min(axis=1), width=0.02 * motion.rate)[:, None]
    if motion.kind == "lie":
        places[depth > 0, :, 2] -= lowest(figure, worlds[depth > 0], places[depth > 0])[:, None]
    places[..., :2] += (path.places - places[:, 0, :2] - _strayed(soles, depth))[:, None]
    return worlds, places


def _strayed(soles: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """(T, 2) metres by which soles (T, points, 3) go away from the pelvis while one is down: depth (T,) above 0."""
    down = depth > 0
    middle = soles[..., :2].mean(axis=1)
    return np.where(down[:, None], middle - middle[np.argmax(down)], 0.0)


def stride_length(figure: Figure, motion: Motion) -> float:
    """Metres of a stride, two steps, of the figure's walk straight ahead."""
    straight = replace(motion, way=(), duration=STRIDES / motion.cadence + 1 / motion.rate, turn_rate=0.0)
    angles, bearing = walk(np.random.default_rng(0), straight)
    worlds, places = _posed(figure, rotations(figure, angles, np.zeros(len(straight.times))))
    shift = planted(figure, worlds, places, bearing, straight)
    return float(np.ptp(places[:, 0, 0] + shift[:, 0]) / (straight.times[-1] * motion.cadence))


def plan(motion: Motion, speed: float) -> Plan:
    """Where one is at every frame, walking at this speed, metres a second."""
    times, distance = motion.times, 0.0
    walked, pace = np.zeros(len(times)), np.zeros(len(times))
    lines, stops, clock = [], [], motion.way[0][2]
    for leg in _legs(motion):
        line = _rounded(np.array(leg)[:, :2])
        length = float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
        covered, going, seconds = _covered(times - clock, length, speed)
        walked += covered
        pace += going
        lines.append(line)
        distance += length
        stops.append((clock + seconds, leg[-1][2]))
        clock += seconds + leg[-1][2]
    line = np.concatenate(lines)
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    keep = np.concatenate([[True], np.diff(along) > 1e-9])  # where one leg ends the next begins
    line, along = line[keep], along[keep]
    courses = np.unwrap(np.arctan2(*np.gradient(line, axis=0).T[::-1]))
    return Plan(
        np.column_stack([np.interp(walked, along, column) for column in line.T]),
        smoothed(np.interp(walked, along, courses), width=TURNING * motion.rate),
        walked,
        pace,
        tuple(stops[:-1]),
    )


def _legs(motion: Motion) -> list[list[tuple[float, float, float]]]:
    """The way, cut where one stands still."""
    legs, leg = [], [motion.way[0]]
    for point in motion.way[1:]:
        leg.append(point)
        if point[2] > 0:
            legs.append(leg)
            leg = [point]
    return [*legs, leg] if len(leg) > 1 else legs


def _rounded(corners: np.ndarray) -> np.ndarray:
    """(P, 2) metres: points STEP apart from the first corner to the last, the others rounded."""
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
    at = np.linspace(0.0, lengths[-1], max(2, int(np.ceil(lengths[-1] / STEP)) + 1))
    line = np.column_stack([np.interp(at, lengths, column) for column in corners.T])
    bent = np.column_stack([smoothed(column, width=ROUNDING / STEP) for column in line.T])
    # Rounding draws the ends inward; near them the line itself is kept.
    near = np.minimum(at, lengths[-1] - at)
    share = np.clip(near / (4 * ROUNDING), 0, 1)[:, None]
    return share * bent + (1 - share) * line


def _covered(times: np.ndarray, length: float, speed: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Metres covered (T,) and share of the speed (T,) on a leg begun at time 0; seconds that it takes."""
    fastest = min(speed, np.sqrt(ACCELERATION * length))  # a short leg is over before the speed is reached
    ramp = fastest / ACCELERATION
    seconds = length / fastest + ramp
    t = np.clip(times, 0.0, seconds)
    begin, end = np.minimum(t, ramp), np.maximum(t - (seconds - ramp), 0.0)
    covered = 0.5 * ACCELERATION * begin**2 + fastest * np.maximum(t - ramp, 0.0) - 0.5 * ACCELERATION * end**2
    going = np.minimum(begin, ramp - end) * ACCELERATION / speed
    return np.minimum(covered, length), going, seconds


def _posed(figure: Figure, local: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(T, B, 3, 3) and (T, B, 3): world rotations and places, the pelvis at the origin."""
    worlds, places = np.empty_like(local), np.zeros(local.shape[:3])
    worlds[:, 0] = local[:, 0]
    for bone in range(1, local.shape[1]):
        parent = figure.parents[bone]
        worlds[:, bone] = worlds[:, parent] @ local[:, bone]
        places[:, bone] = places[:, parent] + worlds[:, parent] @ figure.neutral_offsets[bone]
    return worlds, places
