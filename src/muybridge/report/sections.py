"""The parts of a report, from what was gathered to HTML."""

from __future__ import annotations

import json
from collections.abc import Mapping
from html import escape
from typing import Any

import numpy as np

from muybridge.report import figures
from muybridge.report.content import RunContent
from muybridge.report.page import figure, folded, paragraph, section, table, tiles

GOOD_STATUS = ("done", "ok", "complete", "completed", "finished", "tracked")
MOST_TROUBLE = 40
"""Rows of trouble shown; a run with more has one cause, and the first rows show it."""


def heading(content: RunContent) -> str:
    """Name, status, and the figures to see first."""
    status = str(content.summary.get("status", "unknown"))
    kind = "good" if status in GOOD_STATUS else "bad"
    lead = f"{len(content.series.frames)} frames, {_seconds(content)} of video, {len(content.series.names)} joints"
    return (
        f'<header><h1>{escape(content.name)}<span class="status {kind}">{escape(status)}</span></h1>'
        f'<p class="quiet">{escape(lead)}</p>{tiles(_headline(content))}</header>'
    )


def trouble_section(content: RunContent) -> str:
    """Which frames deserve a look, or that none does."""
    if not content.trouble:
        looked = "no joint was missing, too fast or unusually uncertain" + (", nor lost" if content.errors else "")
        return section("What went wrong", paragraph(f"Nothing that can be seen from the outside: {looked}."))
    rows = [[_span(t.first, t.last), t.what, t.remedy] for t in content.trouble[:MOST_TROUBLE]]
    more = len(content.trouble) - MOST_TROUBLE
    rest = paragraph(f"and {more} more spans", quiet=True) if more > 0 else ""
    return section("What went wrong", table(["frames", "what", "what to do"], rows), rest)


def overlay_section(content: RunContent) -> str:
    """A contact sheet for each camera."""
    parts = [
        figure(f'<img src="{figures.data_uri(figures.jpeg(sheet), "image/jpeg")}" alt="overlay, {escape(name)}">', name)
        for name, sheet in content.sheets.items()
    ]
    note = "The estimate over the pictures: left is blue, right is orange." if parts else ""
    return section("Overlays", paragraph(note, quiet=True) if note else "", *parts)


def error_section(content: RunContent) -> str:
    """Errors against the truth, with the alignment named."""
    draw, errors = figures.error_figure(content), content.errors
    if draw is None or errors is None:
        return ""
    return section(
        "Error against the truth",
        paragraph(f"Alignment {errors.alignment}; {errors.overlap.describe()}.", quiet=True),
        figure(
            figures.picture(draw, "error per joint and over time", len(content.series.frames)),
            "Bars: mean. Lines: the middle 90 % of the frames.",
        ),
        paragraph(f"Stated uncertainty: {errors.calibration.describe()}.") if errors.calibration else "",
        folded("All numbers", errors.to_table()),
    )


def angle_section(content: RunContent) -> str:
    """Joint-angle curves."""
    draw = figures.angle_figure(content)
    caption = (
        "Zero is upright standing, positive is forward. Bands: two standard deviations that follow from those of the "
        "joints, taken as independent."
    )
    return (
        section(
            "Joint angles", figure(figures.picture(draw, "joint angles over time", len(content.series.frames)), caption)
        )
        if draw
        else ""
    )


def health_section(content: RunContent) -> str:
    """What the run knows about its own certainty."""
    draw = figures.health_figure(content)
    caption = (
        "A cross marks frames in which fewer than 5 % of the particles carry the estimate."
        if "ess" in content.diagnostics
        else ""
    )
    return (
        section(
            "How sure it was",
            figure(figures.picture(draw, "uncertainty over time", len(content.series.frames)), caption),
        )
        if draw
        else ""
    )


def path_section(content: RunContent) -> str:
    """The path from above."""
    draw = figures.path_figure(content)
    return (
        section(
            "Path",
            figure(
                figures.picture(draw, "path from above", len(content.series.frames)), "The pelvis in world coordinates."
            ),
        )
        if draw
        else ""
    )


def camera_section(content: RunContent) -> str:
    """The self-check of the cameras, where the run made one."""
    checks = content.summary.get("cameras")
    if (
        not isinstance(checks, Mapping)
        or not all(isinstance(check, Mapping) for check in checks.values())
        or not checks
    ):
        return ""
    rows = [
        [str(name), *(_pixels(check.get(key)) for key in ("shift_px", "residual_px"))] for name, check in checks.items()
    ]
    note = (
        "How far each camera's picture had to be shifted to agree with the others, and what disagreement is left. "
        "More than a few pixels: calibrate again."
    )
    return section(
        "Self-check of the cameras",
        paragraph(note, quiet=True),
        table(["camera", "shift x, y (px)", "left over (px)"], rows, {1, 2}),
    )


def settings_section(content: RunContent) -> str:
    """What is needed to do it again."""
    kept = {key: content.summary[key] for key in ("seed", "settings", "versions") if key in content.summary}
    return (
        section("Settings", folded("Seed, settings and versions", json.dumps(kept, indent=2, ensure_ascii=False)))
        if kept
        else ""
    )


def _headline(content: RunContent) -> list[tuple[str, str]]:
    summary, errors = content.summary, content.errors
    found: list[tuple[str, str]] = []
    if errors is not None:
        found.append((f"{errors.mean_mm:.1f} mm", f"mean error, alignment {errors.alignment}"))
        found.append((f"{errors.worst_frame_mm:.0f} mm", f"worst frame ({errors.worst_frame})"))
    deviation = content.series.sd[np.isfinite(content.series.sd)]
    if len(deviation):
        found.append((f"{1000 * np.median(deviation):.1f} mm", "median stated deviation"))
    times = summary.get("ms_per_frame")
    if isinstance(times, Mapping) and isinstance(times.get("median"), int | float):
        last = f", 95 % below {times['p95']:.0f}" if isinstance(times.get("p95"), int | float) else ""
        found.append((f"{times['median']:.0f} ms", f"per frame{last}"))
    for key, label, unit in (
        ("evaluations_per_frame", "evaluations per frame", ""),
        ("peak_memory_mb", "peak memory", " MB"),
    ):
        if isinstance(summary.get(key), int | float):
            found.append((f"{summary[key]:,.0f}{unit}", label))
    return found


def _seconds(content: RunContent) -> str:
    times = content.series.times
    return f"{times[-1] - times[0]:.1f} s" if len(times) else "0 s"


def _span(first: int, last: int) -> str:
    return str(first) if first == last else f"{first}\N{EN DASH}{last}"


def _pixels(value: Any) -> str:
    if isinstance(value, int | float):
        return f"{value:.1f}"
    if isinstance(value, list | tuple) and all(isinstance(item, int | float) for item in value):
        return ", ".join(f"{item:+.1f}" for item in value)
    return "\N{EN DASH}"
