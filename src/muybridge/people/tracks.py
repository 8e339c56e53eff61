"""What comes out of tracking: everybody's boxes, and those of their parts."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from muybridge.filters.particles import FloatArray
from muybridge.io.boxes import BoxSeries
from muybridge.io.parts import PartSeries
from muybridge.people.box import boxes_from_states
from muybridge.people.parts import PARTS

if TYPE_CHECKING:
    from muybridge.people.person import Person, Sighting

INSIDE = 0.25  # of a body, in the picture: with less, it is not there


@dataclass(frozen=True, eq=False)
class Tracks:
    """boxes : BoxSeries, whole bodies; parts : PartSeries, where they were followed."""

    boxes: BoxSeries
    parts: PartSeries

    def inside(self, picture: tuple[int, int]) -> Tracks:
        """Bodies of which at least `INSIDE` is within a picture (width, height); they may reach beyond its sides."""
        low = np.clip(self.boxes.boxes[:, :2], 0, picture)
        high = np.clip(self.boxes.boxes[:, :2] + self.boxes.boxes[:, 2:], 0, picture)
        keep = (high - low).prod(axis=1) >= INSIDE * self.boxes.boxes[:, 2:].prod(axis=1)
        return Tracks(self.boxes.where(keep), self.parts)

    def scaled(self, factor: float) -> Tracks:
        """In the pixels of pictures `factor` times as large."""
        boxes = BoxSeries(self.boxes.frames, self.boxes.ids, factor * self.boxes.boxes, self.boxes.confidence)
        return Tracks(boxes, self.parts.scaled(factor))


def gathered(people: Iterable[Person], between: tuple[int, int] | None = None) -> Tracks:
    """The sightings of all of them, each up to the last frame in which something was seen of them.

    between : (after, last), optional
        Sightings of these frames only.
    """
    rows: list[tuple[int, Sighting]] = []
    for person in people:
        last = max((i for i, sighting in enumerate(person.sightings) if sighting.seen), default=-1)
        mine = bridged(person.sightings[: last + 1])
        rows += [(person.identity, one) for one in mine if between is None or between[0] < one.frame <= between[1]]
    boxes = _column([sighting.box for _, sighting in rows], 6)
    bodies = BoxSeries(
        np.array([sighting.frame for _, sighting in rows], np.int64), np.array([i for i, _ in rows], np.int64),
        boxes_from_states(boxes), np.array([sighting.score for _, sighting in rows], np.float64),
    )  # fmt: skip
    return Tracks(bodies, _parts([(i, sighting) for i, sighting in rows if sighting.parts is not None]))


def bridged(sightings: list[Sighting]) -> list[Sighting]:
    """Where nothing was seen of somebody, a straight walk from the last sight of them to the next."""
    seen = [k for k, sighting in enumerate(sightings) if sighting.seen]
    found = list(sightings)
    for before, after in pairwise(seen):
        first, last = sightings[before], sightings[after]
        for k in range(before + 1, after):
            share = (sightings[k].frame - first.frame) / (last.frame - first.frame)
            found[k] = _moved(sightings[k], first.box + share * (last.box - first.box))
    return found


def _moved(sighting: Sighting, box: FloatArray) -> Sighting:
    """With another box (6,), and the parts where they were on the old one."""
    parts = sighting.parts
    if parts is not None:
        parts = parts.copy()
        parts[:, :2] += box[:2] - sighting.box[:2]
    return replace(sighting, box=box, parts=parts)


def _parts(rows: list[tuple[int, Sighting]]) -> PartSeries:
    found = np.array([sighting.parts for _, sighting in rows]).reshape(-1, 5)
    return PartSeries(
        np.repeat(np.array([sighting.frame for _, sighting in rows], np.int64), len(PARTS)),
        np.repeat(np.array([i for i, _ in rows], np.int64), len(PARTS)),
        np.tile(np.array(PARTS), len(rows)), boxes_from_states(found[:, :4]), found[:, 4],
    )  # fmt: skip


def _column(values: list[FloatArray], width: int) -> FloatArray:
    return np.array(values, dtype=np.float64).reshape(-1, width)
