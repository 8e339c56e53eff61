"""One person: a particle filter over the body's box, one over how its parts lie on it, and what the person looks like.

Every frame: foreground, colour and the ground say how likely each particle is; `filters.condensation` does the rest.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from muybridge.filters.particles import FloatArray
from muybridge.filters.state import Likelihood
from muybridge.people.appearance import LONGEST, Appearance, AppearanceLikelihood, log_ratios
from muybridge.people.arrangement import Arrangement
from muybridge.people.box import HEIGHT, WIDTH, BoxMotion, CountConfig, X, Y
from muybridge.people.colour_likelihood import ColourConfig, Picture
from muybridge.people.down import Down
from muybridge.people.evidence import Together
from muybridge.people.filtered import Filtered, Frame
from muybridge.people.ground import GroundScale
from muybridge.people.identity import Look
from muybridge.people.part_filters import Parts

TRUST_COLOUR = 0.6  # share of the box that must be visible: below, the histogram is of somebody else
APPEARANCE = 0.5  # weight of colours against the foreground: neighbouring pixels have much the same ones; 1 was alike
UNLIKE, DOUBT = 0.5, 0.25  # share of the usual likeness, and nats a pixel below that: then it is somebody else
TRUST_WHOLE = 0.8  # to learn what the person looks like
ENOUGH_LOOKS = 4  # frames
SHORTEST, TALLEST = 0.6, 1.25  # of people's mean height: a child of five, and hardly anybody
NARROWEST, BROADEST = 0.6, 1.6  # of the mean of width over height
AGREE_TALL, AGREE_WIDE = 0.3, 0.4  # logarithms: of an outline's size over the box's, for it to be believed


@dataclass(frozen=True, eq=False)
class Sighting:
    """A person in one frame: the body's box (6,), how sure it is, whether anything was seen of it.

    parts : (3, 5) or None, centre, size and score of each part
    """

    frame: int
    box: FloatArray
    score: float
    seen: bool
    parts: FloatArray | None = None


@dataclass(eq=False)
class Person:
    """Somebody who is followed.

    Attributes
    ----------
    seen : int
        Frames in which enough was seen, in all.
    unseen, hidden, doubled : int
        Frames in a row: nothing was seen; somebody nearer or an occluder covered the box; another had the same box.
    visible, filled : float
        Of the box now: the share that can be seen, and the share of that which is foreground.
    alike, usual : float
        Nats a pixel by which that looks like this person more than like anybody; and the mean of that while it was
        clear to see and upright.
    looks : int
        Frames from which `look` was learnt.
    stature, breadth : float
        Of people's mean height, and of the mean of width over height.
    down : Down or None
        Whether they crouch, bend or lie, and how large the box then is.
    otherwise : int
        Frames in a row in which it looked as if they had gone down, or come up again.
    usual_down : float
        What `alike` should be while they are down.
    """

    identity: int
    body: Filtered
    rng: np.random.Generator
    colour: ColourConfig
    confirmed: bool = False
    lost: bool = False
    seen: int = 1
    unseen: int = 0
    hidden: int = 0
    doubled: int = 0
    visible: float = 1.0
    filled: float = 1.0
    alike: float = 0.0
    usual: float = 0.0
    sightings: list[Sighting] = field(default_factory=list)
    look: Look | None = None
    appearance: Appearance | None = None
    looks: int = 0
    stature: float = 1.0
    breadth: float = 1.0
    last_clear: Sighting | None = None
    parts: Arrangement | Parts | None = None
    down: Down | None = None
    otherwise: int = 0
    usual_down: float = 0.0

    def measure(self, outline: FloatArray, ground: GroundScale, rate: float) -> None:
        """Learn how tall and how broad they are from the box of their foreground (4,), where it agrees with their own.

        Only while they are clear to see. Where it does not, it is of somebody else too, or not of all of them; but a
        child's box, too large at first, comes down: height is then learnt from the box itself.
        """
        wider, taller = np.abs(np.log(outline[WIDTH : HEIGHT + 1] / self.body.box[WIDTH : HEIGHT + 1]))
        agrees = taller < AGREE_TALL and wider < AGREE_WIDE
        box = outline if agrees else self.body.box
        tall = float(box[HEIGHT] / ground.height(feet(box)))
        self.stature = float(np.clip(self.stature + rate * (tall - self.stature), SHORTEST, TALLEST))
        if agrees:
            broad = float(box[WIDTH] / box[HEIGHT] / ground.aspect)
            self.breadth = float(np.clip(self.breadth + rate * (broad - self.breadth), NARROWEST, BROADEST))

    @property
    def is_another(self) -> bool:
        """Whether what is in the box looks much less like them than it used to."""
        usual = self.usual if self.down is None else self.usual_down
        return self.alike < UNLIKE * usual - DOUBT

    @property
    def missing(self) -> int:
        """Frames in a row without a sight of them."""
        return self.unseen + self.hidden

    @property
    def is_known(self) -> bool:
        """Whether their look was learnt from enough frames to tell them from others."""
        return self.confirmed and self.looks >= ENOUGH_LOOKS

    @property
    def colours(self) -> Appearance | None:
        """What they look like in the box as it is now."""
        return self.appearance if self.down is None or self.appearance is None else self.appearance.pooled

    def may_be_down(self, number: int, frames: int) -> bool:
        """Whether they are, or stood there clear to see for so many frames, and not longer before this one."""
        stood = self.last_clear is not None and number - self.last_clear.frame <= frames <= self.looks
        return stood or self.down is not None

    def remember(self, frame: Frame) -> None:
        """Learn what they look like; only while they are clear to see."""
        picture, codes, mask, box = frame.picture, frame.evidence.codes, frame.evidence.mask, self.body.box
        if self.appearance is None:
            self.appearance = None if codes is None else Appearance.learn(codes, mask, box)
        elif codes is not None:
            self.appearance = self.appearance.updated(codes, mask, box)
            self.usual += (self.alike - self.usual) / min(self.appearance.looks, LONGEST)
        self.look = Look.learn(picture, box, self.colour) if self.look is None else self.look.updated(picture, box)
        self.looks += 1
        self.last_clear = self.sightings[-1]

    def likeness(self, picture: Picture, other: Person) -> float:
        """Squared distance of what they look like to what is seen where another is."""
        return np.inf if self.look is None else self.look.distance(picture, other.body.box)


def follow(
    person: Person,
    frame: Frame,
    motion: BoxMotion,
    counts: CountConfig,
    ground: GroundScale | None,
    anybody: NDArray[np.float32] | None,
) -> None:
    """One frame of the body's filter, of what is evidence for this person."""
    body, evidence = person.body, frame.evidence
    ground = None if ground is None else ground.of_person(person.stature, person.breadth)
    sizes: Likelihood | None = ground
    if person.down is not None:
        evidence, sizes, motion = person.down.evidence(evidence), person.down, person.down.motion(motion)
    colour = body.target.observe(frame.picture, frame.background, evidence.shown)
    cues: list[Likelihood] = [evidence.observe(usual_area(body.box, ground))]
    if sizes is not None:
        cues.append(sizes)
    looks = None
    if person.colours is not None and anybody is not None and evidence.codes is not None:
        scale = APPEARANCE * evidence.config.looks / usual_area(body.box, ground)
        counted = evidence.share * evidence.weights
        ratios = log_ratios(person.colours, anybody)
        if person.down is not None:
            person.usual_down = float((person.colours.histograms * ratios.T).sum() / len(anybody))
        looks = AppearanceLikelihood(evidence.codes, counted, ratios, scale)
        cues.append(looks)
    elif evidence.seen(body.expected)[0] >= TRUST_COLOUR:
        cues.append(colour)
    body.step(person.rng, Together(tuple(cues)), motion, counts)
    person.visible, person.filled = evidence.seen(body.box)
    pixels = person.visible * person.filled * float(body.box[2] * body.box[3])
    person.alike = 0.0 if looks is None else float(looks.log_prob(body.box[None])[0]) / looks.scale / max(1.0, pixels)
    if person.visible >= TRUST_WHOLE and person.filled >= 0.5 * evidence.silhouette.mean:
        body.target = body.target.updated(colour.histogram(body.box))


def usual_area(box: FloatArray, ground: GroundScale | None) -> float:
    """Pixels of a person's box who stands where this one (>= 4,) does; its own where nothing is known of the ground."""
    return float(box[2] * box[HEIGHT]) if ground is None else ground.area(feet(box))


def feet(box: FloatArray) -> float:
    """Row of the feet of a box (>= 4,)."""
    return float(box[Y] + box[HEIGHT] / 2)


def nearness(person: Person) -> tuple[bool, float, float]:
    """Sorts from near to far: those who are sure first, then by where the feet are expected."""
    return not person.confirmed, -feet(person.body.expected), float(person.body.box[X])
