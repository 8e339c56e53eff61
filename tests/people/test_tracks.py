"""What comes out of tracking, of people made by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import cast

import numpy as np

from muybridge.people.colour_likelihood import ColourConfig
from muybridge.people.filtered import Filtered
from muybridge.people.person import Person, Sighting
from muybridge.people.tracks import bridged, gathered


def sighting(frame: int, x: float, seen: bool = True) -> Sighting:
    return Sighting(
        frame, np.array([x, 50.0, 20.0, 60.0, 1.0, 0.0]), 1.0, seen, np.array([[x, 30.0, 8.0, 9.0, 1.0]] * 3)
    )


def somebody(sightings: list[Sighting]) -> Person:
    """Nobody follows them any more: there is no filter."""
    return Person(7, cast(Filtered, None), np.random.default_rng(0), ColourConfig(), sightings=sightings)


WAY = [sighting(0, 10.0), sighting(1, 12.0), sighting(2, 90.0, False), sighting(3, 95.0, False), sighting(5, 20.0)]
"""Hidden in frames 2 and 3, where the estimate went astray; frame 4 was dropped."""


def test_who_was_hidden_walked_straight() -> None:
    """From 12 in frame 1 to 20 in frame 5: two pixels a frame."""
    found = bridged(WAY)
    assert [one.box[0] for one in found] == [10.0, 12.0, 14.0, 16.0, 20.0]
    assert [one.seen for one in found] == [one.seen for one in WAY] and [one.frame for one in found] == [0, 1, 2, 3, 5]
    for one in found:
        assert one.parts is not None
        np.testing.assert_array_equal(one.parts[:, 0], one.box[0])  # parts stay where they are on the body


def test_who_is_not_found_again_stays_where_it_was() -> None:
    assert bridged(WAY[:4])[2:] == WAY[2:4]
    person = somebody(WAY[:4])
    np.testing.assert_array_equal(gathered([person]).boxes.frames, [0, 1])  # up to the last sight


def test_frames_asked_for_are_bridged_from_before_them() -> None:
    boxes = gathered([somebody(WAY)], (2, 3)).boxes
    np.testing.assert_array_equal(boxes.frames, [3])
    assert boxes.boxes[0, 0] == 16.0 - 10.0 + 0.5  # half a width to the left, pixel i from i to i + 1


def test_what_was_seen_is_not_moved() -> None:
    seen = [replace(one, seen=True) for one in WAY]
    assert bridged(seen) == seen
