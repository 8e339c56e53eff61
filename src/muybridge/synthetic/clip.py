"""What a figure is to do, and what it then did: `Motion` in, `Track` out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from muybridge.errors import InputError

#: Their order seeds what they do: new ones come last.
KINDS = ("walk", "wave", "crouch", "jog", "hop", "jump", "turn", "sidestep", "punch", "bend", "lie")
#: These may be done on a way, at its longest stop.
LOWERED = ("crouch", "bend", "lie")


@dataclass(frozen=True)
class Motion:
    """What the figure does.

    Parameters
    ----------
    kind : one of KINDS
        "walk"; "wave", standing, one arm up; "crouch", down and up again; "jog"; on the
        spot "hop" on one leg, "jump" on both, and "turn"; "sidestep", facing ahead; "punch", standing;
        "bend" at the hips, and "lie", who falls and gets up again, in the middle of the clip
    duration, rate : seconds, frames per second
    heading : radians, at the middle of the clip, counter-clockwise from +x
        Walked and jogged at; faced, where the feet stay on the spot or go sideways.
    turn_rate : radians per second, to the left: of walk, jog and turn; a turn of 0 takes its own side and speed
    place : (x, y) metres, world, of the pelvis at the middle of the clip
    cadence : pace: strides (two steps) per second of a walk, others in proportion
    vigour : factor on the amplitudes, 1 = table
    way : of a walk from point to point: (x, y, seconds) of each, metres, world, and how long one stands there; at the
        last one to the end of the clip. Heading, turn_rate and place then have no say. Who crouches, bends or lies does
        so at the longest stop but the last, all the time of it
    """

    kind: str = "walk"
    duration: float = 3.0
    rate: float = 30.0
    heading: float = 0.0
    turn_rate: float = 0.0
    place: tuple[float, float] = (0.0, 0.0)
    cadence: float = 0.9
    vigour: float = 1.0
    seed: int = 0
    way: tuple[tuple[float, float, float], ...] = ()

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError("motion: kind", expected=f"one of {', '.join(KINDS)}", got=repr(self.kind))
        for name in ("duration", "rate", "cadence", "vigour"):
            if not (np.isfinite(getattr(self, name)) and getattr(self, name) > 0):
                raise InputError(f"motion: {name}", expected="a positive number", got=str(getattr(self, name)))
        if self.way and (self.kind not in ("walk", *LOWERED) or len(self.way) < 2):
            expected = f"two points or more, of walk, {', '.join(LOWERED)}"
            raise InputError("motion: way", expected=expected, got=f"{len(self.way)} of a {self.kind}")
        if self.way and not (np.isfinite(self.way).all() and min(point[2] for point in self.way) >= 0):
            raise InputError("motion: way", expected="finite x, y and seconds, seconds 0 or more", got=str(self.way))

    @property
    def times(self) -> np.ndarray:
        """(T,) seconds."""
        return np.arange(max(1, round(self.duration * self.rate))) / self.rate


@dataclass(frozen=True, eq=False)
class Track:
    """A motion of one figure: bone frames over time.

    Parameters
    ----------
    times : (T,) seconds
    rotations : (T, B, 3, 3), world
    places : (T, B, 3) metres, world: bone heads
    joints : (T, 15, 3) metres, world
    """

    times: np.ndarray
    rotations: np.ndarray
    places: np.ndarray
    joints: np.ndarray

    @property
    def interval(self) -> float:
        """Seconds between two frames; 1 where there is only one."""
        return float(self.times[1] - self.times[0]) if len(self.times) > 1 else 1.0
