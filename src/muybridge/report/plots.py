"""The report's figures as single files beside it: `plots/angles.png` and so on."""

from __future__ import annotations

from pathlib import Path

from muybridge.io.disk import make_folder, replace_file
from muybridge.plotting.style import LIGHT, to_png
from muybridge.report import figures
from muybridge.report.content import RunContent

PLOTS_FOLDER = "plots"
PLOTS = {
    "angles": figures.angle_figure,
    "errors": figures.error_figure,
    "health": figures.health_figure,
    "path": figures.path_figure,
}


def write_plots(folder: str | Path, content: RunContent) -> list[Path]:
    """Write a run's figures as PNG into `plots/` of its folder; those that there is nothing for are left out."""
    target = make_folder(Path(folder) / PLOTS_FOLDER)
    written = []
    for name, figure in PLOTS.items():
        draw = figure(content)
        if draw is not None:
            written.append(target / f"{name}.png")
            replace_file(written[-1], to_png(draw(LIGHT)))
    return written
