"""Head, torso and hip-leg as one state: how they lie on a body, followed by one filter.

Zhao (2009, ch. 7) leaves "one joint state for the three parts" as future work, in which arrangements that people do not
have are never proposed. How far parts are from where they were on the body when it was cut hangs together: who leans or
bends moves all three, and where the body's box is off, it is off for all three. So where one part has lost its
colours, the others say where it is.

==========  =====================================================================
symbol      name
==========  =====================================================================
x (6,)      a state: how far head, torso and hip-leg are from there, across, then
            along, in heights of the body
C (6, 6)    `usual_arrangements`
a, r        ArrangementWalk.keep, ArrangementWalk.reach
==========  =====================================================================

Sizes are not in the state: colours hardly tell them (docs/benchmarks.md, "People"); they go with the body's.

Cost: N colour likelihoods a part and frame, N adapted by (4.18): as many as of a filter of N for each.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from muybridge.filters import condensation
from muybridge.filters.dynamics import Belief, GaussianWalk
from muybridge.filters.particles import FloatArray
from muybridge.filters.state import Likelihood, State
from muybridge.people.box import adapted_count
from muybridge.people.filtered import FILTER, Frame, Target, flattened, learn
from muybridge.people.part_filters import PartRules, boxes_of, cut, shares_of
from muybridge.people.parts import PARTS

DIMENSIONS = 2 * len(PARTS)
ACROSS = ((24.0, 10.5, -7.5), (10.5, 6.0, -1.5), (-7.5, -1.5, 9.0))
ALONG = ((18.5, 13.5, 7.5), (13.5, 11.5, 7.5), (7.5, 7.5, 8.0))
"""(3, 3) covariances of how far the true parts are from where their shares of the body's box have them, (heights /
100)^2, in halls 9100 (calm) and 9200 to 9205 (hard): `python benchmarks/people_arrangement.py --learn`. People lean to
both sides: nothing between the two."""
COLOUR_SD = 0.02  # heights: where one part's colours fit best is off by itself; 0.015 was alike
BODY_SD = 0.03  # heights: a body's box that is off takes all three along; 0 and 0.02 were alike, 0.08 was worse
TRUST = (0.5, 1.0, 0.7)
"""Weight of the colours of head, torso and hip-leg: heads have few pixels, and legs of one colour slide. Deviation in
hard halls 9200 and 9202 to 9204, shares of the height: with these 3.3, 2.4 and 3.7 %, with 1 for each 3.6, 2.6, 3.6."""
KEEP = 0.65  # a, a frame; 0.5 and 0.8 were alike on development clips
REACH = 4.1  # r: 99 % of N(0, C) are within, of six components
DRAWS = 20  # before what is still not plausible is pulled in
START_SD = 0.01  # heights: the parts have just been cut


def usual_arrangements() -> FloatArray:
    """C (6, 6), heights squared."""
    covariance = np.zeros((DIMENSIONS, DIMENSIONS))
    for k, block in enumerate((ACROSS, ALONG)):
        rows = slice(len(PARTS) * k, len(PARTS) * (k + 1))
        covariance[rows, rows] = np.array(block) / 100**2 + COLOUR_SD**2 * np.eye(len(PARTS)) + BODY_SD**2
    return covariance


@dataclass(frozen=True, eq=False)
class ArrangementWalk(GaussianWalk):
    """x_t = a x_{t-1} + N(0, (1 - a^2) C), drawn again where it is not plausible: x' C^-1 x > r^2.

    In the long run, and where nothing is seen, it is N(0, C) within that ellipsoid.

    Parameters
    ----------
    noise_sd : (6,) float64, heights
        Of each component by itself; `usual_walk` makes it from C.
    covariance : (6, 6) float64, heights squared
        C.
    keep, reach : float
        a and r.
    """

    covariance: FloatArray = field(default_factory=usual_arrangements)
    keep: float = KEEP
    reach: float = REACH

    @classmethod
    def usual_walk(cls, covariance: FloatArray | None = None) -> ArrangementWalk:
        """As people's parts were found to move."""
        covariance = usual_arrangements() if covariance is None else covariance
        return cls(np.sqrt((1 - KEEP**2) * np.diag(covariance)), covariance=covariance)

    @cached_property
    def root(self) -> FloatArray:
        """(6, 6) lower L with L L' = C."""
        root: FloatArray = np.linalg.cholesky(self.covariance).astype(np.float64)
        return root

    def sample(
        self,
        rng: np.random.Generator,
        particles: FloatArray,
        velocity: FloatArray | None = None,
        scale: float | FloatArray = 1.0,
    ) -> FloatArray:
        """See `Dynamics.sample`; the velocity is not used. What is not plausible is never returned."""
        moved, wanted = np.empty_like(particles), np.arange(len(particles))
        for _ in range(DRAWS):
            moved[wanted] = self._drawn(rng, particles[wanted], scale)
            wanted = wanted[self.distance(moved[wanted]) > self.reach]
            if not wanted.size:
                return moved
        moved[wanted] *= (self.reach / self.distance(moved[wanted]))[:, None]
        return moved

    def distance(self, particles: FloatArray) -> FloatArray:
        """(N,) sqrt(x' C^-1 x) of states (N, 6)."""
        whitened = np.linalg.solve(self.root, particles.T)
        squared: FloatArray = np.einsum("dn,dn->n", whitened, whitened)
        return np.sqrt(squared)

    def carry(self, belief: Belief) -> Belief:
        """Mean a m, covariance a^2 P + (1 - a^2) C; no velocity is believed in."""
        covariance = self.keep**2 * belief.covariance + (1 - self.keep**2) * self.covariance
        return replace(super().carry(belief), mean=self.keep * belief.mean, covariance=covariance)

    def _drawn(self, rng: np.random.Generator, particles: FloatArray, scale: float | FloatArray) -> FloatArray:
        noise = np.einsum("nd,ed->ne", rng.standard_normal(particles.shape), self.root)
        drawn: FloatArray = self.keep * particles + np.sqrt(1 - self.keep**2) * scale * noise
        return drawn


