"""People whom nobody follows yet: the box of the expected size that explains most foreground, then the next.

Every place on a grid of feet is tried. Where two people touch, the second is found in what the first leaves
unexplained, whether or not there is a valley between them; `blobs` needs one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from muybridge._kernels.occupancy import fill_sums, silhouette_scores
from muybridge.filters.particles import FloatArray
from muybridge.people.evidence import Evidence
from muybridge.people.ground import GroundScale

STEP = 3  # pixels between places
SHOWN = 0.4  # share of a box that is reckoned with at least: a strip that shows is not a person
FILLED = 0.2  # share of foreground below which a place is not looked at closer
MOST = 30  # people found in one frame


@dataclass(frozen=True, eq=False)
class Places:
    """Where people may stand: boxes (P, 4) float64, centre, width, height."""

    boxes: FloatArray

    @classmethod
    def on(cls, ground: GroundScale, picture: tuple[int, int], smallest: float, step: int = STEP) -> Places:
        """All over a picture (width, height) where people are expected to be at least so many pixels tall.

        Feet may be below the picture, by as much as leaves half of a person inside.
        """
        width, height = picture
        lowest = height + float(ground.height(height)) / 2
        feet, x = np.meshgrid(np.arange(step, lowest, step) - 0.5, np.arange(0, width, step), indexing="ij")
        boxes = ground.standing(x.ravel().astype(np.float64), feet.ravel())
        return cls(np.ascontiguousarray(boxes[boxes[:, 3] >= smallest]))


def find_standing(evidence: Evidence, places: Places, least: float) -> list[FloatArray]:
    """Boxes (4,) of people in what the evidence leaves to be explained; each is explained before the next is sought.

    least : float
        Log likelihood ratio per pixel that shows; a person alone has about 1.
    """
    found: list[FloatArray] = []
    table = np.empty((evidence.mask.shape[0] + 1, evidence.mask.shape[1] + 1, 2))
    area = places.boxes[:, 2] * places.boxes[:, 3]
    while len(found) < MOST and (evidence.mask & (evidence.weights > 0)).any():
        fill_sums(evidence.mask, evidence.weights, table)
        full, empty = (_sums(table, places.boxes, side) for side in (0, 1))
        likely = np.flatnonzero(full > FILLED * SHOWN * area)
        if not likely.size:
            break
        boxes = np.ascontiguousarray(places.boxes[likely])
        ratio = np.empty(len(boxes))
        silhouette_scores(table, 0, 0, boxes, evidence.gain, evidence.cost, ratio)
        mean = ratio / np.maximum((full + empty)[likely], SHOWN * area[likely])
        best = int(np.argmax(np.where(mean >= least, ratio / area[likely], -np.inf)))
        if mean[best] < least:
            break
        found.append(boxes[best])
        evidence.explain(boxes[best], share=1.0)
    return found


def _sums(table: NDArray[np.float64], boxes: FloatArray, side: int) -> FloatArray:
    """(P,) weighted pixels of foreground (side 0) or background (1) in each box."""
    one, none, out = np.ones((1, 1)), np.zeros((1, 1)), np.empty(len(boxes))
    silhouette_scores(table, 0, 0, boxes, *((one, none) if side == 0 else (none, one)), out)
    return out
