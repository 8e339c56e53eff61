"""Head, torso and hip-leg: a person's region cut at two rows, each section shrunk to where its pixels are.

Zhao (2009), section 5.2.

===============  ======================================
symbol           name
===============  ======================================
H_h, H_t, H_l    PartConfig.ratios
K_R              PartConfig.shrink
R_h, R_t, R_l    rows above, between and below the cuts
C, S             centre and half the sides of a part's box
===============  ======================================

Differences from the paper: the lines move within a reach, since a line that may go anywhere finds the belt of a coat or
the hem of a skirt as readily as the neck; how much the sections differ is the sum of the differences across both lines.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.people.blobs import Blob

PARTS = ("head", "torso", "hip_leg")


@dataclass(frozen=True, kw_only=True)
class PartConfig:
    """Settings of the decomposition."""

    ratios: tuple[float, float, float] = (0.17, 0.35, 0.48)  # of the height; the paper gives none: a standing adult's
    reach: float = 0.06  # of the height, up and down, that a line may move
    shrink: float = 1.25  # K_R; the square root of 3 leaves an evenly filled section as it is

    def __post_init__(self) -> None:
        if len(self.ratios) != 3 or min(self.ratios) <= 0 or abs(sum(self.ratios) - 1) > 1e-6:
            raise InputError("parts: ratios", expected="three numbers above 0 whose sum is 1", got=str(self.ratios))
        if not (0 <= self.reach < min(self.ratios) / 2 and self.shrink > 0):
            raise InputError("parts", expected="reach from 0 to half the smallest ratio, shrink above 0",
                             got=f"{self.reach}, {self.shrink}")  # fmt: skip


def decompose(picture: NDArray[np.uint8], blob: Blob, config: PartConfig | None = None) -> FloatArray | None:
    """The three parts' boxes (3, 6): centre, size, and no velocity; None where a section would be without pixels.

    picture : (H, W, 3) uint8, of any colour space whose mean says something
    """
    config = config or PartConfig()
    mask = blob.mask
    own = picture[blob.top : blob.top + mask.shape[0], blob.left : blob.left + mask.shape[1]]
    cuts = best_cuts(own, mask, config)
    if cuts is None:
        return None
    neck, waist = cuts
    thigh = waist + max(1, (mask.shape[0] - waist) // 2)  # hip-leg uses the upper half
    parts = [inner_box(mask, top, bottom, config.shrink) for top, bottom in ((0, neck), (neck, waist), (waist, thigh))]
    if any(part is None for part in parts):
        return None
    boxes = np.zeros((3, 6))
    boxes[:, :4] = np.array(parts)
    boxes[:, :2] += (blob.left, blob.top)
    return boxes


def best_cuts(picture: NDArray[np.uint8], mask: NDArray[np.bool_], config: PartConfig) -> tuple[int, int] | None:
    """The two rows, torso's first and hip-leg's first, across which mean colours differ most; None for tiny regions."""
    height = mask.shape[0]
    usual = np.cumsum(config.ratios)[:2] * height
    reach = config.reach * height
    necks, waists = (np.arange(max(1, int(np.ceil(at - reach))), min(height - 1, int(at + reach)) + 1) for at in usual)
    colours = np.where(mask[..., None], picture, 0).sum(axis=1, dtype=np.float64)
    sums = np.concatenate([np.zeros((1, 3)), np.cumsum(colours, axis=0)])
    counts = np.concatenate([[0], np.cumsum(np.count_nonzero(mask, axis=1))])
    best: tuple[float, int, int] | None = None
    for neck in necks:
        for waist in waists[waists > neck]:
            edges = np.array([0, neck, waist, height])
            pixels = np.diff(counts[edges])
            if not pixels.all():
                continue
            means = np.diff(sums[edges], axis=0) / pixels[:, None]
            difference = float(np.linalg.norm(np.diff(means, axis=0), axis=1).sum())
            if best is None or difference > best[0]:
                best = difference, int(neck), int(waist)
    return None if best is None else best[1:]


def inner_box(mask: NDArray[np.bool_], top: int, bottom: int, shrink: float) -> tuple[float, ...] | None:
    """(5.1) to (5.4): centre and size of rows top..bottom, the size 2 K_R standard deviations, at least a pixel."""
    y, x = np.nonzero(mask[top:bottom])
    if not y.size:
        return None
    y = y + top
    width, height = (max(1.0, 2 * shrink * float(values.std())) for values in (x, y))
    return float(x.mean()), float(y.mean()), width, height
