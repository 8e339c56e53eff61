"""Joint-angle curves as in Fig. 7.7 of Du (2005): positive is forward, zero is upright standing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from muybridge.plotting.style import LIGHT, Theme, title

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

DASHED = (0, (3, 2))  # points drawn and left out
PANELS = ("shoulder", "elbow", "hip", "knee")


def plot_joint_angles(
    axes: np.ndarray,
    times: np.ndarray,
    angles: np.ndarray,
    deviations: np.ndarray | None = None,
    truth: tuple[np.ndarray, np.ndarray] | None = None,
    *,
    theme: Theme = LIGHT,
) -> list[Artist]:
    """Shoulder, elbow, hip and knee, left and right in each panel.

    Parameters
    ----------
    axes : four Axes, in any shape
        For shoulder, elbow, hip and knee.
    times : (T,) float64, seconds
    angles : (T, 8) float64, radians
        In the order of `muybridge.evaluation.angles.ANGLES`.
    deviations : (T, 8) float64, radians, optional
        Drawn as a band of plus and minus two of them.
    truth : ((U,) seconds, (U, 8) radians), optional
        Drawn dashed, in its side's colour.

    Returns
    -------
    list of Artist
        Lines and bands.
    """
    artists: list[Artist] = []
    for panel, (ax, joint) in enumerate(zip(np.ravel(axes), PANELS, strict=True)):
        pair = slice(2 * panel, 2 * panel + 2)
        spread = None if deviations is None else deviations[:, pair]
        true_pair = None if truth is None else (truth[0], truth[1][:, pair])
        artists += plot_angle_pair(ax, times, angles[:, pair], spread, true_pair, theme=theme)
        title(ax, joint.capitalize(), "degrees, + forward", theme)
        if panel == 0:
            above = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "frameon": False}
            ax.legend(ncols=3, handlelength=1.4, columnspacing=1.0, fontsize=8, labelcolor=theme.muted, **above)
        if panel >= 2:
            ax.set_xlabel("time (s)")
    return artists


def plot_angle_pair(
    ax: Axes,
    times: np.ndarray,
    angles: np.ndarray,
    deviations: np.ndarray | None = None,
    truth: tuple[np.ndarray, np.ndarray] | None = None,
    *,
    theme: Theme = LIGHT,
) -> list[Artist]:
    """One joint's angle, left and right, in degrees over time.

    Parameters
    ----------
    ax : Axes
    times : (T,) float64, seconds
    angles : (T, 2) float64, radians
        Left, right.
    deviations : (T, 2) float64, radians, optional
    truth : ((U,) seconds, (U, 2) radians), optional
    """
    artists: list[Artist] = [ax.axhline(0.0, color=theme.muted, linewidth=0.8, zorder=1)]
    for column, (side, colour) in enumerate((("left", theme.left), ("right", theme.right))):
        degrees = continuous_degrees(angles[:, column])
        if deviations is not None:
            reach = 2 * np.degrees(deviations[:, column])
            artists.append(
                ax.fill_between(times, degrees - reach, degrees + reach, color=colour, alpha=0.18, linewidth=0)
            )
        artists += ax.plot(times, degrees, color=colour, label=side)
        if truth is not None:
            true = continuous_degrees(truth[1][:, column], degrees)
            once = "truth" if column else None
            artists += ax.plot(truth[0], true, color=colour, linewidth=1.2, linestyle=DASHED, label=once)
    ax.margins(x=0.0)
    _fit_to_curves(ax)
    return artists


def _fit_to_curves(ax: Axes) -> None:
    """Limits from the curves: a band that a few uncertain frames blow up must not flatten everything else."""
    values = np.concatenate([np.asarray(line.get_ydata(), float) for line in ax.get_lines()])
    values = values[np.isfinite(values)]
    margin = max(10.0, 0.15 * float(np.ptp(values)))
    ax.set_ylim(float(values.min()) - margin, float(values.max()) + margin)


def continuous_degrees(angle: np.ndarray, near: np.ndarray | None = None) -> np.ndarray:
    """Radians as degrees without jumps of a full turn; with `near`, on the same turn as that curve.

    Examples
    --------
    >>> continuous_degrees(np.radians([170.0, -175.0, np.nan, -170.0])).round()
    array([170., 185.,  nan, 190.])
    """
    known = np.isfinite(angle)
    degrees = np.full(len(angle), np.nan)
    degrees[known] = np.degrees(np.unwrap(angle[known]))
    if near is not None and known.any() and np.isfinite(near).any():
        degrees -= 360.0 * np.round((np.nanmean(degrees) - np.nanmean(near)) / 360.0)
    return degrees
