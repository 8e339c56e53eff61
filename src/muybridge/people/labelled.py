"""Part tracks beside the truth: the thesis' tracker on rendered people, each started where the truth says.

What failure detectors learn from, and what tracking rates are counted on (Zhao 2009, 5.3 and 6.3.2). A box is right if
at least half of it lies on what it should show.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from muybridge.filters.particles import FloatArray
from muybridge.people.alone import BodyAlone, PartsAlone
from muybridge.people.blobs import Mask
from muybridge.people.box import states_from_boxes
from muybridge.people.colour_likelihood import Picture
from muybridge.people.evidence import Evidence
from muybridge.people.filtered import Frame
from muybridge.people.histograms import to_luma_chroma
from muybridge.people.part_filters import PartRules
from muybridge.people.silhouette import Silhouette
from muybridge.synthetic.crowd import PeopleShot

Alone = PartsAlone | BodyAlone
WHOLE = 0.95  # share of a person that must be seen to start


@dataclass(frozen=True, eq=False)
class LabelledTrack:
    """One person from a start on, T frames.

    states : (T, 3, 6) of the parts, or (T, 1, 6) of the one box; bodies : (T, 6), as the parts have it
    true_parts : (T, 3, 4), true_bodies : (T, 4), left, top, width, height
    visible : (T, 3) share of each part that nothing hides
    """

    person: int
    states: FloatArray
    bodies: FloatArray
    true_parts: FloatArray
    true_bodies: FloatArray
    visible: FloatArray


@dataclass
class _Followed:
    person: int
    tracker: Alone
    rows: list[tuple[FloatArray, ...]] = field(default_factory=list)

    def finished(self) -> LabelledTrack:
        return LabelledTrack(self.person, *(np.array(column) for column in zip(*self.rows, strict=True)))


def follow_labelled(
    rng: np.random.Generator,
    shots: Iterable[PeopleShot],
    empty: Picture,
    rules: PartRules,
    *,
    most: int,
    again: bool = False,
    one_box: bool = False,
    pillar: Mask | None = None,
    known: bool = True,
) -> list[LabelledTrack]:
    """Everybody from the first frame that shows them whole, up to `most` frames or until they leave.

    Parameters
    ----------
    empty : (H, W, 3) uint8 BGR, the scene without people
    again : start anew at the truth after `most` frames
    one_box : each is one box, instead of parts that are repaired if the rules say so
    pillar : (H, W) bool, what may stand before people, drawn by hand (5.4.2)
    known : lost parts are placed anew on foreground that is the person's own; else on the nearest, whose it may be
    """
    kind: type[Alone] = BodyAlone if one_box else PartsAlone
    background = to_luma_chroma(empty)
    size = empty.shape[1], empty.shape[0]
    following: dict[int, _Followed] = {}
    done: list[LabelledTrack] = []
    finished: set[int] = set()
    for number, shot in enumerate(shots):
        picture = to_luma_chroma(shot.image)
        there = {int(person): k for k, person in enumerate(shot.numbers)}
        for person in [person for person in following if person not in there]:
            done.append(following.pop(person).finished())
        for person, k in there.items():
            frame = Frame(number, picture, background, _evidence(shot, person, pillar))
            if person in following:
                one = following[person]
                if known or isinstance(one.tracker, BodyAlone):
                    one.tracker.step(frame)
                else:
                    one.tracker.step(frame, replace(frame, evidence=Evidence(shot.mask, Silhouette.flat())))
            elif person in finished or not is_whole(shot, k, size):
                continue
            else:
                body = states_from_boxes(shot.boxes[k])[0]
                tracker = kind.start(rng.spawn(1)[0], body, frame, rules)
                if tracker is None:
                    continue
                one = following[person] = _Followed(person, tracker)
            one.rows.append((one.tracker.states, one.tracker.body, shot.parts[k], shot.boxes[k],
                             shot.parts_visible[k]))  # fmt: skip
            if len(one.rows) == most:
                done.append(following.pop(person).finished())
                if not again:
                    finished.add(person)
    return done + [one.finished() for one in following.values()]


def coverage(boxes: FloatArray, truth: FloatArray) -> FloatArray:
    """(...) share of each box (..., 4) that lies on the true one; both left, top, width, height."""
    low = np.maximum(boxes[..., :2], truth[..., :2])
    high = np.minimum(boxes[..., :2] + boxes[..., 2:], truth[..., :2] + truth[..., 2:])
    shared = np.prod(np.maximum(0.0, high - low), axis=-1)
    result: FloatArray = shared / np.maximum(np.prod(boxes[..., 2:], axis=-1), 1e-9)
    return result


def as_boxes(states: FloatArray) -> FloatArray:
    """(..., 4) left, top, width, height of states (..., >= 4)."""
    return np.concatenate([states[..., :2] - states[..., 2:4] / 2 + 0.5, states[..., 2:4]], axis=-1)


def around(boxes: FloatArray) -> FloatArray:
    """(..., 4) the smallest box that holds all of (..., K, 4)."""
    low, high = boxes[..., :2].min(axis=-2), (boxes[..., :2] + boxes[..., 2:]).max(axis=-2)
    return np.concatenate([low, high - low], axis=-1)


def _evidence(shot: PeopleShot, person: int, pillar: Mask | None) -> Evidence:
    """The person's own foreground; others, and a pillar, who stand before them or not, say nothing."""
    own = shot.ids == person
    other = shot.ids > 0 if pillar is None else (shot.ids > 0) | pillar
    return Evidence(own, Silhouette.flat(), hidden=other & ~own)


def is_whole(shot: PeopleShot, k: int, size: tuple[int, int]) -> bool:
    left, top, width, height = shot.boxes[k]
    inside = left >= 0 and top >= 0 and left + width <= size[0] and top + height <= size[1]
    return bool(inside and shot.visible[k] >= WHOLE)
