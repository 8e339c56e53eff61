"""A plate of a scene that was never empty: the person's video, and one picture in which the person stands elsewhere.

A median over the video alone fails where the person stays in one place; the other picture is right there, but wrong
where the person stands in it. So: (1) where no frame of the video agrees with the other picture, that one shows the
person or something moved, and is not believed; (2) against what is left of it, the person is found in every frame, and
continued by colour into the disbelieved region; (3) each pixel takes the median of the frames that show background
there, else the other picture, else it is painted over from its surroundings.

Painting invents what nobody saw, behind a person who never moved away: the person differs from it, which is what a
plate is for. Believing pixels that hardly change was tried there instead, and learnt the person's shorts. Where the
person stays inside the region that is not believed, a ghost remains.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.segmentation.cleaning import drop_small, fill_holes, keep_near_main
from muybridge.segmentation.pictures import median_picture, reduce_image

FACTOR = 0.25
"""Masks are made at this reduction; the plate has the pictures' size."""
DISAGREEMENT = 25.0
"""Grey values, largest over the channels, by which every frame differs from the other picture where that is wrong."""
PERSON = 18.0
"""Grey values by which a frame differs from the background where the person is."""
SMALLEST = 0.003
"""Share of the picture: a smaller disagreement is noise, or a foot that never left its place."""
REACH = 20
"""Pixels at FACTOR round the person in which colours are compared."""
ARM = 50
"""Pixels at FACTOR: nothing of the person is further from what is seen of it."""
ENOUGH = 0.08
"""Share of the frames that must show background for their median to be believed."""


def make_plate(pictures: Sequence[NDArray], elsewhere: NDArray) -> NDArray:
    """The empty scene from a video and one picture with the person elsewhere.

    Parameters
    ----------
    pictures : sequence of (H, W, 3) uint8
        20 to 50 frames spread over the video.
    elsewhere : (H, W, 3) uint8
        The same scene from the same place, at the same size.

    Returns
    -------
    (H, W, 3) uint8
    """
    if len(pictures) < 3:
        raise InputError("frames for a plate", expected="3 or more, spread over the video", got=str(len(pictures)))
    if any(picture.shape != elsewhere.shape for picture in pictures):
        raise InputError(
            "picture with the person elsewhere", expected="the size of the video", got=str(elsewhere.shape)
        )
    small = [reduce_image(picture, FACTOR) for picture in pictures]
    gain = _gain(median_picture(small), reduce_image(elsewhere, FACTOR))
    other = _scaled(elsewhere, gain)
    small_other = reduce_image(other, FACTOR)
    disbelieved = disagreement(small, small_other)
    masks = [_person(picture, small_other, disbelieved) for picture in small]
    return _combine(pictures, masks, other, disbelieved)


def disagreement(pictures: Sequence[NDArray], elsewhere: NDArray) -> NDArray:
    """(H, W) bool: where no frame looks like the other picture, closed over gaps where two people look alike."""
    closest = np.full(elsewhere.shape[:2], np.inf, np.float32)
    for picture in pictures:
        closest = np.minimum(closest, _difference(picture, elsewhere))
    found = fill_holes(_close(drop_small(closest > DISAGREEMENT, 20), 15), 4000)
    return _grow(drop_small(found, round(SMALLEST * found.size)), 9)


def _person(picture: NDArray, background: NDArray, disbelieved: NDArray) -> NDArray:
    """Foreground, generously; inside the disbelieved region it is what has the colours of the foreground outside."""
    seen = drop_small((_difference(picture, background) > PERSON) & ~disbelieved, 30)
    person = keep_near_main(seen, ARM)
    if (_grow(person, 9) & disbelieved).any():
        seen = seen | _continued(picture, person, disbelieved)
    return _grow(seen, 9)


