"""Which cues make up the likelihood, and how each is made of one frame.

A new cue is a weight in `CueWeights` and a row of `MAKERS`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from muybridge.body.model import Body
from muybridge.errors import InputError
from muybridge.likelihood.boundary import BoundaryCue, descriptors_of
from muybridge.likelihood.colour import ColourCue, ColourReference, fill_reference, measure_reference, mirrored_segments
from muybridge.likelihood.edges import EdgeCue, edge_map, stack_maps
from muybridge.likelihood.fusion import Cue, Fusion
from muybridge.likelihood.pictures import HALF
from muybridge.likelihood.silhouette import KINDS, SilhouetteCue


@dataclass(frozen=True)
class CueWeights:
    """Powers of the cues, (5.12); 0 switches a cue off. Only their ratios count: they are made to sum to 1.

    silhouette_kind : a key of `silhouette.KINDS`
    """

    silhouette: float = 1.0
    colour: float = 0.0
    boundary: float = 0.0
    edges: float = 0.0
    silhouette_kind: str = "two-sided"

    def __post_init__(self) -> None:
        given = self.by_name
        if any(not (np.isfinite(w) and w >= 0) for w in given.values()) or not any(given.values()):
            raise InputError("cue weights", expected="finite numbers, none negative, not all 0", got=str(given))
        if self.silhouette_kind not in KINDS:
            expected = f"one of {', '.join(KINDS)}"
            raise InputError("silhouette kind", expected=expected, got=repr(self.silhouette_kind))

    @property
    def by_name(self) -> dict[str, float]:
        return {name: getattr(self, name) for name in MAKERS}

    @property
    def need_pictures(self) -> bool:
        """Masks do not say everything."""
        return self.colour > 0 or self.edges > 0

    @property
    def only_two_sided(self) -> bool:
        """Nothing but (12), for which there is a shorter way."""
        return not (self.colour or self.boundary or self.edges) and self.silhouette_kind == "two-sided"


class Frame(Protocol):
    """What cues are made of: `observation.Observation`. shares, bits, areas: reduced masks; tables: of colours."""

    @property
    def body(self) -> Body: ...
    @property
    def cameras(self) -> np.ndarray: ...
    @property
    def cues(self) -> CueWeights: ...
    @property
    def shares(self) -> np.ndarray: ...
    @property
    def bits(self) -> np.ndarray: ...
    @property
    def areas(self) -> np.ndarray: ...
    @property
    def pictures(self) -> tuple[np.ndarray, ...]: ...
    @property
    def tables(self) -> np.ndarray: ...
    @property
    def reference(self) -> ColourReference | None: ...


def fusion_of(frame: Frame, camera_weights: np.ndarray) -> Fusion:
    """The cues that are switched on, made of one frame; camera_weights (C,)."""
    used = {name: weight for name, weight in frame.cues.by_name.items() if weight > 0}
    total = sum(used.values())
    made = tuple(MAKERS[name](frame, camera_weights) for name in used)
    return Fusion(made, tuple(weight / total for weight in used.values()))


def silhouette_cue(frame: Frame, camera_weights: np.ndarray) -> SilhouetteCue:
    kind = frame.cues.silhouette_kind
    return SilhouetteCue(frame.body.arrays, frame.cameras, frame.bits, frame.areas, kind, camera_weights)


def colour_cue(frame: Frame, camera_weights: np.ndarray) -> ColourCue:
    if frame.reference is None:
        remedy = "measure one with Observation.first_reference"
        raise InputError("colour cue", expected="a reference", got="none", remedy=remedy)
    return ColourCue(frame.body.arrays, frame.cameras, frame.tables, frame.reference, weights=camera_weights)


def boundary_cue(frame: Frame, camera_weights: np.ndarray) -> BoundaryCue:
    height, width = frame.shares.shape[1:]
    descriptors, found = descriptors_of([share >= HALF for share in frame.shares])
    return BoundaryCue(frame.body.arrays, frame.cameras, (width, height), descriptors, found, weights=camera_weights)


def edge_cue(frame: Frame, camera_weights: np.ndarray) -> EdgeCue:
    maps = []
    for picture, share in zip(frame.pictures, frame.shares, strict=True):
        height, width = picture.shape[:2]
        maps.append(edge_map(picture, share[:height, :width] >= HALF))
    return EdgeCue(frame.body.arrays, frame.cameras, stack_maps(maps), camera_weights)


MAKERS: dict[str, Callable[[Frame, np.ndarray], Cue]] = {
    "silhouette": silhouette_cue,
    "colour": colour_cue,
    "boundary": boundary_cue,
    "edges": edge_cue,
}


def complete_reference(frame: Frame, pose: np.ndarray) -> ColourReference:
    """What every segment looks like at a known pose (D,); hidden ones filled by symmetry and from other cameras."""
    measured = measure_reference(frame.body.arrays, frame.cameras, frame.tables, pose)
    names = [frame.body.segments[index].name for index in frame.body.arrays.shaped]
    return fill_reference(measured, mirrored_segments(names))
