"""Errors as pictures: per joint with their spread, and over time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from muybridge.evaluation.joints import LOST_FRAME_MM, JointErrors
from muybridge.plotting.style import LIGHT, Theme, title

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

ORDER = ("head_top", "thorax", "pelvis", "shoulder", "elbow", "wrist", "hip", "knee", "ankle")


def plot_joint_errors(ax: Axes, result: JointErrors, *, theme: Theme = LIGHT) -> list[Artist]:
    """A bar a joint (mean), a line for the middle 90 % of its frames, left and right next to each other.

    Parameters
    ----------
    ax : Axes
    result : JointErrors

    Returns
    -------
    list of Artist
        Bars, then spread lines.
    """
    names = sorted((joint.joint for joint in result.joints if joint.count), key=_position)
    places, ticks, labels = _places(names)
    column = {joint.joint: j for j, joint in enumerate(result.joints)}
    errors = [result.errors_mm[:, column[name]] for name in names]
    means = [float(np.nanmean(error)) for error in errors]
    bars = ax.barh(places, means, height=0.36, color=[theme.side(name) for name in names], linewidth=0)
    low, high = np.array([np.nanpercentile(error, (5, 95)) for error in errors]).T
    lines = ax.hlines(places, low, high, color=theme.ink, linewidth=1.0)
    for place, mean, top in zip(places, means, high, strict=True):
        ax.annotate(
            f"{mean:.0f}",
            (max(mean, top), place),
            xytext=(4, 0),
            textcoords="offset points",
            va="center",
            fontsize=7.5,
            color=theme.muted,
        )
    ax.set_yticks(ticks, labels)
    ax.invert_yaxis()
    ax.grid(False, axis="y")
    ax.set_xlim(left=0)
    ax.margins(x=0.08)
    title(ax, "Error per joint", f"mm, mean and middle 90 %, alignment {result.alignment}", theme)
    _side_legend(ax, names, theme)
    return [*bars, lines]


def plot_error_over_time(ax: Axes, result: JointErrors, *, theme: Theme = LIGHT) -> list[Artist]:
    """The mean over joints of each frame, the middle 80 % of the joints as a band; lost and leg-swapped frames
    marked."""
    times = result.times if np.isfinite(result.times).all() else result.frames.astype(float)
    means = result.frame_means_mm
    seen = np.isfinite(means)
    low, high = np.nanpercentile(result.errors_mm[seen], (10, 90), axis=1)
    artists: list[Artist] = [ax.fill_between(times[seen], low, high, color=theme.left, alpha=0.18, linewidth=0)]
    artists += ax.plot(times, means, color=theme.left)
    artists += _events(ax, times, means, result, theme)
    ax.set_ylim(bottom=0)
    ax.margins(x=0.0)
    ax.set_xlabel("time (s)" if times is result.times else "frame")
    title(ax, "Error over time", f"mm, mean and middle 80 % of the joints, alignment {result.alignment}", theme)
    return artists


def _events(ax: Axes, times: np.ndarray, means: np.ndarray, result: JointErrors, theme: Theme) -> list[Artist]:
    lost = means > LOST_FRAME_MM
    swapped = np.isin(result.frames, result.swapped_frames)
    artists: list[Artist] = []
    for events, marker, label in ((lost, "x", "lost"), (swapped, "v", "legs swapped")):
        if events.any():
            artists += ax.plot(times[events], means[events], marker, color=theme.warning, markersize=5, label=label)
    if artists:
        ax.legend(loc="upper left", ncols=2, labelcolor=theme.muted)
    return artists


def _position(name: str) -> tuple[int, str]:
    base = name.removeprefix("left_").removeprefix("right_")
    return (ORDER.index(base) if base in ORDER else len(ORDER), name)


def _places(names: list[str]) -> tuple[np.ndarray, list[float], list[str]]:
    """Where each bar goes: one row a joint, both sides in one row."""
    rows = list(dict.fromkeys(name.removeprefix("left_").removeprefix("right_") for name in names))
    places = []
    for name in names:
        shift = -0.2 if name.startswith("left_") else 0.2 if name.startswith("right_") else 0.0
        places.append(rows.index(name.removeprefix("left_").removeprefix("right_")) + shift)
    return np.array(places), list(range(len(rows))), [row.replace("_", " ") for row in rows]


def _side_legend(ax: Axes, names: list[str], theme: Theme) -> None:
    from matplotlib.patches import Patch

    sides = [side for side in ("left", "right") if any(name.startswith(side) for name in names)]
    if sides:
        handles = [Patch(color=theme.side(side), label=side) for side in sides]
        ax.legend(handles=handles, loc="lower right", labelcolor=theme.muted)
