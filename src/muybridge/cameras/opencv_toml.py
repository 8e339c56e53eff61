"""Calibrations in TOML as Pose2Sim, Anipose and caliscope write them: one table per camera.

A table has name, size, matrix, distortions, rotation (Rodrigues vector, world to camera) and translation; the table
`metadata` is no camera. What differs between the programs:

| | unit | world | distortions | fisheye key |
|---|---|---|---|---|
| Pose2Sim | metres | z up | 4 | always |
| Anipose | of the board's squares, mostly mm | first camera's or the board's | 5 | only when true |
| caliscope | metres | as the user set it | 5 | sometimes |
"""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from muybridge.cameras._reading import five_coefficients, numbers, picture_size, read_text, require, to_metres
from muybridge.cameras.model import Camera
from muybridge.cameras.rotations import nearest_rotation, rotation_from_vector
from muybridge.errors import InputError


def read_opencv_toml(paths: Sequence[Path], unit: str | None = None) -> list[Camera]:
    """Cameras of TOML files, in the files' order, in metres.

    Parameters
    ----------
    paths : files
    unit : "m", "cm" or "mm"; None judges by the size of the rig and refuses what could be either
    """
    cameras = [camera for path in paths for camera in _cameras_in(path)]
    return to_metres(f"calibration {paths[0]}", cameras, unit)


def _cameras_in(path: Path) -> list[Camera]:
    try:
        document = tomllib.loads(read_text(path))
    except (ValueError, RecursionError) as error:
        raise InputError(f"calibration {path}", expected="TOML", got=str(error)) from None
    tables = {key: value for key, value in document.items() if key != "metadata" and isinstance(value, dict)}
    if not tables:
        raise InputError(f"calibration {path}", expected="a table [NAME] for each camera", got="none")
    return [_camera(f"calibration {path}, [{key}]", key, table) for key, table in tables.items()]


def _camera(what: str, key: str, table: dict[str, Any]) -> Camera:
    if table.get("fisheye", False):
        raise InputError(
            f"{what}: fisheye",
            expected="a pinhole camera with radial and tangential distortion",
            got="fisheye = true",
            remedy="undistort the video first, or calibrate without the fisheye model",
        )
    rotation = numbers(f"{what} rotation", require(what, table, "rotation"), 3, 9)
    return Camera(
        name=str(table.get("name", key)),
        size=picture_size(what, require(what, table, "size")),
        matrix=numbers(f"{what} matrix", require(what, table, "matrix"), 9).reshape(3, 3),
        distortion=five_coefficients(f"{what} distortions", require(what, table, "distortions", "distortion")),
        rotation=(
            rotation_from_vector(rotation)
            if rotation.size == 3
            else nearest_rotation(f"{what} rotation", rotation.reshape(3, 3))
        ),
        translation=numbers(f"{what} translation", require(what, table, "translation"), 3),
    )
