"""Bodies as text: read one from TOML, write one back, or take one from the catalogue by name.

See `body/catalogue/person.toml` for a commented example. Lengths are metres, angles degrees, as the keys say.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from difflib import get_close_matches
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from muybridge.body.model import Body, Landmark, Rotation, Segment, Shape
from muybridge.errors import InputError

_SEGMENT_KEYS = {"name", "parent", "at", "offset_m", "orientation_deg", "orientation", "rotations", "shape", "length_group", "offset_group",
                 "radius_group", "block"}
_SHAPE_KEYS = {"base_m", "tip_m", "radii_m", "scale", "side", "ends"}
_BODY_KEYS = {"name", "source", "height_m", "segment", "joints"}
_TURN = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}


def catalogue() -> tuple[str, ...]:
    """Names of the bodies that ship with the package."""
    folder = resources.files("muybridge.body") / "catalogue"
    return tuple(sorted(entry.name[:-5] for entry in folder.iterdir() if entry.name.endswith(".toml")))


def named_body(name: str, height: float | None = None) -> Body:
    """A body of the catalogue, made `height` metres tall where that is given."""
    if name not in catalogue():
        near = get_close_matches(name, catalogue(), 1)
        raise InputError("body", expected=f"one of {', '.join(catalogue())}", got=repr(name), remedy=f"did you mean {near[0]!r}?" if near else "")
    text = (resources.files("muybridge.body") / "catalogue" / f"{name}.toml").read_text(encoding="utf8")
    body = parse_body(text, name)
    return body if height is None else body.with_height(height)


def read_body(path: str | Path) -> Body:
    """A body from a TOML file."""
    path = Path(path)
    try:
        text = path.read_text(encoding="utf8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"body file {path}", expected="a readable TOML file", got=str(error)) from error
    return parse_body(text, str(path))


def parse_body(text: str, where: str = "body") -> Body:
    """A body from TOML text; `where` names it in errors."""
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(where, expected="TOML", got=str(error)) from error
    _check_keys(where, data, _BODY_KEYS, {"name", "segment"})
    segments = tuple(_segment(where, entry) for entry in data["segment"])
    marks = {name: _landmark(where, name, entry) for name, entry in data.get("joints", {}).items()}
    return Body(data["name"], segments, marks, float(data.get("height_m", 1.75)), data.get("source", ""))


def write_body(path: str | Path, body: Body) -> None:
    """Write a body as TOML that `read_body` reads back exactly."""
    Path(path).write_text(dump_body(body), encoding="utf8")


def dump_body(body: Body) -> str:
    """A body as TOML text; numbers keep every digit."""
    lines = [f"name = {_quoted(body.name)}", f"source = {_quoted(body.source)}", f"height_m = {float(body.height)!r}", ""]
    for segment in body.segments:
        lines += ["[[segment]]", *_segment_lines(segment), ""]
    lines.append("[joints]")
    for name, mark in body.landmarks.items():
        at = "tip" if mark.at_tip else "origin"
        lines.append(f'{name} = {{segment = {_quoted(mark.segment)}, at = "{at}", offset_m = {_listed(mark.offset)}}}')
    return "\n".join(lines) + "\n"


def _segment_lines(segment: Segment) -> list[str]:
    turns = ", ".join(_rotation_text(rotation) for rotation in segment.rotations)
    lines = [
        f"name = {_quoted(segment.name)}",
        f"parent = {_quoted(segment.parent)}",
        f'at = "{"tip" if segment.at_tip else "origin"}"',
        f"offset_m = {_listed(segment.offset)}",
        f"orientation = [{', '.join(_listed(row) for row in segment.orientation)}]",
        f"rotations = [{turns}]",
        *(f"{key} = {_quoted(getattr(segment, key))}" for key in ("length_group", "offset_group", "radius_group", "block")),
    ]
    if segment.shape is not None:
        s = segment.shape
        lines.append(f"shape = {{base_m = {_listed(s.base)}, tip_m = {_listed(s.tip)}, radii_m = {_listed(s.radii)}, "
                     f'scale = {_listed(s.scale)}, side = {_listed(s.side)}, ends = "{"round" if s.round_ends else "flat"}"}}')
    return lines


def _rotation_text(rotation: Rotation) -> str:
    limits = ""
    if np.isfinite(rotation.lower) and np.isfinite(rotation.upper):
        limits = f", limits_rad = [{rotation.lower!r}, {rotation.upper!r}]"
    return f'{{name = {_quoted(rotation.name)}, axis = "{rotation.axis}"{limits}}}'


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _listed(numbers: Any) -> str:
    return "[" + ", ".join(repr(float(v)) for v in numbers) + "]"


def _check_keys(where: str, entry: Mapping[str, Any], known: set[str], needed: set[str]) -> None:
    if not isinstance(entry, Mapping):
        raise InputError(where, expected="a table", got=repr(entry))
    for key in entry:
        if key not in known:
            near = get_close_matches(key, known, 1)
            raise InputError(f"{where}: key {key!r}", expected=f"one of {', '.join(sorted(known))}", remedy=f"did you mean {near[0]!r}?" if near else "")
    missing = needed - set(entry)
    if missing:
        raise InputError(where, expected=f"the key {sorted(missing)[0]!r}", got="none")


def _numbers(where: str, value: Any, count: int) -> tuple[float, ...]:
    try:
        numbers = tuple(float(v) for v in value)
    except (TypeError, ValueError):
        numbers = ()
    if len(numbers) != count or not np.all(np.isfinite(numbers)):
        raise InputError(where, expected=f"{count} finite numbers", got=repr(value))
    return numbers


def _segment(where: str, entry: Mapping[str, Any]) -> Segment:
    _check_keys(where, entry, _SEGMENT_KEYS, {"name"})
    where = f"{where}: segment {entry['name']!r}"
    shape = _shape(where, entry["shape"]) if "shape" in entry else None
    at = entry.get("at", "origin")
    if at not in ("origin", "tip"):
        raise InputError(f"{where}: at", expected="'origin' or 'tip'", got=repr(at))
    pooled = entry["name"].removeprefix("left_").removeprefix("right_")
    return Segment(
        name=entry["name"],
        parent=entry.get("parent", ""),
        offset=_numbers(f"{where}: offset_m", entry.get("offset_m", (0, 0, 0)), 3),  # type: ignore[arg-type]
        at_tip=at == "tip",
        orientation=_matrix(where, entry["orientation"]) if "orientation" in entry
        else _orientation(where, entry.get("orientation_deg", ())),
        rotations=tuple(_rotation(where, turn) for turn in entry.get("rotations", ())),
        shape=shape,
        length_group=entry.get("length_group", pooled if shape and shape.base != shape.tip else ""),
        offset_group=entry.get("offset_group", ""),
        radius_group=entry.get("radius_group", pooled if shape else ""),
        block=entry.get("block", "root"),
    )


def _shape(where: str, entry: Mapping[str, Any]) -> Shape:
    _check_keys(f"{where}: shape", entry, _SHAPE_KEYS, {"radii_m"})
    base = _numbers(f"{where}: base_m", entry.get("base_m", (0, 0, 0)), 3)
    ends = entry.get("ends", "round")
    if ends not in ("round", "flat"):
        raise InputError(f"{where}: ends", expected="'round' or 'flat'", got=repr(ends))
    return Shape(
        base=base,  # type: ignore[arg-type]
        tip=_numbers(f"{where}: tip_m", entry.get("tip_m", base), 3),  # type: ignore[arg-type]
        radii=_numbers(f"{where}: radii_m", entry["radii_m"], 2),  # type: ignore[arg-type]
        scale=_numbers(f"{where}: scale", entry.get("scale", (1, 1)), 2),  # type: ignore[arg-type]
        side=_numbers(f"{where}: side", entry.get("side", (1, 0, 0)), 3),  # type: ignore[arg-type]
        round_ends=ends == "round",
    )


def _rotation(where: str, entry: Mapping[str, Any]) -> Rotation:
    _check_keys(f"{where}: rotation", entry, {"name", "axis", "limits_deg", "limits_rad"}, {"name", "axis"})
    lower, upper = -np.inf, np.inf
    if "limits_deg" in entry:
        lower, upper = np.radians(_numbers(f"{where}: limits_deg", entry["limits_deg"], 2))
    elif "limits_rad" in entry:
        lower, upper = _numbers(f"{where}: limits_rad", entry["limits_rad"], 2)
    return Rotation(entry["name"], entry["axis"], float(lower), float(upper))


def _orientation(where: str, turns: Any) -> tuple[tuple[float, float, float], ...]:
    """Fixed turns [["x", 90], ["y", 180]], applied from left to right, as a matrix."""
    matrix = np.eye(3)
    for turn in turns:
        if len(turn) != 2 or turn[0] not in _TURN:
            raise InputError(f"{where}: orientation_deg", expected='turns like ["x", 90]', got=repr(turn))
        i, j = _TURN[turn[0]]
        cosine, sine = np.cos(np.radians(turn[1])), np.sin(np.radians(turn[1]))
        one = np.eye(3)
        one[i, i] = one[j, j] = cosine
        one[i, j], one[j, i] = -sine, sine
        matrix = matrix @ one
    return tuple(tuple(float(v) for v in row) for row in matrix)  # type: ignore[return-value]


def _matrix(where: str, rows: Any) -> tuple[tuple[float, float, float], ...]:
    """A fixed turn as its rotation matrix, for turns that are no chain of axes."""
    flat = _numbers(f"{where}: orientation", [v for row in rows for v in row], 9)
    matrix = np.array(flat).reshape(3, 3)
    if np.abs(matrix @ matrix.T - np.eye(3)).max() > 1e-6 or np.linalg.det(matrix) < 0:
        raise InputError(f"{where}: orientation", expected="a right-handed rotation matrix", got=repr(rows))
    return tuple(tuple(row) for row in matrix.tolist())  # type: ignore[return-value]


def _landmark(where: str, name: str, entry: Mapping[str, Any]) -> Landmark:
    _check_keys(f"{where}: joint {name!r}", entry, {"segment", "at", "offset_m"}, {"segment"})
    offset = _numbers(f"{where}: joint {name!r}: offset_m", entry.get("offset_m", (0, 0, 0)), 3)
    return Landmark(entry["segment"], entry.get("at", "origin") == "tip", offset)  # type: ignore[arg-type]
