"""Who is who after people met: what they looked like before, against what they look like now.

While two people are close and one hides the other, a filter may go on with the wrong one. Before, everybody's look is
remembered: colours of three bands of the body, each with bins fitted to it. Once both are clear to see again, looks and
people are compared both ways round, and identities are exchanged if that fits better. In the same way somebody who was
lost is recognised.

Not in Zhao (2009), where the likelier of two is taken to stand in front and nothing is exchanged later.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.people.colour_likelihood import ColourConfig, ColourTarget, Picture, pixel_boxes
from muybridge.people.histograms import count_histograms

if TYPE_CHECKING:
    from muybridge.people.filtered import Frame
    from muybridge.people.person import Person

BANDS = np.array([[0.0, -0.38, 0.35, 0.2], [0.0, -0.16, 0.5, 0.3], [0.0, 0.18, 0.5, 0.35]])
"""Head, trunk and legs: centre from the box's, and size, as shares of the box."""
FASTEST = 1.5  # heights a second: a brisk walk is 1
REACH = 0.5  # heights: what a first box may be off


@dataclass(frozen=True, kw_only=True)
class IdentityConfig:
    """Settings of recognition. Squared distances are sums over three bands; of one person after some seconds they are
    about 1, of two different people about 3."""

    margin: float = 1.0  # by so much an exchange must fit better, in squared distance per person
    looks: int = 6  # frames in which both are clear, before it is decided
    near: float = 1.5  # widths between two who may be mistaken for each other
    alike: float = 1.3  # squared distance of somebody lost and somebody new who are one person
    recall_s: float = 6.0  # for so long somebody lost is remembered, seconds

    def __post_init__(self) -> None:
        if not (self.margin >= 0 and self.looks >= 1 and self.near > 0 and self.alike >= 0 and self.recall_s >= 0):
            raise InputError("identity", expected="looks from 1, near above 0, the others not below 0", got=str(self))


@dataclass(frozen=True, eq=False)
class Look:
    """What somebody looks like: three bands' colours, each with its own bins."""

    bands: tuple[ColourTarget, ...]

    @classmethod
    def learn(cls, picture: Picture, box: FloatArray, colour: ColourConfig) -> Look:
        """From a picture (H, W, 3) uint8, Y Cr Cb, and the body's box (>= 4,)."""
        return cls(tuple(ColourTarget.learn(picture, band, colour) for band in bands_of(box)))

    def updated(self, picture: Picture, box: FloatArray) -> Look:
        """After another look at the same person."""
        return Look(tuple(band.updated(seen) for band, seen in zip(self.bands, self._histograms(picture, box))))

    def distance(self, picture: Picture, box: FloatArray) -> float:
        """Squared distance, summed over bands and bins, to whoever is in a box (>= 4,)."""
        seen = self._histograms(picture, box)
        return float(sum(np.square(band.histogram - z).sum() for band, z in zip(self.bands, seen)))

    def _histograms(self, picture: Picture, box: FloatArray) -> list[NDArray[np.float32]]:
        pixels, _ = pixel_boxes(bands_of(box))
        return [count_histograms(picture, band.bins, at[None])[0] for band, at in zip(self.bands, pixels)]


def bands_of(box: FloatArray) -> FloatArray:
    """(3, 4) boxes of the bands of a body's box (>= 4,)."""
    bands = BANDS * np.array([box[2], box[3], box[2], box[3]])
    bands[:, :2] += box[:2]
    return bands


@dataclass
class Meeting:
    """Two who came close while one of them was not clear to see: when they were closest, and what was seen since."""

    closest: int
    gap: float
    gains: list[float] = field(default_factory=list)