@dataclass(frozen=True, eq=False)
class ArrangementLikelihood:
    """One frame: the parts' colours are independent given where they are, so that their log likelihoods add up.

    colours : one a part, None where it is not asked; expected : (3, 4), and the body's height, pixels
    """

    colours: Sequence[Likelihood | None]
    expected: FloatArray
    height: float

    def log_prob(self, states: FloatArray) -> FloatArray:
        """(N,) of arrangements (N, 6)."""
        boxes = self.boxes(states)
        log_prob = np.zeros(len(states))
        for k, (colour, trust) in enumerate(zip(self.colours, TRUST, strict=True)):
            if colour is not None:
                log_prob += trust * colour.log_prob(boxes[:, k])
        return log_prob

    def boxes(self, states: FloatArray) -> FloatArray:
        """(N, 3, 4) centre and size, pixels, of arrangements (N, 6)."""
        boxes = np.repeat(self.expected[None], len(states), axis=0)
        boxes[..., 0] += self.height * states[:, : len(PARTS)]
        boxes[..., 1] += self.height * states[:, len(PARTS) :]
        return boxes


@dataclass(eq=False)
class Arrangement:
    """The three parts of one person on their body.

    shares : (3, 4) float64, centre from the body's and size when they were cut, as shares of the body's sides
    boxes : (3, 4) float64, centre and size, pixels, the estimate
    """

    state: State
    targets: list[Target]
    shares: FloatArray
    boxes: FloatArray
    rules: PartRules
    rng: np.random.Generator
    walk: ArrangementWalk = field(default_factory=ArrangementWalk.usual_walk)

    @classmethod
    def start(cls, rng: np.random.Generator, body: FloatArray, frame: Frame, rules: PartRules) -> Arrangement | None:
        """Cut a body (>= 4,) that is clear to see into three; None where that cannot be done.

        Random numbers are its own: the body goes where it would without parts.
        """
        boxes = cut(body, frame, rules.cut)
        if boxes is None:
            return None
        rng = rng.spawn(1)[0]
        state = condensation.init(rng, np.zeros(DIMENSIONS), np.full(DIMENSIONS, START_SD), FILTER)
        targets = [learn(frame.picture, box, rules.colour) for box in boxes]
        return cls(state, targets, shares_of(boxes, body), boxes[:, :4], rules, rng)

    def step(self, body: FloatArray, frame: Frame, trusted: bool) -> FloatArray:
        """One frame: (3, 5) centre, size and score of the parts of a body (>= 4,).

        trusted : bool
            Whether colours are the person's own; if not, nothing is learnt, and of colours only those are asked that
            know what is hidden: a head that can be seen is not to go with a body whose legs cannot.
        """
        colours = [target.observe(frame.picture, frame.background, frame.evidence.shown) for target in self.targets]
        asked = [colour if trusted or colour.partial else None for colour in colours]
        seen = ArrangementLikelihood(asked, boxes_of(self.shares, body), float(body[3]))
        config = replace(FILTER, particles=adapted_count(self.state.log_weights, self.rules.counts))
        self.state, _ = condensation.step(self.rng, flattened(self.state), seen, self.walk, config)
        self.boxes = seen.boxes(self.state.estimate[None])[0]
        scores = [colour.likeness(box) for colour, box in zip(colours, self.boxes, strict=True)]
        if trusted:
            looks = [colour.histogram(box) for colour, box in zip(colours, self.boxes, strict=True)]
            self.targets = [target.updated(look) for target, look in zip(self.targets, looks, strict=True)]
        return np.column_stack([self.boxes, scores])
