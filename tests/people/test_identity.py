"""Looks, exchanges and recalls on people made by hand."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from made_people import Walker, picture_of
from muybridge.errors import InputError
from muybridge.people.appearance import colour_codes
from muybridge.people.box import states_from_boxes
from muybridge.people.colour_likelihood import ColourConfig
from muybridge.people.evidence import Evidence
from muybridge.people.filtered import Filtered, Frame
from muybridge.people.histograms import to_luma_chroma
from muybridge.people.identity import Identities, IdentityConfig, Look, bands_of, exchange, gap_between, take_up
from muybridge.people.person import Person, Sighting
from muybridge.people.silhouette import Silhouette
from muybridge.people.tracks import bridged
from people.made import EMPTY


def state_of(walker: Walker, frame: int) -> np.ndarray:
    return states_from_boxes(np.array([walker.box(frame)]))[0]


def test_a_look_knows_its_own_clothes() -> None:
    """Two seconds later and elsewhere, the same clothes are nearer than others by far."""
    walkers = [Walker((40 + 100 * k, 170), (60 + 100 * k, 170), 0, 20, k) for k in range(3)]
    first, later = (to_luma_chroma(picture_of(walkers, frame, EMPTY)[0]) for frame in (0, 20))
    looks = [Look.learn(first, state_of(walker, 0), ColourConfig()) for walker in walkers]
    distances = np.array([[look.distance(later, state_of(walker, 20)) for walker in walkers] for look in looks])
    assert (np.diag(distances) < 0.5).all()
    assert (distances[~np.eye(3, dtype=bool)] > 2).all()


def test_bands_are_inside_the_box_from_head_to_legs() -> None:
    bands = bands_of(np.array([50.0, 40.0, 20.0, 60.0, 0, 0]))
    assert (np.diff(bands[:, 1]) > 0).all()
    assert (bands[:, 1] - bands[:, 3] / 2 >= 10).all() and (bands[:, 1] + bands[:, 3] / 2 <= 70).all()
    assert (bands[:, 2] <= 10).all()


def test_gaps_are_in_widths_at_the_feet() -> None:
    box = np.array([50.0, 40.0, 20.0, 60.0])
    assert gap_between(box, box + [30, 0, 0, 0]) == pytest.approx(1.5)
    assert gap_between(box, box + [0, 30, 0, 0]) == pytest.approx(1.0)  # half the height counts as a width


def person(identity: int, frames: range, x: float = 0.0) -> Person:
    sightings = [Sighting(frame, np.array([x + frame, 5.0, 2.0, 4.0, 1.0, 0.0]), 1.0, True) for frame in frames]
    made = Person(identity, None, np.random.default_rng(0), ColourConfig(), sightings=sightings)  # type: ignore[arg-type]
    made.last_clear = sightings[-1]
    return made


def test_an_exchange_swaps_what_was_before_and_leaves_what_comes_after() -> None:
    a, b = person(1, range(10)), person(2, range(3, 10), x=100)
    exchange(a, b, 5)
    assert (a.identity, b.identity) == (2, 1)
    assert [s.frame for s in a.sightings] == list(range(3, 10)) and [s.frame for s in b.sightings] == list(range(10))
    assert [s.box[0] > 50 for s in a.sightings] == [True] * 3 + [False] * 4
    exchange(a, b, 5)  # its own inverse
    assert (a.identity, b.identity) == (1, 2) and all(s.box[0] < 50 for s in a.sightings)


def test_who_is_taken_up_walked_straight_meanwhile() -> None:
    lost, new = person(1, range(5)), person(7, range(9, 12), x=8)
    take_up(new, lost)
    assert new.identity == 1 and [s.frame for s in new.sightings] == list(range(12))
    np.testing.assert_allclose([s.box[0] for s in bridged(new.sightings)[4:10]], np.linspace(4, 17, 6))
    assert [s.seen for s in new.sightings] == [True] * 5 + [False] * 4 + [True] * 3


@pytest.mark.parametrize("clothes", [0, 1], ids=["the same", "others"])
def test_somebody_hidden_may_turn_out_to_be_somebody_new(clothes: int) -> None:
    """Behind something since frame 10; from frame 14 on somebody stands beside it, clear to see for six looks."""
    known, seen = Walker((100, 170), (100, 170), 0, 40, 0), Walker((120, 170), (120, 170), 0, 40, clothes)

    def frame_of(walker: Walker, number: int) -> Frame:
        picture, mask = picture_of([walker], number, EMPTY)
        colours = to_luma_chroma(picture)
        evidence = Evidence(mask, Silhouette.flat(), codes=colour_codes(colours))
        return Frame(number, colours, to_luma_chroma(EMPTY), evidence)

    def somebody(identity: int, walker: Walker, frames: range) -> Person:
        made = person(identity, frames)
        made.sightings = [replace(one, box=state_of(walker, 0)) for one in made.sightings]
        made.last_clear, made.confirmed = None, True
        made.body = cast(Filtered, SimpleNamespace(box=state_of(walker, 0)))
        return made

    identities = Identities(IdentityConfig(), 10.0, (320, 240))
    hidden = somebody(1, known, range(11))
    for number in range(5, 11):
        assert not identities.step(frame_of(known, number), [hidden], {hidden}, [])
    hidden.hidden = 4
    new = somebody(2, seen, range(14, 15))
    found = [identities.step(frame_of(seen, number), [hidden, new], {new}, []) for number in range(14, 20)]
    assert found[:5] == [set()] * 5  # six looks are needed
    assert (found[5], new.identity) == (({hidden}, 1) if clothes == 0 else (set(), 2))


def test_bad_settings_are_one_line() -> None:
    with pytest.raises(InputError, match="identity"):
        IdentityConfig(looks=0)
