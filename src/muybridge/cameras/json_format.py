"""Our own calibration file: JSON with its version and its units in the keys. Written and read without loss."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from muybridge.cameras._reading import numbers, picture_size, read_text, require
from muybridge.cameras.model import Camera, Rig
from muybridge.cameras.rotations import nearest_rotation
from muybridge.errors import InputError

FORMAT = "muybridge-cameras"
VERSION = 1
WORLD = "metres, right-handed, z up; X_camera = rotation X_world + translation; x right, y down, z forward"


def write_rig(path: Path | str, rig: Rig) -> None:
    """Write a rig as JSON; numbers keep all their digits."""
    document = {
        "format": FORMAT,
        "version": VERSION,
        "world": WORLD,
        "cameras": [
            {
                "name": camera.name,
                "size_px": list(camera.size),
                "matrix_px": camera.matrix.tolist(),
                "distortion_k1_k2_p1_p2_k3": camera.distortion.tolist(),
                "rotation_world_to_camera": camera.rotation.tolist(),
                "translation_m": camera.translation.tolist(),
            }
            for camera in rig
        ],
    }
    Path(path).write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")


def read_json(paths: Sequence[Path]) -> list[Camera]:
    """Cameras of files that `write_rig` wrote."""
    return [camera for path in paths for camera in _cameras_in(path)]


def _cameras_in(path: Path) -> list[Camera]:
    what = f"calibration {path}"
    try:
        document = json.loads(read_text(path))
    except (ValueError, RecursionError) as error:
        raise InputError(what, expected="JSON", got=str(error)) from None
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise InputError(what, expected=f'JSON with "format": "{FORMAT}"', got="another kind of JSON")
    if document.get("version") != VERSION:
        raise InputError(
            f"{what}: version",
            expected=str(VERSION),
            got=repr(document.get("version")),
            remedy="it was written by another version of this program",
        )
    entries = require(what, document, "cameras")
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise InputError(f"{what}: cameras", expected="a list of objects", got=type(entries).__name__)
    return [_camera(f"{what}, camera {index + 1}", entry) for index, entry in enumerate(entries)]


def _camera(what: str, entry: dict[str, Any]) -> Camera:
    def field(key: str, count: int) -> Any:
        return numbers(f"{what} {key}", require(what, entry, key), count)

    rotation = field("rotation_world_to_camera", 9).reshape(3, 3)
    nearest = nearest_rotation(f"{what} rotation_world_to_camera", rotation)
    return Camera(
        name=require(what, entry, "name"),
        size=picture_size(what, require(what, entry, "size_px")),
        matrix=field("matrix_px", 9).reshape(3, 3),
        distortion=field("distortion_k1_k2_p1_p2_k3", 5),
        # What we wrote is orthonormal already; only a matrix edited by hand is replaced by its neighbour.
        rotation=rotation if abs(rotation - nearest).max() < 1e-12 else nearest,
        translation=field("translation_m", 3),
    )
