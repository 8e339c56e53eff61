"""The ground's scale from regions of the foreground: most are one person each, the others are outliers.

A region whose legs are missing, or to which a shadow or somebody nearer was added, has its feet as many pixels off as
its height: such errors lie along the diagonal of heights against feet, and whatever fits heights to feet leans towards
it. So what is measured is by how many pixels e the feet would have to be moved to lie on a line,

    h + e = s (o + k (f + e)),

with o, k the line and s how tall the person is. Regions that follow each other from one moment to the next are of one
person, and have s in common: how heights change as somebody walks says more of k than who is how tall. Errors count up
to a limit, above the line a higher one: what is cut short, by a thing in the way or a hole in the mask, lies below.

Not in Zhao (2009), who sets thresholds by hand for each camera (5.1).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from muybridge.evaluation.boxes import overlaps
from muybridge.filters.particles import FloatArray
from muybridge.people.blobs import Blob
from muybridge.people.ground import SHORTEST, GroundScale, touches_side

FEWEST = 12  # regions; fewer say nothing about a line
TRIALS = 400  # pairs of regions of which lines are tried
FEET_SD = 0.06  # of the height: by how much feet are off
BELOW, ABOVE = 1.0, 1.5  # nats: the most that one region counts against a line, cut short, or too tall
STATURES = np.exp(np.linspace(-0.35, 0.35, 29))  # of people's mean height
STATURE_SD = 0.13  # of its logarithm: adults have 0.05, and there are children
SLOPES, SLOPE_SD = (
    0.5,
    0.1,
)  # k is how tall people are over how high the camera hangs: some 3 m; weak against many
SAME = 3  # pixels: regions whose lower left corners are nearer are one that stands, seen again
UPRIGHT = (0.15, 0.7)  # width over height of what may be one standing person
FOLLOWS, BESIDE, ALIKE = 0.3, 0.02, 0.12  # overlap of one region with the next; with any other; logarithm of heights


def fit_ground(moments: Sequence[Sequence[Blob]], picture: tuple[int, int]) -> GroundScale | None:
    """The line that regions of several moments agree on, of a picture (width, height); None where they are too few.

    Regions that touch a side of the picture are cut off and say nothing.
    """
    boxes, person = _upright(*follow_regions(moments, picture))
    if len(boxes) < FEWEST:
        return None
    regions = _Regions(boxes, person)
    best = min(_tried(boxes), key=regions.cost)
    offset, slope = _refined(regions, best)
    return GroundScale(offset, slope, float(np.median((boxes[:, 2] / boxes[:, 3])[regions.agreeing(offset, slope)])))


def follow_regions(moments: Sequence[Sequence[Blob]], picture: tuple[int, int]) -> tuple[FloatArray, NDArray[np.int64]]:
    """Boxes (N, 4) left, top, width, height of the regions inside a picture, and (N,) numbers: whose they are.

    A region is that of the moment before where the two overlap, no other overlaps with either, and the height is much
    the same: regions that merge or come apart begin anew.
    """
    boxes: list[FloatArray] = []
    numbers: list[int] = []
    before, count = (np.empty((0, 4)), np.empty(0, np.int64)), 0
    for blobs in moments:
        now = np.array([blob.box for blob in blobs]).reshape(-1, 4)
        shared = overlaps(now, before[0])
        own = np.empty(len(now), np.int64)
        for i, blob in enumerate(blobs):
            follows = _followed(now[i], shared, i, before[0])
            own[i] = count if follows is None else before[1][follows]
            count += follows is None
            if not touches_side(blob, picture):
                boxes.append(now[i])
                numbers.append(int(own[i]))
        before = now, own
    return np.array(boxes).reshape(-1, 4), np.array(numbers, np.int64)


def _followed(box: FloatArray, shared: FloatArray, index: int, before: FloatArray) -> int | None:
    """Which region of the moment before this is, if one."""
    beside = np.flatnonzero(shared[index] > BESIDE)
    if len(beside) != 1 or np.count_nonzero(shared[:, beside[0]] > BESIDE) > 1:
        return None
    one = int(beside[0])
    alike = abs(np.log(box[3] / before[one, 3])) < ALIKE
    return one if alike and shared[index, one] > FOLLOWS else None


def _upright(boxes: FloatArray, person: NDArray[np.int64]) -> tuple[FloatArray, NDArray[np.int64]]:
    """Of boxes (N, 4), those that may be one standing person; of somebody who stands there the narrowest, once."""
    shape = boxes[:, 2] / np.maximum(boxes[:, 3], 1)
    upright = np.flatnonzero((shape > UPRIGHT[0]) & (shape < UPRIGHT[1]))
    upright = upright[np.argsort(boxes[upright, 2], kind="stable")]  # alone more likely than a wider one
    corners = np.column_stack([boxes[upright, 0], boxes[upright, 1] + boxes[upright, 3]])
    _, first = np.unique(np.rint(corners / SAME), axis=0, return_index=True)
    kept = np.sort(upright[first])
    return boxes[kept], np.unique(person[kept], return_inverse=True)[1]


class _Regions:
    """Feet, heights and whose they are, and what a line (offset, slope) costs, nats."""

    def __init__(self, boxes: FloatArray, person: NDArray[np.int64]) -> None:
        self.feet, self.heights, self.person = boxes[:, 1] + boxes[:, 3] - 0.5, boxes[:, 3], person
        self._usual = np.tile(0.5 * np.square(np.log(STATURES) / STATURE_SD), (int(person.max()) + 1, 1))

    def off(self, line: FloatArray) -> FloatArray:
        """(N, S) e over the height expected and its standard deviation, for people of each stature."""
        offset, slope = line
        expected = np.maximum(SHORTEST, offset + slope * self.feet)[:, None] * STATURES
        moved = (self.heights[:, None] - expected) / np.maximum(0.05, 1 - slope * STATURES)
        result: FloatArray = moved / (FEET_SD * expected)
        return result

    def by_person(self, line: FloatArray) -> FloatArray:
        """(P, S) what everybody's regions and stature cost."""
        off = self.off(line)
        cost = np.minimum(0.5 * off * off, np.where(off > 0, ABOVE, BELOW))
        total = self._usual.copy()
        np.add.at(total, self.person, cost)
        return total

    def cost(self, line: FloatArray) -> float:
        """Of the line, with the stature that suits everybody best; infinite where people shrink towards the camera."""
        if not 0 <= line[1] < 1:
            return np.inf
        return float(self.by_person(line).min(axis=1).sum() + 0.5 * ((line[1] - SLOPES) / SLOPE_SD) ** 2)

    def agreeing(self, offset: float, slope: float) -> NDArray[np.bool_]:
        """(N,) which lie near the line, each by their own stature."""
        line = np.array([offset, slope])
        stature = self.by_person(line).argmin(axis=1)[self.person]
        near: NDArray[np.bool_] = np.abs(self.off(line)[np.arange(len(stature)), stature]) < 1
        return near if near.any() else ~near


