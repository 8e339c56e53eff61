"""Several people and one fixed camera: who is where in every frame.

From near to far, everybody's filter takes its step and explains the foreground that it covers; what is left over may be
somebody new. Somebody is believed in after some frames, and given up after some without a sight.

Differences from Zhao (2009): nearer is whose feet are lower in the picture, not whose likelihood is higher (5.4.1);
people are followed by foreground and by where they may stand as well as by colour.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from muybridge.errors import InputError
from muybridge.evaluation.boxes import overlaps
from muybridge.filters.particles import FloatArray
from muybridge.io.boxes import BoxSeries
from muybridge.people.blobs import BlobConfig, Mask, find_people
from muybridge.people.box import PRINTED_VARIANCES, BoxMotion, CountConfig, boxes_from_states, states_from_boxes
from muybridge.people.colour_likelihood import ColourConfig, Picture
from muybridge.people.detect import Places, find_standing
from muybridge.people.evidence import Evidence, ForegroundConfig
from muybridge.people.identity import Identities, IdentityConfig
from muybridge.people.histograms import to_luma_chroma
from muybridge.people.person import Filtered, Frame, Person, Sighting, feet, follow, nearness
from muybridge.people.scene import Scene

LOST_OR_HIDDEN = 0.3  # share of a box; less is called hidden, not lost
TOO_EMPTY = 0.4  # of what a person fills: less, and nobody is there
SAME = 0.6  # intersection over union of two boxes that may be one person


@dataclass(frozen=True, kw_only=True)
class TrackerConfig:
    """Settings of the tracker; times are in seconds of the video."""

    colour: ColourConfig = ColourConfig(spread=0.6)
    looks: ColourConfig = ColourConfig(update_rate=0.1)
    identity: IdentityConfig = IdentityConfig()
    foreground: ForegroundConfig = ForegroundConfig()
    counts: CountConfig = CountConfig()
    blobs: BlobConfig = BlobConfig()  # where the ground's scale is not known
    variances: tuple[float, ...] = PRINTED_VARIANCES  # px^2 a frame, (4.3)
    smallest: float = 45.0  # px: height of a person below which nobody is looked for
    least: float = 0.45  # of `detect.find_standing`
    clear: float = 0.1  # share of its size round everybody's box where nobody new is looked for
    confirm_s: float = 0.4  # seen for so long, somebody is believed in
    patience_s: float = 0.8  # and given up after so long unseen,
    patience_hidden_s: float = 2.5  # or so long hidden
    doubled_s: float = 1.0  # or so long in the same place as somebody else

    def __post_init__(self) -> None:
        times = self.confirm_s, self.patience_s, self.patience_hidden_s, self.doubled_s
        if min(times) < 0 or not (self.smallest > 0 and self.least > 0 and self.clear >= 0):
            raise InputError("tracker", expected="times and clear not below 0, smallest and least above 0",
                             got=f"{times}, {self.clear}, {self.smallest}, {self.least}")  # fmt: skip


class PeopleTracker:
    """Follows people through pictures of one size, given with their foreground.

    Parameters
    ----------
    scene : Scene
    config : TrackerConfig
    frame_rate : float, frames per second
    seed : int
    """

    def __init__(
        self, scene: Scene, config: TrackerConfig | None = None, *, frame_rate: float = 10.0, seed: int = 0
    ) -> None:
        self.scene, self.config = scene, config or TrackerConfig()
        self.rng = np.random.default_rng(seed)
        self.people: list[Person] = []
        self.gone: list[Person] = []
        self._count = 0
        self._identities = Identities(self.config.identity, frame_rate, scene.size)
        self._rate = frame_rate
        self._motion = BoxMotion.within(scene.size, self.config.variances)
        self._background = to_luma_chroma(scene.background)
        self._places = scene.ground and Places.on(scene.ground, scene.size, self.config.smallest)

    def step(self, number: int, picture: Picture, mask: Mask) -> None:
        """One frame: picture (H, W, 3) uint8 BGR and its foreground (H, W) bool; numbers must rise."""
        evidence = Evidence(mask, self.scene.silhouette, self.config.foreground, self.scene.occluders)
        frame = Frame(number, to_luma_chroma(picture), self._background, evidence)
        order = sorted(self.people, key=nearness)
        for rank, person in enumerate(order):
            self._follow(person, frame, [other.body.expected for other in order[rank + 1 :]])
        self._give_up()
        self._identify(frame)
        self._welcome(frame)

    def tracks(self) -> BoxSeries:
        """Everybody who was believed in, from the first sight to the last; frames without a sight between are kept."""
        rows: list[tuple[int, int, FloatArray, float]] = []
        for person in self.gone + self.people:
            last = max((i for i, sighting in enumerate(person.sightings) if sighting.seen), default=-1)
            if person.confirmed:
                rows += [(s.frame, person.identity, s.box, s.score) for s in person.sightings[: last + 1]]
        frames, ids, boxes, scores = zip(*rows) if rows else ((), (), np.zeros((0, 6)), ())
        return BoxSeries(np.array(frames, np.int64), np.array(ids, np.int64), boxes_from_states(np.array(boxes)),
                         np.array(scores, np.float64))  # fmt: skip

    def _identify(self, frame):
        people = [p for p in self.people if p.confirmed]
        if not people:
            return
        B = boxes_from_states(np.array([p.body.box for p in people]))
        o = (overlaps(B, B) - np.eye(len(B))).max(axis=1)
        clear = {p for p, w in zip(people, o) if w < 0.05 and p.visible >= 0.8 and p.filled > 0.6 * self.scene.silhouette.mean and not p.missing}
        self._identities.step(frame.picture, frame.number, people, clear, self.gone)

    def _frames(self, seconds: float) -> int:
        return max(1, round(seconds * self._rate))

    def _follow(self, person: Person, frame: Frame, behind: list[FloatArray]) -> None:
        visible, filled = follow(self.rng, person.body, frame, self._motion, self.config.counts, self.scene.ground, behind)
        if visible < LOST_OR_HIDDEN:
            person.hidden += 1
        elif filled < TOO_EMPTY * self.scene.silhouette.mean:
            person.unseen += 1
        else:
            person.seen += 1
            person.unseen = person.hidden = 0
            person.confirmed |= person.seen >= self._frames(self.config.confirm_s)
        person.visible, person.filled = visible, filled
        person.sightings.append(Sighting(frame.number, person.body.box, visible * filled, not person.missing))
        if not person.unseen:
            frame.evidence.explain(person.body.box)

    def _give_up(self) -> None:
        """Those unseen for too long, those who left or are too far away, and one of two who are one."""
        leaving = {person for person in self.people if self._has_left(person)} | self._double()
        self.gone += [person for person in self.people if person in leaving]
        self.people = [person for person in self.people if person not in leaving]

    def _has_left(self, person: Person) -> bool:
        config, ground = self.config, self.scene.ground
        if ground is not None and ground.height(feet(person.body.box)) < 0.95 * config.smallest:
            return True
        if not person.confirmed:
            return person.missing > 1
        return person.missing > self._frames(config.patience_hidden_s if person.hidden else config.patience_s)

    def _double(self) -> set[Person]:
        """The one of two to give up who have had nearly the same box for too long: the one seen less."""
        if len(self.people) < 2:
            return set()
        boxes = boxes_from_states(np.array([person.body.box for person in self.people]))
        shared = overlaps(boxes, boxes) - np.eye(len(boxes))
        for person, most in zip(self.people, shared.max(axis=1)):
            person.doubled = person.doubled + 1 if most > SAME else 0
        for a, b in np.argwhere(np.triu(shared) > SAME):
            one, other = self.people[a], self.people[b]
            both = one.confirmed and other.confirmed
            if min(one.doubled, other.doubled) > (self._frames(self.config.doubled_s) if both else 2):
                return {min(one, other, key=lambda person: (person.confirmed, person.seen))}
        return set()

    def _welcome(self, frame: Frame) -> None:
        """Somebody new for every box that explains foreground which nobody followed does."""
        for person in self.people:
            around = person.body.box.copy()
            around[2:4] *= 1 + 2 * self.config.clear
            frame.evidence.explain(around, share=1.0)
        for box in self._newcomers(frame.evidence):
            self._count += 1
            body = Filtered.start(self.rng, box, frame, self._motion, self.config.colour)
            person = Person(self._count, body, self.config.looks)
            person.sightings.append(Sighting(frame.number, body.box, 1.0, True))
            self.people.append(person)

    def _newcomers(self, evidence: Evidence) -> list[FloatArray]:
        if self._places is not None:
            return find_standing(evidence, self._places, self.config.least)
        unexplained = evidence.mask & (evidence.weights > 0)
        return [states_from_boxes(blob.box)[0] for blob in find_people(unexplained, self.config.blobs)]
