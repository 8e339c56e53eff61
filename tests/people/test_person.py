"""One person: how tall and how broad they are found to be."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from muybridge.people.colour_likelihood import ColourConfig
from muybridge.people.filtered import Filtered
from muybridge.people.ground import GroundScale
from muybridge.people.person import Person

GROUND = GroundScale(offset=80.0, slope=0.0, aspect=0.4)


def measured(outline: tuple[float, float]) -> Person:
    """Somebody with a box of 24 x 60 where people have 32 x 80, after one outline (width, height) and a rate of 0.5."""
    body = SimpleNamespace(box=np.array([50.0, 70.0, 24.0, 60.0, 0.0, 0.0]))
    person = Person(0, cast(Filtered, body), np.random.default_rng(0), ColourConfig())
    person.measure(np.array([50.0, 70.0, *outline]), GROUND, 0.5)
    return person


def test_height_and_breadth_are_those_of_the_outline() -> None:
    """64 of 80 pixels: halfway from 1 to 0.8. 19.2 / 64 over 0.4: halfway from 1 to 0.75."""
    person = measured((19.2, 64.0))
    assert (person.stature, person.breadth) == pytest.approx((0.9, 0.875))


@pytest.mark.parametrize("outline", [(24.0, 40.0), (40.0, 60.0)])
def test_an_outline_that_is_not_the_box_says_nothing(outline: tuple[float, float]) -> None:
    """log 60 / 40 = 0.41 is more than 0.3, log 40 / 24 = 0.51 more than 0.4; height is then the box's, 60 of 80."""
    person = measured(outline)
    assert (person.stature, person.breadth) == pytest.approx((0.875, 1.0))
