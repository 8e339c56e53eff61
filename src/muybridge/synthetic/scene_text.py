"""`Scene` -> scene.toml: every value written out, so that the file renders the same pictures again."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from muybridge import __version__
from muybridge.cameras.model import Camera
from muybridge.io import _toml
from muybridge.synthetic.description import Person, Scene
from muybridge.synthetic.light import Lamp, Light


def scene_text(scene: Scene) -> str:
    """The scene as TOML."""
    head = f"# What was rendered, by muybridge {__version__}; every value is written out, so no preset decides any.\n"
    return head + _toml.dumps(_plain(scene_table(scene)))


def scene_table(scene: Scene) -> dict[str, Any]:
    """The nested tables of a scene file, complete."""
    motion = _motion(scene.person)
    table: dict[str, Any] = {"seed": scene.seed, "duration": motion.pop("duration", None), "rate": motion.pop("rate")}
    table["follow"] = scene.follow
    if not scene.others:
        table["other"] = []
    if not scene.occluders:
        table["occluder"] = []
    table["person"] = _person(scene.person)
    table["motion"] = motion
    table["camera"] = [_camera(camera) for camera in scene.rig]
    table["room"] = asdict(scene.room)
    table["light"] = {"drift": scene.drift, "shadow": scene.shadow, **_light(scene.light)}
    table["sensor"] = {"noise": scene.noise, **asdict(scene.sensor)}
    if scene.occluders:
        table["occluder"] = [asdict(thing) for thing in scene.occluders]
    if scene.others:
        table["other"] = [{**_person(other), "motion": _own_motion(other)} for other in scene.others]
    return table


def _person(person: Person) -> dict[str, Any]:
    """All that is worn, the figure's own too, so that nobody draws anything for it."""
    whole = person.complete()
    names = ("figure", "cut", "hair", "looseness")
    return {**{name: getattr(whole, name) for name in names}, "garment": [asdict(item) for item in whole.outfit]}


def _motion(person: Person) -> dict[str, Any]:
    """A recorded motion has no duration of its own, and words that it leaves open are empty."""
    return {key: value for key, value in asdict(person.motion).items() if value not in ("", ())}


def _own_motion(person: Person) -> dict[str, Any]:
    return {key: value for key, value in _motion(person).items() if key not in ("duration", "rate")}


def _camera(camera: Camera) -> dict[str, Any]:
    return {
        "name": camera.name,
        "size": list(camera.size),
        "distortion": camera.distortion.tolist(),
        "matrix": camera.matrix.tolist(),
        "rotation": camera.rotation.tolist(),
        "translation": camera.translation.tolist(),
    }


def _light(light: Light) -> dict[str, Any]:
    switches = [{"time": switch.time, **_lamp(switch.lamp)} for switch in light.switches]
    return {**_lamp(light.lamp), "switch": switches}


def _lamp(lamp: Lamp) -> dict[str, Any]:
    return {"direction": list(lamp.direction), "gain": lamp.gain, "spot": list(lamp.spot)}


def _plain(value: Any) -> Any:
    """Python's own numbers: numpy's write themselves with their type."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return float(value)
    return int(value) if isinstance(value, np.integer) else value
