"""One frame as the filters see it: frozen, with `log_prob` for particles and `normal_equations` for the guided search.

`ImageLikelihood` is made once for a body and a rig and says how pictures become evidence; `observe` is called once a
frame. Cues are made of a frame when they are first asked for: see `likelihood.cues`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from muybridge._kernels.silhouette import silhouette_counts
from muybridge.body.model import Body
from muybridge.cameras.model import Rig
from muybridge.errors import InputError
from muybridge.filters.guess import Guess
from muybridge.likelihood.colour import ColourReference, colour_tables, measure_reference, update_reference
from muybridge.likelihood.contour import (
    SIDE_POINTS,
    Borders,
    ContourRows,
    NormalEquations,
    contour_rows,
    mask_borders,
    no_borders,
    robust_weights,
)
from muybridge.likelihood.cues import CueWeights, complete_reference, fusion_of
from muybridge.likelihood.fusion import Fusion
from muybridge.likelihood.pictures import FULL, HALF, camera_rows, reduce_mask, stack_masks
from muybridge.segmentation import has_colour, reduce_image

#: No contour is believed better than this, metres, however well it fits.
MINIMUM_SD = 0.002
#: Unexplained pieces of mask pull limbs only while the search is coarse: at the end they would bias what already fits.
UNCOVERED_SPREAD = 0.055  # metres


@dataclass(frozen=True)
class ImageLikelihood:
    """How pictures of one person become evidence about a pose.

    Parameters
    ----------
    body : Body
    rig : Rig
        Cameras of the pictures as recorded.
    reductions : (C,) int
        Every camera's masks are reduced by this factor before anything is measured.
    row_sd : float, metres
        Error of one contour point, with neighbours' dependence in it.
    weights : (C,) float
        Of each camera; a camera whose masks are bad can be made to count less.
    cues : CueWeights
        What `log_prob` is made of; two-sided silhouettes unless said otherwise.
    """

    body: Body
    rig: Rig
    reductions: tuple[int, ...]
    row_sd: float = 0.02
    weights: tuple[float, ...] = ()
    cues: CueWeights = CueWeights()

    @cached_property
    def cameras(self) -> np.ndarray:
        """(C, CAMERA_COLUMNS) float64: the cameras of the reduced pictures."""
        reduced = []
        for camera, factor in zip(self.rig, self.reductions, strict=True):
            width, height = camera.size
            reduced.append(camera.scaled(1.0 / factor).with_size(max(1, width // factor), max(1, height // factor)))
        return camera_rows(reduced)

    @cached_property
    def camera_weights(self) -> np.ndarray:
        """(C,) float64, mean 1."""
        weights = np.array(self.weights or np.ones(len(self.rig)), float)
        return weights / weights.mean()

    def observe(
        self,
        masks: Sequence[np.ndarray],
        pictures: Sequence[np.ndarray] | None = None,
        reference: ColourReference | None = None,
    ) -> Observation:
        """The frame's evidence.

        Parameters
        ----------
        masks : C times (H, W) bool
            At recorded size, or already reduced.
        pictures : C times (H, W, 3) uint8 BGR, or grey (H, W) uint8; only the cues of colour and edges need them
            Likewise.
        reference : what the segments look like, for colour
        """
        self._one_each("masks", masks)
        shares = [self._reduced(c, mask) for c, mask in enumerate(masks)]
        return Observation(self, *stack_masks(shares), self._pictures(pictures), reference)

    def _pictures(self, pictures: Sequence[np.ndarray] | None) -> tuple[np.ndarray, ...]:
        """The pictures reduced, where a cue looks at them."""
        if not self.cues.need_pictures:
            return ()
        if pictures is None:
            raise InputError("pictures", expected="one for each camera, for the cues of colour and edges", got="none",
                             remedy="give pictures, or set the weights of colour and edges to 0")  # fmt: skip
        self._one_each("pictures", pictures)
        reduced = []
        for c, picture in enumerate(pictures):
            small, factor = self._small(c, picture, "picture"), 1.0 / self.reductions[c]
            reduced.append(reduce_image(picture, factor) if small is None else picture[: small[0], : small[1]])
        return tuple(reduced)

    def _one_each(self, what: str, given: Sequence[np.ndarray]) -> None:
        if len(given) != len(self.rig):
            raise InputError(what, expected=f"one for each of the {len(self.rig)} cameras", got=str(len(given)))

    def _reduced(self, c: int, mask: np.ndarray) -> np.ndarray:
        """The share of foreground per block (H', W') uint8 of camera c's mask."""
        small = self._small(c, mask, "mask")
        if small is None:
            return reduce_mask(mask, self.reductions[c])
        return mask[: small[0], : small[1]].astype(np.uint8) * np.uint8(FULL)

    def _small(self, c: int, image: np.ndarray, what: str) -> tuple[int, int] | None:
        """Rows and columns to keep of an image that is reduced already; None where it is as recorded."""
        camera, factor = self.rig[c], self.reductions[c]
        width, height = camera.size
        if image.shape[:2] == (height, width):
            return None
        small = height // factor, width // factor
        if all(0 <= had - need <= 1 for had, need in zip(image.shape[:2], small, strict=True)):
            return small
        expected, got = f"{width}x{height} pixels as calibrated", "x".join(map(str, image.shape[1::-1]))
        raise InputError(f"{what} of camera {camera.name!r}", expected=expected, got=got)


