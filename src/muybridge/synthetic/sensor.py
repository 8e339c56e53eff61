"""What a camera makes of light: exposure, noise, 8 bits; how long its shutter is open; how its video is compressed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from muybridge.errors import InputError

SUBFRAMES = 8  # pictures averaged over an open shutter; a hand at 3 m/s then moves about a pixel between two
WANDER_PERIOD = (1.5, 4.0)  # seconds: an automatic exposure that never quite settles


@dataclass(frozen=True)
class Sensor:
    """A camera's ways; all cameras of a scene are alike, each wanders by itself.

    Parameters
    ----------
    shutter : 0-1, share of the time between frames for which the shutter is open: motion blur
    exposure : relative amplitude with which the exposure wanders
    automatic : 0-1, how much of a change of the light the exposure makes up for
    lag : seconds, time constant with which it does so
    readout : 0-1, share of the time between frames from the first row's exposure to the last one's; geometry does not
        roll, only brightness does
    quality : x264's constant rate factor of the video, 0 (lossless) to 51 (worst)
    """

    shutter: float = 0.0
    exposure: float = 0.0
    automatic: float = 0.0
    lag: float = 0.3
    readout: float = 0.0
    quality: int = 18

    def __post_init__(self) -> None:
        for name in ("shutter", "automatic", "readout"):
            if not 0 <= getattr(self, name) <= 1:
                raise InputError(f"sensor: {name}", expected="0 to 1", got=str(getattr(self, name)))
        if not 0 <= self.exposure < 0.5:
            raise InputError("sensor: exposure", expected="0 to 0.5", got=str(self.exposure))
        if not (np.isfinite(self.lag) and self.lag > 0):
            raise InputError("sensor: lag", expected="positive seconds", got=str(self.lag))
        if not 0 <= self.quality <= 51:
            raise InputError("sensor: quality", expected="0 (best) to 51 (worst)", got=str(self.quality))

    @property
    def moments(self) -> np.ndarray:
        """(K,) frames: when the pictures are taken that are averaged, relative to the middle of the exposure."""
        if self.shutter == 0:
            return np.zeros(1)
        return ((np.arange(SUBFRAMES) + 0.5) / SUBFRAMES - 0.5) * self.shutter

    def wander(self, seed: int, camera: int, times: np.ndarray) -> np.ndarray:
        """Factor on the exposure of a camera at these times, seconds."""
        rng = np.random.default_rng([seed, camera, 7])
        period, phase = rng.uniform(*WANDER_PERIOD), rng.uniform()
        return 1.0 + self.exposure * np.sin(2 * np.pi * (np.asarray(times) / period + phase))

    def row_times(self, time: float, rate: float, height: int) -> np.ndarray:
        """(H,) seconds: when each row is exposed."""
        return time + (np.arange(height) / height - 0.5) * self.readout / rate


def exposed(colours: np.ndarray, gain: np.ndarray | np.float32, noise: float, rng: np.random.Generator) -> np.ndarray:
    """A picture in 8 bits, with a sensor's noise: its variance grows with the light, plus a floor.

    Parameters
    ----------
    colours : (H, W, 3) float32, 0-255
    gain : float32, or one a row (H, 1, 1) float32
    noise : standard deviation at a grey value of 128, grey values
    """
    light = colours * gain
    deviation = np.sqrt(light * np.float32(0.75 / 128) + np.float32(0.25)) * np.float32(noise)
    grain = rng.standard_normal(light.shape, dtype=np.float32)
    return np.clip(light + deviation * grain + 0.5, 0, 255).astype(np.uint8)
