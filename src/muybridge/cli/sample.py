"""`muybridge sample NAME`."""

from __future__ import annotations

from pathlib import Path

from muybridge.cli.reporting import DEFAULT_REPORTING, Reporting


def sample(
    name: str,
    /,
    *,
    out: Path | None = None,
    source: Path | None = None,
    reporting: Reporting = DEFAULT_REPORTING,
) -> None:
    """Get a real recording to try things on, and write the job that tracks it.

    Parameters
    ----------
    name
        beam: a man balancing along a beam, four cameras, 100 frames; fetched as a package on first use (51 MB).
    out
        Where the job goes; samples/NAME where absent.
    source
        A folder that holds the recording already; nothing is fetched then.
    """
    from muybridge.datasets.recording import JOB_FILE
    from muybridge.datasets.samples import SAMPLES
    from muybridge.errors import InputError

    if name not in SAMPLES:
        raise InputError("sample", expected=" or ".join(SAMPLES), got=repr(name))
    folder = out or Path("samples") / name
    SAMPLES[name](folder, source, progress=reporting.say)
    reporting.say(f"job written to {folder / JOB_FILE}; now: muybridge track {folder / JOB_FILE}")
    reporting.finish({"job": folder / JOB_FILE, "sample": name})
