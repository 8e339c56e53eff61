"""Several people before one fixed camera: who is where in every frame.

From near to far, everybody's filter takes its step and explains the foreground it covers; what is left over may be
somebody new. Somebody is believed in after some frames, and given up after some without a sight.

Differences from Zhao (2009): nearer is whose feet are lower in the picture, not whose likelihood is higher (5.4.1), and
of what two cover, pixels go by their colours (`appearance`); people are followed by the foreground and by where they
may stand as well as by colour.

Cost: of one person and frame, N particles for the body and N for its parts, each adapted by (4.18).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.evaluation.boxes import overlaps
from muybridge.filters.particles import FloatArray
from muybridge.people.appearance import anybody, colour_codes
from muybridge.people.arrangement import Arrangement
from muybridge.people.blobs import BlobConfig, Mask, find_people
from muybridge.people.box import PRINTED_VARIANCES, BoxMotion, CountConfig, boxes_from_states, states_from_boxes
from muybridge.people.colour_likelihood import ColourConfig, Picture
from muybridge.people.contrast_likelihood import ContrastConfig
from muybridge.people.detect import Places, find_standing
from muybridge.people.down import look_lower
from muybridge.people.evidence import Claim, Evidence, ForegroundConfig, touching
from muybridge.people.failure import FailureDetector
from muybridge.people.filtered import Filtered, Frame
from muybridge.people.ground import GroundScale
from muybridge.people.histograms import to_luma_chroma
from muybridge.people.identity import Identities, IdentityConfig
from muybridge.people.part_filters import PartRules, Parts
from muybridge.people.parts import PartConfig
from muybridge.people.person import TRUST_WHOLE, Person, Sighting, feet, follow, nearness
from muybridge.people.scene import Scene
from muybridge.people.tracks import Tracks, gathered

HIDDEN = 0.3  # share of a box that can be seen; less is called hidden, not lost
EMPTY, FULL = 0.4, 0.6  # of what a person fills: less, and nobody is there; more, and all of them is
DECIDED_S = 0.12  # seconds in which it must look as if somebody had gone down, or come up again
STOOD_S = 2.0  # seconds for which, and since which at most, somebody was clear to see who goes down
MEASURED_S = 1.0  # seconds in which somebody's height is learnt
WALK = 0.6  # heights a second: standard deviation of speeds that are tried for somebody new; a brisk walk is 1
SAME, APART = 0.6, 0.05  # intersection over union of boxes that may be one person; of people clear of each other


@dataclass(frozen=True, kw_only=True)
class TrackerConfig:
    """Settings of the tracker; times are seconds of the video."""

    colour: ColourConfig = ColourConfig(spread=0.6)  # of the whole body
    part_colour: ContrastConfig = ContrastConfig(bands=2, spread=0.3)
    look: ColourConfig = ColourConfig(update_rate=0.1)  # by which people are told apart after they met
    foreground: ForegroundConfig = ForegroundConfig()
    identity: IdentityConfig = IdentityConfig()
    parts: PartConfig = PartConfig()
    down: bool = True  # whether boxes leave the size of a standing person where the foreground is clearly lower
    held: bool = True  # parts are one state on the body; false: each goes where its colours are, as in the paper
    counts: CountConfig = CountConfig()
    blobs: BlobConfig = BlobConfig()  # where the ground's scale is not known
    variances: tuple[float, ...] = PRINTED_VARIANCES  # px^2 a frame, (4.3)
    smallest: float = 45.0  # px: height of a standing person below which nobody is looked for
    least: float = 0.45  # of `detect.find_standing`
    clear: float = 0.1  # share of its size round everybody's box where nobody new is looked for
    confirm_s: float = 0.4  # seen for so long, somebody is believed in
    patience_s: float = 0.8  # and given up after so long unseen,
    patience_hidden_s: float = 5.0  # or so long hidden,
    doubled_s: float = 1.0  # or so long in the same place as somebody else

    def __post_init__(self) -> None:
        times = self.confirm_s, self.patience_s, self.patience_hidden_s, self.doubled_s
        if not (min(times) >= 0 and self.smallest > 0 and self.least > 0 and self.clear >= 0):
            raise InputError("tracker", expected="times and clear not below 0, smallest and least above 0",
                             got=f"{times}, {self.clear}, {self.smallest}, {self.least}")  # fmt: skip
        if len(self.variances) != len(PRINTED_VARIANCES):
            raise InputError("tracker variances", expected=f"{len(PRINTED_VARIANCES)} numbers", got=str(self.variances))


class PeopleTracker:
    """Follows people through pictures of one size, given with their foreground.

    Parameters
    ----------
    scene : Scene
    config : TrackerConfig
    frame_rate : float, frames per second
    seed : int
    detector : FailureDetector, optional
        What says that a part that is not held must be repaired; nothing is where absent.
    """

    def __init__(
        self,
        scene: Scene,
        config: TrackerConfig | None = None,
        *,
        frame_rate: float = 10.0,
        seed: int = 0,
        detector: FailureDetector | None = None,
    ) -> None:
        self.scene, self.config = scene, config or TrackerConfig()
        self.people: list[Person] = []
        self.gone: list[Person] = []
        self._rng = np.random.default_rng(seed)
        self._rate, self._count, self._settled = frame_rate, 0, -1
        self._motion = BoxMotion.within(scene.size, self.config.variances)
        self._rules = PartRules(self._motion, self.config.counts, self.config.part_colour, self.config.parts,
                                frame_rate, detector)  # fmt: skip
        self._background = to_luma_chroma(scene.background)
        smallest = self.config.smallest
        self._places = None if scene.ground is None else Places.on(scene.ground, scene.size, smallest)
        self._identities = Identities(self.config.identity, frame_rate, scene.size)
        self._anybody: NDArray[np.float32] | None = None

    def step(self, number: int, picture: Picture, mask: Mask, *, blind: bool = False) -> None:
        """One frame: picture (H, W, 3) uint8 BGR and its foreground (H, W) bool; numbers must rise.

        blind : the picture tells nothing, as if all of it were behind an occluder
        """
        if picture.shape != self.scene.background.shape or mask.shape != picture.shape[:2]:
            raise InputError("picture and mask", expected=f"the scene's {self.scene.background.shape}",
                             got=f"{picture.shape} and {mask.shape}")  # fmt: skip
        hidden = np.ones(mask.shape, bool) if blind else self.scene.occluders
        colours = to_luma_chroma(picture)
        evidence = Evidence(mask, self.scene.silhouette, self.config.foreground, hidden, colour_codes(colours))
        frame = Frame(number, colours, self._background, evidence)
        order = sorted(self.people, key=nearness)
        known = [person.appearance for person in self.people if person.appearance is not None]
        self._anybody = anybody(known) if known else None
        nearer: list[Claim] = []
        for rank, person in enumerate(order):
            further = [self._claim(other, other.body.expected) for other in order[rank + 1 :]]
            self._follow(person, frame, nearer, further)
            if not person.unseen:
                nearer.append(self._claim(person, person.body.box))
        self._give_up(frame)
        self._tell_apart(frame)
        self._welcome(frame)

    def tracks(self) -> Tracks:
        """Everybody who was believed in so far, from the first sight to the last."""
        return gathered(person for person in self.gone + self.people if person.confirmed)

    def settle(self, frame: int) -> Tracks:
        """Tracks up to a frame that no call before gave: they are forgotten here, so that a stream may go on for ever.

        Whoever was lost, and has no sighting after that frame, is forgotten altogether.
        """
        people = [person for person in self.gone + self.people if person.confirmed]
        settled = gathered(people, (self._settled, frame))
        self._settled = frame
        for person in self.gone + self.people:
            # The first one stays: it says since when somebody is followed; and the last sight, for what comes between.
            first, *rest = person.sightings
            past = [sighting for sighting in rest if sighting.frame <= frame and sighting.seen]
            person.sightings = [first, *past[-1:], *(sighting for sighting in rest if sighting.frame > frame)]
        self.gone = [person for person in self.gone if person.sightings[-1].frame > frame]
        self._identities.forget({*self.gone, *self.people})
        return settled

    def adopt(self, scene: Scene) -> None:
        """Go on in the same scene, of which more is known by now."""
        if scene.size != self.scene.size:
            raise InputError("scene", expected=f"the size {self.scene.size}", got=str(scene.size))
        self.scene, self._background = scene, to_luma_chroma(scene.background)
        self._places = None if scene.ground is None else Places.on(scene.ground, scene.size, self.config.smallest)

    def abandon(self) -> None:
        """Give everybody up: nothing is where it was."""
        for person in self.people:
            person.lost = True
        self.gone += self.people
        self.people = []

    def _frames(self, seconds: float) -> int:
        return max(1, round(seconds * self._rate))

    def _follow(self, person: Person, frame: Frame, nearer: list[Claim], further: list[Claim]) -> None:
        """The body, what can be seen of it, the parts; and what the body explains."""
        all_of_it = frame.evidence
        mine = self._claim(person, person.body.expected)
        frame = replace(frame, evidence=all_of_it.of(mine, touching(mine, nearer), touching(mine, further)))
        ground = self.scene.ground
        if self.config.down and ground is not None and person.may_be_down(frame.number, self._frames(STOOD_S)):
            others = [other.box for other in (*nearer, *further)]
            look_lower(person, frame.evidence, ground, others, self._motion, self._frames(DECIDED_S))
        follow(person, frame, self._motion, self.config.counts, ground, self._anybody)
        if person.visible < HIDDEN:
            person.hidden += 1
        elif person.filled < EMPTY * self._filled(person) or person.is_another:
            person.unseen += 1
        else:
            person.seen += 1
            person.unseen = person.hidden = 0
            person.confirmed |= person.seen >= self._frames(self.config.confirm_s)
        parts, box = None, person.body.box
        if person.down is not None:
            person.parts = None  # to be cut anew once they are upright
        if person.parts is not None:
            trusted = person.visible >= TRUST_WHOLE and not person.missing
            parts = person.parts.step(box, frame, trusted)
        score = min(1.0, person.visible) * person.filled
        person.sightings.append(Sighting(frame.number, box, score, not person.missing, parts))
        if not person.unseen:
            all_of_it.explain(box)

    def _claim(self, person: Person, box: FloatArray) -> Claim:
        """Whose look is not known yet looks like anybody."""
        return Claim(box, self._anybody if person.colours is None else person.colours.colours)

    def _give_up(self, frame: Frame) -> None:
        """Those unseen for too long, those too far away, and one of two who are one."""
        leaving = {person for person in self.people if self._is_lost(person)} | self._double(frame.picture)
        for person in leaving:
            person.lost = True
        self.gone += [person for person in self.people if person in leaving]
        self.people = [person for person in self.people if person not in leaving]

    def _is_lost(self, person: Person) -> bool:
        ground = self.scene.ground
        if ground is not None and ground.height(feet(person.body.box)) < 0.95 * self.config.smallest:
            return True
        if not person.confirmed:
            return person.missing > 1
        waited = person.missing > self._frames(self.config.patience_hidden_s)
        return waited or person.unseen > self._frames(self.config.patience_s)

    def _double(self, picture: Picture) -> set[Person]:
        """Of two who had nearly the same box for too long, the one to give up: who looks less like what is there."""
        shared = self._shared(self.people)
        for person, most in zip(self.people, shared.max(axis=1, initial=0.0)):
            person.doubled = person.doubled + 1 if most > SAME else 0
        for a, b in np.argwhere(np.triu(shared) > SAME):
            one, other = self.people[a], self.people[b]
            both = one.confirmed and other.confirmed
            if min(one.doubled, other.doubled) > (self._frames(self.config.doubled_s) if both else 2):
                if one.is_another != other.is_another:
                    return {one if one.is_another else other}
                if one.is_known and other.is_known:
                    return {max(one, other, key=lambda person: person.likeness(picture, person))}
                return {min(one, other, key=lambda person: (person.confirmed, person.seen))}
        return set()

    def _tell_apart(self, frame: Frame) -> None:
        """Identities of those who met, and the parts of those who can be seen whole."""
        people = [person for person in self.people if person.confirmed]
        alone = self._shared(people).max(axis=1, initial=0.0) < APART
        clear = {person for person, is_alone in zip(people, alone) if is_alone and self._is_whole(person)}
        found = self._identities.step(frame, people, clear, self.gone)
        for person in found:
            person.lost = True
        self.gone = [person for person in self.gone if person not in found]
        self.people = [person for person in self.people if person not in found]
        if self.scene.ground is not None:
            self._measure(clear, frame.evidence, self.scene.ground)
        for person in self.people:
            if person in clear and person.parts is None:
                kind = Arrangement if self.config.held else Parts
                person.parts = kind.start(person.rng, person.body.box, frame, self._rules)

    def _measure(self, clear: set[Person], evidence: Evidence, ground: GroundScale) -> None:
        """How tall and how broad those who are clear to see are."""
        for person in clear:
            outline = evidence.outline(person.body.box)
            if outline is not None:
                person.measure(outline, ground, 1 / (1 + MEASURED_S * self._rate))

    def _is_whole(self, person: Person) -> bool:
        """And upright: only then their looks, parts and size are told."""
        full = person.filled > FULL * self.scene.silhouette.mean and person.down is None
        return full and person.visible >= TRUST_WHOLE and not person.missing

    def _filled(self, person: Person) -> float:
        """The share of their box that they fill."""
        return self.scene.silhouette.mean if person.down is None else person.down.filled

    def _welcome(self, frame: Frame) -> None:
        """Somebody new for every box that explains foreground which nobody followed does."""
        for person in self.people:
            if person.is_another:
                continue
            around = person.body.box.copy()
            around[2:4] *= 1 + 2 * self.config.clear
            frame.evidence.explain(around, share=1.0)
        for box in self._newcomers(frame.evidence):
            self._count += 1
            rng = self._rng.spawn(1)[0]
            speed_sd = WALK * float(box[3]) / self._rate
            body = Filtered.start(rng, box, frame, self._motion, self.config.colour, speed_sd)
            sighting = Sighting(frame.number, body.box, 1.0, True)
            self.people.append(Person(self._count, body, rng, self.config.look, sightings=[sighting]))

    def _newcomers(self, evidence: Evidence) -> list[FloatArray]:
        if self._places is not None:
            return find_standing(evidence, self._places, self.config.least)
        unexplained = evidence.mask & (evidence.weights > 0)
        return [states_from_boxes(blob.box)[0] for blob in find_people(unexplained, self.config.blobs)]

    @staticmethod
    def _shared(people: list[Person]) -> FloatArray:
        """(P, P) intersection over union of everybody's box with everybody else's."""
        boxes = boxes_from_states(np.array([person.body.box for person in people]).reshape(-1, 6))
        return overlaps(boxes, boxes) - np.eye(len(boxes))
