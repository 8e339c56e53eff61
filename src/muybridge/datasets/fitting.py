"""Cameras for pictures that are not stored at the size they were calibrated at.

Video tools that are asked for another size scale the picture to fit inside and centre it between black bars. That is
the only change accepted here, and only where the bars are really black.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from muybridge.cameras import Camera
from muybridge.errors import InputError

DARK = 24
"""Mean grey value below which a bar counts as black; lossy video lifts it from 0."""


def letterbox(original: tuple[int, int], stored: tuple[int, int]) -> tuple[float, float, float]:
    """Scale and offsets (dx, dy), pixels, of a picture fitted inside another size: u' = s (u + 0.5) - 0.5 + dx."""
    scale = min(stored[0] / original[0], stored[1] / original[1])
    return scale, (stored[0] - scale * original[0]) / 2, (stored[1] - scale * original[1]) / 2


def fit_camera(camera: Camera, picture: NDArray) -> Camera:
    """The camera of the picture as stored.

    Parameters
    ----------
    camera : Camera
        As calibrated.
    picture : (H, W, 3) or (H, W) uint8
        Any frame; looked at only where its size is not the camera's.

    Raises
    ------
    InputError
        Where the sizes differ and the picture has no black bars where fitting would have put them.
    """
    stored = (picture.shape[1], picture.shape[0])
    if stored == camera.size:
        return camera
    scale, dx, dy = letterbox(camera.size, stored)
    if not has_bars(picture, dx, dy):
        raise InputError(
            f"pictures of camera {camera.name!r}",
            expected="{} x {} pixels as calibrated, or that fitted between black bars".format(*camera.size),
            got="{} x {}".format(*stored),
            remedy="give a calibration for the pictures as they are stored",
        )
    shift = 0.5 * scale - 0.5
    return camera.mapped(scale, (shift + dx, shift + dy), size=stored)


def has_bars(picture: NDArray, dx: float, dy: float) -> bool:
    """Whether whole bars of dx columns left and right and dy rows at top and bottom are black."""
    grey = picture if picture.ndim == 2 else picture.max(axis=2)
    columns, rows = (max(0, int(np.floor(bar - 1e-6))) for bar in (dx, dy))
    parts = [grey[:rows], grey[grey.shape[0] - rows :], grey[:, :columns], grey[:, grey.shape[1] - columns :]]
    return all(part.mean() < DARK for part in parts if part.size)


def fit_picture(picture: NDArray, size: tuple[int, int]) -> NDArray:
    """A picture in the calibrated size, such as a plate, as a video of another size would have stored it.

    Returns
    -------
    (height, width, channels) uint8, with black bars
    """
    original = (picture.shape[1], picture.shape[0])
    if original == tuple(size):
        return picture
    import cv2

    scale, dx, dy = letterbox(original, size)
    shift = 0.5 * scale - 0.5
    change = np.array([[scale, 0, shift + dx], [0, scale, shift + dy]])
    return cv2.warpAffine(picture, change, size, flags=cv2.INTER_LINEAR)
