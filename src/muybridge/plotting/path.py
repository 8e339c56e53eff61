"""Where somebody went, seen from above."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from muybridge.plotting.style import LIGHT, Theme, title

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes


def plot_top_view(
    ax: Axes,
    path: np.ndarray,
    truth: np.ndarray | None = None,
    cameras: Mapping[str, tuple[np.ndarray, np.ndarray]] | None = None,
    *,
    theme: Theme = LIGHT,
) -> list[Artist]:
    """A path on the ground, x to the right and y up, in one scale.

    Parameters
    ----------
    ax : Axes
    path : (T, 2) or (T, 3) float64, metres, world
        Its first two coordinates are drawn; it starts at the open circle and ends at the filled one.
    truth : (U, 2) or (U, 3) float64, metres, world, optional
    cameras : dict of name to (position (3,), viewing direction (3,)), world, optional

    Returns
    -------
    list of Artist
    """
    artists: list[Artist] = []
    if truth is not None:
        artists += ax.plot(
            truth[:, 0], truth[:, 1], color=theme.truth, linewidth=1.0, linestyle=(0, (3, 2)), label="truth"
        )
    artists += ax.plot(path[:, 0], path[:, 1], color=theme.left, label="estimate")
    known = path[np.isfinite(path[:, :2]).all(axis=1)]
    if len(known):
        artists += ax.plot(
            *known[0, :2], "o", color=theme.left, markersize=7, markerfacecolor=theme.surface, label="start"
        )
        artists += ax.plot(*known[-1, :2], "o", color=theme.left, markersize=7, label="end")
    for name, (position, direction) in (cameras or {}).items():
        artists += _draw_camera(ax, name, np.asarray(position, float), np.asarray(direction, float), theme)
    ax.set_aspect("equal", adjustable="datalim")
    ax.margins(0.08)
    ax.set_xlabel("x (m)")
    ax.set_ylabel("y (m)")
    ax.legend(loc="best", labelcolor=theme.muted)
    title(ax, "Path from above", "metres, world", theme)
    return artists


def _draw_camera(ax: Axes, name: str, position: np.ndarray, direction: np.ndarray, theme: Theme) -> list[Artist]:
    """A wedge from the camera's place the way it looks; a camera that looks straight down is a point."""
    flat = direction[:2] / max(float(np.linalg.norm(direction[:2])), 1e-9)
    heading = np.degrees(np.arctan2(flat[1], flat[0]))
    artists: list[Artist] = list(ax.plot(*position[:2], marker=(3, 0, heading + 90), color=theme.middle, markersize=11))
    across = "left" if flat[0] < -0.5 else "right" if flat[0] > 0.5 else "center"
    place: dict[str, Any] = {
        "xytext": (-10 * flat[0], -12 * flat[1]),
        "textcoords": "offset points",
        "ha": across,
        "va": "center",
    }
    label = ax.annotate(name, (position[0], position[1]), **place, fontsize=8, color=theme.muted)
    return [*artists, label]
