"""What somebody looks like from head to foot, and so, of two people one before the other, whose a pixel is.

Each of eight bands of the body has the joint histogram of its foreground's colours. Where two boxes meet, a foreground
pixel is the nearer one's with probability

    s_a L_a / (s_a L_a + (1 - s_a) s_b L_b)

with s how often that place of a person's box is covered, and L the density of the pixel's colour in the band it would
be in: the nearer one is seen where he covers the pixel, the other where he does not.

Not in Zhao (2009), where the hidden one is not observed at all (5.4.1). Pixels are told apart by colour in Elgammal and
Davis (2001) and Senior et al. (2006).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from muybridge._kernels.appearance import (
    CHROMA,
    CODES,
    LUMA,
    band_scores,
    fill_band_sums,
    fill_claims,
    fill_codes,
)
from muybridge.filters.particles import FloatArray
from muybridge.people.blobs import Mask
from muybridge.people.colour_likelihood import Picture, pixel_boxes
from muybridge.people.histograms import inside
from muybridge.people.silhouette import HIGHEST, Silhouette

BANDS = 8
EVEN = 0.02  # of a band's pixels: any colour, as likely as any other; 0.1 was alike
BEYOND = 0.1  # how often a person covers a pixel outside the box where he is expected: boxes are off; 0.03 was worse
LONGEST = 25  # looks that are remembered: the newest weighs one in so many
CLEAREST = 2.0  # nats: the most that one pixel's colour says
KERNEL = np.array([0.25, 0.5, 0.25])


@dataclass(frozen=True, eq=False)
class Appearance:
    """histograms : (BANDS, CODES) float32, shares of each band's pixels; looks : from how many frames"""

    histograms: NDArray[np.float32]
    looks: int = 1

    @classmethod
    def learn(cls, codes: NDArray[np.int16], mask: Mask, box: FloatArray) -> Appearance | None:
        """From colours (H, W), the foreground (H, W) and a body's box (>= 4,); None where a band shows nothing."""
        histograms = _histograms(codes, mask, box)
        return cls(histograms) if (histograms.sum(axis=1) > 0).all() else None

    def updated(self, codes: NDArray[np.int16], mask: Mask, box: FloatArray) -> Appearance:
        """After another look at the same person; a band that shows nothing stays as it was."""
        seen = _histograms(codes, mask, box)
        rate = np.float32(1 / min(self.looks + 1, LONGEST)) * (seen.sum(axis=1, keepdims=True) > 0)
        return replace(self, histograms=(1 - rate) * self.histograms + rate * seen, looks=self.looks + 1)

    @cached_property
    def colours(self) -> NDArray[np.float32]:
        """(BANDS, CODES) float32: densities, smoothed over neighbouring colours and bands."""
        from scipy.ndimage import correlate1d

        spread = self.histograms.reshape(BANDS, LUMA, CHROMA, CHROMA)
        for axis in range(4):
            spread = correlate1d(spread, KERNEL, axis=axis, mode="nearest" if axis == 0 else "constant")
        result = (1 - EVEN) * spread.reshape(BANDS, CODES) + EVEN / CODES
        return np.ascontiguousarray(result, dtype=np.float32)

    @cached_property
    def pooled(self) -> Appearance:
        """Without the order of the bands: somebody who lies has their head and feet at any side of the box."""
        return replace(self, histograms=np.tile(self.histograms.mean(axis=0), (BANDS, 1)))


def colour_codes(picture: Picture) -> NDArray[np.int16]:
    """(H, W) the joint bins of a picture (H, W, 3) uint8, Y Cr Cb."""
    codes = np.empty(picture.shape[:2], np.int16)
    fill_codes(picture, codes)
    return codes


def claims(
    codes: NDArray[np.int16],
    place: tuple[slice, slice],
    near: tuple[FloatArray, NDArray[np.float32]],
    far: tuple[FloatArray, NDArray[np.float32]],
    silhouette: Silhouette,
) -> NDArray[np.float32]:
    """Of a part of the picture: how probable it is that a foreground pixel shows the nearer of two people."""
    part = codes[place]
    out = np.empty(part.shape, np.float32)
    share = np.clip(silhouette.share, BEYOND, HIGHEST)
    fill_claims(part, place[1].start, place[0].start, near[0], far[0], near[1], far[1], share, BEYOND, out)
    return out


def _histograms(codes: NDArray[np.int16], mask: Mask, box: FloatArray) -> NDArray[np.float32]:
    left, top, right, bottom = pixel_boxes(box[None])[0][0]
    height = bottom - top
    rows, columns = slice(max(0, top), max(0, bottom)), slice(max(0, left), max(0, right))
    y, x = np.nonzero(mask[rows, columns])
    band = np.minimum((y + rows.start - top) * BANDS // max(1, height), BANDS - 1)
    counts = np.bincount(band * CODES + codes[rows, columns][y, x], minlength=BANDS * CODES).reshape(BANDS, CODES)
    return (counts / np.maximum(1, counts.sum(axis=1, keepdims=True))).astype(np.float32)


def anybody(known: Sequence[Appearance]) -> NDArray[np.float32]:
    """(BANDS, CODES) float32: density of the colours of all these people, the same in every band."""
    mean = np.mean([one.colours.mean(axis=0) for one in known], axis=0, dtype=np.float32)
    return np.tile(mean, (BANDS, 1))


@dataclass(frozen=True, eq=False)
class AppearanceLikelihood:
    """One frame, seen with one person in mind: log of L over the density of anybody's colours, pixel by pixel.

    codes (H, W) int16; counted (H, W) float32, how far each pixel is foreground that may be theirs; ratios (CODES,
    BANDS) float32; scale : of the sum over pixels
    """

    codes: NDArray[np.int16]
    counted: NDArray[np.float32]
    ratios: NDArray[np.float32]
    scale: float

    def log_prob(self, states: FloatArray) -> FloatArray:
        """(N,) of boxes (N, >= 4)."""
        left, top, right, bottom = inside(pixel_boxes(states)[1], self.codes.shape)
        part = slice(top, bottom), slice(left, right)
        table = np.empty((bottom - top + 1, right - left + 1, BANDS))
        fill_band_sums(self.codes[part], self.counted[part], self.ratios, table)
        out = np.empty(len(states))
        band_scores(table, left, top, np.ascontiguousarray(states, dtype=np.float64), out)
        return self.scale * out


def log_ratios(person: Appearance, anybody_: NDArray[np.float32]) -> NDArray[np.float32]:
    """(CODES, BANDS) float32, each at most `CLEAREST`."""
    ratios = np.log(person.colours / anybody_)
    return np.ascontiguousarray(np.clip(ratios, -CLEAREST, CLEAREST).T)
