"""Area of the silhouette as evidence: by intersection over union (Du 2005, 5.1) or by what is missed and spilt (Sedai
2013, 12).

Z is the observed silhouette, H the model's. Differences from the papers: none in value; a camera whose mask is empty
says the same of every pose.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from muybridge._kernels.draw import transpose_rows
from muybridge._kernels.fused import INSIDE, MODEL
from muybridge._kernels.silhouette import silhouette_counts
from muybridge.body.model import BodyArrays
from muybridge.errors import InputError
from muybridge.likelihood._measure import SMALLEST_PROBABILITY, average, shares


def iou_log_prob(area: np.ndarray, model: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """log p1 = log |Z n H| / |Z u H|, (5.1)."""
    return np.log(np.maximum(inside / np.maximum(area + model - inside, 1), SMALLEST_PROBABILITY))


def two_sided_log_prob(area: np.ndarray, model: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """Minus (12): half of the share of Z that is missed and half of the share of H that is spilt."""
    return -0.5 * (2.0 - inside / np.maximum(area, 1) - inside / np.maximum(model, 1))


def one_sided_log_prob(area: np.ndarray, model: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """Minus the share of H that is spilt, as annealed particle filters had it: a folded body is never wrong."""
    return inside / np.maximum(model, 1) - 1.0


KINDS: dict[str, Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]] = {
    "iou": iou_log_prob,
    "two-sided": two_sided_log_prob,
    "one-sided": one_sided_log_prob,
}


@dataclass(frozen=True, eq=False)
class SilhouetteCue:
    """One frame's silhouettes.

    Parameters
    ----------
    arrays : BodyArrays
    cameras : (C, CAMERA_COLUMNS) float64, see `likelihood.pictures.camera_rows`
    bits : (C, H, words) uint64
        Observed masks, packed.
    areas : (C,) int, pixels
        Foreground of each mask.
    kind : one of KINDS
    weights : (C,) float64
        How much each camera counts; they are made to sum to 1. Equal where none are given.
    """

    arrays: BodyArrays
    cameras: np.ndarray
    bits: np.ndarray
    areas: np.ndarray
    kind: str = "iou"
    weights: np.ndarray | None = None
    camera_shares: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError("silhouette cue: kind", expected=f"one of {', '.join(KINDS)}", got=repr(self.kind))
        if len(self.bits) != len(self.cameras) or len(self.areas) != len(self.cameras):
            raise InputError(
                "silhouette cue: masks",
                expected=f"one for each of {len(self.cameras)} cameras",
                got=str(len(self.bits)),
            )
        object.__setattr__(self, "camera_shares", shares(self.weights, len(self.cameras)))

    @cached_property
    def masks(self) -> np.ndarray:
        """(C, words, canvas_rows(H)) uint64, as the fused kernel reads them."""
        return transpose_rows(self.bits)

    def log_prob(self, poses: np.ndarray) -> np.ndarray:
        """Log likelihood (N,) of poses (N, D), averaged over cameras."""
        counts = silhouette_counts(np.atleast_2d(poses), *self.arrays, self.cameras, self.bits)
        return average(self._by_camera(counts[..., 0], counts[..., 1]), self.camera_shares)

    def from_results(self, results: np.ndarray) -> np.ndarray:
        """The same from results (N, C, RESULT_COLUMNS) of the fused kernel."""
        return average(self._by_camera(results[..., MODEL], results[..., INSIDE]), self.camera_shares)

    def _by_camera(self, model: np.ndarray, inside: np.ndarray) -> np.ndarray:
        return KINDS[self.kind](np.asarray(self.areas), model, inside)
