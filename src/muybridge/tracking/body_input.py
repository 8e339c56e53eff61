"""A job's `[body]` table made a body: by name or file, by height, by measured segments."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from muybridge.body import Body, named_body, read_body
from muybridge.body.bodytrack import bodytrack_body
from muybridge.datasets.bodytrack import read_measures
from muybridge.errors import InputError
from muybridge.io.job import BodyInput

DEFAULT_BODY = "person"


def body_from(entry: BodyInput) -> Body:
    """The body of a job."""
    body = read_body(entry.file) if entry.file else named_body(entry.name or DEFAULT_BODY)
    if entry.height_m is not None:
        body = body.with_height(entry.height_m)
    if entry.measures is None:
        return body
    if isinstance(entry.measures, Mapping):
        return with_measures(body, entry.measures)
    path = Path(entry.measures)
    if path.suffix != ".toml" and body.name == "bodytrack":
        measures = read_measures(path)
        return bodytrack_body(measures["radii"], measures["lengths"])
    try:
        table = tomllib.loads(path.read_text(encoding="utf8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(
            f"body measures {path}", expected="a TOML file of lengths in metres", got=str(error)
        ) from error
    return with_measures(body, table)


def with_measures(body: Body, measures: Mapping[str, float]) -> Body:
    """The body with measured lengths, metres, by length group or segment (`upper_arm`, `left_thigh`)."""
    lengths = own_lengths(body)
    factors: dict[str, float] = {}
    for name, metres in measures.items():
        group = name if name in lengths else name.removeprefix("left_").removeprefix("right_")
        if group not in lengths:
            raise InputError(f"body measure {name!r}", expected=f"one of {', '.join(lengths)}")
        if not (isinstance(metres, int | float) and 0 < metres < 100):
            raise InputError(f"body measure {name!r}", expected="metres", got=repr(metres))
        factors[group] = float(metres) / lengths[group]
    return body.scaled(lengths=factors)


def own_lengths(body: Body) -> dict[str, float]:
    """Length in metres of every length group: of its segment, or of the joint's distance from its parent's."""
    lengths: dict[str, float] = {}
    for segment in body.segments:
        if segment.length_group and segment.shape is not None:
            span = float(np.linalg.norm(np.subtract(segment.shape.tip, segment.shape.base)))
            lengths.setdefault(segment.length_group, span)
    for segment in body.segments:
        if segment.offset_group and segment.offset_group not in lengths:
            lengths[segment.offset_group] = float(np.linalg.norm(segment.offset))
    return {name: length for name, length in lengths.items() if length > 0}
