"""Motions that begin with the feet: footprints first, flight under gravity, then legs that reach them.

A foot stands still on its print while it bears, and swings to the next in between. The pelvis moves along the path at
an even speed. Where no foot bears, it falls freely; where one bears, the floor's push is a half wave of a sine that
gives back what gravity took:

    z'' = -g + pi g P / (2 b) sin(pi t / b)    while a foot bears (0 <= t < b),    z'' = -g    in flight (b <= t < P)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from muybridge.errors import InputError
from muybridge.synthetic.angles import about, smooth_step
from muybridge.synthetic.limbs import SIDES, leg_length, reach
from muybridge.synthetic.planting import foot_points
from muybridge.synthetic.skinning import Figure

GRAVITY = 9.81
#: Share of the leg's length within which a bearing foot stays from its hip, so that a knee is never locked.
EXTENDED = 0.97
#: Share of the leg's length below which hips do not come.
CROUCHED = 0.5

Keys = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Steps:
    """How somebody steps.

    Parameters
    ----------
    rate : strides per second
    begin : phase of the stride at time 0
    shifts : phase of the left and right foot in the stride
    bears : share of the stride during which a foot bears; 0: a foot that is kept off the floor
    speed, direction : metres per second, radians from the heading to the left
    turn_rate : radians per second, to the left
    apart : metres from the path to the footprints of each foot, outward
    ahead : metres, how far forward of its hip the ankle is put, at the middle of its bearing
    lift : metres, how high the sole is carried at the middle of a swing
    pitch : (phase of the foot's stride, degrees) pairs: how far the heel is up
    flight : whether there are times when no foot bears, and the body falls freely
    rises : flights per stride
    """

    rate: float
    begin: float
    shifts: tuple[float, float] = (0.0, 0.5)
    bears: tuple[float, float] = (0.6, 0.6)
    speed: float = 0.0
    direction: float = 0.0
    turn_rate: float = 0.0
    apart: float = 0.1
    ahead: float = 0.0
    lift: float = 0.06
    pitch: Keys = ((0.0, 0.0),)
    flight: bool = False
    rises: int = 2


def heading_at(steps: Steps, times: np.ndarray, heading: float) -> np.ndarray:
    """(T,) radians at times (T,) seconds from the middle of the clip."""
    return heading + steps.turn_rate * times


def path_at(steps: Steps, times: np.ndarray, heading: float) -> np.ndarray:
    """(T, 2) metres at times (T,) seconds from the middle of the clip: an arc through the origin."""
    half = 0.5 * steps.turn_rate * times
    chord = steps.speed * times * np.sinc(half / np.pi)
    course = heading + steps.direction + half
    return chord[:, None] * np.stack([np.cos(course), np.sin(course)], axis=1)


def bounce(steps: Steps, times: np.ndarray) -> np.ndarray:
    """(T,) metres: height of the pelvis over where it is as a foot comes down, times (T,) seconds from begin."""
    if not steps.flight:
        return np.zeros(len(times))
    period = 1.0 / (steps.rate * steps.rises)
    bearing = max(steps.bears) * steps.rises * period
    flying = period - bearing
    own = (times + (steps.begin + steps.shifts[int(np.argmax(steps.bears))]) / steps.rate) % period
    t = np.minimum(own, bearing)
    push = np.pi * GRAVITY * period / (2 * bearing)
    part = bearing / np.pi
    pushed = -0.5 * GRAVITY * (flying * t + t * t) + push * part * (t - part * np.sin(t / part))
    fly = np.maximum(own - bearing, 0.0)
    return pushed + 0.5 * GRAVITY * fly * (flying - fly)


def step(
    figure: Figure, worlds: np.ndarray, places: np.ndarray, steps: Steps, times: np.ndarray, heading: float
) -> None:
    """Carry the body (T, B, 3, 3) and (T, B, 3), standing at the origin, along its path, and put its feet down.

    Parameters
    ----------
    worlds, places : world, metres; both are changed
    times : (T,) seconds from 0
    heading : radians, at the middle of the clip
    """
    middle = 0.5 * times[-1]
    height = bounce(steps, times)
    places[..., :2] += path_at(steps, times - middle, heading)[:, None]
    used = [foot for foot in (0, 1) if steps.bears[foot] > 0]
    ankles = {foot: _footfall(figure, worlds, steps, foot, times, heading) for foot in used}
    height += _base_height(figure, places, steps, times, height, ankles)
    _check_height(figure, height)
    places[..., 2] += height[:, None]
    for foot in used:
        reach(figure, worlds, places, SIDES[foot], ankles[foot])


def _phase(steps: Steps, foot: int, times: np.ndarray) -> np.ndarray:
    """(T,) strides that this foot has begun."""
    return steps.begin + steps.shifts[foot] + steps.rate * times


def _footfall(
    figure: Figure, worlds: np.ndarray, steps: Steps, foot: int, times: np.ndarray, heading: float
) -> np.ndarray:
    """(T, 3) metres: where the ankle is to be; the foot's and toes' orientation is set."""
    side, phase, bears = SIDES[foot], _phase(steps, foot, times), steps.bears[foot]
    stride = np.floor(phase)
    swing = np.clip((phase - stride - bears) / (1.0 - bears), 0.0, 1.0)
    share = swing**3 * (10.0 - 15.0 * swing + 6.0 * swing**2)
    begins = (stride + 0.5 * bears - steps.begin - steps.shifts[foot]) / steps.rate - 0.5 * times[-1]
    ahead = _standing_reach(figure, side) + steps.ahead
    prints, courses = zip(*(_print(steps, begins + k / steps.rate, heading, foot, ahead) for k in (0, 1)), strict=True)
    place, course = (a + (b - a) * s for (a, b), s in ((prints, share[:, None]), (courses, share)))
    pitch = np.radians(_curve(steps.pitch, phase - stride))
    flat = 1.0 - smooth_step(swing / 0.35)
    bone, toes = figure.bone(f"{side}_foot"), figure.bone(f"{side}_toes")
    worlds[:, bone] = about(2, course) @ about(1, pitch)
    worlds[:, toes] = about(2, course) @ about(1, pitch * (1.0 - flat) + np.clip(pitch - 0.8, 0.0, None) * flat)
    lifted = 16.0 * steps.lift * (swing * (1.0 - swing)) ** 2
    return np.column_stack([place, lifted]) - _lowest(figure, worlds, side)


def _lowest(figure: Figure, worlds: np.ndarray, side: str) -> np.ndarray:
    """(T, 3) metres: from the ankle: the ball's x and y, and the z of heel, ball or tip, whichever is lowest."""
    foot, toes = figure.bone(f"{side}_foot"), figure.bone(f"{side}_toes")
    heel, ball, tip = foot_points(figure, side)[:3]
    points = [worlds[:, foot] @ heel, worlds[:, foot] @ ball]
    points.append(worlds[:, foot] @ figure.neutral_offsets[toes] + worlds[:, toes] @ tip)
    return np.column_stack([points[1][:, :2], np.min(points, axis=0)[:, 2]])


def _standing_reach(figure: Figure, side: str) -> float:
    """Metres: how far the ball of the foot is forward of the pelvis, the leg straight down."""
    hip = figure.neutral_offsets[figure.bone(f"{side}_thigh")]
    return float(hip[0] + foot_points(figure, side)[1, 0])


def _print(
    steps: Steps, times: np.ndarray, heading: float, foot: int, reach_ahead: float
) -> tuple[np.ndarray, np.ndarray]:
    """(T, 2) metres and (T,) radians: the footprint made at times (T,) seconds from the middle of the clip."""
    course = heading_at(steps, times, heading)
    out = steps.apart if SIDES[foot] == "left" else -steps.apart
    ahead, left = (
        np.stack([np.cos(course), np.sin(course)], axis=1),
        np.stack([-np.sin(course), np.cos(course)], axis=1),
    )
    return path_at(steps, times, heading) + reach_ahead * ahead + out * left, course


def _base_height(
    figure: Figure,
    places: np.ndarray,
    steps: Steps,
    times: np.ndarray,
    height: np.ndarray,
    ankles: dict[int, np.ndarray],
) -> float:
    """Metres: how high the body may be for every bearing foot to be within reach."""
    length, room = EXTENDED * leg_length(figure), []
    for foot, target in ankles.items():
        hip = places[:, figure.bone(f"{SIDES[foot]}_thigh")]
        bearing = _phase(steps, foot, times) % 1.0 <= steps.bears[foot]
        flat = np.linalg.norm((target - hip)[:, :2], axis=1)
        allowed = target[:, 2] + np.sqrt(np.maximum(length**2 - flat**2, 0.0)) - hip[:, 2] - height
        room.append(allowed[bearing])
    return float(np.concatenate(room).min())


def _check_height(figure: Figure, height: np.ndarray) -> None:
    """Steps too long and falls too deep for the legs would take the hips (T,) metres down to the floor."""
    if height.min() < CROUCHED * leg_length(figure):
        raise InputError(
            "motion: cadence and vigour",
            expected="steps and leaps that legs can make",
            got=f"hips {max(height.min(), 0.0):.2f} m over the floor",
            remedy="raise cadence or lower vigour",
        )


def _curve(keys: Keys, phase: np.ndarray) -> np.ndarray:
    """Periodic curve through (phase, value) pairs that has no waves of its own between them."""
    at, value = np.array(keys, dtype=np.float64).T
    return PchipInterpolator(np.concatenate([at - 1, at, at + 1]), np.tile(value, 3))(phase % 1.0)
