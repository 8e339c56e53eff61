"""Light that changes over the whole picture: estimated from the background, and taken out before pixels are judged.

A lamp that goes off, a cloud, or the camera's exposure makes nearly all of the picture darker or brighter at once, and
smoothly from place to place; nobody does. So the picture is taken for the background times exp(q), with a quadratic q
of the place for each channel, which iterated reweighted least squares finds from pixels on a lattice. People, and what
else the background does not explain, are outliers. The field of the last picture, one gain for all pixels, and no
change at all are tried; a field is believed only if with it the background explains at least half of the pixels, and
`GAIN` of them more than with none. Otherwise nothing is changed, and the change is for the model to learn.

What is least is the difference of the divided picture from the background, weighted by the background alone: then noise
in the picture biases the field in neither direction, and a model that learns the divided pictures keeps its light.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from muybridge._kernels.light import relight

LATTICE = 1200
"""About so many pixels are looked at."""
FEWEST = 60
"""Usable pixels of the lattice below which nothing is said."""
DARKEST, BRIGHTEST = 12, 250
"""Grey values: beyond them a pixel does not follow the light."""
GAIN = 0.1
SCALES = (12.0, 8.0, 5.0, 4.0)
"""Root mean square of the deviations over the channels at which Tukey's weight is nought: a field begins far off."""
FURTHEST = 1.4
"""Logarithm of a gain: a factor of four is no longer a light under which colours can be compared."""


NOISE, MATCH = 5.0, 2.5
"""Of a single picture of the background: grey values, one standard deviation; and `Light`'s match for it."""


def relit(picture: NDArray, plate: NDArray) -> NDArray:
    """The picture (H, W, C) uint8 in the light of a plate (H, W, C) of the same scene; itself where it has that."""
    light = Light(picture.shape, MATCH)
    mean = plate[light.lattice]
    return light.taken_out(picture, light.measure(picture, mean, np.full(mean.shape, NOISE)))


class Light:
    """The light of a stream of pictures, relative to that of the background; `field` (6, C) is that of the last one.

    Parameters
    ----------
    shape : (H, W, C)
    match : float
        Standard deviations, root mean square over the channels, up to which the background explains a colour.
    """

    def __init__(self, shape: tuple[int, ...], match: float) -> None:
        height, width, channels = shape
        step = max(1, round(np.sqrt(height * width / LATTICE)))
        self.lattice = (slice(step // 2, None, step), slice(step // 2, None, step))
        rows, columns = np.mgrid[self.lattice[0].start : height : step, self.lattice[1].start : width : step]
        y, x = (2.0 * at.ravel() / max(size - 1, 1) - 1.0 for at, size in ((rows, height), (columns, width)))
        self._terms = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)
        self._match = match
        self.field = np.zeros((6, channels))

    def measure(self, picture: NDArray, mean: NDArray, deviation: NDArray) -> NDArray:
        """(6, C): the field of a picture (H, W, C) uint8 over a background; nought where none is believed.

        mean, deviation : (R, Q, C) float, grey values of the background at `lattice`
        """
        channels = picture.shape[2]
        seen = picture[self.lattice].reshape(-1, channels).astype(float)
        mean, deviation = (values.reshape(-1, channels).astype(float) for values in (mean, deviation))
        usable = ((seen > DARKEST) & (seen < BRIGHTEST) & (mean > DARKEST) & (mean < BRIGHTEST)).all(axis=1)
        if usable.sum() < FEWEST:
            return np.zeros_like(self.field)
        given = seen[usable], mean[usable], deviation[usable], self._terms[usable]
        none = np.zeros_like(self.field)
        best, needed = none, max(0.5, self._explained(none, *given) + GAIN)
        for start in (self.field, _flat(*given)):
            if needed > 1.0 - GAIN / 2:  # what is there leaves too little to gain
                break
            field = _fitted(start, *given)
            share = self._explained(field, *given)
            if share >= needed:
                best, needed = field, share
        return best

    def taken_out(self, picture: NDArray, field: NDArray) -> NDArray:
        """The picture (H, W, C) uint8 as it would look in the background's light."""
        if not field.any():
            return picture
        out = np.empty_like(picture)
        relight(picture, field, out)
        return out

    def _explained(self, field: NDArray, *given: NDArray) -> float:
        """The share of pixels that the background explains."""
        return float((_squared(_divided(field, *given), *given) < self._match**2).mean())


def _flat(seen: NDArray, mean: NDArray, deviation: NDArray, terms: NDArray) -> NDArray:
    """(6, C): one gain for all pixels, the median."""
    field = np.zeros((terms.shape[1], mean.shape[1]))
    field[0] = np.median(np.log(seen / mean), axis=0)
    return field


def _divided(field: NDArray, seen: NDArray, mean: NDArray, deviation: NDArray, terms: NDArray) -> NDArray:
    """(P, C): the colours seen, in the background's light; a light too far from it leaves nothing to compare."""
    logarithm = terms @ field
    near = np.abs(logarithm) < FURTHEST
    return np.where(near, seen * np.exp(-np.where(near, logarithm, 0.0)), np.inf)


def _squared(divided: NDArray, seen: NDArray, mean: NDArray, deviation: NDArray, terms: NDArray) -> NDArray:
    """(P,): squared deviations from the background, the mean over the channels."""
    return np.square((divided - mean) / deviation).mean(axis=1)


def _fitted(field: NDArray, *given: NDArray) -> NDArray:
    """(6, C): iterated reweighted least squares from a field, Gauss-Newton steps; the start where it fails."""
    _, mean, deviation, terms = given
    for scale in SCALES:
        divided = _divided(field, *given)
        weights = np.square(np.clip(1.0 - _squared(divided, *given) / scale**2, 0.0, None))
        if np.count_nonzero(weights) < FEWEST:
            return field
        kept = weights > 0
        slopes = terms[kept, None, :] * (mean[kept] / deviation[kept])[..., None]
        apart = ((divided - mean) / deviation)[kept]
        weighted = (slopes * weights[kept, None, None]).transpose(1, 2, 0)
        normal = weighted @ slopes.transpose(1, 0, 2) + 1e-6 * np.eye(terms.shape[1])
        field = field + np.linalg.solve(normal, weighted @ apart.T[..., None])[..., 0].T
    return field
