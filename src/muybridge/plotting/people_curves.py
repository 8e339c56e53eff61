"""How well people are followed: share right against frames, deviation against particles."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from muybridge.plotting.experiments import COLOURS
from muybridge.plotting.style import LIGHT, Theme, title

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes


def plot_rates(ax: Axes, curves: Mapping[str, np.ndarray], heading: str, *, theme: Theme = LIGHT) -> list[Artist]:
    """A line for each tracker.

    Parameters
    ----------
    curves : tracker -> (T,) float64, share right at each frame; NaN where nobody is left
    """
    artists: list[Artist] = []
    for (label, shares), colour in zip(curves.items(), COLOURS, strict=False):
        artists += ax.plot(100 * shares, color=colour, label=label, linewidth=1.6)
    ax.set_ylim(0, 103)
    ax.set_xlabel("frames since the start")
    ax.legend(loc="lower left", labelcolor=theme.muted)
    title(ax, heading, "per cent of people right", theme)
    return artists


def plot_deviation(
    ax: Axes, curves: Mapping[str, tuple[np.ndarray, ...]], heading: str, *, theme: Theme = LIGHT
) -> list[Artist]:
    """A line and a band for each tracker.

    Parameters
    ----------
    curves : tracker -> (particles, mean, low, high), each (n,) float64, pixels; NaN bounds draw no band
    """
    artists: list[Artist] = []
    for (label, (particles, mean, low, high)), colour in zip(curves.items(), COLOURS, strict=False):
        artists.append(ax.fill_between(particles, np.maximum(low, 0.0), high, color=colour, alpha=0.13, linewidth=0))
        artists += ax.plot(particles, mean, "o-", color=colour, label=label, markersize=4.5)
    ax.set_ylim(bottom=0)
    ax.set_xlabel("particles")
    ax.legend(loc="best", labelcolor=theme.muted)
    title(ax, heading, "pixels, mean and 95 % interval over seeds", theme)
    return artists
