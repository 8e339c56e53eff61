"""`muybridge track JOB.toml`."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from muybridge.cli.reporting import DEFAULT_REPORTING, DONE, LOST, Reporting

if TYPE_CHECKING:
    from muybridge.io.job import Job

Overrides = Annotated[list[str] | None, Parameter(name="--set", negative=())]


def track(
    job: Path,
    /,
    *,
    out: Path | None = None,
    seed: int | None = None,
    set_: Overrides = None,
    resume: Annotated[bool, Parameter(negative=(), show_default=False)] = False,
    overlay: bool = True,
    reporting: Reporting = DEFAULT_REPORTING,
) -> int:
    """Track the person that a job file describes.

    Parameters
    ----------
    job
        The job, a TOML file; see docs/job.md.
    out
        Where the run folder is made; runs/NAME where absent.
    seed
        Wins over the job's seed.
    set_
        One setting of the job, KEY=VALUE, such as filter.particles=1000; may be repeated.
    resume
        Go on where an interrupted run of the same job into the same folder stopped.
    overlay
        Draw the run over the pictures of each camera.
    """
    from muybridge.io.job import check_settings, read

    overrides = [*(set_ or []), *([] if seed is None else [f"seed={seed}"])]
    described = read(job, overrides)
    check_settings(described)
    return run_and_tell(described, out or Path("runs") / described.name, reporting, resume=resume, overlay=overlay)


def run_and_tell(job: Job, out: Path, reporting: Reporting, *, resume: bool = False, overlay: bool = True) -> int:
    """Track, and say what came of it; LOST where the person was lost for good."""
    from muybridge.cli.aftermath import check_reference, compare, write_overlays
    from muybridge.tracking import run

    check_reference(job.reference)
    try:
        with reporting.progress(f"track {job.name}") as progress:
            summary = run(job, out, progress, resume=resume)
        reporting.say(f"{summary.frames} frames, {summary.status}")
        overlays = write_overlays(job, out, reporting) if overlay else []
        comparison = compare(out, job.reference, reporting)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"interrupted; what was finished is kept in {out}") from None
    reporting.say(f"results in {out}")
    reporting.finish({"out": out, **asdict(summary), "overlays": overlays, **comparison})
    return LOST if summary.status == "lost" else DONE
