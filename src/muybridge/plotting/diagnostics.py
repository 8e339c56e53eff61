"""How the filter fared: effective sample size and acceptance over time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from muybridge.plotting.style import LIGHT, Theme, title

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

LOW_SHARE = 0.05
"""Fewer effective particles than this share say that the weights collapsed onto a few."""


def plot_effective_sample_size(
    ax: Axes, times: np.ndarray, sizes: np.ndarray, particles: int | None = None, *, theme: Theme = LIGHT
) -> list[Artist]:
    """Effective sample size of each frame.

    Parameters
    ----------
    ax : Axes
    times : (T,) float64, seconds
    sizes : (T,) float64
        1 / sum of squared weights.
    particles : int, optional
        How many there are: draws the scale, and marks frames below 5 % of it.

    Returns
    -------
    list of Artist
    """
    artists: list[Artist] = [ax.fill_between(times, 0, sizes, color=theme.accent, alpha=0.18, linewidth=0)]
    artists += ax.plot(times, sizes, color=theme.accent)
    if particles:
        low = np.asarray(sizes) < LOW_SHARE * particles
        if low.any():
            artists += ax.plot(np.asarray(times)[low], np.asarray(sizes)[low], "x", color=theme.warning, markersize=5)
        ax.set_ylim(0, particles)
    else:
        ax.set_ylim(bottom=0)
    ax.margins(x=0.0)
    ax.set_xlabel("time (s)")
    title(ax, "Effective sample size", f"of {particles} particles" if particles else "particles", theme)
    return artists


def plot_acceptance(ax: Axes, times: np.ndarray, rates: np.ndarray, *, theme: Theme = LIGHT) -> list[Artist]:
    """Share of accepted moves of each frame.

    Parameters
    ----------
    ax : Axes
    times : (T,) float64, seconds
    rates : (T,) or (T, L) float64, in 0 to 1
        With L columns, one a layer: their range is the band, their mean the line.
    """
    percent = 100.0 * np.asarray(rates, float).reshape(len(times), -1)
    artists: list[Artist] = []
    if percent.shape[1] > 1:
        low, high = np.nanmin(percent, axis=1), np.nanmax(percent, axis=1)
        artists.append(ax.fill_between(times, low, high, color=theme.accent, alpha=0.18, linewidth=0))
    artists += ax.plot(times, np.nanmean(percent, axis=1), color=theme.accent)
    ax.set_ylim(0, 100)
    ax.margins(x=0.0)
    ax.set_xlabel("time (s)")
    title(ax, "Accepted moves", "percent" + (", mean and range of the layers" if percent.shape[1] > 1 else ""), theme)
    return artists
