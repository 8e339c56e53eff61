"""Edges along the visible outline of every segment as evidence (Sedai 2013, eq. 13)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import cv2
import numpy as np

from muybridge._kernels.fused import EDGE_COST, EDGE_POINTS
from muybridge.body.model import BodyArrays
from muybridge.errors import InputError
from muybridge.likelihood._measure import average, measure_cues, shares

THRESHOLD = 40.0  # grey levels per pixel (of 255): between the grain of cloth and the rim of a limb
BLUR = 2.0  # pixels, standard deviation; a little more than a particle's error in the last layer
MARGIN = 3  # pixels by which the mask is widened: its own rim is an edge too


def edge_map(
    image: np.ndarray, mask: np.ndarray, threshold: float = THRESHOLD, blur: float = BLUR, margin: int = MARGIN
) -> np.ndarray:
    """How near an edge is, (H, W) float32 in [0, 1], for a picture (H, W, 3) or (H, W) uint8 and a mask (H, W) bool.

    The gradient is thresholded, what lies off the widened mask is removed, and the rest is blurred so that a straight
    line has the value 1 along its middle.
    """
    if image.shape[:2] != mask.shape:
        raise InputError("mask", expected=f"the picture's size {image.shape[:2]}", got=str(mask.shape))
    grey = image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    smooth = cv2.GaussianBlur(grey, (3, 3), 0).astype(np.float32)
    gradient = cv2.magnitude(
        cv2.Sobel(smooth, cv2.CV_32F, 1, 0, scale=0.125), cv2.Sobel(smooth, cv2.CV_32F, 0, 1, scale=0.125)
    )
    near = cv2.dilate(mask.astype(np.uint8), np.ones((2 * margin + 1, 2 * margin + 1), np.uint8)) > 0
    lines = ((gradient > threshold / 2.0) & near).astype(np.float32)  # a step of t has a central difference of t / 2
    line = blur * np.sqrt(2.0 * np.pi) if blur > 0 else 1.0
    spread = cv2.GaussianBlur(lines, (0, 0), blur) if blur > 0 else lines
    return np.minimum(1.0, spread * line).astype(np.float32)


def stack_maps(maps: Sequence[np.ndarray]) -> np.ndarray:
    """Edge maps of several cameras padded to one size, (C, H, W) float32."""
    out = np.zeros((len(maps), max(m.shape[0] for m in maps), max(m.shape[1] for m in maps)), np.float32)
    for row, one in zip(out, maps, strict=True):
        row[: one.shape[0], : one.shape[1]] = one
    return out


@dataclass(frozen=True, eq=False)
class EdgeCue:
    """One frame's edges.

    Parameters
    ----------
    arrays, cameras, weights : as in `SilhouetteCue`
    maps : (C, H, W) float32 in [0, 1], see `edge_map` and `stack_maps`
    """

    arrays: BodyArrays
    cameras: np.ndarray
    maps: np.ndarray
    weights: np.ndarray | None = None
    camera_shares: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if len(self.maps) != len(self.cameras):
            raise InputError(
                "edge cue: maps", expected=f"one for each of {len(self.cameras)} cameras", got=str(len(self.maps))
            )
        object.__setattr__(self, "camera_shares", shares(self.weights, len(self.cameras)))

    def log_prob(self, poses: np.ndarray) -> np.ndarray:
        """Log likelihood (N,) of poses (N, D), averaged over cameras."""
        size = self.maps.shape[2], self.maps.shape[1]
        return self.from_results(measure_cues(poses, self.arrays, self.cameras, size, edge_maps=self.maps))

    def from_results(self, results: np.ndarray) -> np.ndarray:
        """Minus (13), mean over points of (1 - map)^2, from results (N, C, RESULT_COLUMNS); 1 where no point is
        seen.
        """
        points = results[..., EDGE_POINTS]
        cost = np.where(points > 0, results[..., EDGE_COST] / np.maximum(points, 1), 1.0)
        return average(-cost, self.camera_shares)
