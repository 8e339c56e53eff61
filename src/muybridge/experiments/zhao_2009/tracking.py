"""One box for a whole person, followed by colour: ours, the thesis' and Nummiaro's (thesis, 6.2, Tables 1 to 4).

All are the same particle filter with the thesis' motion and a fixed number of particles; what differs is the
likelihood: `contrast_likelihood`, (4.13) as printed, and `nummiaro`. With ours people are followed from near to far,
and what the middle of a nearer box covers is not looked at, nor learnt, for those behind it (in the spirit of 5.4.1).
Everybody is started at the truth when first seen whole, and followed until their middle leaves the picture.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from muybridge.experiments.experiment import Amount, Case, Outcome, Part, Report
from muybridge.experiments.statistics import over_seeds
from muybridge.experiments.tables import Cell, Column, Table
from muybridge.experiments.zhao_2009.people_clips import ClipPictures, PeopleTrial, people_clips
from muybridge.filters import condensation
from muybridge.people.blobs import Mask
from muybridge.people.box import HEIGHT, PRINTED_VARIANCES, SPEED_Y, BoxMotion, Y, states_from_boxes
from muybridge.people.colour_likelihood import ColourTarget, Picture
from muybridge.people.contrast_likelihood import ContrastTarget
from muybridge.people.evidence import middle
from muybridge.people.histograms import to_luma_chroma
from muybridge.people.labelled import is_whole
from muybridge.people.nummiaro import NummiaroTarget

PARTICLES = (200, 400, 600, 800, 1000, 2000)
METHODS = ("ours", "thesis", "Nummiaro")
TARGETS: dict[str, Any] = {"ours": ContrastTarget, "thesis": ColourTarget, "Nummiaro": NummiaroTarget}
CORE = 0.7
"""Share of a nearer box's width that hides what is behind it; chosen with the likelihood."""
UNKNOWN = float("nan")
PRINTED = {
    "ours": ((UNKNOWN,) * 6, (UNKNOWN,) * 6),
    "thesis": ((52.2, 46.3, 41.7, 43.0, 41.7, 39.1), (32.9, 26.9, 22.2, 22.4, 22.6, 19.8)),
    "Nummiaro": ((78.4, 73.0, 73.5, 73.0, 71.3, 68.6), (44.7, 42.1, 41.2, 39.0, 41.3, 40.5)),
}
"""Tables 1 and 3: centre deviation, pixels, on the thesis' own clips and on CAVIAR."""
PRINTED_SPEED = {
    "ours": (UNKNOWN,) * 6,
    "thesis": (62.4, 56.1, 49.7, 45.0, 41.1, 21.5),
    "Nummiaro": (50.3, 26.4, 17.0, 12.9, 10.3, 4.6),
}
"""Table 4: frames a second at 384 x 288, 3 GHz."""
FEWEST = 25  # frames; who is seen for less is not counted


@dataclass(frozen=True)
class BoxResult:
    """Means over people: how far the box's centre is from the true one, pixels; and frames a second of CPU time."""

    deviation: float
    frames_per_second: float
    people: int


@dataclass
class _Followed:
    target: Any
    state: condensation.State
    off: list[float] = field(default_factory=list)
    there: bool = True
    seconds: float = 0.0

    @property
    def feet(self) -> float:
        """Row in which the feet are expected; who has it lower in the picture is nearer."""
        box = self.state.estimate
        return float(box[Y] + box[HEIGHT] / 2 + box[SPEED_Y])

    def step(
        self,
        rng: np.random.Generator,
        pictures: tuple[Picture, Picture],
        shown: Mask | None,
        motion: BoxMotion,
        config: condensation.Config,
    ) -> None:
        """One frame: picture and background; what is hidden behind this one is taken out of `shown`."""
        began = time.thread_time()
        likelihood = self.target.observe(*pictures) if shown is None else self.target.observe(*pictures, shown)
        self.state, _ = condensation.step(rng, self.state, likelihood, motion, config)
        self.target = self.target.updated(likelihood.histogram(self.state.estimate))
        if shown is not None:
            shown[middle(self.state.estimate, CORE)] = False
        self.seconds += time.thread_time() - began


