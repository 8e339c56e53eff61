"""Colour histograms of the visible segments against a reference (Du 2005, 5.2.2).

The reference is measured at a known pose; `fill_reference` completes it by the left-right symmetry of clothes and by
the rule that a hidden part looks like the visible part.

Differences from the paper: the shares alpha_m of (5.5) are of the *visible* area, so that a hidden segment, whose
histogram is empty, says nothing; (5.3) is divided by the number of segments seen, which beta absorbs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from muybridge._kernels.colour import BINS, CHANNELS, COUNT_LANE, LANES, TALLEST, histogram_table
from muybridge._kernels.fused import COLOUR
from muybridge.body.model import BodyArrays
from muybridge.errors import InputError
from muybridge.likelihood._measure import ColourInput, average, measure_cues, shares, visible_histograms

BETA = 1.0  # of (5.6); D lies in [0, 3], and a body off by a limb's width has D of about 1
UPDATE_RATE = 0.1  # lambda of (5.7): the light changes over tens of frames
FEWEST_PIXELS = 20  # a histogram of fewer is noise: 10 bins of 2


@dataclass(frozen=True, eq=False)
class ColourReference:
    """What every segment looks like in every camera.

    histograms : (C, K, CHANNELS, BINS) float64, each row of bins sums to 1, blue, green, red
    known : (C, K) bool
    """

    histograms: np.ndarray
    known: np.ndarray

    def __post_init__(self) -> None:
        if self.histograms.shape != (*self.known.shape, CHANNELS, BINS):
            raise InputError(
                "colour reference",
                expected=f"histograms of shape {(*self.known.shape, CHANNELS, BINS)}",
                got=str(self.histograms.shape),
            )

    @cached_property
    def roots(self) -> np.ndarray:
        """(C, K, LANES) float32: square roots of the bins."""
        out = np.zeros((*self.known.shape, LANES), np.float32)
        out[..., : CHANNELS * BINS] = np.sqrt(self.histograms).reshape(*self.known.shape, -1)
        return out


def colour_tables(images: Sequence[np.ndarray]) -> np.ndarray:
    """Cumulative histograms (C, H, W + 1, LANES) uint16 of pictures (H, W, 3) uint8, padded to one size."""
    height, width = max(i.shape[0] for i in images), max(i.shape[1] for i in images)
    if height > TALLEST:
        raise InputError(
            "pictures for colour", expected=f"at most {TALLEST} rows", got=str(height), remedy="reduce them"
        )
    tables = np.zeros((len(images), height, width + 1, LANES), np.uint16)
    for table, image in zip(tables, images, strict=True):
        if image.ndim != 3 or image.shape[2] != 3 or image.dtype != np.uint8:
            raise InputError("picture", expected="(H, W, 3) uint8", got=f"{image.shape} {image.dtype}")
        histogram_table(np.ascontiguousarray(image), table[: image.shape[0], : image.shape[1] + 1])
    return tables


def measure_reference(arrays: BodyArrays, cameras: np.ndarray, tables: np.ndarray, pose: np.ndarray) -> ColourReference:
    """Histograms of the visible pixels of every segment at a pose (D,); known where FEWEST_PIXELS were seen."""
    size = tables.shape[2] - 1, tables.shape[1]
    counts = visible_histograms(pose, arrays, cameras, size, tables)
    known = counts[..., COUNT_LANE] >= FEWEST_PIXELS
    bins = counts[..., : CHANNELS * BINS].reshape(*known.shape, CHANNELS, BINS)
    return ColourReference(bins / np.maximum(counts[..., COUNT_LANE], 1)[..., None, None], known)


def mirrored_segments(names: Sequence[str]) -> np.ndarray:
    """(K,) int: index of the segment on the other side of the body, by name; its own where there is none."""
    swap = {"left_": "right_", "right_": "left_"}
    twins = [next((new + n.removeprefix(old) for old, new in swap.items() if n.startswith(old)), n) for n in names]
    return np.array([list(names).index(twin) if twin in names else i for i, twin in enumerate(twins)], dtype=np.int64)


def fill_reference(reference: ColourReference, mirrored: np.ndarray) -> ColourReference:
    """Fill what was hidden: from the other side in the same camera, else the same segment or its twin in other
    cameras.
    """
    histograms, known = reference.histograms.copy(), reference.known.copy()
    for c, k in zip(*np.nonzero(~reference.known), strict=True):
        twin = mirrored[k]
        sources = ([(c, twin)], [(o, k) for o in range(len(known))], [(o, twin) for o in range(len(known))])
        for group in sources:
            seen = [reference.histograms[place] for place in group if reference.known[place]]
            if seen:
                histograms[c, k], known[c, k] = np.mean(seen, axis=0), True
                break
    return ColourReference(histograms, known)


def update_reference(
    reference: ColourReference, measured: ColourReference, rate: float = UPDATE_RATE
) -> ColourReference:
    """H+_k = lambda H-_k + (1 - lambda) H+_{k-1}, (5.7), where a segment is seen; what is new is taken as it is."""
    if not 0.0 <= rate <= 1.0:
        raise InputError("colour reference: rate", expected="a number in [0, 1]", got=repr(rate))
    share = np.where(measured.known, np.where(reference.known, rate, 1.0), 0.0)[..., None, None]
    return ColourReference(
        share * measured.histograms + (1.0 - share) * reference.histograms, reference.known | measured.known
    )


@dataclass(frozen=True, eq=False)
class ColourCue:
    """One frame's colours.

    Parameters
    ----------
    arrays, cameras, weights : as in `SilhouetteCue`
    tables : (C, H, W + 1, LANES) uint16, see `colour_tables`
    reference : ColourReference
    beta : float, of (5.6)
    by_area : bool
        Segments count by their visible area (5.5), or all alike (5.3).
    """

    arrays: BodyArrays
    cameras: np.ndarray
    tables: np.ndarray
    reference: ColourReference
    beta: float = BETA
    by_area: bool = True
    weights: np.ndarray | None = None
    camera_shares: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        expected = (len(self.cameras), len(self.arrays.shaped))
        if self.reference.known.shape != expected or len(self.tables) != expected[0]:
            raise InputError(
                "colour cue: reference",
                expected=f"{expected} cameras and segments",
                got=str(self.reference.known.shape),
            )
        object.__setattr__(self, "camera_shares", shares(self.weights, len(self.cameras)))

    @cached_property
    def kernel_input(self) -> ColourInput:
        """What the fused kernel takes for this cue."""
        return ColourInput(self.tables, self.reference.roots, self.reference.known, self.by_area)

    def log_prob(self, poses: np.ndarray) -> np.ndarray:
        """Log likelihood (N,) of poses (N, D), averaged over cameras."""
        size = self.tables.shape[2] - 1, self.tables.shape[1]
        return self.from_results(measure_cues(poses, self.arrays, self.cameras, size, colour=self.kernel_input))

    def from_results(self, results: np.ndarray) -> np.ndarray:
        """log p2 = -beta D^2, (5.6), from results (N, C, RESULT_COLUMNS) of the fused kernel."""
        return average(-self.beta * results[..., COLOUR] ** 2, self.camera_shares)
