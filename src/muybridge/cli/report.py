"""`muybridge report RUN`."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from muybridge.cli.reporting import DEFAULT_REPORTING, Reporting


def report(
    run: Path,
    /,
    *,
    truth: Path | None = None,
    alignment: Literal["none", "root", "rigid", "similarity"] = "none",
    axes: str | None = None,
    reporting: Reporting = DEFAULT_REPORTING,
) -> None:
    """Write report.html and the plots of a run into its folder.

    Parameters
    ----------
    run
        A run folder.
    truth
        A joints.csv, an office scene's truth_joints.csv, or a .trc file, to compare with.
    alignment
        What is forgiven before distances are taken.
    axes
        The world axis of a .trc file's X, Y and Z, such as yzx; found from heads and feet where absent.
    """
    from muybridge.report.content import gather
    from muybridge.report.plots import write_plots
    from muybridge.report.write import REPORT_FILE, render

    content = gather(run, truth, alignment=alignment, axes=axes)
    page = run / REPORT_FILE
    page.write_text(render(content), encoding="utf-8")
    plots = write_plots(run, content)
    reporting.say(f"{page}, and {len(plots)} plots in {plots[0].parent if plots else run}")
    reporting.finish({"report": page, "plots": plots})
