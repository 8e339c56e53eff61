"""The tables of a scene file, as they are written: what is absent is the preset's."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from muybridge.io._tables import Table

Positive = Annotated[float, Meta(gt=0)]
Share = Annotated[float, Meta(ge=0, le=1)]
Grey = Annotated[int, Meta(ge=0, le=255)]
Colour = tuple[Grey, Grey, Grey]
"""Blue, green, red."""
Place = tuple[float, float]
Point = tuple[float, float, float]
"""x, y, and how long one stands there."""
Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]
Pixels = Annotated[int, Meta(ge=16, le=8192)]


class GarmentTable(Table, frozen=True):
    """`[[person.garment]]`: cloth on one part of the figure, in place of the outfit's."""

    label: str
    pattern: str | None = None
    colour: Colour | None = None
    second: Colour | None = None
    tile: Positive | None = None


class MotionTable(Table, frozen=True):
    """`[motion]`: a kind of motion, or a recorded one."""

    kind: str | None = None
    turn_rate: float | None = None
    way: Annotated[tuple[Point, ...], Meta(min_length=2)] | None = None
    cadence: Positive | None = None
    vigour: Positive | None = None
    seed: Annotated[int, Meta(ge=0)] | None = None
    file: Path | None = None
    start: Annotated[float, Meta(ge=0)] | None = None
    end: Positive | None = None
    skeleton: Path | None = None
    scale: Positive | None = None
    axes: str | None = None
    file_rate: Positive | None = None
    heading: float | None = None
    place: Place | None = None

    def __post_init__(self) -> None:
        made = [
            name
            for name in ("kind", "turn_rate", "way", "cadence", "vigour", "seed")
            if getattr(self, name) is not None
        ]
        if self.file is not None and made:
            raise ValueError(f"expected kind or file, got file and {made[0]}")
        recorded = ("start", "end", "skeleton", "scale", "axes", "file_rate")
        needless = [name for name in recorded if getattr(self, name) is not None]
        if self.file is None and needless:
            raise ValueError(f"expected {needless[0]} together with file, got no file")
        if self.start is not None and self.end is not None and self.start >= self.end:
            raise ValueError(f"expected start before end, got {self.start:g} and {self.end:g}")


class PersonTable(Table, frozen=True):
    """`[person]` and `[[other]]`: who, and what is worn; somebody else has a motion of their own."""

    figure: str | None = None
    cut: str | None = None
    hair: str | None = None
    outfit: str | None = None
    looseness: Annotated[float, Meta(ge=0)] | None = None
    garment: tuple[GarmentTable, ...] = ()
    motion: MotionTable | None = None


class CameraTable(Table, frozen=True):
    """`[[camera]]`: where it stands and what it looks at; or its matrices."""

    name: str | None = None
    position: Vector | None = None
    look_at: Vector | None = None
    focal: Positive | None = None
    size: tuple[Pixels, Pixels] = (640, 480)
    distortion: Annotated[tuple[float, ...], Meta(min_length=4, max_length=5)] = (0.0, 0.0, 0.0, 0.0, 0.0)
    matrix: Matrix | None = None
    rotation: Matrix | None = None
    translation: Vector | None = None

    def __post_init__(self) -> None:
        placed = self.position is not None and self.look_at is not None
        exact = self.matrix is not None and self.rotation is not None and self.translation is not None
        parts = [self.matrix, self.rotation, self.translation]
        some = any(part is not None for part in (self.position, self.look_at, self.focal))
        if exact and some:
            raise ValueError("expected position and look_at, or matrix, rotation and translation, got both")
        if not placed and not exact:
            missing = "translation" if any(part is not None for part in parts) else "look_at"
            raise ValueError(f"expected position and look_at, or matrix, rotation and translation, got no {missing}")


class RoomTable(Table, frozen=True):
    """`[room]`: a room of the preset by name, and what is different in it."""

    kind: str | None = None
    half_width: Positive | None = None
    height: Positive | None = None
    floor: str | None = None
    wall: Colour | None = None
    floor_colour: Colour | None = None
    clutter: Annotated[int, Meta(ge=0, le=40)] | None = None
    seed: Annotated[int, Meta(ge=0)] | None = None


