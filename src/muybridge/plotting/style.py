"""One look for every figure: a light and a dark theme, colours that stay apart in every kind of colour vision.

Left is blue, right is vermilion, the middle is grey (after Okabe and Ito's palette), and nothing is said by colour
alone: sides are labelled, the truth is dashed. Figures are made without pyplot, so no window system is ever asked for.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Theme:
    """Colours by their role, as #rrggbb."""

    surface: str
    ink: str
    muted: str
    grid: str
    left: str
    right: str
    middle: str
    truth: str
    accent: str
    warning: str

    def side(self, name: str) -> str:
        """The colour of a joint or segment by the side in its name.

        Examples
        --------
        >>> LIGHT.side("left_knee") == LIGHT.left, LIGHT.side("pelvis") == LIGHT.middle
        (True, True)
        """
        return {"left": self.left, "right": self.right}.get(side_of(name), self.middle)


LIGHT = Theme(
    surface="#ffffff",
    ink="#1d2126",
    muted="#616a75",
    grid="#e3e7eb",
    left="#0072b2",
    right="#d55e00",
    middle="#7d8792",
    truth="#1d2126",
    accent="#009e73",
    warning="#c7254e",
)
DARK = Theme(
    surface="#16191d",
    ink="#e9edf1",
    muted="#9aa4af",
    grid="#2c3238",
    left="#56b4e9",
    right="#f0883e",
    middle="#8b96a2",
    truth="#e9edf1",
    accent="#2fc79a",
    warning="#ff7a96",
)
FONTS = ["Inter", "Source Sans 3", "Helvetica Neue", "Arial", "DejaVu Sans"]


def side_of(name: str) -> str:
    """`"left"`, `"right"` or `""`: the side that a joint's or segment's name begins with."""
    return next((side for side in ("left", "right") if name == side or name.startswith(f"{side}_")), "")


def bgr(colour: str) -> tuple[int, int, int]:
    """A #rrggbb colour in the order that pictures have.

    Examples
    --------
    >>> bgr("#0072b2")
    (178, 114, 0)
    """
    return int(colour[5:7], 16), int(colour[3:5], 16), int(colour[1:3], 16)


@contextmanager
def styled(theme: Theme = LIGHT) -> Iterator[None]:
    """Within this context new figures and axes have the theme's look."""
    import matplotlib as mpl

    with mpl.rc_context(cast(Any, _settings(theme))):
        yield


def new_figure(
    rows: int = 1, columns: int = 1, *, width: float = 7.2, height: float = 3.0, theme: Theme = LIGHT, **options: Any
) -> tuple[Figure, np.ndarray]:
    """A figure that belongs to no window, and its axes.

    Parameters
    ----------
    rows, columns : int
    width, height : float, inches
    theme : Theme
    **options
        Passed to `Figure.subplots` (sharex, sharey, ...).

    Returns
    -------
    figure : matplotlib.figure.Figure
    axes : (rows, columns) array of Axes
    """
    from matplotlib.figure import Figure

    with styled(theme):
        figure = Figure(figsize=(width, height), layout="constrained")
        return figure, figure.subplots(rows, columns, squeeze=False, **options)


def title(ax: Axes, text: str, detail: str = "", theme: Theme = LIGHT) -> None:
    """A heading, and under it in a quieter tone what is shown in which unit."""
    ax.set_title(text, loc="left", color=theme.ink, fontweight="bold", fontsize=10, pad=20 if detail else 8)
    if detail:
        place: dict[str, Any] = {
            "xy": (0, 1),
            "xycoords": "axes fraction",
            "xytext": (0, 7),
            "textcoords": "offset points",
        }
        ax.annotate(detail, **place, color=theme.muted, fontsize=8.5)


def to_png(figure: Figure, dpi: int = 150) -> bytes:
    """The figure as a PNG."""
    return _rendered(figure, "png", dpi=dpi)


def to_svg(figure: Figure) -> bytes:
    """The figure as an SVG; the same figure gives the same bytes."""
    import matplotlib as mpl

    with mpl.rc_context({"svg.hashsalt": "muybridge"}):
        return _rendered(figure, "svg", metadata={"Date": None})


def _rendered(figure: Figure, kind: str, **options: Any) -> bytes:
    stream = io.BytesIO()
    figure.savefig(stream, format=kind, facecolor=figure.get_facecolor(), **options)
    return stream.getvalue()


def _settings(theme: Theme) -> dict[str, Any]:
    return {
        "figure.facecolor": theme.surface,
        "axes.facecolor": theme.surface,
        "savefig.facecolor": theme.surface,
        "text.color": theme.ink,
        "axes.labelcolor": theme.muted,
        "axes.edgecolor": theme.grid,
        "xtick.color": theme.grid,
        "ytick.color": theme.grid,
        "xtick.labelcolor": theme.muted,
        "ytick.labelcolor": theme.muted,
        "axes.grid": True,
        "grid.color": theme.grid,
        "grid.linewidth": 0.8,
        "axes.axisbelow": True,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.spines.left": False,
        "xtick.major.size": 3,
        "ytick.major.size": 0,
        "axes.linewidth": 0.8,
        "font.family": "sans-serif",
        "font.sans-serif": FONTS,
        "font.size": 9,
        "axes.labelsize": 9,
        "xtick.labelsize": 8.5,
        "ytick.labelsize": 8.5,
        "axes.titlepad": 8,
        "legend.frameon": False,
        "legend.fontsize": 8.5,
        "lines.linewidth": 1.8,
        "lines.solid_capstyle": "round",
        "path.simplify": True,
        "axes.titlelocation": "left",
    }
