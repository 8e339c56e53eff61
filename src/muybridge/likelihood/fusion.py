"""Several cues as one likelihood: a product of powers (Du 2005, 5.12; Sedai 2013, 14), made sharper where asked.

    log p = K (mu log p1 + nu log p2 + (1 - mu - nu) log p3)

Cues of the same body and cameras are measured in one pass over the drawn segments.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from muybridge.errors import InputError
from muybridge.likelihood._measure import measure_cues
from muybridge.likelihood.boundary import BoundaryCue
from muybridge.likelihood.colour import ColourCue
from muybridge.likelihood.edges import EdgeCue
from muybridge.likelihood.silhouette import SilhouetteCue

EQUAL = 0.33  # mu and nu of (5.12)


class Cue(Protocol):
    """Evidence of one frame."""

    def log_prob(self, poses: np.ndarray) -> np.ndarray:
        """Log likelihood (N,) of poses (N, D)."""
        ...


@dataclass(frozen=True, eq=False)
class Fusion:
    """Weighted cues.

    Parameters
    ----------
    cues : any number of cues
    weights : (number of cues,) float
        Powers; a cue of weight 0 is switched off and not measured.
    sharpness : float
        K. The papers' likelihoods, K = 1, are too flat for a Metropolis step to tell poses apart.
    """

    cues: tuple[Cue, ...]
    weights: tuple[float, ...]
    sharpness: float = 1.0

    def __post_init__(self) -> None:
        if len(self.cues) != len(self.weights):
            raise InputError(
                "fusion: weights", expected=f"one for each of {len(self.cues)} cues", got=str(len(self.weights))
            )
        if any(not (np.isfinite(w) and w >= 0) for w in self.weights) or not any(self.weights):
            raise InputError(
                "fusion: weights", expected="finite numbers, none negative, not all 0", got=str(self.weights)
            )
        if not (np.isfinite(self.sharpness) and self.sharpness > 0):
            raise InputError("fusion: sharpness", expected="a positive number", got=repr(self.sharpness))

    def log_prob(self, poses: np.ndarray) -> np.ndarray:
        """Log likelihood (N,) of poses (N, D)."""
        used = [(cue, weight) for cue, weight in zip(self.cues, self.weights, strict=True) if weight > 0]
        together = _measured_together([cue for cue, _ in used])
        results = _measure_once(poses, together) if together else None
        total = np.zeros(len(np.atleast_2d(poses)))
        for cue, weight in used:
            shared = results is not None and any(cue is other for other in together)
            total += weight * (cue.from_results(results) if shared else cue.log_prob(poses))  # type: ignore[attr-defined]
        return self.sharpness * total


def fuse(
    silhouette: Cue, colour: Cue, boundary: Cue, mu: float = EQUAL, nu: float = EQUAL, sharpness: float = 1.0
) -> Fusion:
    """The thesis' three cues, p1^mu p2^nu p3^(1 - mu - nu), (5.12)."""
    if not (mu >= 0 and nu >= 0 and mu + nu <= 1):
        raise InputError("fusion: mu, nu", expected="numbers in [0, 1] whose sum is not above 1", got=f"{mu}, {nu}")
    return Fusion((silhouette, colour, boundary), (mu, nu, max(0.0, 1.0 - mu - nu)), sharpness)


def _measured_together(cues: Sequence[Any]) -> list[Any]:
    """Those cues, at most one of a kind, that share the first one's body, cameras and size; empty where one would
    be alone.
    """
    chosen: dict[type, Any] = {}
    for cue in cues:
        if type(cue) not in (SilhouetteCue, ColourCue, BoundaryCue, EdgeCue) or type(cue) in chosen:
            continue
        first = next(iter(chosen.values()), cue)
        if cue.arrays is first.arrays and cue.cameras is first.cameras and _canvas(cue) == _canvas(first):
            chosen[type(cue)] = cue
    return list(chosen.values()) if len(chosen) > 1 else []


def _canvas(cue: Any) -> tuple[int, int]:
    """Words and rows of a canvas that holds the cue's pictures."""
    match cue:
        case SilhouetteCue():
            return cue.bits.shape[2], cue.bits.shape[1]
        case ColourCue():
            return -(-(cue.tables.shape[2] - 1) // 64), cue.tables.shape[1]
        case EdgeCue():
            return -(-cue.maps.shape[2] // 64), cue.maps.shape[1]
    return -(-cue.size[0] // 64), cue.size[1]


def _measure_once(poses: np.ndarray, cues: Sequence[Any]) -> np.ndarray:
    by_type = {type(cue): cue for cue in cues}
    silhouette, colour = by_type.get(SilhouetteCue), by_type.get(ColourCue)
    boundary, edges = by_type.get(BoundaryCue), by_type.get(EdgeCue)
    words, rows = _canvas(cues[0])
    return measure_cues(
        poses,
        cues[0].arrays,
        cues[0].cameras,
        (64 * words, rows),
        masks=silhouette.masks if silhouette else None,
        colour=colour.kernel_input if colour else None,
        boundary=boundary.kernel_input if boundary else None,
        edge_maps=edges.maps if edges else None,
    )
