"""`muybridge job LAYOUT DIR`."""

from __future__ import annotations

from pathlib import Path

from muybridge.cli.reporting import DEFAULT_REPORTING, Reporting


def job(
    layout: str,
    folder: Path,
    /,
    *,
    subject: str | None = None,
    motion: str | None = None,
    cameras: str | None = None,
    part: str | None = None,
    out: Path | None = None,
    reporting: Reporting = DEFAULT_REPORTING,
) -> None:
    """Write a job for a folder in a known layout.

    Parameters
    ----------
    layout
        bodytrack, pose2sim or humaneva.
    folder
        The folder with the recording.
    subject
        Of humaneva: whose motion, such as S1; not needed where there is only one.
    motion
        Of humaneva: which one, such as Walking_1; not needed where there is only one.
    cameras
        Of humaneva: which ones, such as C1,C2,BW1; the colour cameras where absent.
    part
        Of humaneva: train, validate or test, as published; all frames where absent.
    out
        Where JOB.toml goes, with cameras and reference beside it where they had to be made; the folder itself where
        absent.
    """
    from muybridge.datasets import write_job
    from muybridge.datasets.recording import JOB_FILE

    text = write_job(layout, folder, out, subject=subject, motion=motion, cameras=cameras, part=part)
    written = (out or folder) / JOB_FILE
    reporting.say(f"{text}\nwritten to {written}; now: muybridge track {written}")
    reporting.finish({"job": written, "layout": layout})
