"""Bodies written as TOML that `load` reads back exactly."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from muybridge.body.model import Body
from muybridge.body.parts import Rotation, Segment, Shape

_TEXT_KEYS = ("length_group", "offset_group", "radius_group", "block")


def write_body(path: str | Path, body: Body) -> None:
    """Write a body as TOML that `read_body` reads back exactly."""
    Path(path).write_text(dump_body(body), encoding="utf8")


def dump_body(body: Body) -> str:
    """A body as TOML text; numbers keep every digit.

    Examples
    --------
    >>> from muybridge.body import named_body, parse_body
    >>> body = named_body("dog", height=0.62)
    >>> parse_body(dump_body(body)) == body
    True
    """
    lines = [f"name = {_quoted(body.name)}", f"source = {_quoted(body.source)}"]
    lines += [f"height_m = {_number(body.height)}", ""]
    for segment in body.segments:
        lines += ["[[segment]]", *_segment_lines(segment), ""]
    lines.append("[joints]")
    for name, mark in body.landmarks.items():
        at = _quoted("tip" if mark.at_tip else "origin")
        table = f"{{segment = {_quoted(mark.segment)}, at = {at}, offset_m = {_listed(mark.offset)}}}"
        lines.append(f"{_quoted(name)} = {table}")
    return "\n".join(lines) + "\n"


def _segment_lines(segment: Segment) -> list[str]:
    turns = ", ".join(_rotation_text(rotation) for rotation in segment.rotations)
    lines = [
        f"name = {_quoted(segment.name)}",
        f"parent = {_quoted(segment.parent)}",
        f"at = {_quoted('tip' if segment.at_tip else 'origin')}",
        f"offset_m = {_listed(segment.offset)}",
        f"orientation = [{', '.join(_listed(row) for row in segment.orientation)}]",
        f"rotations = [{turns}]",
    ]
    lines += [f"{key} = {_quoted(getattr(segment, key))}" for key in _TEXT_KEYS]
    return lines if segment.shape is None else [*lines, f"shape = {_shape_text(segment.shape)}"]


def _shape_text(shape: Shape) -> str:
    numbers = {
        "base_m": shape.base,
        "tip_m": shape.tip,
        "radii_m": shape.radii,
        "scale": shape.scale,
        "side": shape.side,
    }
    ends = _quoted("round" if shape.round_ends else "flat")
    return "{" + ", ".join(f"{key} = {_listed(value)}" for key, value in numbers.items()) + f", ends = {ends}}}"


def _rotation_text(rotation: Rotation) -> str:
    limits = ""
    if np.isfinite(rotation.lower) or np.isfinite(rotation.upper):
        limits = f", limits_rad = {_listed((rotation.lower, rotation.upper))}"
    usual = ""
    if rotation.usual != 0.0 or np.isfinite(rotation.usual_sd):
        usual = f", usual_rad = {_listed((rotation.usual, rotation.usual_sd))}"
    return f"{{name = {_quoted(rotation.name)}, axis = {_quoted(rotation.axis)}{limits}{usual}}}"


def _quoted(text: str) -> str:
    """A TOML string: JSON's escapes are TOML's too, but TOML wants one more character escaped."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _number(value: float) -> str:
    return repr(float(value))


def _listed(numbers: Iterable[float]) -> str:
    return "[" + ", ".join(_number(v) for v in numbers) + "]"
