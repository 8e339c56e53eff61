"""`muybridge experiment`."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from muybridge.cli.reporting import DEFAULT_REPORTING, Reporting, Switch


def experiment(
    name: str,
    /,
    *,
    out: Path | None = None,
    quick: Switch = False,
    seeds: int | None = None,
    workers: int | None = None,
    only: Annotated[str, Parameter(show_default=False)] = "",
    resume: Switch = False,
    reporting: Reporting = DEFAULT_REPORTING,
) -> None:
    """Run a paper's experiments on scenes with known truth.

    Parameters
    ----------
    name
        The paper: du-2005, sedai-2013, zhao-2009.
    out
        Where results, tables and plots go; runs/NAME where absent.
    quick
        A few short clips: every table and plot in minutes, numbers that mean little.
    seeds
        Of scene and tracker; 10, or 2 with --quick.
    workers
        Processes; one for each core where absent. Results do not depend on it.
    only
        Parts, separated by commas, such as E1,E3.
    resume
        Go on where an interrupted run into the same folder stopped.
    """
    import os

    from muybridge.experiments.harness import experiment as find
    from muybridge.experiments.harness import run_experiment

    asked = find(name)
    scale = asked.scale(quick, seeds)
    folder = out or Path("runs") / name
    parts = [part.strip() for part in only.split(",") if part.strip()]
    if workers is None:
        workers = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    try:
        with reporting.progress(name) as progress:
            summary = run_experiment(
                asked, scale, folder, only=parts, workers=workers, resume=resume, progress=progress
            )
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"interrupted; finished trials are kept in {folder}, go on with --resume") from None
    reporting.say(f"{summary.trials} trials, {summary.run} of them run now")
    reporting.say(f"tables and plots in {summary.report}")
    reporting.finish(asdict(summary))
