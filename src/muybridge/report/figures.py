"""The report's figures, each once for light and once for dark surroundings, as text that stands inside the page."""

from __future__ import annotations

import base64
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from muybridge.errors import InputError
from muybridge.evaluation.angles import angle_deviations, joint_angles
from muybridge.evaluation.names import root_joints
from muybridge.plotting import (
    DARK,
    LIGHT,
    Theme,
    new_figure,
    plot_acceptance,
    plot_effective_sample_size,
    plot_error_over_time,
    plot_joint_angles,
    plot_joint_errors,
    plot_top_view,
    styled,
    to_png,
    to_svg,
)
from muybridge.plotting.style import title
from muybridge.report.content import RunContent
from muybridge.report.trouble import mean_deviation

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Draw = Callable[[Theme], "Figure"]
MOST_VECTOR_FRAMES = 2000
"""Beyond, the curves are more than an SVG of 1 MB, and denser than its lines are wide."""


def picture(draw: Draw, text: str, frames: int = 0) -> str:
    """One figure as an HTML picture that follows the reader's light or dark setting; long runs as pixels."""
    if frames > MOST_VECTOR_FRAMES:
        light, dark = (data_uri(to_png(draw(theme)), "image/png") for theme in (LIGHT, DARK))
    else:
        light, dark = (data_uri(to_svg(draw(theme)), "image/svg+xml") for theme in (LIGHT, DARK))
    return (
        f'<picture><source srcset="{dark}" media="(prefers-color-scheme: dark)">'
        f'<img src="{light}" alt="{text}"></picture>'
    )


def data_uri(content: bytes, kind: str) -> str:
    """Bytes as an address that needs no other file."""
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"


def jpeg(image: np.ndarray, quality: int = 84) -> bytes:
    """A picture (H, W, 3) uint8 BGR as a JPEG file."""
    import cv2

    done, content = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])
    if not done:
        raise InputError("picture for the report", expected="one that can be written as JPEG", got=f"{image.shape}")
    return content.tobytes()


def angle_figure(content: RunContent) -> Draw | None:
    """Shoulder, elbow, hip and knee; None where the body has no such joints."""
    series = content.series
    try:
        angles = joint_angles(series.positions, series.names)
    except InputError:
        return None
    stated = np.isfinite(series.sd).any()
    deviations = angle_deviations(series.positions, series.sd, series.names) if stated else None
    truth = _true_angles(content)

    def draw(theme: Theme) -> Figure:
        figure, axes = new_figure(2, 2, width=9.6, height=5.4, theme=theme, sharex=True)
        with styled(theme):
            plot_joint_angles(axes, series.times, angles, deviations, truth, theme=theme)
        return figure

    return draw


def error_figure(content: RunContent) -> Draw | None:
    """Error per joint and over time; None without a truth."""
    errors = content.errors
    if errors is None:
        return None

    def draw(theme: Theme) -> Figure:
        figure, axes = new_figure(1, 2, width=9.6, height=4.0, theme=theme)
        with styled(theme):
            plot_joint_errors(axes[0, 0], errors, theme=theme)
            plot_error_over_time(axes[0, 1], errors, theme=theme)
        return figure

    return draw


def health_figure(content: RunContent) -> Draw | None:
    """Uncertainty, effective sample size and acceptance over time: what the run knows about itself."""
    panels = _health_panels(content)
    if not panels:
        return None

    def draw(theme: Theme) -> Figure:
        figure, axes = new_figure(1, len(panels), width=9.6, height=2.7, theme=theme)
        with styled(theme):
            for ax, panel in zip(axes[0], panels, strict=True):
                panel(ax, theme)
        return figure

    return draw


def path_figure(content: RunContent) -> Draw | None:
    """The pelvis from above; None where the body has neither pelvis nor hips."""
    root = root_joints(content.series.names)
    if not root:
        return None
    path = content.series.positions[:, list(root)].mean(axis=1)
    true_root = root_joints(content.truth.names) if content.truth is not None else ()
    truth = (
        content.truth.positions[:, list(true_root)].mean(axis=1) if content.truth is not None and true_root else None
    )

    def draw(theme: Theme) -> Figure:
        figure, axes = new_figure(width=5.4, height=4.2, theme=theme)
        with styled(theme):
            plot_top_view(axes[0, 0], path, truth, theme=theme)
        return figure

    return draw


def _health_panels(content: RunContent) -> list[Callable[[Axes, Theme], object]]:
    times, found = content.series.times, content.diagnostics
    panels: list[Callable[[Axes, Theme], object]] = []
    deviation = 1000.0 * mean_deviation(content.series)
    if np.isfinite(deviation).any():
        panels.append(lambda ax, theme: _plot_deviation(ax, times, deviation, theme))
    if "ess" in found:
        panels.append(
            lambda ax, theme: plot_effective_sample_size(ax, times, found["ess"], content.particles, theme=theme)
        )
    if "acceptance" in found:
        panels.append(lambda ax, theme: plot_acceptance(ax, times, found["acceptance"], theme=theme))
    return panels


def _plot_deviation(ax: Axes, times: np.ndarray, deviation: np.ndarray, theme: Theme) -> None:
    ax.fill_between(times, 0, deviation, color=theme.left, alpha=0.18, linewidth=0)
    ax.plot(times, deviation, color=theme.left)
    ax.set_ylim(bottom=0)
    ax.margins(x=0.0)
    ax.set_xlabel("time (s)")
    title(ax, "Stated uncertainty", "mm, mean standard deviation of the joints", theme)


def _true_angles(content: RunContent) -> tuple[np.ndarray, np.ndarray] | None:
    """True angles on the run's own clock, since files may count time from elsewhere."""
    truth, series = content.truth, content.series
    if truth is None:
        return None
    _, mine, theirs = np.intersect1d(series.frames, truth.frames, return_indices=True)
    try:
        return series.times[mine], joint_angles(truth.positions[theirs], truth.names)
    except InputError:
        return None
