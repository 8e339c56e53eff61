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

    Silhouettes alone are the default, and colour counts by area, by tables E3-paired and E4-colour-alone-paired of
    papers/du-2005: no cue beside silhouettes makes the error less.

    silhouette_kind : a key of `silhouette.KINDS`
    colour_by_area : segments count by their visible area, (5.5), or all alike, (5.3)
    """

    silhouette: float = 1.0
    colour: float = 0.0
    boundary: float = 0.0
    edges: float = 0.0
    silhouette_kind: str = "two-sided"
    colour_by_area: bool = True

    def __post_init__(self) -> None:
        given = self.by_name
        if any(not (np.isfinite(w) and w >= 0) for w in given.values()) or not any(given.values()):
            raise InputError("cue weights", expected="finite numbers, none negative, not all 0", got=str(given))
        if self.silhouette_kind not in KINDS:
            expected = f"one of {', '.join(KINDS)}"
            raise InputError("silhouette kind", expected=expected, got=repr(self.silhouette_kind))

    @property
    def by_name(self) -> dict[str, float]:
        """Every cue and its weight, those switched off as well."""
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
    """What cues are made of: `observation.Observation`."""

    @property
    def body(self) -> Body:
        """Whose outline is compared: K segments with a shape."""
        ...

    @property
    def cameras(self) -> np.ndarray:
        """(C, CAMERA_COLUMNS) float64, of the reduced pictures."""
        ...

    @property
    def cues(self) -> CueWeights:
        """Which cues are wanted, and how strongly."""
        ...

    @property
    def shares(self) -> np.ndarray:
        """(C, H, W) uint8: reduced masks, the share of foreground in every pixel, 0 to FULL."""
        ...

    @property
    def bits(self) -> np.ndarray:
        """(C, H, words) uint64: the shares thresholded at one half, 64 pixels a word."""
        ...

    @property
    def areas(self) -> np.ndarray:
        """(C,) int64: foreground pixels of the thresholded masks."""
        ...

    @property
    def pictures(self) -> tuple[np.ndarray, ...]:
        """C times (H, W, 3) or (H, W) uint8, reduced; none where no cue looks at them."""
        ...

    @property
    def tables(self) -> np.ndarray:
        """(C, H, W + 1, LANES) uint16: cumulative histograms, see `colour.colour_tables`."""
        ...

    @property
    def reference(self) -> ColourReference | None:
        """What the segments look like; None where colour does not count."""
        ...


def fusion_of(frame: Frame, camera_weights: np.ndarray) -> Fusion:
    """The cues that are switched on, made of one frame; camera_weights (C,)."""
    used = {name: weight for name, weight in frame.cues.by_name.items() if weight > 0}
    total = sum(used.values())
    made = tuple(MAKERS[name](frame, camera_weights) for name in used)
    return Fusion(made, tuple(weight / total for weight in used.values()))


def silhouette_cue(frame: Frame, camera_weights: np.ndarray) -> SilhouetteCue:
    """The body's area against the masks, compared as `silhouette_kind` says; camera_weights (C,)."""
    kind = frame.cues.silhouette_kind
    return SilhouetteCue(frame.body.arrays, frame.cameras, frame.bits, frame.areas, kind, camera_weights)


def colour_cue(frame: Frame, camera_weights: np.ndarray) -> ColourCue:
    """The colours of the visible segments against the reference; camera_weights (C,)."""
    if frame.reference is None:
        remedy = "measure one with Observation.first_reference"
        raise InputError("colour cue", expected="a reference", got="none", remedy=remedy)
    return ColourCue(
        frame.body.arrays,
        frame.cameras,
        frame.tables,
        frame.reference,
        by_area=frame.cues.colour_by_area,
        weights=camera_weights,
    )


def boundary_cue(frame: Frame, camera_weights: np.ndarray) -> BoundaryCue:
    """The outer borders of body and masks, by their Fourier descriptors; camera_weights (C,)."""
    height, width = frame.shares.shape[1:]
    descriptors, found = descriptors_of([share >= HALF for share in frame.shares])
    return BoundaryCue(frame.body.arrays, frame.cameras, (width, height), descriptors, found, weights=camera_weights)


def edge_cue(frame: Frame, camera_weights: np.ndarray) -> EdgeCue:
    """The pictures' edges near the masks, along the visible outlines; camera_weights (C,)."""
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