class LampTable(Table, frozen=True):
    """`[[light.switch]]`: from `time` on, the light is another."""

    time: Annotated[float, Meta(ge=0)]
    direction: Vector | None = None
    gain: Positive | None = None
    spot: Place | None = None


class LightTable(Table, frozen=True):
    """`[light]`: the lamp at the beginning, and what it does later."""

    direction: Vector | None = None
    gain: Positive | None = None
    spot: Place | None = None
    drift: Share | None = None
    shadow: Share | None = None
    switch: tuple[LampTable, ...] | None = None


class SensorTable(Table, frozen=True):
    """`[sensor]`: the cameras' ways."""

    noise: Annotated[float, Meta(ge=0)] | None = None
    shutter: Share | None = None
    exposure: Annotated[float, Meta(ge=0)] | None = None
    automatic: Share | None = None
    lag: Positive | None = None
    readout: Share | None = None
    quality: int | None = None


class OccluderTable(Table, frozen=True):
    """`[[occluder]]`: a thing that stands in the room."""

    kind: str | None = None
    place: Place | None = None
    size: Vector | None = None
    turn: float | None = None
    pattern: str | None = None
    colour: Colour | None = None
    second: Colour | None = None
    tile: Positive | None = None
    since: float | None = None
    until: float | None = None


SURVEILLANCE = "surveillance"
SURVEILLANCE_KEYS = ("people", "size", "events", "linger")


class SceneTable(Table, frozen=True):
    """A whole scene file."""

    preset: str = "studio"
    seed: Annotated[int, Meta(ge=0)] = 1
    duration: Positive | None = None
    rate: Positive | None = None
    view: Literal["ring", "side"] | None = None
    cameras: int | None = None
    follow: Literal["person", "people"] | None = None
    people: int | None = None
    size: tuple[Pixels, Pixels] | None = None
    events: tuple[str, ...] | None = None
    linger: Positive | None = None
    person: PersonTable = PersonTable()
    motion: MotionTable | None = None
    camera: tuple[CameraTable, ...] | None = None
    room: RoomTable = RoomTable()
    light: LightTable = LightTable()
    sensor: SensorTable = SensorTable()
    occluder: tuple[OccluderTable, ...] | None = None
    other: tuple[PersonTable, ...] | None = None

    def __post_init__(self) -> None:
        if self.cameras is not None and self.camera is not None:
            raise ValueError("expected cameras = N or [[camera]] tables, got both")
        if self.view is not None and self.camera is not None:
            raise ValueError("expected view or [[camera]] tables, got both")
        self._check_preset()
        if self.person.motion is not None:
            raise ValueError("expected the person's motion in [motion], got [person.motion]")
        if self.motion is not None and self.motion.end is not None and self.duration is not None:
            raise ValueError("expected duration or motion.end, got both")

    def _check_preset(self) -> None:
        """The surveillance preset has keys of its own, and decides who walks where before one camera."""
        own = [name for name in SURVEILLANCE_KEYS if getattr(self, name) is not None]
        if own and self.preset != SURVEILLANCE:
            raise ValueError(f'expected {own[0]} with preset = "{SURVEILLANCE}", got "{self.preset}"')
        other = [name for name in ("view", "cameras", "camera", "motion", "other") if getattr(self, name) is not None]
        other += ["person"] * (self.person != PersonTable()) + ["room.kind"] * (self.room.kind is not None)
        if other and self.preset == SURVEILLANCE:
            raise ValueError(f'expected a preset other than "{SURVEILLANCE}", which decides {other[0]}')


def given(table: Table, *, only: Sequence[str] | None = None, without: Sequence[str] = ()) -> dict[str, Any]:
    """What a table says, by field; what it leaves to others is left out."""
    names = [field.name for field in msgspec.structs.fields(table)]
    chosen = [name for name in names if (only is None or name in only) and name not in without]
    return {name: getattr(table, name) for name in chosen if getattr(table, name) is not None}
