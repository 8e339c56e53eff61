"""SCENE.toml -> `Scene`: a preset, and whatever the file says instead. docs/scenes.md lists every key.

An unknown key is an error that names the nearest known one. Nothing is rendered here, so a scene that cannot be is one
line before anything is written.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from muybridge.cameras.model import Camera, Rig
from muybridge.errors import InputError
from muybridge.io import _tables, _toml
from muybridge.synthetic.description import Person, Scene
from muybridge.synthetic.light import Lamp, Light, Switch
from muybridge.synthetic.motion import Motion, perform
from muybridge.synthetic.occluders import Occluder
from muybridge.synthetic.outfits import Garment, Outfit, completed, outfit
from muybridge.synthetic.placing import check_seen
from muybridge.synthetic.presets import PRESETS, preset_scene
from muybridge.synthetic.rigs import looking_at
from muybridge.synthetic.scene_tables import (
    SURVEILLANCE,
    SURVEILLANCE_KEYS,
    CameraTable,
    GarmentTable,
    LampTable,
    LightTable,
    MotionTable,
    OccluderTable,
    PersonTable,
    SceneTable,
    given,
)
from muybridge.synthetic.surveillance import surveillance_scene

if TYPE_CHECKING:
    from muybridge.synthetic.recorded import Recorded

MADE = ("turn_rate", "way", "cadence", "vigour", "seed", "heading", "place")
"""Keys of [motion] that are fields of `Motion`."""


def read(path: Path | str, overrides: Sequence[str] = ()) -> Scene:
    """Read a scene file.

    Parameters
    ----------
    path : Path
        The TOML file; relative paths in it start from its folder.
    overrides : sequence of str
        Settings that win over the file's, `"sensor.quality=30"`; a camera is `camera.NAME.` or `camera.0.`.
    """
    path = Path(path)
    table = _toml.load(path, "a scene")
    return from_table(table, path.parent, overrides=overrides, source=path.name)


def from_table(
    table: Mapping[str, Any], folder: Path, *, overrides: Sequence[str] = (), source: str = "scene"
) -> Scene:
    """A scene from the nested tables that its file would hold."""
    tables: dict[str, Any] = _tables.copied(table)
    for text in overrides:
        _tables.override(tables, text)
    _check_finite(tables, source, "")
    return scene_of(_tables.convert(tables, SceneTable, Path(folder).absolute(), source))


def scene_of(table: SceneTable) -> Scene:
    """The scene that a file's tables describe."""
    base = _base(table)
    scene = replace(
        base,
        person=_person(table.person, base.person, base.person.motion),
        room=replace(base.room, **given(table.room, without=("kind",))),
        light=_light(table.light, base.light),
        sensor=replace(base.sensor, **given(table.sensor, without=("noise",))),
        **given(table.light, only=("drift", "shadow")),
        **given(table.sensor, only=("noise",)),
        **given(table, only=("follow",)),
    )
    if table.occluder is not None:
        scene = replace(scene, occluders=tuple(_occluder(row) for row in table.occluder))
    if table.other is not None:
        scene = replace(scene, others=tuple(_other(row, scene) for row in table.other))
    joints = perform(scene.person.load(), scene.person.motion).joints
    check_seen(scene.rig, joints)
    _check_inside(scene, joints)
    return scene


def _base(table: SceneTable) -> Scene:
    """The preset's scene, with cameras and motion as the file has them."""
    rig = _rig(table.camera) if table.camera else None
    if table.camera is not None and not table.camera:
        raise InputError("scene: camera", expected="at least one camera", got="none")
    if table.preset == SURVEILLANCE:
        asked = given(table, only=("duration", "rate", *SURVEILLANCE_KEYS))
        return surveillance_scene(seed=table.seed, **asked)
    action = table.motion or MotionTable()
    preset = PRESETS.get(table.preset)
    rate = table.rate or (preset.rate if preset else 30.0)
    return preset_scene(
        table.preset,
        seed=table.seed,
        figure=table.person.figure,
        motion=action.kind if action.file is None else _recorded(action, rate, table.duration),
        details=given(action, only=MADE),
        cameras=table.cameras,
        view=table.view or "ring",
        room=table.room.kind,
        outfit_name=table.person.outfit,
        cut=table.person.cut,
        hair=table.person.hair,
        duration=table.duration,
        rate=table.rate,
        rig=rig,
    )


def _rig(rows: Sequence[CameraTable]) -> Rig:
    return Rig(tuple(_camera(row, number) for number, row in enumerate(rows, 1)))


