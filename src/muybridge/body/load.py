"""Bodies from text: read one from TOML, or take one from the catalogue by name.

See docs/bodies.md for the format and `body/catalogue/person.toml` for a commented example. Lengths are metres, angles
degrees, as the keys say.
"""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from difflib import get_close_matches
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from muybridge.body.model import Body
from muybridge.body.parts import AXIS_CODES, UNTURNED, Landmark, Matrix, Rotation, Segment, Shape
from muybridge.errors import InputError

_BODY_KEYS = ("name", "source", "height_m", "segment", "joints")
_TEXT_KEYS = ("length_group", "offset_group", "radius_group", "block")
_SEGMENT_KEYS = (
    "name",
    "parent",
    "at",
    "offset_m",
    "orientation_deg",
    "orientation",
    "rotations",
    "shape",
    *_TEXT_KEYS,
)
_SHAPE_KEYS = ("base_m", "tip_m", "radii_m", "scale", "side", "ends")
_ROTATION_KEYS = ("name", "axis", "limits_deg", "limits_rad", "usual_deg", "usual_rad")
_JOINT_KEYS = ("segment", "at", "offset_m")
_TURNED_AXES = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}


def catalogue() -> tuple[str, ...]:
    """Names of the bodies that ship with the package."""
    folder = resources.files("muybridge.body") / "catalogue"
    names = (entry.name for entry in folder.iterdir())
    return tuple(sorted(name.removesuffix(".toml") for name in names if name.endswith(".toml")))


def named_body(name: str, height: float | None = None) -> Body:
    """A body of the catalogue, made `height` metres tall where that is given."""
    known = catalogue()
    if name not in known:
        raise InputError("body", expected=f"one of {', '.join(known)}", got=repr(name), remedy=_nearest(name, known))
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
    with _inside(where):
        try:
            data = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            raise InputError("text", expected="TOML", got=str(error)) from error
        _check_keys(data, _BODY_KEYS, needed=("name", "segment"))
        segments = tuple(_segment(entry) for entry in _tables("segment", data["segment"]))
        joints = data.get("joints", {})
        _check_table("joints", joints)
        marks = {name: _landmark(name, entry) for name, entry in joints.items()}
        (height,) = _numbers("height_m", [data.get("height_m", 1.75)], 1)
        return Body(_text("name", data["name"]), segments, marks, height, _text("source", data.get("source", ""), True))


def _segment(entry: Mapping[str, Any]) -> Segment:
    _check_keys(entry, _SEGMENT_KEYS, needed=("name",))
    name = _text("name", entry["name"])
    with _inside(f"segment {name!r}"):
        shape = _shape(entry["shape"]) if "shape" in entry else None
        pooled = name.removeprefix("left_").removeprefix("right_")
        groups = {
            "length_group": pooled if shape and shape.base != shape.tip else "",
            "offset_group": "",
            "radius_group": pooled if shape else "",
            "block": "root",
        }
        return Segment(
            name=name,
            parent=_text("parent", entry.get("parent", ""), True),
            offset=_numbers("offset_m", entry.get("offset_m", (0, 0, 0)), 3),  # type: ignore[arg-type]
            at_tip=_at_tip(entry),
            orientation=_orientation(entry),
            rotations=tuple(_rotation(turn) for turn in _tables("rotations", entry.get("rotations", ()))),
            shape=shape,
            **{key: _text(key, entry.get(key, default), True) for key, default in groups.items()},
        )


def _shape(entry: Any) -> Shape:
    with _inside("shape"):
        _check_keys(entry, _SHAPE_KEYS, needed=("radii_m",))
        base = _numbers("base_m", entry.get("base_m", (0, 0, 0)), 3)
        return Shape(
            base=base,  # type: ignore[arg-type]
            tip=_numbers("tip_m", entry.get("tip_m", base), 3),  # type: ignore[arg-type]
            radii=_numbers("radii_m", entry["radii_m"], 2),  # type: ignore[arg-type]
            scale=_numbers("scale", entry.get("scale", (1, 1)), 2),  # type: ignore[arg-type]
            side=_numbers("side", entry.get("side", (1, 0, 0)), 3),  # type: ignore[arg-type]
            round_ends=_choice("ends", entry.get("ends", "round"), ("round", "flat")) == "round",
        )


