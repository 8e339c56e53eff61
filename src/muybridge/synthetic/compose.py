"""Layers laid over a picture, in the order of their depth at each pixel."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from muybridge._kernels.layers import composite
from muybridge.synthetic.rasterise import Layer


def lay_over(background: np.ndarray, layers: Sequence[Layer]) -> np.ndarray:
    """Lay things over a picture (H, W, 3) float32, which is changed.

    Returns
    -------
    (L, H, W) float32 in 0-1
        How much of each pixel shows each layer.
    """
    seen = np.zeros((len(layers), *background.shape[:2]), dtype=np.float32)
    if not layers:
        return seen
    if len(layers) == 1:
        _lay_one(background, layers[0], seen[0])
        return seen
    left, top, right, bottom = _union([layer.window for layer in layers])
    shape = (len(layers), bottom - top, right - left)
    coverage, visible = np.zeros(shape, dtype=np.float32), np.zeros(shape, dtype=np.float32)
    colours, depth = np.zeros((*shape, 3), dtype=np.float32), np.full(shape, np.inf, dtype=np.float32)
    for index, layer in enumerate(layers):
        x0, y0, x1, y1 = layer.window
        if x0 == x1 or y0 == y1:
            continue  # beside the picture, and so perhaps beside the union too
        place = index, slice(y0 - top, y1 - top), slice(x0 - left, x1 - left)
        coverage[place], colours[place], depth[place] = layer.coverage, layer.colours, layer.depth
    composite(background[top:bottom, left:right], coverage, colours, depth, visible)
    seen[:, top:bottom, left:right] = visible
    return seen


def depth_map(layers: Sequence[Layer], size: tuple[int, int]) -> np.ndarray:
    """(H, W) float32, metres: camera z of the nearest layer that covers at least half of the pixel; else infinity."""
    nearest = np.full((size[1], size[0]), np.inf, dtype=np.float32)
    for layer in layers:
        left, top, right, bottom = layer.window
        part = nearest[top:bottom, left:right]
        np.minimum(part, np.where(layer.coverage >= 0.5, layer.depth, np.float32(np.inf)), out=part)
    return nearest


def _lay_one(background: np.ndarray, layer: Layer, seen: np.ndarray) -> None:
    left, top, right, bottom = layer.window
    part = background[top:bottom, left:right]
    part *= 1.0 - layer.coverage[..., None]
    part += layer.colours
    seen[top:bottom, left:right] = layer.coverage


def _union(windows: Sequence[tuple[int, int, int, int]]) -> tuple[int, int, int, int]:
    filled = [window for window in windows if window[2] > window[0] and window[3] > window[1]]
    if not filled:
        return 0, 0, 0, 0
    low, high = np.min(filled, axis=0)[:2], np.max(filled, axis=0)[2:]
    return int(low[0]), int(low[1]), int(high[0]), int(high[1])
