"""How long parts stay right, with and without repair (thesis, 6.3, Fig. 6.15), and boxes that are mistaken for them.

A box is right if at least half of it lies on what it should show. Everybody is started at the truth when first seen
whole; the whole body is the box around the parts, or, where it is followed by itself, a box of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar

import numpy as np

from muybridge.experiments.experiment import Amount, Case, Outcome, Part, Report
from muybridge.experiments.statistics import over_seeds
from muybridge.experiments.tables import Cell, Column, Table
from muybridge.experiments.zhao_2009.people_clips import ClipPictures, PeopleClip, PeopleTrial, hard_clips, people_clips
from muybridge.people.blobs import BlobConfig
from muybridge.people.box import states_from_boxes
from muybridge.people.colour_likelihood import pixel_boxes
from muybridge.people.failure import FailureDetector, detector_named
from muybridge.people.histograms import BinMap, count_histograms, to_luma_chroma
from muybridge.people.labelled import around, as_boxes, coverage, follow_labelled, is_whole
from muybridge.people.masks import Masks
from muybridge.people.parts import PARTS
from muybridge.people.repair_training import thesis_rules
from muybridge.people.scene import describe
from muybridge.people.tracker import PeopleTracker

ANY = "repair, any region"
OURS = "ours, one state"
CONDITIONS = ("one box", "no repair", "repair", ANY, OURS)
"""A single box a person, which is what the whole body is compared with in Fig. 6.15 (d); the thesis' three parts
without and with repair, by foreground that is known to be the person's or by the nearest, whose it may be; `muybridge
people`, which follows bodies too, and on each its three parts as one state."""
FRAME, NEAR = 105, 5
"""The thesis' frame, and how many frames to either side are averaged."""
TARGETS = (*PARTS, "whole")
UNKNOWN = float("nan")
PRINTED = {
    "one box": (UNKNOWN, UNKNOWN, UNKNOWN, 0.75),
    "no repair": (0.67, 0.68, 0.64, UNKNOWN),
    "repair": (0.95, 0.83, 0.91, 0.95),
}
"""Fig. 6.15 at frame 105: head, torso, hip-leg, whole body."""
MOST = 150  # frames
RIGHT = 0.5
NOWHERE = np.full((3, 4), -1e6)
LEAST_PIXELS = 250  # of a region that may be a person


@dataclass(frozen=True)
class RateResult:
    """right : for each target, for each person, a text of 0 and 1, one a frame; none for a target not followed."""

    right: tuple[tuple[str, ...], ...]

    def rate(self, target: int, first: int, last: int) -> float:
        """Share right in frames first..last, of the people who are there in any of them; NaN: nobody."""
        seen = [text[first : last + 1] for text in self.right[target] if len(text) > first]
        return float(np.mean([np.mean([mark == "1" for mark in text]) for text in seen])) if seen else float("nan")


@dataclass(frozen=True)
class RateTrial(PeopleTrial):
    """One condition."""

    RESULT: ClassVar[type[Any]] = RateResult
    REVISION: ClassVar[int] = 2
    condition: str = "repair"

    def measure(self, pictures: ClipPictures) -> RateResult:
        """Follow everybody by their parts."""
        repaired = self.condition in ("repair", ANY)
        detector = detector_named("shipped" if repaired else "none")
        follow = FOLLOW.get(self.condition, _by_parts_alone)
        right: list[list[str]] = [[] for _ in TARGETS]
        for boxes, true_parts, true_bodies in follow(self.clip, pictures, detector):
            whole = coverage(around(boxes), true_bodies) >= RIGHT
            right[-1].append(_text(whole))
            if self.condition != "one box":
                for target, flags in enumerate((coverage(boxes, true_parts) >= RIGHT).T):
                    right[target].append(_text(flags))
        return RateResult(tuple(tuple(texts) for texts in right))


def _text(flags: np.ndarray) -> str:
    return "".join("01"[int(flag)] for flag in flags)


Followed = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Of one person, left, top, width, height: boxes (T, 3, 4) of the parts, or (T, 1, 4) of the one box; the true parts'
(T, 3, 4), and the true body's (T, 4)."""


def _by_parts_alone(
    clip: PeopleClip, pictures: ClipPictures, detector: FailureDetector | None, known: bool = True
) -> Iterator[Followed]:
    """The thesis' tracker."""
    rules = replace(thesis_rules(clip.size, clip.rate), detector=detector)
    rng = np.random.default_rng([clip.seed, 6])
    for track in follow_labelled(
        rng, pictures.shots, pictures.empty, rules, most=MOST, pillar=pictures.pillar, known=known
    ):
        yield as_boxes(track.states), track.true_parts, track.true_bodies


def _by_one_box(clip: PeopleClip, pictures: ClipPictures, detector: FailureDetector | None) -> Iterator[Followed]:
    """The thesis' single whole-body tracker, "the same as that for the body part" (6.3.2)."""
    rng = np.random.default_rng([clip.seed, 6])
    rules = thesis_rules(clip.size, clip.rate)
    for track in follow_labelled(
        rng, pictures.shots, pictures.empty, rules, most=MOST, one_box=True, pillar=pictures.pillar
    ):
        yield as_boxes(track.states), track.true_parts, track.true_bodies


def _by_people_tracker(
    clip: PeopleClip, pictures: ClipPictures, detector: FailureDetector | None
) -> Iterator[Followed]:
    """`PeopleTracker` on masks of its own; a person counts from the first frame in which their parts are followed."""
    masks = Masks.train([pictures.empty])
    found = [masks.apply(shot.image) for shot in pictures.shots]
    scene = describe(pictures.empty, found[::4], BlobConfig(smallest=LEAST_PIXELS))
    tracker = PeopleTracker(scene, frame_rate=clip.rate, seed=clip.seed)
    for number, (shot, mask) in enumerate(zip(pictures.shots, found, strict=True)):
        tracker.step(number, shot.image, mask)
    parts = tracker.tracks().parts
    boxes = {(int(parts.frames[k]), int(parts.ids[k])): parts.boxes[k : k + 3] for k in range(0, len(parts), 3)}
    for person in {int(number) for shot in pictures.shots for number in shot.numbers}:
        rows = _rows_of(person, pictures, boxes, clip.size)
        if rows:
            yield tuple(np.array(column) for column in zip(*rows, strict=True))  # type: ignore[misc]


Follow = Callable[[PeopleClip, ClipPictures, FailureDetector | None], Iterator[Followed]]
FOLLOW: Mapping[str, Follow] = {
    "one box": _by_one_box,
    ANY: partial(_by_parts_alone, known=False),
    OURS: _by_people_tracker,
}
"""How each condition follows; by parts alone where nothing is said."""


def _rows_of(
    person: int, pictures: ClipPictures, boxes: Mapping[tuple[int, int], np.ndarray], size: tuple[int, int]
) -> list[Followed]:
    """From the first frame that shows them whole and some track's parts on them; that track's, or nothing, after it."""
    rows: list[Followed] = []
    identity: int | None = None
    for frame, shot in enumerate(pictures.shots):
        at = np.flatnonzero(shot.numbers == person)
        if not at.size:
            if rows:
                break
            continue
        k = int(at[0])
        if identity is None and is_whole(shot, k, size):
            fits = {i: float(coverage(around(box), shot.boxes[k])) for (t, i), box in boxes.items() if t == frame}
            best = max(fits, key=fits.__getitem__, default=None)
            identity = best if best is not None and fits[best] > RIGHT else None
        if identity is not None and len(rows) < MOST:
            rows.append((boxes.get((frame, identity), NOWHERE), shot.parts[k], shot.boxes[k]))
    return rows


def cases_of_rates(scale: Amount) -> Iterator[Case]:
    """Every condition on one clip a seed."""
    return _cases(people_clips(scale.seeds))


def cases_of_hard_rates(scale: Amount) -> Iterator[Case]:
    """The same in halls where more is lost."""
    return _cases(hard_clips(scale.seeds))


def _cases(clips: Iterator[PeopleClip]) -> Iterator[Case]:
    for clip in clips:
        for condition in CONDITIONS:
            yield Case(condition, RateTrial(clip, condition))


def report_of_rates(outcome: Outcome, name: str = "tracking-rate", where: str = "") -> Report:
    """At the thesis' frame, and against the frame."""
    from muybridge.plotting.people_curves import plot_rates
    from muybridge.plotting.style import new_figure

    rows: list[tuple[Cell, ...]] = []
    figure, axes = new_figure(2, 2, width=9.0, height=6.0)
    curves: dict[str, list[np.ndarray]] = {}
    for condition, group in outcome.groups().items():
        cells = [over_seeds({row.key: row.result.rate(k, FRAME - NEAR, FRAME + NEAR) for row in group})
                 for k in range(len(TARGETS))]  # fmt: skip
        people = sum(len(text) > FRAME - NEAR for row in group for text in row.result.right[-1])
        rows.append((condition, *cells, people))
        curves[condition] = [_curve(group, k) for k in range(len(TARGETS))]
    rows += [(f"thesis, {name}", *values, 72) for name, values in PRINTED.items()]
    for k, (target, ax) in enumerate(zip(TARGETS, axes.ravel(), strict=True)):
        plot_rates(ax, {condition: curve[k] for condition, curve in curves.items()}, target.replace("_", "-"))
    columns = (Column("tracker"), *(Column(name, 0, percent=True) for name in TARGETS), Column("people", 0))
    notes = (
        f"Share right in frames {FRAME - NEAR} to {FRAME + NEAR} after the start, of the people still there; intervals "
        "over seeds.",
        "Ours is not started at the truth: it counts from the first frame in which the parts are followed.",
    )
    table = Table(name, f"Parts still right at frame 105{where} (Fig. 6.15)", columns, tuple(rows), notes)
    return Report((table,), {name: figure})


def report_of_hard_rates(outcome: Outcome) -> Report:
    """The same in halls where more is lost."""
    return report_of_rates(outcome, "tracking-rate-hard", ", five people and a pillar")


def _curve(group: list[Any], target: int) -> np.ndarray:
    """(MOST,) share right at each frame; NaN where nobody is left."""
    texts = [text for row in group for text in row.result.right[target]]
    marks = np.full((len(texts), MOST), np.nan)
    for mark, text in zip(marks, texts):
        mark[: len(text)] = [character == "1" for character in text]
    counts = np.sum(~np.isnan(marks), axis=0)
    return np.where(counts > 0, np.nansum(marks, axis=0) / np.maximum(counts, 1), np.nan)


@dataclass(frozen=True)
class AlarmResult:
    """For each part: random boxes that were tried, and those that were mistaken for the part."""

    tried: tuple[int, ...]
    mistaken: tuple[int, ...]


@dataclass(frozen=True)
class AlarmTrial(PeopleTrial):
    """Random boxes against parts, with bins fitted to the part or even ones (thesis, 6.2.3)."""

    RESULT: ClassVar[type[Any]] = AlarmResult
    mapping: bool = True
    boxes: int = 1000  # a part and picture
    pictures: int = 8

    def measure(self, pictures: ClipPictures) -> AlarmResult:
        """The first person seen whole in pictures spread over the clip."""
        rng = np.random.default_rng([self.clip.seed, 623])
        tried, mistaken = np.zeros(len(PARTS), int), np.zeros(len(PARTS), int)
        whole = [(shot, k) for shot in pictures.shots for k in range(len(shot.numbers)) if shot.visible[k] > 0.95]
        for index in np.linspace(0, len(whole) - 1, min(self.pictures, len(whole))).astype(int):
            shot, k = whole[index]
            picture = to_luma_chroma(shot.image)
            for part, box in enumerate(shot.parts[k]):
                far, near = _random_boxes(rng, box, self.clip.size, self.boxes)
                alike = _likeness(picture, box, self.mapping)
                threshold = float(alike(near).mean())
                tried[part] += len(far)
                mistaken[part] += int(np.count_nonzero(alike(far) >= threshold))
        return AlarmResult(tuple(map(int, tried)), tuple(map(int, mistaken)))


def _random_boxes(
    rng: np.random.Generator, box: np.ndarray, size: tuple[int, int], count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Boxes (N, 4) of the target's size that do not overlap with it, and (M, 4) that do with more than half."""
    low, high = np.zeros(2), np.maximum(1.0, np.array(size) - box[2:])
    places = rng.uniform(low, high, (4 * count, 2))
    apart = (np.abs(places - box[:2]) >= box[2:]).any(axis=1)
    far = places[apart][:count]
    shifts = rng.uniform(-0.5, 0.5, (200, 2)) * box[2:]
    near = box[:2] + shifts[np.prod(1 - np.abs(shifts) / box[2:], axis=1) > 0.5]
    return tuple(np.column_stack([corners, np.repeat(box[None, 2:], len(corners), axis=0)]) for corners in (far, near))  # type: ignore[return-value]


def _likeness(picture: np.ndarray, box: np.ndarray, mapping: bool) -> Any:
    """Function of boxes (N, 4): (N,) Bhattacharyya coefficients with what is in `box`, mean of the three channels."""
    target = pixel_boxes(states_from_boxes(box))[0]
    left, top, right, bottom = np.maximum(0, target[0])
    bins = BinMap.equalising(picture[top:bottom, left:right]) if mapping else BinMap.even()
    reference = count_histograms(picture, bins, target)[0]

    def alike(boxes: np.ndarray) -> np.ndarray:
        found = count_histograms(picture, bins, pixel_boxes(states_from_boxes(boxes))[0])
        return np.sqrt(found * reference).sum(axis=1) / 3

    return alike


def cases_of_alarms(scale: Amount) -> Iterator[Case]:
    """With and without the mapping."""
    for clip in people_clips(scale.seeds):
        for mapping in (True, False):
            yield Case("fitted bins" if mapping else "even bins", AlarmTrial(clip, mapping))


def report_of_alarms(outcome: Outcome) -> Report:
    """Shares of random boxes."""
    printed = {"fitted bins": (0.0013, 0.0016, 0.0009), "even bins": (0.0195, 0.0147, 0.0145)}
    rows: list[tuple[Cell, ...]] = []
    for label, group in outcome.groups().items():
        shares = [over_seeds({row.key: row.result.mistaken[k] / max(1, row.result.tried[k]) for row in group})
                  for k in range(len(PARTS))]  # fmt: skip
        rows.append((label, *shares, sum(sum(row.result.tried) for row in group)))
        rows.append((f"thesis, {label}", *printed[label], 50000))
    columns = (Column("histogram"), *(Column(name, 2, percent=True) for name in PARTS), Column("boxes", 0))
    notes = ("Mistaken: as like the part (Bhattacharyya's coefficient) as boxes that overlap with it by more than half "
             "are on average.",)  # fmt: skip
    return Report((Table("false-alarms", "Random boxes mistaken for a part (6.2.3)", columns, tuple(rows), notes),))


RATES = Part("rates", "Parts still right, with and without repair (Fig. 6.15)", report_of_rates, cases_of_rates)
HARD_RATES = Part("hard-rates", "The same where five people and a pillar hide each other", report_of_hard_rates,
                  cases_of_hard_rates)  # fmt: skip
ALARMS = Part("alarms", "Boxes mistaken for parts, with and without fitted bins (6.2.3)", report_of_alarms,
              cases_of_alarms)  # fmt: skip
