"""The light of a scene over time: it drifts, and lamps go on and off.

A lamp's light has a direction (shading and shadows follow it) and a spot under which the room is brightest. A switch
replaces it from one frame to the next, and everything becomes brighter or darker by its gain.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from muybridge.errors import InputError
from muybridge.synthetic.rasterise import LIGHT

Vector = tuple[float, float, float]
LOWEST = (
    0.3  # the least elevation, as z over length: a lower lamp would throw shadows up the walls, which are not drawn
)


@dataclass(frozen=True)
class Lamp:
    """Light of one direction.

    Parameters
    ----------
    direction : towards the lamp, world; its length does not matter
    gain : brightness of everything, 1 = as painted
    spot : (x, y) metres, world: the room is brightest below it
    """

    direction: Vector = (float(LIGHT[0]), float(LIGHT[1]), float(LIGHT[2]))
    gain: float = 1.0
    spot: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        length = float(np.linalg.norm(self.direction))
        if not (np.isfinite(length) and length > 0 and self.direction[2] / length >= LOWEST):
            raise InputError("light: direction", expected=f"towards a lamp above, z at least {LOWEST:g} of its length",
                             got=str(list(self.direction)))  # fmt: skip
        if not (np.isfinite(self.gain) and self.gain > 0):
            raise InputError("light: gain", expected="a positive number", got=str(self.gain))


@dataclass(frozen=True)
class Switch:
    """From `time` (seconds) on, the light is that of `lamp`."""

    time: float
    lamp: Lamp

    def __post_init__(self) -> None:
        if not (np.isfinite(self.time) and self.time >= 0):
            raise InputError("light: switch time", expected="0 or more seconds", got=str(self.time))


@dataclass(frozen=True)
class Light:
    """How a scene is lit.

    Parameters
    ----------
    lamp : at the beginning, and in the empty frames
    switches : in the order of their times
    """

    lamp: Lamp = Lamp()
    switches: tuple[Switch, ...] = ()

    def __post_init__(self) -> None:
        times = [switch.time for switch in self.switches]
        if times != sorted(set(times)):
            raise InputError("light: switches", expected="one after the other", got=f"times {times}")

    @property
    def lamps(self) -> tuple[Lamp, ...]:
        """Every state of the light, in order."""
        return (self.lamp, *(switch.lamp for switch in self.switches))

    def state(self, time: float) -> int:
        """Which of `lamps` shines at this time, seconds."""
        return sum(switch.time <= time for switch in self.switches)

    def lagged_gain(self, time: float, lag: float) -> float:
        """The gain as an exposure meter knows it: steps become exponentials with a time constant `lag`, seconds."""
        level = before = self.lamp.gain
        for switch in self.switches:
            if switch.time <= time:
                level += (switch.lamp.gain - before) * (1.0 - float(np.exp(-(time - switch.time) / max(lag, 1e-9))))
                before = switch.lamp.gain
        return level


def drift_gain(drift: float, time: float, duration: float) -> float:
    """Slow change of the light, once up and down over the clip."""
    return float(1.0 + drift * np.sin(2 * np.pi * time / max(duration, 1e-9)))
