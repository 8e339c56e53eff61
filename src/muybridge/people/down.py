"""Somebody who crouches, bends or lies: the box leaves the size of a standing person, where the foreground says so.

Of the foreground that hangs together with what is in somebody's box, two things may be the case: they stand in it, at
their stature and with a standing person's silhouette, or they are down, and it is all of them: a box round it, filled
evenly. Both are asked of the frame's foreground (`evidence`). Where the second explains it better, and is clearly lower
than they are tall, they are down, until what is seen of them is as tall as they are again, or, where others are about,
until standing explains it better.

What hides somebody makes them no lower: only of who is seen whole and alone is it said that they are down. Their size
is that of what is seen then, unless it changes at once: who passes by is no part of them. While they are down, nothing
else is learnt of them.

Not in Zhao (2009), where sizes are free and people upright.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from muybridge.filters.particles import FloatArray
from muybridge.people.box import HEIGHT, WIDTH, BoxMotion, X, Y
from muybridge.people.evidence import Evidence, Region
from muybridge.people.ground import GroundScale
from muybridge.people.silhouette import Silhouette

if TYPE_CHECKING:
    from muybridge.people.person import Person

LOWER, UPRIGHT = 0.8, 0.9  # of somebody's height: lower than the first is down, taller than the second upright again
LEAD = 8.0  # nats; who lay had 20 to 35, and who stood hardly ever 5
LEAST = 0.35  # of the pixels that they fill upright: who lies along the view has half of them
OPEN = 0.85  # of the pixels around: beside a pillar a third may hide the rest of them
SPREAD = 0.06  # of the size of who is down: from one frame to the next somebody who falls changes by as much
CHANGES = 0.2  # of the size: most by which somebody changes in a frame; who is added to them is more
ACROSS, ALONG = 7, 7  # places where standing is tried, from feet in a region to a head at its top
EVENLY = 0.2, 0.8  # the least and most that a box is filled


@dataclass(frozen=True, eq=False)
class Down:
    """Somebody is down.

    size : (2,) float64, width and height, pixels, as they were when last seen whole
    filled : share of that box which is foreground
    """

    size: FloatArray
    filled: float

    @classmethod
    def of(cls, region: Region) -> Down:
        """As the region is."""
        return cls(region.box[2:4], float(np.clip(region.filled, *EVENLY)))

    def log_prob(self, states: FloatArray) -> FloatArray:
        """(N,) how usual the sizes of boxes (N, >= 4) are, up to a constant."""
        off = (states[:, WIDTH : HEIGHT + 1] / self.size - 1) / SPREAD
        result: FloatArray = -0.5 * np.square(off).sum(axis=1)
        return result

    def motion(self, motion: BoxMotion) -> BoxMotion:
        """Sizes change as fast as somebody falls."""
        noise = motion.noise_sd.copy()
        noise[WIDTH : HEIGHT + 1] = SPREAD * self.size
        return replace(motion, noise_sd=noise)

    def evidence(self, evidence: Evidence) -> Evidence:
        """The same frame, in which a person fills a box evenly."""
        view = copy(evidence)
        view.silhouette = Silhouette.flat(self.filled)
        view.gain, view.cost = view.silhouette.ratios(view.config.outside)
        return view


def look_lower(
    person: Person,
    evidence: Evidence,
    ground: GroundScale,
    others: Sequence[FloatArray],
    motion: BoxMotion,
    frames: int,
) -> None:
    """See whether somebody, among others (>= 4,), went down or came up again, for so many frames in a row."""
    ground = ground.of_person(person.stature, person.breadth)
    region = evidence.region(person.body.expected)
    region = region if region is not None and is_whole(region, evidence, ground) else None
    if region is not None and (is_alone(region, others) or goes_on(region, person.down)):
        _see(person, region, evidence, ground, motion, frames)
    elif person.down is not None:
        held = Region(person.body.expected[:4], person.down.filled)
        ahead, standing = lead(held, evidence, ground)
        if _lasts(person, ahead < -LEAD, frames):
            _become(person, None, standing, motion)
    else:
        person.otherwise = 0


def _see(
    person: Person, region: Region, evidence: Evidence, ground: GroundScale, motion: BoxMotion, frames: int
) -> None:
    """All of them is a region."""
    share = lowness(region, ground)
    if person.down is None:
        is_lower = region.open > OPEN and share < LOWER
        if _lasts(person, is_lower and lead(region, evidence, ground)[0] > LEAD, frames):
            _become(person, Down.of(region), region.box, motion)
    elif _lasts(person, share > UPRIGHT, frames):
        _become(person, None, region.box, motion)
    else:
        person.down = Down.of(region)


def _lasts(person: Person, otherwise: bool, frames: int) -> bool:
    person.otherwise = person.otherwise + 1 if otherwise else 0
    return person.otherwise >= frames


def _become(person: Person, down: Down | None, box: FloatArray, motion: BoxMotion) -> None:
    person.down, person.otherwise = down, 0
    person.body.place(person.rng, box, motion)


def lead(region: Region, evidence: Evidence, ground: GroundScale) -> tuple[float, FloatArray]:
    """Nats by which a person who is down in a region explains more than if they stood there, and where that is (4,)."""
    x, y, width, height = region.box
    feet = y + height / 2
    tall = float(ground.height(feet))
    reach = max(0.0, width - ground.aspect * tall) / 2
    rows = np.linspace(feet - 0.2 * height, max(feet + 0.1 * height, feet - height + tall), ALONG)
    places = np.meshgrid(np.linspace(x - reach, x + reach, ACROSS), rows)
    standing = ground.standing(*(place.ravel() for place in places))
    area = ground.area(feet)
    low = Down.of(region).evidence(evidence).observe(area).log_prob(region.box[None])[0]
    upright = evidence.observe(area).log_prob(standing)
    best = int(upright.argmax())
    return float(low - upright[best]), standing[best]


def lowness(region: Region, ground: GroundScale) -> float:
    """Height over that of the person who would stand there."""
    return float(region.box[HEIGHT] / ground.height(region.box[Y] + region.box[HEIGHT] / 2))


def is_whole(region: Region, evidence: Evidence, ground: GroundScale) -> bool:
    """Whether a region may be all of a person."""
    usual = evidence.silhouette.mean * ground.area(region.box[Y] + region.box[HEIGHT] / 2)
    return region.pixels > LEAST * usual


def goes_on(region: Region, down: Down | None) -> bool:
    """Whether a region is of about the size that somebody who is down had before: nobody else was added to them."""
    return down is not None and bool((np.abs(region.box[2:4] / down.size - 1) < CHANGES).all())


def is_alone(region: Region, others: Sequence[FloatArray]) -> bool:
    """Whether no other box (>= 4,) meets the region's."""
    place = region.box
    return not any(
        abs(other[X] - place[X]) < (other[WIDTH] + place[WIDTH]) / 2
        and abs(other[Y] - place[Y]) < (other[HEIGHT] + place[HEIGHT]) / 2
        for other in others
    )
