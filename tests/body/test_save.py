"""Bodies come back from their text exactly, whatever is in them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from muybridge.body import (
    Body,
    Landmark,
    Rotation,
    Segment,
    Shape,
    catalogue,
    dump_body,
    named_body,
    parse_body,
    read_body,
    write_body,
)

NUMBERS = st.floats(-1e3, 1e3, allow_subnormal=False)
SIZES = st.floats(1e-6, 10)
WORDS = st.text(st.characters(codec="utf-8", exclude_categories=["Cs"]), min_size=1, max_size=12)


@pytest.mark.parametrize("name", catalogue())
def test_every_body_of_the_catalogue_comes_back(name: str, tmp_path: Path) -> None:
    fitted = named_body(name, 1.0 / 3.0 + 1.4)
    fitted = fitted.scaled(lengths={fitted.length_groups[0]: math.pi / 3})
    for body in (named_body(name), fitted):
        write_body(tmp_path / "body.toml", body)
        again = read_body(tmp_path / "body.toml")
        assert again == body and again.dof_names == body.dof_names and again.joint_names == body.joint_names
        pose = np.linspace(-1, 1, len(body.dof_names))
        np.testing.assert_array_equal(again.joints(pose), body.joints(pose))


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_any_body_comes_back(data: st.DataObject) -> None:
    """Names with quotes, line ends and letters of any script; limits on one side; angles that are usual, with and
    without a deviation; every number to its last digit.
    """
    draw = data.draw
    vector = st.tuples(NUMBERS, NUMBERS, NUMBERS)
    shape = Shape(draw(vector), draw(vector), draw(st.tuples(SIZES, SIZES)), draw(st.tuples(SIZES, SIZES)))
    angle = draw(NUMBERS)
    turned = ((math.cos(angle), -math.sin(angle), 0.0), (math.sin(angle), math.cos(angle), 0.0), (0.0, 0.0, 1.0))
    usual = draw(NUMBERS), draw(SIZES | st.just(math.inf))
    rotations = (Rotation(draw(WORDS), "-y", -math.inf, draw(NUMBERS), *usual), Rotation("free", "z"))
    segments = (
        Segment("root", shape=shape, length_group=draw(WORDS), radius_group=""),
        Segment(draw(WORDS) + "!", "root", draw(vector), draw(st.booleans()), turned, rotations, block=draw(WORDS)),
    )
    marks = {draw(WORDS): Landmark("root", draw(st.booleans()), draw(vector))}
    body = Body(draw(WORDS), segments, marks, draw(SIZES), draw(st.text(max_size=20).filter(str.isprintable)))
    assert parse_body(dump_body(body)) == body
