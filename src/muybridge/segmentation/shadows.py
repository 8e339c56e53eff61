"""Shadows: foreground pixels that are only a darker background.

A shadow scales the light of what it falls on and leaves its colour nearly alone. So a pixel is shadow where brightness
over the plate's brightness lies in a range below and about 1 and the chromaticity (b, g, r over their sum) has hardly
moved: the less, the darker it has become. A grey picture has no colour; there the ratio must be even over a small
window, because a shadow keeps the texture of the ground and a person does not.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.segmentation.pictures import check_same_shape, with_channels


@dataclass(frozen=True)
class ShadowConfig:
    """What counts as a shadow."""

    darkest: float = 0.45
    """Smallest ratio of brightness to the plate's."""
    brightest: float = 1.05
    """Largest ratio; a little above 1, for light reflected by the person."""
    chroma_change: float = 0.025
    """Largest Euclidean change of the chromaticities b, g, r = B, G, R / (B + G + R)."""
    sure_above: float = 0.9
    """Below this ratio of brightness the largest change falls with its square: dark skin before a light wall has
    nearly the wall's chromaticity, and few shadows are that deep."""
    window: int = 3
    """Pixels: colours are also compared as means over so large a square: a dark pixel's own colour is mostly noise."""
    mean_change: float = 0.015
    """As `chroma_change`, of the means, which are known better."""
    noise: float = 3.0
    """Grey values: a sensor's noise. A pixel's own colour may be off by so much more, and no more than that."""
    grey_spread: float = 0.05
    """Grey pictures: largest standard deviation of the ratio over 5 x 5 pixels."""
    minimum_brightness: float = 12.0
    """Mean grey value of the plate below which nothing can be told from the colour: never shadow."""

    def __post_init__(self) -> None:
        if not 0 <= self.darkest < self.brightest:
            raise InputError("shadow brightness range", expected="0 <= darkest < brightest",
                             got=f"{self.darkest:g} and {self.brightest:g}")  # fmt: skip
        if self.sure_above <= 0:
            raise InputError("shadow sure_above", expected="above 0", got=f"{self.sure_above:g}")
        if self.window < 1:
            raise InputError("shadow window", expected="1 pixel or more", got=f"{self.window:g}")
        if not self.noise >= 0:  # NaN fails too
            raise InputError("shadow noise", expected="0 grey values or more", got=f"{self.noise:g}")
        for name in ("chroma_change", "mean_change", "grey_spread"):
            if not getattr(self, name) >= 0:
                raise InputError(f"shadow {name}", expected="0 or more", got=f"{getattr(self, name):g}")


def shadow_mask(image: NDArray, background: NDArray, config: ShadowConfig | None = None) -> NDArray:
    """Where the picture looks like the background with less light on it.

    Parameters
    ----------
    image, background : (H, W) or (H, W, channels) uint8 or float32
        The picture and the empty scene, of one size.

    Returns
    -------
    (H, W) bool
        True on shadow, and on unchanged background; combine it as `mask & ~shadow_mask(...)`.
    """
    config = config or ShadowConfig()
    empty = with_channels(background)
    picture = check_same_shape(image, empty.shape)
    if picture.shape[2] == 3:
        return _coloured_shadow(picture, empty, np.ones(picture.shape[:2], dtype=bool), config)
    light, light_before = picture[..., 0].astype(np.float32), empty[..., 0].astype(np.float32)
    ratio = light / np.maximum(light_before, 1)
    return _in_range(ratio, light_before, config) & (_local_spread(ratio) <= config.grey_spread)


def remove_shadows(mask: NDArray, image: NDArray, background: NDArray, config: ShadowConfig | None = None) -> NDArray:
    """The mask without its shadow: `mask & ~shadow_mask(...)`, in colour worked out on the mask's pixels alone."""
    config = config or ShadowConfig()
    empty = with_channels(background)
    picture = check_same_shape(image, empty.shape)
    if picture.shape[2] == 1:
        return mask & ~shadow_mask(picture, empty, config)
    kept = mask.copy()
    if not mask.any():
        return kept
    box = _box(mask, config.window)
    mask, picture, empty = mask[box], picture[box], empty[box]
    kept[box][mask] = ~_coloured_shadow(picture, empty, mask, config)[mask]
    return kept


def _coloured_shadow(picture: NDArray, empty: NDArray, asked: NDArray, config: ShadowConfig) -> NDArray:
    """(H, W) bool: where asked (H, W), by the pixel itself, or where noise excuses it by its square."""
    found = np.zeros(asked.shape, dtype=bool)
    own = picture[asked].astype(np.float32), empty[asked].astype(np.float32)
    mean = _blurred(picture, config.window)[asked], _blurred(empty, config.window)[asked]
    surer = replace(config, chroma_change=config.mean_change)
    excused = _only_darker(*own, config, 3.0 * config.noise) & _only_darker(*mean, surer)
    found[asked] = excused | _only_darker(*own, config)
    return found


def _box(mask: NDArray, margin: int) -> tuple[slice, slice]:
    """The part of a picture that holds the mask, and some pixels around it."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return tuple(slice(max(0, int(at[0]) - margin), int(at[-1]) + 1 + margin) for at in (rows, columns))  # type: ignore[return-value]


def _blurred(picture: NDArray, window: int) -> NDArray:
    """(H, W, 3) float32: means over squares."""
    import cv2

    return cv2.blur(picture.astype(np.float32), (window, window))


def _only_darker(picture: NDArray, empty: NDArray, config: ShadowConfig, noise: float = 0.0) -> NDArray:
    """(..., 3) colours now and before -> (...) bool; a colour may be off by `noise` grey values more."""
    light, light_before = (colours[..., 0] + colours[..., 1] + colours[..., 2] for colours in (picture, empty))
    ratio = light / np.maximum(light_before, 1)
    before = empty / np.maximum(light_before, 1)[..., None]
    change = picture / np.maximum(light, 1)[..., None] - before
    largest = config.chroma_change * np.square(np.minimum(1.0, ratio / config.sure_above)) + noise / np.maximum(
        light, 1
    )
    return _in_range(ratio, light_before / 3, config) & (np.square(change).sum(axis=-1) <= np.square(largest))


def _in_range(ratio: NDArray, light_before: NDArray, config: ShadowConfig) -> NDArray:
    bright_enough = light_before >= config.minimum_brightness
    return (ratio >= config.darkest) & (ratio <= config.brightest) & bright_enough


def _local_spread(ratio: NDArray) -> NDArray:
    """Standard deviation over 5 x 5 pixels."""
    import cv2

    mean = cv2.blur(ratio, (5, 5))
    return np.sqrt(np.maximum(cv2.blur(ratio * ratio, (5, 5)) - mean * mean, 0))