class Identities:
    """Who met whom and is not sure yet to be told apart, and who of the new ones may be somebody who was lost.

    frame_rate : float, frames per second
    """

    def __init__(self, config: IdentityConfig, frame_rate: float, size: tuple[int, int]) -> None:
        self.config, self.size = config, size
        self._memory = round(config.recall_s * frame_rate)
        self._stride = FASTEST / frame_rate
        self._meetings: dict[frozenset[Person], Meeting] = {}
        self._likeness: dict[tuple[Person, int], list[float]] = {}

    def step(self, frame: Frame, people: list[Person], clear: set[Person], gone: list[Person]) -> set[Person]:
        """One frame, after everybody was followed. Exchanges and takes up identities; remembers looks of the clear.

        Returns those whom somebody new has turned out to be: they are followed no more.
        """
        picture, number = frame.picture, frame.number
        known = {*people, *(lost for lost in gone if number - lost.sightings[-1].frame <= self._memory)}
        for lost in gone:
            if lost not in known:
                lost.appearance = None  # 128 KB
        self._meetings = {pair: meeting for pair, meeting in self._meetings.items() if pair <= known}
        for a, b in combinations([person for person in people if person.is_known and not person.missing], 2):
            if not (a in clear and b in clear) and gap_between(a.body.box, b.body.box) < self.config.near:
                self._meet(number, a, b)
        for pair in list(self._meetings):
            followed = {person for person in pair if not person.lost}
            if followed and followed <= clear:
                self._compare(picture, *sorted(pair, key=lambda person: person.lost))
        uncertain = {person for pair in self._meetings for person in pair}
        found: set[Person] = set()
        for person in people:
            if person in clear and person not in uncertain:
                person.remember(frame)
                waiting = [one for one in people if one.missing and one not in found]
                found |= self._recall(picture, number, person, gone + waiting)
        return found

    def forget(self, known: set[Person]) -> None:
        """Keep only what concerns these."""
        self._meetings = {pair: meeting for pair, meeting in self._meetings.items() if pair <= known}
        self._likeness = {key: values for key, values in self._likeness.items() if key[0] in known}

    def _meet(self, number: int, a: Person, b: Person) -> None:
        """They are close; what was compared before counts no more."""
        gap = gap_between(a.body.box, b.body.box)
        meeting = self._meetings.setdefault(frozenset((a, b)), Meeting(number, gap))
        meeting.gains.clear()
        if gap < meeting.gap:
            meeting.closest, meeting.gap = number, gap

    def _compare(self, picture: Picture, a: Person, b: Person) -> None:
        """How much better an exchange would fit those who are still followed, decided after so many looks.

        Where b was lost meanwhile, a alone is compared: it may be b who is followed, and a who was lost.
        """
        meeting = self._meetings[frozenset((a, b))]
        gain = a.likeness(picture, a) - b.likeness(picture, a)
        if not b.lost:
            gain = (gain + b.likeness(picture, b) - a.likeness(picture, b)) / 2
        meeting.gains.append(gain)
        if len(meeting.gains) >= self.config.looks:
            if np.mean(meeting.gains) > self.config.margin:
                exchange(a, b, meeting.closest)
            del self._meetings[frozenset((a, b))]

    def _recall(self, picture: Picture, number: int, person: Person, missed: list[Person]) -> set[Person]:
        """Whether somebody new is somebody lost or hidden: as many looks as for an exchange, then the most alike."""
        if number - person.sightings[0].frame > self._memory:
            return set()
        distance = {}
        for lost in missed:
            if self._may_be(person, lost, number):
                # By identity, which goes with the look: the lost one's may have been exchanged meanwhile.
                values = self._likeness.setdefault((person, lost.identity), [])
                values.append(lost.likeness(picture, person))
                if len(values) >= self.config.looks:
                    distance[lost] = float(np.mean(values[-self.config.looks :]))
        best = min(distance, key=distance.__getitem__, default=None)
        if best is None or distance[best] >= self.config.alike:
            return set()
        take_up(person, best)
        return {best}

    def _may_be(self, person: Person, lost: Person, number: int) -> bool:
        """Seen last before the other was, not too long ago, not at a side, and near enough to have walked there."""
        born, last = person.sightings[0], lost.last_clear
        if last is None or not last.frame < born.frame or number - last.frame > self._memory:
            return False
        half = last.box[2] / 2
        if not half < last.box[0] < self.size[0] - half:
            return False
        reach = last.box[3] * (REACH + self._stride * (born.frame - last.frame))
        return float(np.hypot(*(born.box[:2] - last.box[:2]))) < reach


def gap_between(a: FloatArray, b: FloatArray) -> float:
    """How far apart the feet of two boxes (>= 4,) are, in widths; half a height up or down counts as one."""
    across = abs(a[0] - b[0]) / (a[2] + b[2])
    along = abs(a[1] + a[3] / 2 - b[1] - b[3] / 2) / (a[3] + b[3])
    return float(2 * np.hypot(across, 2 * along))


def exchange(a: Person, b: Person, frame: int) -> None:
    """Give each what the other was up to a frame: identity, look and sightings. Where they are now stays."""
    a.identity, b.identity = b.identity, a.identity
    a.look, b.look = b.look, a.look
    a.appearance, b.appearance = b.appearance, a.appearance
    a.usual, b.usual = b.usual, a.usual
    a.stature, b.stature = b.stature, a.stature
    a.breadth, b.breadth = b.breadth, a.breadth
    a.last_clear, b.last_clear = b.last_clear, a.last_clear
    a.parts = b.parts = None  # to be cut anew
    before = [[sighting for sighting in person.sightings if sighting.frame <= frame] for person in (a, b)]
    after = [[sighting for sighting in person.sightings if sighting.frame > frame] for person in (a, b)]
    a.sightings, b.sightings = before[1] + after[0], before[0] + after[1]


def take_up(person: Person, lost: Person) -> None:
    """The new person is the lost one: same identity, and unseen in the frames between, see `tracks.bridged`."""
    person.identity = lost.identity
    last, born = lost.last_clear, person.sightings[0]
    assert last is not None
    before = [sighting for sighting in lost.sightings if sighting.frame <= last.frame]
    between = [replace(last, frame=frame, seen=False) for frame in range(last.frame + 1, born.frame)]
    person.sightings = before + between + person.sightings
