"""Experiments as pictures: intervals side by side, error against evaluations, coverage, surfaces, distance matrices."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from muybridge.plotting.style import LIGHT, Theme, title

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

#: Curves, told apart by marker too: Okabe and Ito's colours.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7d8792", "#1d2126", "#8c510a", "#762a83")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*", "<", ">")


def plot_intervals(
    ax: Axes,
    labels: Sequence[str],
    means: Sequence[float],
    lows: Sequence[float],
    highs: Sequence[float],
    heading: str,
    detail: str = "mm, mean and 95 % interval",
    *,
    targets: Sequence[tuple[float, float]] = (),
    theme: Theme = LIGHT,
) -> list[Artist]:
    """A dot and a line for each label, top to bottom; the means beside them.

    Parameters
    ----------
    labels : (n,) str
    means, lows, highs : (n,) float
        NaN bounds draw no line.
    targets : (n,) pairs of float, optional
        What each must reach at least, and the aim: two short strokes.
    """
    places = np.arange(len(labels))
    bounds = np.array([lows, highs], float)
    known = np.isfinite(bounds).all(axis=0)
    artists: list[Artist] = [ax.hlines(places[known], *bounds[:, known], color=theme.left, linewidth=2.0)]
    artists += ax.plot(means, places, "o", color=theme.left, markersize=5)
    right = np.where(known, bounds[1], means)
    for place, mean, edge in zip(places, means, right, strict=True):
        text = f"{mean:.0f}" if abs(mean) >= 10 else f"{mean:.1f}"
        ax.annotate(text, (edge, place), xytext=(5, 0), textcoords="offset points", va="center", fontsize=7.5,
                    color=theme.muted)  # fmt: skip
    if targets:
        least, aim = np.array(targets, float).T
        stroke = {"marker": "|", "linestyle": "none", "markersize": 12, "markeredgewidth": 1.6}
        artists += ax.plot(least, places, color=theme.warning, label="at least", **stroke)  # type: ignore[arg-type]
        artists += ax.plot(aim, places, color=theme.accent, label="aim", **stroke)  # type: ignore[arg-type]
        ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), labelcolor=theme.muted)  # beside: titles are above
    ax.set_yticks(places, labels)
    ax.set_ylim(len(labels) - 0.4, -0.6)
    ax.grid(False, axis="y")
    ax.margins(x=0.12)
    if np.nanmin(means) >= 0:
        ax.set_xlim(left=0)
    title(ax, heading, detail, theme)
    return artists


def plot_budgets(
    ax: Axes, curves: Mapping[str, tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]], heading: str,
    *, theme: Theme = LIGHT,
) -> list[Artist]:  # fmt: skip
    """Error against likelihood evaluations, both on logarithmic axes, with their intervals as bands.

    Parameters
    ----------
    curves : filter -> (evaluations, mean, low, high), each (n,) float64; NaN for a bound is no band there
    """
    artists: list[Artist] = []
    for (label, (evaluations, mean, low, high)), colour, marker in zip(curves.items(), COLOURS, MARKERS, strict=False):
        artists.append(ax.fill_between(evaluations, np.maximum(low, 1.0), high, color=colour, alpha=0.13, linewidth=0))
        artists += ax.plot(evaluations, mean, marker=marker, markersize=4.5, color=colour, label=label)
    means = np.concatenate([mean for _, mean, _, _ in curves.values()])
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_ylim(0.6 * means.min(), 1.8 * means.max())  # a band of few seeds must not flatten the curves
    _plain_ticks(ax, "x", (250, 500, 1000, 2000, 5000, 10000, 20000))
    _plain_ticks(ax, "y", (5, 10, 20, 50, 100, 200, 500, 1000))
    ax.set_xlabel("likelihood evaluations a frame")
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.18), ncols=5, frameon=False, fontsize=8, columnspacing=1.0,
              handlelength=1.4, labelcolor=theme.muted)  # fmt: skip
    title(ax, heading, "mm, mean; bands: 95 % interval over seeds, where there are three or more", theme)
    return artists


def plot_coverage(
    ax: Axes, levels: Sequence[float], curves: Mapping[str, Sequence[float]], heading: str, *, theme: Theme = LIGHT
) -> list[Artist]:
    """Share of true joints inside the stated regions against what was claimed; the diagonal is the truth."""
    artists: list[Artist] = ax.plot([0, 100], [0, 100], color=theme.truth, linewidth=1.0, linestyle=(0, (3, 2)))  # type: ignore[assignment]
    for (label, found), colour, marker in zip(curves.items(), COLOURS, MARKERS, strict=False):
        shares = 100 * np.array(found, float)
        artists += ax.plot(100 * np.array(levels), shares, marker=marker, markersize=4.5, color=colour, label=label)
    ax.set_xlim(40, 100)
    ax.set_ylim(0, 102)
    ax.set_xlabel("claimed, %")
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), labelcolor=theme.muted)
    title(ax, heading, "% of true joints inside; below the dashed line: too sure", theme)
    return artists


def plot_surface(
    ax: Axes,
    first: np.ndarray,
    second: np.ndarray,
    values: np.ndarray,
    names: tuple[str, str],
    heading: str,
    *,
    theme: Theme = LIGHT,
) -> list[Artist]:
    """A likelihood over two degrees of freedom, the others being true (Fig. 5.4 of Du, 2005), seen from above.

    Parameters
    ----------
    first, second : (A,), (B,) float64, degrees from the truth
    values : (A, B) float64
    """
    levels = np.linspace(values.min(), values.max(), 13)
    filled = ax.contourf(first, second, values.T, levels=levels, cmap="viridis")
    best = np.unravel_index(int(np.argmax(values)), values.shape)
    artists: list[Artist] = [filled]
    artists += ax.plot([0.0], [0.0], "+", color="white", markersize=11, markeredgewidth=1.8, label="truth")
    artists += ax.plot([first[best[0]]], [second[best[1]]], "o", color="none", markeredgecolor="white", markersize=8,
                       label="highest")  # fmt: skip
    ax.set_xlabel(f"{names[0]}, degrees from the truth")
    ax.set_ylabel(f"{names[1]}, degrees")
    ax.grid(False)
    legend = ax.legend(loc="upper right", facecolor="#00000088", frameon=True, edgecolor="none")
    for text in legend.get_texts():
        text.set_color("white")
    title(ax, heading, "dark low, bright high", theme)
    return artists


def plot_distance_matrix(
    ax: Axes, distances: np.ndarray, labels: Sequence[str], heading: str, *, theme: Theme = LIGHT
) -> list[Artist]:
    """Distances (n, n) between poses, dark where they are alike (Fig. 5.3 of Du, 2005), each with its number."""
    image = ax.imshow(distances, cmap="gray", vmin=0.0)
    middle = 0.5 * float(distances.max())
    for i, j in np.ndindex(*distances.shape):
        colour = "white" if distances[i, j] < middle else "black"
        ax.text(j, i, f"{distances[i, j]:.0f}", ha="center", va="center", fontsize=7.5, color=colour)
    ax.set_xticks(range(len(labels)), labels)
    ax.set_yticks(range(len(labels)), labels)
    ax.set_xlabel("observed")
    ax.set_ylabel("drawn")
    ax.grid(False)
    title(ax, heading, "pixels, dark is alike", theme)
    return [image]


def plot_error_curves(
    ax: Axes, times: np.ndarray, curves: Mapping[str, np.ndarray], heading: str, *, theme: Theme = LIGHT
) -> list[Artist]:
    """Mean error (T,) mm of each condition over time (T,) seconds."""
    artists: list[Artist] = []
    for (label, errors), colour in zip(curves.items(), COLOURS, strict=False):
        artists += ax.plot(times, errors, color=colour, label=label)
    ax.set_ylim(0.0, 1.05 * max(float(errors.max()) for errors in curves.values()))
    ax.margins(x=0.0)
    ax.set_xlabel("time (s)")
    ax.legend(loc="best", labelcolor=theme.muted)
    title(ax, heading, "mm, mean over runs", theme)
    return artists


def _plain_ticks(ax: Axes, axis: str, candidates: Sequence[float]) -> None:
    """Numbers as people write them on a logarithmic axis; those inside its limits."""
    from matplotlib.ticker import NullFormatter, NullLocator

    low, high = ax.get_xlim() if axis == "x" else ax.get_ylim()
    chosen = [value for value in candidates if 0.9 * low <= value <= 1.1 * high]
    target = ax.xaxis if axis == "x" else ax.yaxis
    target.set_ticks(chosen, [f"{value:g}" for value in chosen])
    target.set_minor_locator(NullLocator())
    target.set_minor_formatter(NullFormatter())