def _camera(row: CameraTable, number: int) -> Camera:
    name = row.name or f"cam{number}"
    lens = np.array(row.distortion, dtype=np.float64)
    if row.matrix is not None and row.rotation is not None and row.translation is not None:
        return Camera(name, row.size, np.array(row.matrix), lens, np.array(row.rotation), np.array(row.translation))
    assert row.position is not None and row.look_at is not None  # CameraTable has made sure
    place, target = np.array(row.position), np.array(row.look_at)
    if np.linalg.norm(np.cross(target - place, (0.0, 0.0, 1.0))) < 1e-9:
        raise InputError(f"camera {name}: look_at", expected="a point that is not straight above or below the camera",
                         got=str(list(row.look_at)))  # fmt: skip
    focal = 0.9 * row.size[0] if row.focal is None else row.focal
    return looking_at(name, place, target, focal=focal, size=row.size, distortion=lens)


def _recorded(row: MotionTable, rate: float, duration: float | None) -> Recorded:
    """A motion from a file; it lasts `duration` seconds where the table does not say when it ends."""
    from muybridge.synthetic.recorded import Recorded

    assert row.file is not None
    details = given(row, only=("start", "end", "heading", "place", "scale", "axes", "file_rate"))
    if duration is not None and row.end is None:
        details["end"] = (row.start or 0.0) + duration
    skeleton = "" if row.skeleton is None else str(row.skeleton)
    return Recorded(str(row.file), rate=rate, skeleton=skeleton, **details)


def _person(row: PersonTable, base: Person, motion: Motion | Recorded) -> Person:
    """The base person, with what the table says instead."""
    loose = base.looseness if row.looseness is None else row.looseness
    worn, cut, hair = _clothes(row.garment, base.outfit), row.cut or base.cut, row.hair or base.hair
    made = Person(base.figure, motion, worn, loose, cut, hair)
    known = made.load().label_names
    for garment in row.garment:
        if garment.label not in known:
            raise InputError("garment: label", expected=f"one of {', '.join(known)}", got=repr(garment.label))
    return made


def _other(row: PersonTable, scene: Scene) -> Person:
    """Somebody else, who does something for as long as the person does."""
    action, seconds = row.motion or MotionTable(), scene.person.motion.duration
    motion: Motion | Recorded
    if action.file is not None:
        motion = _recorded(action, scene.rate, seconds)
    else:
        details = {"seed": scene.seed + 1, **given(action, only=MADE)}
        motion = Motion(action.kind or "walk", seconds, scene.rate, **details)
    base = Person(row.figure or "woman", motion, outfit(row.outfit or "checked"))
    return _person(row, base, motion)


def _clothes(rows: Sequence[GarmentTable], base: Outfit) -> Outfit:
    """The base outfit with these garments in place of those on the same labels."""
    worn = {garment.label: garment for garment in completed(base)}
    for row in rows:
        worn[row.label] = replace(worn.get(row.label, Garment(row.label, "plain", (128, 128, 128))),
                                  **given(row, without=("label",)))  # fmt: skip
    return tuple(worn.values())


def _light(row: LightTable, base: Light) -> Light:
    lamp = replace(base.lamp, **given(row, only=("direction", "gain", "spot")))
    if row.switch is None:
        return Light(lamp, base.switches)
    return Light(lamp, tuple(Switch(item.time, _lamp(item, lamp)) for item in row.switch))


def _lamp(row: LampTable, base: Lamp) -> Lamp:
    return replace(base, **given(row, only=("direction", "gain", "spot")))


def _occluder(row: OccluderTable) -> Occluder:
    return Occluder(**given(row))


def _check_inside(scene: Scene, joints: np.ndarray) -> None:
    """Raise where a camera or the person is outside the walls, which would then be seen from behind."""
    half = scene.room.half_width
    for camera in scene.rig:
        if not ((np.abs(camera.position[:2]) < half).all() and 0 < camera.position[2] < scene.room.height):
            raise InputError(f"camera {camera.name}", expected=f"a place inside the room, {2 * half:g} m wide and "
                             f"{scene.room.height:g} m high", got=str(np.round(camera.position, 3).tolist()),
                             remedy="move the camera, or set room.half_width or room.height")  # fmt: skip
    if not (np.abs(joints[..., :2]) < half).all():
        raise InputError("motion", expected="a way inside the room", got=f"one through a wall at {half:g} m",
                         remedy="make it shorter, or set room.half_width")  # fmt: skip


def _check_finite(value: Any, source: str, place: str) -> None:
    """Raise at the first number that is none; TOML knows nan and inf."""
    if isinstance(value, dict):
        for key, item in value.items():
            _check_finite(item, source, f"{place}.{key}" if place else str(key))
    elif isinstance(value, list):
        for index, item in enumerate(value):
            _check_finite(item, source, f"{place}[{index}]")
    elif isinstance(value, float) and not np.isfinite(value):
        raise InputError(f"{source}: {place}", expected="a finite number", got=str(value))