def _rotation(entry: Mapping[str, Any]) -> Rotation:
    with _inside("rotation"):
        _check_keys(entry, _ROTATION_KEYS, needed=("name", "axis"))
        name, axis = _text("name", entry["name"]), _choice("axis", entry["axis"], tuple(AXIS_CODES))
        limits = (-np.inf, np.inf)
        if "limits_deg" in entry:
            limits = tuple(np.radians(_numbers(f"limits_deg of {name!r}", entry["limits_deg"], 2, endless=True)))
        elif "limits_rad" in entry:
            limits = _numbers(f"limits_rad of {name!r}", entry["limits_rad"], 2, endless=True)  # type: ignore[assignment]
        usual = (0.0, np.inf)
        if "usual_deg" in entry:
            usual = tuple(np.radians(_numbers(f"usual_deg of {name!r}", entry["usual_deg"], 2, endless=True)))
        elif "usual_rad" in entry:
            usual = _numbers(f"usual_rad of {name!r}", entry["usual_rad"], 2, endless=True)  # type: ignore[assignment]
        return Rotation(name, axis, *map(float, (*limits, *usual)))


def _orientation(entry: Mapping[str, Any]) -> Matrix:
    """A fixed turn: a rotation matrix, or turns [["x", 90], ["y", 180]] applied from left to right."""
    if "orientation" in entry:
        try:
            flat = [v for row in entry["orientation"] for v in row]
        except TypeError:
            flat = []
        matrix = np.array(_numbers("orientation", flat, 9)).reshape(3, 3)
    elif "orientation_deg" in entry:
        matrix = _turned(entry["orientation_deg"])
    else:
        return UNTURNED
    return tuple(tuple(row) for row in matrix.tolist())  # type: ignore[return-value]


def _turned(turns: Any) -> np.ndarray:
    matrix = np.eye(3)
    for turn in turns if isinstance(turns, list) else [turns]:
        if not isinstance(turn, list) or len(turn) != 2 or turn[0] not in _TURNED_AXES:
            raise InputError("orientation_deg", expected='turns like ["x", 90]', got=repr(turn))
        i, j = _TURNED_AXES[turn[0]]
        (degrees,) = _numbers("orientation_deg", turn[1:], 1)
        cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        one = np.eye(3)
        one[i, i] = one[j, j] = cosine
        one[i, j], one[j, i] = -sine, sine
        matrix = matrix @ one
    return matrix


def _landmark(name: str, entry: Any) -> Landmark:
    with _inside(f"joint {name!r}"):
        _check_keys(entry, _JOINT_KEYS, needed=("segment",))
        offset = _numbers("offset_m", entry.get("offset_m", (0, 0, 0)), 3)
        return Landmark(_text("segment", entry["segment"]), _at_tip(entry), offset)  # type: ignore[arg-type]


def _at_tip(entry: Mapping[str, Any]) -> bool:
    return _choice("at", entry.get("at", "origin"), ("origin", "tip")) == "tip"


@contextmanager
def _inside(where: str) -> Iterator[None]:
    """Say in errors where in the file they are."""
    try:
        yield
    except InputError as error:
        what = error.what if error.what.startswith(where) else f"{where}: {error.what}"
        raise InputError(what, expected=error.expected, got=error.got, remedy=error.remedy) from error.__cause__


def _nearest(word: str, known: Collection[str]) -> str:
    near = get_close_matches(word, known, 1)
    return f"did you mean {near[0]!r}?" if near else ""


def _check_table(what: str, entry: Any) -> None:
    if not isinstance(entry, Mapping):
        raise InputError(what, expected="a table", got=repr(entry))


def _check_keys(entry: Any, known: Collection[str], needed: Collection[str]) -> None:
    _check_table("value", entry)
    for key in entry:
        if key not in known:
            raise InputError(f"key {key!r}", expected=f"one of {', '.join(known)}", remedy=_nearest(key, known))
    for key in needed:
        if key not in entry:
            raise InputError("keys", expected=f"{key!r}", got=", ".join(entry) or "none")


def _tables(what: str, entries: Any) -> list[Mapping[str, Any]]:
    if not isinstance(entries, list | tuple) or not all(isinstance(entry, Mapping) for entry in entries):
        raise InputError(what, expected="a list of tables", got=repr(entries))
    return list(entries)


def _text(what: str, value: Any, may_be_empty: bool = False) -> str:
    if not isinstance(value, str) or not (value or may_be_empty):
        raise InputError(what, expected="a text", got=repr(value))
    return value


def _choice(what: str, value: Any, known: tuple[str, ...]) -> str:
    if value not in known:
        raise InputError(what, expected=f"one of {', '.join(known)}", got=repr(value))
    return value


def _numbers(what: str, value: Any, count: int, endless: bool = False) -> tuple[float, ...]:
    """`count` finite numbers; where `endless`, infinite ones too."""
    numbers = value if isinstance(value, list | tuple) else ()
    plain = all(isinstance(v, int | float) and not isinstance(v, bool) for v in numbers)
    if len(numbers) != count or not plain or not all(np.isfinite(v) or endless and not np.isnan(v) for v in numbers):
        got = repr(value[0] if count == 1 and isinstance(value, list) and value else value)
        raise InputError(what, expected=f"{count} finite number{'s' * (count > 1)}", got=got)
    return tuple(float(v) for v in numbers)