def _tried(boxes: FloatArray) -> list[FloatArray]:
    """Lines (offset, slope) through pairs of regions, and a level one."""
    feet, heights = boxes[:, 1] + boxes[:, 3] - 0.5, boxes[:, 3]
    lines = [np.array([float(np.median(heights)), 0.0])]
    rng = np.random.default_rng(0)  # only which pairs are tried
    for a, b in rng.integers(0, len(feet), (TRIALS, 2)):
        span = feet[b] - feet[a]
        if abs(span) >= 1:
            slope = (heights[b] - heights[a]) / span
            lines.append(np.array([heights[a] - slope * feet[a], slope]))
    return lines


def _refined(regions: _Regions, line: FloatArray) -> tuple[float, float]:
    """The line nearby that costs least, turned about the middle of all feet: offset and slope hang together less so."""
    from scipy.optimize import minimize

    middle = float(np.median(regions.feet))

    def about(place: FloatArray) -> FloatArray:
        return np.array([place[0] - place[1] * middle, place[1]])

    start = np.array([line[0] + line[1] * middle, line[1]])
    steps = start + np.array([[0, 0], [0.05 * start[0], 0], [0, 0.1]])
    options = {"initial_simplex": steps, "xatol": 1e-4, "fatol": 1e-6}
    found = minimize(lambda place: regions.cost(about(place)), start, method="Nelder-Mead", options=options)
    offset, slope = about(found.x)
    return float(offset), float(slope)
