"""What a scene is made from: plain values, frozen and comparable, so that equal scenes have equal pictures."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from muybridge.cameras.model import Rig
from muybridge.errors import InputError
from muybridge.synthetic.light import Light
from muybridge.synthetic.motion import Motion
from muybridge.synthetic.occluders import Occluder
from muybridge.synthetic.outfits import OUTFITS, Outfit, completed
from muybridge.synthetic.room import Room
from muybridge.synthetic.sensor import Sensor
from muybridge.synthetic.skinning import Figure, load_figure

if TYPE_CHECKING:
    from muybridge.synthetic.recorded import Recorded


@dataclass(frozen=True)
class Person:
    """Who does what, and what is worn.

    Parameters
    ----------
    figure : a baked person, such as "man" or "woman"
    motion : what is done, a `Motion` or a recorded one
    outfit : garments; together with BARE they cover every label of the figure
    looseness : metres, how far the clothes stand off the body
    cut : of the clothes, one of `figure_file.cut_names()`; None: the figure's own
    hair : one of `figure_file.HAIR`; None: the figure's own
    """

    figure: str = "man"
    motion: Motion | Recorded = field(default_factory=Motion)
    outfit: Outfit = OUTFITS["striped"]
    looseness: float = 0.0
    cut: str | None = None
    hair: str | None = None

    def __post_init__(self) -> None:
        if not 0 <= self.looseness <= 0.15:
            raise InputError("person: looseness", expected="0 to 0.15 m", got=str(self.looseness))

    def load(self) -> Figure:
        """The figure, dressed."""
        return load_figure(self.figure, self.cut, self.hair)

    def complete(self) -> Person:
        """The same with nothing left to the figure: its cut and hair by name, a garment for every label."""
        figure = self.load()
        return replace(self, cut=figure.cut, hair=figure.hair, outfit=completed(self.outfit))


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
    others : people who are in the way, in no mask and no truth; or more to be followed
    occluders : things that stand about, in the empty frames too
    light : lamps, and when they go on and off
    sensor : exposure, shutter, compression
    follow : "person", the first one, by any number of cameras; or "people", everybody, by one
    """

    rig: Rig
    person: Person = field(default_factory=Person)
    room: Room = field(default_factory=Room)
    noise: float = 3.0
    drift: float = 0.015
    shadow: float = 0.45
    seed: int = 0
    others: tuple[Person, ...] = ()
    occluders: tuple[Occluder, ...] = ()
    light: Light = Light()
    sensor: Sensor = Sensor()
    follow: Literal["person", "people"] = "person"

    def __post_init__(self) -> None:
        for name, least, most in (("noise", 0, 100), ("drift", 0, 0.9), ("shadow", 0, 1)):
            if not least <= getattr(self, name) <= most:
                raise InputError(f"scene: {name}", expected=f"{least} to {most}", got=str(getattr(self, name)))
        if self.follow == "people" and len(self.rig) != 1:
            raise InputError("scene: follow people", expected="one camera", got=str(len(self.rig)))
        for other in self.others:
            if len(other.motion.times) != self.frame_count or other.motion.rate != self.rate:
                expected = f"{self.frame_count} frames at {self.rate:g} Hz, as the person's"
                got = f"{len(other.motion.times)} at {other.motion.rate:g} Hz"
                raise InputError("scene: motion of another person", expected=expected, got=got)
        for camera in self.rig:
            for thing in self.occluders:
                if camera.position[2] < thing.size[2] and not thing.distance(camera.position[:2]) > 0:
                    raise InputError(f"camera {camera.name}", expected="a place outside every occluder",
                                     got="one inside", remedy="move one of the two")  # fmt: skip

    @property
    def changes(self) -> tuple[float, ...]:
        """Seconds at which a lamp is switched, or a thing comes or goes, in order."""
        moments = {switch.time for switch in self.light.switches}
        moments |= {time for thing in self.occluders for time in (thing.since, thing.until) if time is not None}
        return tuple(sorted(moments))

    def epoch(self, time: float) -> int:
        """How many `changes` have been by this time, seconds."""
        return sum(change <= time for change in self.changes)

    @property
    def people(self) -> tuple[Person, ...]:
        """Everybody; the one to be tracked comes first."""
        return (self.person, *self.others)

    @property
    def frame_count(self) -> int:
        """How many frames the clip has."""
        return len(self.person.motion.times)

    @property
    def rate(self) -> float:
        """Frames per second."""
        return self.person.motion.rate

    @property
    def duration(self) -> float:
        """Seconds."""
        return float(np.float64(self.frame_count) / self.rate)
