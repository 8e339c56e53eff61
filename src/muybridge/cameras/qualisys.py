"""Calibrations as Qualisys Track Manager exports them: `.qca.txt`, which is XML.

Lengths are in millimetres; focal lengths, principal point and skew in 64ths of a pixel; the distortion coefficients
are plain numbers (dividing them by 64 too is a known mistake of a converter). `transform` holds the camera's position
in the world and the rotation from the world to Qualisys' camera axes, which look along -z with y up; half a turn
about x makes them x right, y down, z forward. `fov_video` is the part of the sensor that was recorded.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from muybridge.cameras._reading import picture_size, read_text, to_metres
from muybridge.cameras.model import Camera
from muybridge.cameras.rotations import nearest_rotation
from muybridge.errors import InputError

PIXEL_PARTS = 64.0
HALF_TURN_ABOUT_X = np.diag([1.0, -1.0, -1.0])


def read_qualisys(paths: Sequence[Path], unit: str | None = None) -> list[Camera]:
    """The active cameras of `.qca.txt` files, named by their serial, in metres."""
    cameras = [camera for path in paths for camera in _cameras_in(path)]
    return to_metres(f"calibration {paths[0]}", cameras, unit or "mm")


def parse_xml(what: str, text: str) -> ElementTree.Element:
    """The root of an XML text; document types are refused, since entities may expand without bound."""
    if "<!DOCTYPE" in text.upper() or "<!ENTITY" in text.upper():
        raise InputError(what, expected="XML without a document type", got="a DOCTYPE")
    try:
        return ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise InputError(what, expected="XML", got=str(error)) from None


def _cameras_in(path: Path) -> list[Camera]:
    what = f"calibration {path}"
    root = parse_xml(what, read_text(path))
    if "fisheye" in (root.get("type") or "").lower():
        raise InputError(what, expected="a pinhole calibration", got="type fisheye")
    elements = [element for element in root.iter("camera") if element.get("active", "1") != "0"]
    if not elements:
        raise InputError(what, expected="<camera> elements", got=f"none in <{root.tag}>")
    return [_camera(what, element) for element in elements]


def _camera(what: str, element: ElementTree.Element) -> Camera:
    serial = element.get("serial")
    if not serial:
        raise InputError(what, expected="an attribute 'serial' for each <camera>", got="none")
    what = f"{what}, camera {serial}"
    view, lens, place = (_child(what, element, name) for name in ("fov_video", "intrinsic", "transform"))
    left, top = _number(what, view, "left"), _number(what, view, "top")
    size = (_number(what, view, "right") - left + 1, _number(what, view, "bottom") - top + 1)
    names = ("focalLengthU", "focalLengthV", "centerPointU", "centerPointV")
    fx, fy, cx, cy = (_number(what, lens, name) / PIXEL_PARTS for name in names)
    skew = _number(what, lens, "skew", default=0.0) / PIXEL_PARTS
    rows = [[_number(what, place, f"r{row}{column}") for column in (1, 2, 3)] for row in (1, 2, 3)]
    rotation = HALF_TURN_ABOUT_X @ nearest_rotation(f"{what}: transform", np.array(rows))
    position = np.array([_number(what, place, axis) for axis in ("x", "y", "z")])
    return Camera(
        name=serial,
        size=picture_size(what, size),
        matrix=np.array([[fx, skew, cx - left], [0.0, fy, cy - top], [0.0, 0.0, 1.0]]),
        distortion=_distortion(what, lens),
        rotation=rotation,
        translation=-rotation @ position,
    )


def _distortion(what: str, lens: ElementTree.Element) -> np.ndarray:
    """k1 k2 p1 p2 k3. The files write 'tangental'; the right spelling is read as well."""
    spelled = "tangental" if lens.get("tangentalDistortion1") is not None else "tangential"
    k1, k2 = (_number(what, lens, f"radialDistortion{order}") for order in (1, 2))
    k3 = _number(what, lens, "radialDistortion3", default=0.0)
    p1, p2 = (_number(what, lens, f"{spelled}Distortion{order}", default=0.0) for order in (1, 2))
    return np.array([k1, k2, p1, p2, k3])


def _child(what: str, element: ElementTree.Element, name: str) -> ElementTree.Element:
    child = element.find(name)
    if child is None:
        raise InputError(
            what, expected=f"an element <{name}>", got=", ".join(sorted({c.tag for c in element})) or "none"
        )
    return child


def _number(what: str, element: ElementTree.Element, name: str, default: float | None = None) -> float:
    text = element.get(name)
    if text is None and default is not None:
        return default
    try:
        value = float(text) if text is not None else math.nan
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{what}: <{element.tag}> {name}", expected="a number", got=repr(text))
    return value
