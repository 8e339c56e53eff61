"""Masks as pictures, and how well they tell foreground from background."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from muybridge.plotting.experiments import COLOURS
from muybridge.plotting.style import LIGHT, Theme, new_figure, title

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def plot_roc(
    ax: Axes, curves: Mapping[str, tuple[np.ndarray, np.ndarray]], heading: str, theme: Theme = LIGHT
) -> list[Artist]:
    """True against false positive rate, the latter on a logarithmic axis from 0.01 %; a curve for each label.

    curves : label -> false and true rates (n,) each, 0..1
    """
    artists: list[Artist] = []
    for colour, (label, (false, true)) in zip(COLOURS, curves.items(), strict=False):
        artists += ax.plot(np.maximum(false, 1e-4), true, color=colour, label=label, linewidth=1.4)
    ax.set_xscale("log")
    ax.set_xlim(1e-4, 1.0)
    ax.set_ylim(0.0, 1.0)
    ax.set_xlabel("false positive rate", fontsize=8)
    title(ax, heading, "true positive rate", theme)
    return artists


def plot_mask_grid(pictures: np.ndarray, masks: Mapping[str, Sequence[np.ndarray]]) -> Figure:
    """A row of pictures (M, H, W, 3) uint8 BGR, and under it a row of masks (M, H, W) bool for each label."""
    count = len(pictures)
    figure, axes = new_figure(1 + len(masks), count, width=1.7 * count, height=1.28 * (1 + len(masks)))
    rows = [("", pictures[..., ::-1]), *masks.items()]
    for line, (label, shown) in zip(axes, rows, strict=True):
        for ax, image in zip(line, shown, strict=True):
            ax.imshow(image, cmap=None if image.ndim == 3 else "gray", interpolation="nearest")
            ax.set_xticks([])
            ax.set_yticks([])
        line[0].set_ylabel(label, fontsize=8)
    return figure