@dataclass(frozen=True, eq=False)
class Observation:
    """Evidence of one frame.

    shares : (C, H, W) uint8, reduced masks, 0 to FULL; bits : (C, H, words) uint64, the same thresholded at one half.
    pictures : C times (H, W, 3) or (H, W) uint8, reduced; none where no cue looks at them.
    reference : what the segments look like, where colour counts.
    guess : of the pose, from the masks alone; for filters that ask for one.
    """

    model: ImageLikelihood
    shares: np.ndarray
    bits: np.ndarray
    pictures: tuple[np.ndarray, ...] = ()
    reference: ColourReference | None = None
    guess: Guess | None = None

    @property
    def body(self) -> Body:
        """The model's body."""
        return self.model.body

    @property
    def cameras(self) -> np.ndarray:
        """(C, CAMERA_COLUMNS) float64, of the reduced pictures."""
        return self.model.cameras

    @property
    def cues(self) -> CueWeights:
        """The model's weights of the cues."""
        return self.model.cues

    @property
    def masks(self) -> list[np.ndarray]:
        """C times (H, W) bool: the reduced masks, each at its own camera's size."""
        sizes = [tuple(int(side) for side in row[[24, 23]]) for row in self.cameras]
        return [share[:height, :width] >= HALF for share, (height, width) in zip(self.shares, sizes, strict=True)]

    @cached_property
    def areas(self) -> np.ndarray:
        """(C,) foreground pixels of the reduced masks."""
        return np.array([int(np.count_nonzero(share >= HALF)) for share in self.shares])

    @cached_property
    def borders(self) -> Borders:
        """The masks' borders, for what no segment covers."""
        return mask_borders(self.shares)

    @cached_property
    def tables(self) -> np.ndarray:
        """Cumulative histograms of the pictures; see `likelihood.colour`."""
        return colour_tables(self.pictures)

    @cached_property
    def fusion(self) -> Fusion:
        """The cues that are switched on, weighted."""
        return fusion_of(self, self.model.camera_weights)

    def first_reference(self, pose: np.ndarray) -> ColourReference:
        """What every segment looks like if this frame's pose is (D,), hidden ones filled."""
        for camera, picture in zip(self.model.rig, self.pictures, strict=True):
            if not has_colour(picture):
                raise InputError(f"camera {camera.name!r}", expected="colour pictures, for the cue of colour",
                                 got="grey ones", remedy="set the weight of colour to 0")  # fmt: skip
        return complete_reference(self, pose)

    def updated_reference(self, pose: np.ndarray) -> ColourReference:
        """The reference with what is seen at a pose (D,), (5.7)."""
        if self.reference is None:
            return self.first_reference(pose)
        measured = measure_reference(self.body.arrays, self.cameras, self.tables, pose)
        return update_reference(self.reference, measured)

    def costs(self, poses: np.ndarray) -> np.ndarray:
        """Two-sided silhouette cost (Sedai 2013, eq. 12) of poses (N, D) in each camera, (N, C) in [0, 1]."""
        poses = np.ascontiguousarray(np.atleast_2d(poses), np.float64)
        counts = silhouette_counts(poses, *self.model.body.arrays, self.model.cameras, self.bits)
        drawn, inside = counts[..., 0].astype(float), counts[..., 1].astype(float)
        missed = 1.0 - inside / np.maximum(self.areas, 1)
        spilt = 1.0 - inside / np.maximum(drawn, 1.0)
        return 0.5 * (missed + spilt)

    def log_prob(self, poses: np.ndarray) -> np.ndarray:
        """Log likelihood (N,) of poses (N, D), up to a constant."""
        if not self.cues.only_two_sided:
            return self.fusion.log_prob(poses)
        return -np.einsum("nc,c->n", self.costs(poses), self.model.camera_weights) / len(self.model.rig)

    def contour(
        self, pose: np.ndarray, spread: float, side_points: int = SIDE_POINTS, moved: np.ndarray | None = None
    ) -> ContourRows:
        """Contour residuals of one pose (D,); see `likelihood.contour`."""
        borders = self.borders if spread >= UNCOVERED_SPREAD else no_borders(len(self.shares))
        return contour_rows(self.model.body, self.model.cameras, self.shares, borders, pose, spread, side_points, moved)

    def normal_equations(
        self, pose: np.ndarray, spread: float, components: np.ndarray | None = None
    ) -> NormalEquations:
        """Curvature and gradient of the contour's log likelihood at a pose (D,), robust beyond `spread` metres.

        components : (B,) int, optional
            Only these may move: the outlines are looked at that they move, and D becomes B.
        """
        rows = self.contour(pose, spread, moved=components)
        weights = robust_weights(rows.distance, spread) * self.model.camera_weights[rows.camera]
        total = float(weights.sum())
        variance = float(weights @ rows.distance**2) / total if total > 0 else self.model.row_sd**2
        noise = max(variance, MINIMUM_SD**2) / self.model.row_sd**2
        slopes = rows.slopes if components is None else rows.slopes[:, components]
        weighted = slopes * (weights / self.model.row_sd**2)[:, None]
        return NormalEquations(weighted.T @ slopes, weighted.T @ rows.distance, noise, len(rows.distance))
