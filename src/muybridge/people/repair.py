"""A part that failed, placed anew from the other two (Zhao 2009, 5.4).

==========================  =========================================
symbol                      name
==========================  =========================================
{X_T, Y_T, W_T, H_T}        `torso_between`, (5.8)
R_h, R_l                    `section`: rows above and below the torso
N_1 + N_2                   particles of the part that was mended
foreground region           `in_sight`
==========================  =========================================

Differences from the paper: "above" and "below" reach as far from the torso's middle as the sections are high that
bodies are cut into; where there is no foreground, the part is put in the middle of its section, at its size. Whether
somebody is hidden is asked of the foreground around where they are expected, not of the boxes: those may be lost.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from muybridge.filters.particles import FloatArray
from muybridge.filters.state import State
from muybridge.people.blobs import BlobConfig, find_people
from muybridge.people.box import SPEED_X, states_from_boxes
from muybridge.people.evidence import middle
from muybridge.people.filtered import Colour, Filtered, Frame, learn
from muybridge.people.parts import PARTS, PartConfig, inner_box

HEAD, TORSO, HIP_LEG = range(len(PARTS))
AROUND = 0.5  # heights of the body, across and along: how far from where they are expected somebody is looked for
MOST_OF = 0.4
"""Of what a person fills in a box of the size that is expected: with less in sight they are hidden. Chosen on ten halls
with a pillar: whole bodies right at frame 105, with 0.3 and 0.4 95 %, 0.6 91, 0.8 76, and no repair 67."""
FEWEST = 0.15  # share of a section that must be foreground to say where the part is


def mended(
    filters: Sequence[Filtered], index: int, body: FloatArray, frame: Frame, cut: PartConfig, colour: Colour
) -> Filtered:
    """The part `index` anew: its place from the others, their velocities, and what it looks like there.

    body : (>= 4,), whose width and height say how far a section reaches
    """
    others = [part for k, part in enumerate(filters) if k != index]
    if index == TORSO:
        box = torso_between(filters[HEAD].box, filters[HIP_LEG].box)
    else:
        box = in_section(section(index, filters[TORSO].box, body, cut), filters[index].box, frame, cut)
    particles = np.concatenate([part.state.particles for part in others])
    particles[:, :SPEED_X] = box
    speed = np.mean([part.box[SPEED_X:] for part in others], axis=0)
    estimate = np.concatenate([box, speed])
    state = State(particles, np.full(len(particles), -np.log(len(particles))), estimate, filters[index].state.velocity)
    return Filtered(state, learn(frame.picture, estimate, colour))


def torso_between(head: FloatArray, hip_leg: FloatArray) -> FloatArray:
    """(4,) of (5.8): the mean of both boxes (>= 4,)."""
    between: FloatArray = (head[:SPEED_X] + hip_leg[:SPEED_X]) / 2
    return between


def section(index: int, torso: FloatArray, body: FloatArray, cut: PartConfig) -> FloatArray:
    """(4,) centre and size of the head's section, above the torso's, or of the upper half of the legs', below."""
    own = cut.ratios[index] / (2 if index == HIP_LEG else 1)
    reach = (cut.ratios[TORSO] + own) / 2 * body[3]
    centre = torso[1] - reach if index == HEAD else torso[1] + reach
    return np.array([torso[0], centre, body[2], own * body[3]])


def in_section(place: FloatArray, before: FloatArray, frame: Frame, cut: PartConfig) -> FloatArray:
    """(4,) the inner box (5.1) to (5.4) of the foreground in a section (4,)."""
    rows, columns = middle(place, 1.0)
    mask = frame.evidence.mask[rows, columns] & frame.evidence.shown[rows, columns]
    box = inner_box(mask, 0, len(mask), cut.shrink) if mask.any() and mask.mean() > FEWEST else None
    if box is None:
        return np.concatenate([place[:2], before[2:SPEED_X]])
    return np.array(box) + (columns.start, rows.start, 0, 0)


def in_sight(body: FloatArray, frame: Frame) -> FloatArray | None:
    """(4,) the region of foreground nearest to where a body (>= 4,) is expected; None where there is none.

    Centre and size; regions are what may be a person (5.1), of at least `MOST_OF` what this one fills.
    """
    evidence = frame.evidence
    smallest = max(1, round(MOST_OF * evidence.silhouette.mean * float(body[2] * body[3])))
    regions = [blob.box for blob in find_people(evidence.mask & evidence.shown, BlobConfig(smallest=smallest))]
    if not regions:
        return None
    boxes = states_from_boxes(np.array(regions))[:, :SPEED_X]
    away = np.abs(boxes[:, :2] - body[:2]).max(axis=1)
    nearest: FloatArray = boxes[away.argmin()]
    return nearest if away.min() <= AROUND * body[3] else None
