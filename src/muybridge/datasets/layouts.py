"""The layouts by name. A row here is all that `muybridge job LAYOUT DIR` needs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from muybridge.datasets.bodytrack import bodytrack_recording
from muybridge.datasets.pose2sim import pose2sim_recording
from muybridge.datasets.recording import Recording, write_recording_job
from muybridge.errors import InputError

LAYOUTS: dict[str, Callable[[Path], Recording]] = {
    "bodytrack": bodytrack_recording,
    "pose2sim": pose2sim_recording,
}


def read_recording(layout: str, folder: Path | str) -> Recording:
    """The recording in a folder of a known layout."""
    if layout not in LAYOUTS:
        raise InputError("layout", expected=" or ".join(LAYOUTS), got=repr(layout))
    return LAYOUTS[layout](Path(folder))


def write_job(layout: str, folder: Path | str, out: Path | str | None = None) -> str:
    """Write `JOB.toml` for a folder in a known layout, and return its text.

    Parameters
    ----------
    layout : str
        A key of `LAYOUTS`.
    folder : Path
    out : Path, optional
        Where the job goes, with corrected cameras beside it where they were needed; the folder itself where absent.
    """
    recording = read_recording(layout, folder)
    return write_recording_job(recording, Path(folder) if out is None else out)
