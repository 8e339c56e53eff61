"""Parts check themselves: every wrong number is one line that says what, expected and got."""

from __future__ import annotations

import math

import pytest

from muybridge.body import Landmark, Rotation, Segment, Shape
from muybridge.errors import InputError

CONE = {"base": (0.0, 0.0, 0.0), "tip": (0.0, 0.0, 1.0), "radii": (0.1, 0.2)}


@pytest.mark.parametrize("value", [0.0, -0.1, math.nan, math.inf])
@pytest.mark.parametrize("key", ["radii", "scale"])
def test_sizes_are_positive(key: str, value: float) -> None:
    with pytest.raises(InputError, match=f"^shape: {key}: expected positive numbers, got .*$"):
        Shape(**{**CONE, key: (0.1, value)})


@pytest.mark.parametrize("value", [(0.0, 0.0, math.nan), (0.0, math.inf, 0.0), (0.0, 0.0)])
def test_places_are_three_finite_numbers(value: tuple[float, ...]) -> None:
    for make in (
        lambda: Shape(**{**CONE, "base": value}),
        lambda: Shape(**{**CONE, "tip": value}),
        lambda: Shape(**{**CONE, "side": value}),
        lambda: Segment("a", offset=value),
        lambda: Landmark("a", offset=value),
    ):
        with pytest.raises(InputError, match="expected 3 finite numbers, got"):
            make()


def test_limits_are_in_order() -> None:
    with pytest.raises(InputError, match=r"got \[90, -90\] degrees; swap them"):
        Rotation("bend", "x", math.pi / 2, -math.pi / 2)
    with pytest.raises(InputError, match="limits"):
        Rotation("bend", "x", math.nan, 1.0)
    assert Rotation("stiff", "x", 0.0, 0.0).upper == 0.0


@pytest.mark.parametrize(("usual", "sd"), [(math.nan, 1.0), (math.inf, 1.0), (0.0, 0.0), (0.0, -0.1), (0.0, math.nan)])
def test_what_is_usual_is_an_angle_and_a_deviation(usual: float, sd: float) -> None:
    message = r"^rotation 'bend': usual: expected an angle and a positive deviation, got \[.*\] degrees$"
    with pytest.raises(InputError, match=message):
        Rotation("bend", "x", usual=usual, usual_sd=sd)


def test_nothing_is_usual_unless_said() -> None:
    assert Rotation("bend", "x").usual_sd == math.inf


def test_axes_are_known() -> None:
    with pytest.raises(InputError, match="axis: expected one of x, y, z, -x, -y, -z, got 'w'"):
        Rotation("bend", "w")


def test_no_more_than_three_rotations() -> None:
    turns = tuple(Rotation(f"turn_{i}", "x") for i in range(4))
    with pytest.raises(InputError, match="expected at most 3 rotations, got 4"):
        Segment("joint", rotations=turns)


@pytest.mark.parametrize(
    "rows",
    [
        ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0)),
        ((2.0, 0.0, 0.0), (0.0, 0.5, 0.0), (0.0, 0.0, 1.0)),
        ((math.nan, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    ],
    ids=["mirror", "stretch", "nan"],
)
def test_orientations_are_rotations(rows: tuple) -> None:
    with pytest.raises(InputError, match="expected a right-handed rotation matrix"):
        Segment("turned", orientation=rows)


def test_a_shape_is_resized_along_and_across() -> None:
    shape = Shape(**CONE).resized(2.0, 3.0, 0.5)
    assert shape.length == 2.0 and shape.scale == (3.0, 0.5) and shape.radii == CONE["radii"]
