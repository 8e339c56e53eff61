"""The silhouette's outer border as evidence, through its Fourier descriptor (Du 2005, 5.2.3).

Differences from the paper: the border is resampled to SAMPLES points before the transform, so that borders of
different length can be compared; "the first 100 coefficients" are the 100 lowest frequencies of either sign, without
which not even an ellipse comes back.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import cv2
import numpy as np

from muybridge._kernels.bits import pack_rows
from muybridge._kernels.boundary import SAMPLES, SIDE
from muybridge._kernels.draw import transpose_rows
from muybridge._kernels.fused import BOUNDARY, describe_masks
from muybridge.body.model import BodyArrays
from muybridge.errors import InputError
from muybridge.likelihood._measure import SMALLEST_PROBABILITY, BoundaryInput, average, measure_cues, shares

RHO = 0.1  # per pixel, of (5.11): at 320 x 240 a limb's width off gives 1/e
COEFFICIENTS = 100  # section 5.2.3


def largest_component(mask: np.ndarray) -> np.ndarray:
    """The largest 8-connected part of a mask (H, W) bool."""
    count, labels, statistics, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
    if count < 2:
        return mask
    return labels == 1 + int(np.argmax(statistics[1:, cv2.CC_STAT_AREA]))


def descriptors_of(masks: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Fourier descriptors (C, 2, SIDE, SIDE) float64, pixels, of the largest part of each mask (H, W) bool; and which
    have one.

    Index (c, 0, f // SIDE, f % SIDE) is the real part of frequency f, (c, 1, ...) the imaginary.
    """
    out, found = np.zeros((len(masks), 2, SIDE, SIDE)), np.zeros(len(masks), bool)
    for c, mask in enumerate(masks):
        found[c] = describe_masks(transpose_rows(pack_rows(largest_component(mask))[None]), out[c : c + 1])[0] > 0
    return out, found


@dataclass(frozen=True, eq=False)
class BoundaryCue:
    """One frame's boundaries.

    Parameters
    ----------
    arrays, cameras, weights : as in `SilhouetteCue`
    size : (int, int), pixels
        Width and height of the largest picture.
    descriptors : (C, 2, SIDE, SIDE) float64, pixels, and found : (C,) bool, see `descriptors_of`
        A camera without a boundary says nothing.
    rho : float, per pixel, of (5.11)
    coefficients : int
        How many of the lowest frequencies are compared.
    """

    arrays: BodyArrays
    cameras: np.ndarray
    size: tuple[int, int]
    descriptors: np.ndarray
    found: np.ndarray
    rho: float = RHO
    coefficients: int = COEFFICIENTS
    weights: np.ndarray | None = None
    camera_shares: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if not 1 <= self.coefficients <= SAMPLES:
            raise InputError("boundary cue: coefficients", expected=f"1 to {SAMPLES}", got=str(self.coefficients))
        if len(self.descriptors) != len(self.cameras):
            raise InputError(
                "boundary cue: descriptors",
                expected=f"one for each of {len(self.cameras)} cameras",
                got=str(len(self.descriptors)),
            )
        object.__setattr__(self, "camera_shares", shares(self.weights, len(self.cameras)))

    @cached_property
    def kernel_input(self) -> BoundaryInput:
        """What the fused kernel takes for this cue."""
        return BoundaryInput(self.descriptors, self.coefficients)

    def log_prob(self, poses: np.ndarray) -> np.ndarray:
        """Log likelihood (N,) of poses (N, D), averaged over cameras."""
        return self.from_results(measure_cues(poses, self.arrays, self.cameras, self.size, boundary=self.kernel_input))

    def from_results(self, results: np.ndarray) -> np.ndarray:
        """log p3 = -rho ||FD - FD'||, (5.11), from results (N, C, RESULT_COLUMNS); a pose that is not seen has the
        least.
        """
        least = np.log(SMALLEST_PROBABILITY)
        by_camera = np.maximum(least, -self.rho * results[..., BOUNDARY])
        return average(np.where(self.found, by_camera, 0.0), self.camera_shares)
