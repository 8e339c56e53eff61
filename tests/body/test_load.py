"""Reading bodies: what the short forms mean, and one line for everything that is wrong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from muybridge.body import named_body, parse_body, read_body
from muybridge.errors import InputError

LEAST = """
name = "stick"
[[segment]]
name = "left_stick"
shape = {tip_m = [0, 0, 1], radii_m = [0.1, 0.1]}
"""
TWO = (
    LEAST
    + """
[[segment]]
name = "end"
parent = "left_stick"
at = "tip"
rotations = [{name = "bend", axis = "x", limits_deg = [-90, 45]}]
[joints]
end = {segment = "end"}
"""
)


def test_what_is_left_out() -> None:
    body = parse_body(LEAST)
    (stick,) = body.segments
    assert (stick.length_group, stick.radius_group, stick.offset_group, stick.block) == ("stick", "stick", "", "root")
    assert stick.shape is not None and stick.shape.round_ends and stick.shape.scale == (1.0, 1.0)
    assert body.dof_names == ("root_x", "root_y", "root_z")
    assert (body.height, body.source, body.joint_names) == (1.75, "", ())


def test_a_ball_has_no_length_to_fit() -> None:
    (ball,) = parse_body(LEAST.replace("tip_m = [0, 0, 1], ", "")).segments
    assert (ball.length_group, ball.radius_group) == ("", "stick")


def test_degrees_become_radians() -> None:
    body = parse_body(TWO)
    np.testing.assert_allclose([body.lower[3], body.upper[3]], [-np.pi / 2, np.pi / 4])


@pytest.mark.parametrize("text", ["usual_deg = [30, 9]", f"usual_rad = [{np.pi / 6}, {np.pi / 20}]"])
def test_what_is_usual_by_degrees_or_radians(text: str) -> None:
    """Angle and deviation; places have none."""
    body = parse_body(TWO.replace("limits_deg", f"{text}, limits_deg"))
    np.testing.assert_allclose(body.usual, [[0, 0, 0, np.pi / 6], [np.inf, np.inf, np.inf, np.pi / 20]])
    np.testing.assert_array_equal(parse_body(TWO).usual, [[0.0] * 4, [np.inf] * 4])


def test_fixed_turns_are_applied_from_left_to_right() -> None:
    text = TWO.replace('at = "tip"', 'orientation_deg = [["x", 90], ["z", 90]]')
    turn = parse_body(text).frames(np.zeros(4))[0, 1, :, :3]
    np.testing.assert_allclose(turn @ [1, 0, 0], [0, 0, 1], atol=1e-15)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("radii_m = [0.1, 0.1]", "radii_m = [0.1, 0]", "stick.toml: segment 'left_stick': shape: radii: .*positive"),
        ("radii_m = [0.1, 0.1]", "radii_m = [0.1, nan]", "shape: radii_m: expected 2 finite numbers, got"),
        ("radii_m = [0.1, 0.1]", "radii_m = [0.1]", "radii_m: expected 2 finite numbers, got"),
        ("radii_m = [0.1, 0.1]", "radii = [0.1, 0.1]", "key 'radii': expected one of .*; did you mean 'radii_m'"),
        ("radii_m = [0.1, 0.1]", "scale = [1, 1]", "shape: keys: expected 'radii_m', got tip_m, scale"),
        ("tip_m = [0, 0, 1]", "tip_m = [0, 0, inf]", "shape: tip_m: expected 3 finite numbers"),
        ("tip_m = [0, 0, 1]", 'tip_m = "long"', "shape: tip_m: expected 3 finite numbers, got 'long'"),
        ("tip_m = [0, 0, 1]", "tip_m = [0, 0, true]", "shape: tip_m: expected 3 finite numbers"),
        ("tip_m = [0, 0, 1]", 'ends = "square"', "ends: expected one of round, flat, got 'square'"),
        ("shape = {", "shapes = {", "key 'shapes': expected one of .*did you mean 'shape'"),
        ('shape = {tip_m = [0, 0, 1], radii_m = [0.1, 0.1]}', 'shape = "cone"', "shape: value: expected a table"),
        ('name = "stick"', 'nam = "stick"', "key 'nam': .*; did you mean 'name'"),
        ('name = "stick"', "name = 3", "stick.toml: name: expected a text, got 3"),
        ('name = "stick"', 'name = "stick"\nheight_m = -1', "height: expected a positive number of metres, got -1"),
        ('name = "stick"', 'name = "stick"\nheight_m = "tall"', "height_m: expected 1 finite number, got 'tall'"),
        ('name = "left_stick"', "name = []", "name: expected a text, got"),
        ('parent = "left_stick"', 'parent = "stock"', "parent of 'end': expected one of left_stick, end, got 'stock'"),
        ('parent = "left_stick"', "parent = 1", "segment 'end': parent: expected a text, got 1"),
        ('parent = "left_stick"', 'parent = "end"', "a tree, got a cycle among end"),
        ('name = "end"', 'name = "left_stick"', "every segment named once, got left_stick"),
        ('at = "tip"', 'at = "top"', "segment 'end': at: expected one of origin, tip, got 'top'"),
        ('at = "tip"', "offset_m = 3", "segment 'end': offset_m: expected 3 finite numbers, got 3"),
        ('at = "tip"', "block = 3", "segment 'end': block: expected a text, got 3"),
        ('at = "tip"', 'orientation_deg = [["w", 9]]', "orientation_deg: expected turns like"),
        ('at = "tip"', 'orientation_deg = [["x", "far"]]', "orientation_deg: expected 1 finite number, got 'far'"),
        ('at = "tip"', "orientation = 3", "orientation: expected 9 finite numbers"),
        ('at = "tip"', "orientation = [[1,0,0],[0,1,0],[0,0,-1]]", "expected a right-handed rotation matrix"),
        ("limits_deg = [-90, 45]", "limits_deg = [45, -90]", r"limits: .* got \[45, -90\] degrees; swap them"),
        ("limits_deg = [-90, 45]", "limits_deg = [nan, 45]", "limits_deg of 'bend': expected 2 finite numbers"),
        ("limits_deg = [-90, 45]", "usual_deg = [0, 0]", r"rotation 'bend': usual: .*, got \[0, 0\] degrees"),
        ("limits_deg = [-90, 45]", "usual_deg = [inf, 9]", r"rotation 'bend': usual: expected an angle"),
        ("limits_deg = [-90, 45]", "usual_deg = 9", "usual_deg of 'bend': expected 2 .*numbers, got 9"),
        ("limits_deg = [-90, 45]", "usual_rad = [0, nan]", "usual_rad of 'bend': expected 2 .*numbers"),
        ("limits_deg = [-90, 45]", "usual = [0, 9]", "rotation: key 'usual': .*; did you mean 'usual_"),
        ("limits_deg", "limit_deg", "rotation: key 'limit_deg': .*; did you mean 'limits_deg'"),
        ('axis = "x"', 'axis = "w"', "rotation: axis: expected one of x, y, z, -x, -y, -z, got 'w'"),
        ('name = "bend"', 'name = "root_z"', "every degree of freedom named once, got root_z"),
        ("rotations = [{", "rotations = 3 # [{", "rotations: expected a list of tables, got 3"),
        ('segment = "end"', 'segment = "toe"', "joint 'end': expected a segment of the body, got 'toe'"),
        ('segment = "end"', 'segment = "end", at = "top"', "joint 'end': at: expected one of origin, tip, got 'top'"),
        ('{segment = "end"}', "3", "joint 'end': value: expected a table, got 3"),
        ("[[segment]]", "[segment]", "expected TOML, got"),
        ("[joints]", "[joints", "expected TOML, got"),
    ],
)  # fmt: skip
def test_errors_are_one_line(old: str, new: str, message: str) -> None:
    assert old in TWO
    with pytest.raises(InputError, match=message) as error:
        parse_body(TWO.replace(old, new, 1), "stick.toml")
    assert "\n" not in str(error.value) and str(error.value).startswith("stick.toml: ")


def test_no_segments_and_no_joints_table() -> None:
    with pytest.raises(InputError, match="segment: expected a list of tables, got 3"):
        parse_body('name = "stick"\nsegment = 3')
    with pytest.raises(InputError, match="keys: expected 'segment', got name"):
        parse_body('name = "stick"')
    with pytest.raises(InputError, match="joints: expected a table, got 3"):
        parse_body("joints = 3\n" + LEAST)


def test_names_that_are_nearly_right() -> None:
    with pytest.raises(InputError, match="body: expected one of bodytrack, .*got 'du-2004'; did you mean 'du-2005'"):
        named_body("du-2004")


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="^body file .*: expected a readable TOML file"):
        read_body(tmp_path / "none.toml")
    (tmp_path / "picture.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="^body file .*: expected a readable TOML file"):
        read_body(tmp_path / "picture.toml")
