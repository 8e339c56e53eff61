"""`muybridge job LAYOUT DIR`."""

from __future__ import annotations

from pathlib import Path

from muybridge.cli.reporting import DEFAULT_REPORTING, Reporting


def job(layout: str, folder: Path, /, *, out: Path | None = None, reporting: Reporting = DEFAULT_REPORTING) -> None:
    """Write a job for a folder in a known layout.

    Parameters
    ----------
    layout
        bodytrack or pose2sim.
    folder
        The folder with the recording.
    out
        Where JOB.toml goes, with corrected cameras beside it where they were needed; the folder itself where absent.
    """
    from muybridge.datasets import write_job
    from muybridge.datasets.recording import JOB_FILE

    text = write_job(layout, folder, out)
    written = (out or folder) / JOB_FILE
    reporting.say(f"{text}\nwritten to {written}; now: muybridge track {written}")
    reporting.finish({"job": written, "layout": layout})
