"""Where people went: their paths over the empty scene, and on the ground seen from above."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from muybridge.plotting.overlay import line_width
from muybridge.plotting.people_video import SHADE, colour_of
from muybridge.plotting.style import LIGHT, Theme, title

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

    from muybridge.io.boxes import BoxSeries


def draw_paths(scene: np.ndarray, boxes: BoxSeries) -> np.ndarray:
    """A new picture (H, W, 3) uint8 BGR: the way of everybody's feet over the scene, each in their own colour.

    boxes : in the scene's pixels
    """
    import cv2

    picture, width = scene.copy(), line_width(scene)
    feet = np.rint(boxes.boxes[:, :2] + boxes.boxes[:, 2:] * (0.5, 1.0)).astype(np.int32)
    for identity in np.unique(boxes.ids):
        path = feet[boxes.ids == identity]
        for extra, colour in ((2, SHADE), (0, colour_of(int(identity)))):
            cv2.polylines(picture, [path[:, None]], False, colour, width + extra, cv2.LINE_AA)
        place = int(path[0, 0]), int(path[0, 1])
        cv2.circle(picture, place, 2 * width, colour_of(int(identity)), -1, cv2.LINE_AA)
    return picture


def plot_ground_map(ax: Axes, ids: np.ndarray, places: np.ndarray, *, theme: Theme = LIGHT) -> list[Artist]:
    """Everybody's way on the ground, x to the right and y up, in one scale; it starts at the circle.

    Parameters
    ----------
    ax : Axes
    ids : (M,) int64
    places : (M, 2) float64, metres, world
        In the order of time; NaN where somebody is nowhere.

    Returns
    -------
    list of Artist
    """
    artists: list[Artist] = []
    for identity in np.unique(ids):
        path = places[ids == identity]
        colour = tuple(value / 255 for value in colour_of(int(identity))[::-1])
        artists += ax.plot(path[:, 0], path[:, 1], color=colour, label=str(identity))
        known = path[np.isfinite(path).all(axis=1)]
        artists += ax.plot(known[:1, 0], known[:1, 1], "o", color=colour, markersize=6)
    ax.set_aspect("equal", adjustable="datalim")
    ax.margins(0.08)
    ax.set_xlabel("x (m)")
    ax.set_ylabel("y (m)")
    title(ax, "People from above", "metres, world", theme)
    return artists