def _continued(picture: NDArray, seen: NDArray, disbelieved: NDArray) -> NDArray:
    """Cut the disbelieved region into person and background by colour and contrast (GrabCut)."""
    import cv2

    label = np.where(seen, cv2.GC_FGD, cv2.GC_BGD).astype(np.uint8)
    label[disbelieved & _grow(seen, 2 * ARM + 1)] = cv2.GC_PR_FGD
    rows, columns = (slice(max(0, i.min() - REACH), i.max() + REACH) for i in np.nonzero(seen | disbelieved))
    part = np.ascontiguousarray(label[rows, columns])
    cv2.setRNGSeed(0)  # GrabCut seeds its colour clusters from OpenCV's own generator
    models = np.zeros((1, 65)), np.zeros((1, 65))
    cv2.grabCut(np.ascontiguousarray(picture[rows, columns]), part, (0, 0, 1, 1), *models, 3, cv2.GC_INIT_WITH_MASK)
    out = np.zeros_like(seen)
    out[rows, columns] = (part == cv2.GC_FGD) | (part == cv2.GC_PR_FGD)
    return keep_touching(out & disbelieved, _grow(seen, 9))


def keep_touching(mask: NDArray, seed: NDArray) -> NDArray:
    """The components of a mask that have a pixel in common with the seed."""
    import cv2

    count, label = cv2.connectedComponents(mask.astype(np.uint8), connectivity=8)
    touching = np.zeros(count, bool)
    touching[np.unique(label[seed & mask])] = True
    return touching[label]


def _combine(pictures: Sequence[NDArray], masks: list[NDArray], other: NDArray, disbelieved: NDArray) -> NDArray:
    import cv2

    height, width = other.shape[:2]
    background = np.mean([~mask for mask in masks], axis=0)
    masked = _masked_median_of(pictures, masks)
    full = [
        cv2.resize(part.astype(np.uint8), (width, height), interpolation=cv2.INTER_NEAREST).astype(bool)
        for part in (background >= ENOUGH, disbelieved)
    ]
    plate = np.where(full[0][..., None], masked, other)
    unknown = ~full[0] & full[1]
    return cv2.inpaint(plate, unknown.astype(np.uint8), 5, cv2.INPAINT_TELEA) if unknown.any() else plate


def _masked_median_of(pictures: Sequence[NDArray], masks: list[NDArray], band: int = 64) -> NDArray:
    """The median over unmasked frames, in bands of rows so that it needs little memory."""
    height, width = pictures[0].shape[:2]
    rows = np.minimum((np.arange(height) * FACTOR).astype(int), masks[0].shape[0] - 1)
    columns = np.minimum((np.arange(width) * FACTOR).astype(int), masks[0].shape[1] - 1)
    out = np.empty_like(pictures[0])
    for top in range(0, height, band):
        part = slice(top, top + band)
        valid = [~mask[rows[part]][:, columns] for mask in masks]
        out[part] = median_picture([picture[part] for picture in pictures], valid)
    return out


def _gain(now: NDArray, before: NDArray) -> NDArray:
    """By how much each channel has become brighter, over most of the picture."""
    ratio = (now.astype(np.float32) + 1) / (before.astype(np.float32) + 1)
    return np.median(ratio.reshape(-1, ratio.shape[2]), axis=0)


def _scaled(picture: NDArray, gain: NDArray) -> NDArray:
    return np.clip(np.rint(picture * gain), 0, 255).astype(np.uint8)


def _difference(picture: NDArray, other: NDArray) -> NDArray:
    import cv2

    return cv2.absdiff(picture, other).max(axis=2).astype(np.float32)


def _close(mask: NDArray, side: int) -> NDArray:
    """Closing with a disc, as if the picture went on empty beyond its border."""
    import cv2

    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (side, side))
    padded = np.pad(mask.astype(np.uint8), side)
    return cv2.morphologyEx(padded, cv2.MORPH_CLOSE, disc)[side:-side, side:-side].astype(bool)


def _grow(mask: NDArray, side: int) -> NDArray:
    import cv2

    return cv2.dilate(mask.astype(np.uint8), np.ones((side, side), np.uint8)).astype(bool)
