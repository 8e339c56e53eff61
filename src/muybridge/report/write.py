"""Write `report.html` into a run folder: one file that needs no other and asks no network."""

from __future__ import annotations

from pathlib import Path

from muybridge.evaluation.alignment import Alignment
from muybridge.io.disk import replace_file
from muybridge.report import sections
from muybridge.report.content import RunContent, gather
from muybridge.report.page import page

REPORT_FILE = "report.html"


def write_report(
    folder: str | Path, truth: str | Path | None = None, *, alignment: Alignment = "none", axes: str | None = None
) -> Path:
    """Make a run's report.

    Parameters
    ----------
    folder : str or Path
        A run folder with joints.csv and run.json.
    truth : str or Path, optional
        True joints, in any file that `muybridge.evaluation.read_truth` reads.
    alignment : {"none", "root", "rigid", "similarity"}
        What is forgiven before errors are taken; the report names it.
    axes : str, optional
        For TRC truth: the world axis of file X, Y and Z.

    Returns
    -------
    Path
        The written file.
    """
    target = Path(folder) / REPORT_FILE
    replace_file(target, render(gather(folder, truth, alignment=alignment, axes=axes)).encode())
    return target


def render(content: RunContent) -> str:
    """The report as HTML."""
    parts = [
        sections.heading(content),
        sections.overlay_section(content),
        sections.trouble_section(content),
        sections.error_section(content),
        sections.angle_section(content),
        sections.health_section(content),
        sections.path_section(content),
        sections.camera_section(content),
        sections.settings_section(content),
    ]
    versions = content.summary.get("versions")
    version = versions.get("muybridge", "") if isinstance(versions, dict) else ""
    return page(content.name, "\n".join(part for part in parts if part), f"muybridge {version}".strip())
