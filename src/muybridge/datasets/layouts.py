"""The layouts by name. A row here is all that `muybridge job LAYOUT DIR` needs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from muybridge.datasets.bodytrack import bodytrack_recording
from muybridge.datasets.humaneva import humaneva_recording
from muybridge.datasets.pose2sim import pose2sim_recording
from muybridge.datasets.recording import Recording, write_recording_job
from muybridge.errors import InputError


@dataclass(frozen=True)
class Layout:
    """How a folder is read, and what may be chosen where it holds more than one recording."""

    read: Callable[..., Recording]
    options: tuple[str, ...] = ()


LAYOUTS: dict[str, Layout] = {
    "bodytrack": Layout(bodytrack_recording),
    "pose2sim": Layout(pose2sim_recording),
    "humaneva": Layout(humaneva_recording, ("subject", "motion", "cameras", "part")),
}


def read_recording(layout: str, folder: Path | str, **options: str | None) -> Recording:
    """The recording in a folder of a known layout; `options` that are None count as not given."""
    if layout not in LAYOUTS:
        raise InputError("layout", expected=" or ".join(LAYOUTS), got=repr(layout))
    given = {name: value for name, value in options.items() if value is not None}
    other = [name for name in given if name not in LAYOUTS[layout].options]
    if other:
        expected = " or ".join(f"--{name}" for name in LAYOUTS[layout].options) or "nothing to choose"
        raise InputError(f"layout {layout}", expected=expected, got=f"--{other[0]}")
    return LAYOUTS[layout].read(Path(folder), **given)


def write_job(layout: str, folder: Path | str, out: Path | str | None = None, **options: str | None) -> str:
    """Write `JOB.toml` for a folder in a known layout, and return its text.

    Parameters
    ----------
    layout : str
        A key of `LAYOUTS`.
    folder : Path
    out : Path, optional
        Where the job goes, with what had to be made for it beside it; the folder itself where absent.
    options
        What the layout lets choose, see `Layout.options`.
    """
    recording = read_recording(layout, folder, **options)
    return write_recording_job(recording, Path(folder) if out is None else out)