@dataclass(frozen=True)
class BoxTrial(PeopleTrial):
    """One method with so many particles."""

    RESULT: ClassVar[type[Any]] = BoxResult
    REVISION: ClassVar[int] = 3
    method: str = "ours"
    particles: int = 600

    def measure(self, pictures: ClipPictures) -> BoxResult:
        """Follow everybody."""
        rng = np.random.default_rng([self.clip.seed, self.particles])
        seen = np.asarray if self.method == "Nummiaro" else to_luma_chroma
        empty = seen(pictures.empty)
        motion = BoxMotion.within((empty.shape[1], empty.shape[0]))
        config = condensation.Config(estimate="mean", resampling="systematic", particles=self.particles)
        speed_sd = np.sqrt(PRINTED_VARIANCES[-1])
        start_sd = np.array([0.0, 0.0, 0.0, 0.0, speed_sd, speed_sd])
        everybody: dict[int, _Followed] = {}
        for shot in pictures.shots:
            picture = seen(shot.image)
            shown = np.ones(picture.shape[:2], np.bool_) if self.method == "ours" else None
            boxes = {int(number): states_from_boxes(box)[0] for number, box in zip(shot.numbers, shot.boxes)}
            here = [number for number in boxes if number in everybody and everybody[number].there]
            for number in sorted(here, key=lambda number: -everybody[number].feet):
                one, box = everybody[number], boxes[number]
                one.there = bool((motion.lower[:2] <= box[:2]).all() and (box[:2] <= motion.upper[:2]).all())
                one.step(rng, (picture, empty), shown, motion, config)
                one.off.append(float(np.hypot(*(one.state.estimate[:2] - box[:2]))))
            for k, number in enumerate(int(number) for number in shot.numbers):
                if number not in everybody and is_whole(shot, k, self.clip.size):
                    target = TARGETS[self.method].learn(picture, boxes[number])
                    state = condensation.init(rng, boxes[number], start_sd, config, motion.lower, motion.upper)
                    everybody[number] = _Followed(target, state)
        counted = [one for one in everybody.values() if len(one.off) >= FEWEST]
        if not counted:
            return BoxResult(float("nan"), float("nan"), 0)
        rate = sum(len(one.off) for one in counted) / sum(one.seconds for one in counted)
        return BoxResult(float(np.mean([np.mean(one.off) for one in counted])), rate, len(counted))


def cases(scale: Amount) -> Iterator[Case]:
    """Every method, every number of particles, one clip a seed."""
    counts = PARTICLES[::3] if scale.quick else PARTICLES
    for clip in people_clips(scale.seeds):
        for method in METHODS:
            for count in counts:
                yield Case(f"{method}, {count}", BoxTrial(clip, method, count), count)


def report(outcome: Outcome) -> Report:
    """Deviation and speed against the number of particles."""
    from muybridge.plotting.people_curves import plot_deviation
    from muybridge.plotting.style import new_figure

    found: dict[tuple[str, int], list[Any]] = {}
    for row in outcome.rows:
        found.setdefault((row.case.trial.method, row.case.trial.particles), []).append(row)
    rows: list[tuple[Cell, ...]] = []
    curves = {}
    for method in METHODS:
        means, lows, highs, counts = [], [], [], []
        for (name, count), group in found.items():
            if name != method:
                continue
            off = over_seeds({row.key: row.result.deviation for row in group})
            speed = over_seeds({row.key: row.result.frames_per_second for row in group})
            index = PARTICLES.index(count)
            people = sum(row.result.people for row in group)
            rows.append((method, count, off, PRINTED[method][0][index], PRINTED[method][1][index], speed,
                         PRINTED_SPEED[method][index], people))  # fmt: skip
            counts.append(count)
            means.append(off.mean)
            lows.append(off.low)
            highs.append(off.high)
        curves[method] = tuple(np.array(values, dtype=np.float64) for values in (counts, means, lows, highs))
    figure, axes = new_figure(1, 1)
    plot_deviation(axes[0, 0], curves, "Centre deviation")
    columns = (Column("method"), Column("particles", 0), Column("deviation, px"), Column("thesis, own clips"),
               Column("thesis, CAVIAR"), Column("frames/s", 0), Column("thesis, CAVIAR, frames/s"),
               Column("people", 0))  # fmt: skip
    notes = ("Of one box around the whole person, mean over people and frames; intervals over seeds.",
             "Frames a second of one person, CPU time of one thread; decoding is not in it.")  # fmt: skip
    table = Table("boxes", "One box a person by colour (Tables 1 to 4)", columns, tuple(rows), notes)
    return Report((table,), {"boxes": figure})


BOXES = Part("boxes", "Centre deviation and speed against particles (Tables 1 to 4)", report, cases)
