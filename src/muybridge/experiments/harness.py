"""An experiment from end to end: claim the folder, run what is missing, write tables and plots."""

from __future__ import annotations

import json
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from muybridge.errors import InputError
from muybridge.experiments.experiment import Amount, Case, Experiment, Outcome, Part, Report, Row
from muybridge.experiments.machine import describe_machine
from muybridge.experiments.pool import Progress, run_trials
from muybridge.experiments.runnable import RunnableTrial
from muybridge.experiments.store import Store, claim
from muybridge.io.disk import disk_errors, make_folder, replace_file
from muybridge.plotting.style import to_png, to_svg

#: name -> package; imported when asked for.
EXPERIMENTS = {
    "du-2005": "muybridge.experiments.du_2005",
    "sedai-2013": "muybridge.experiments.sedai_2013",
    "zhao-2009": "muybridge.experiments.zhao_2009",
}
RESULTS, PLOTS, REPORT_FILE = "results", "plots", "results.md"


@dataclass(frozen=True)
class Summary:
    """What was done: trials in all and those run now, files written."""

    experiment: str
    trials: int
    run: int
    parts: tuple[str, ...]
    tables: tuple[Path, ...]
    plots: tuple[Path, ...]
    report: Path


def experiment(name: str) -> Experiment:
    """The experiment of that name; InputError names the known ones."""
    if name not in EXPERIMENTS:
        raise InputError("experiment", expected=" | ".join(EXPERIMENTS), got=repr(name))
    return import_module(EXPERIMENTS[name]).EXPERIMENT


def run_experiment(
    asked: Experiment,
    scale: Amount,
    out: Path,
    *,
    only: Sequence[str] = (),
    workers: int = 1,
    resume: bool = False,
    progress: Progress | None = None,
) -> Summary:
    """Run the parts' trials that have no result yet, then write every part's tables and plots.

    Parameters
    ----------
    only : names of parts; all where none is given
    workers : processes
    resume : go on in a folder that has results of this experiment at this scale; more seeds may be added
    """
    if workers < 1:
        raise InputError("workers", expected="at least 1", got=str(workers))
    parts = asked.chosen(only)
    cases = {part.name: tuple(part.cases(scale)) for part in parts}
    claim(out, {"experiment": asked.name, "quick": scale.quick}, resume=resume)
    trials = list(dict.fromkeys(case.trial for found in cases.values() for case in found))
    asked.prepare(scale, out, workers)
    with Store(out) as store:
        missing = [trial for trial in trials if trial not in store or not _all_there(trial, out)]
        if missing and workers > 1:
            warm_up(missing, out)
        run_trials(missing, out, store.append, workers=workers, progress=progress)
        outcomes = {part.name: _outcome(cases[part.name], store, scale, out) for part in parts}
    reports = {part: part.report(outcomes[part.name]) for part in parts}
    tables, plots = write_reports(reports, out)
    report = _write_page(asked, scale, reports, out)
    return Summary(asked.name, len(trials), len(missing), tuple(p.name for p in parts), tables, plots, report)


def warm_up(trials: Sequence[RunnableTrial], folder: Path) -> None:
    """Compile here what the trials need, so that workers find it in the cache and do not race to write it."""
    seen: set[Hashable] = {None}
    for trial in trials:
        if trial.kernels not in seen:
            seen.add(trial.kernels)
            trial.rehearse(folder)


def _all_there(trial: RunnableTrial, folder: Path) -> bool:
    """Whether what it left is still there: results may have been carried here without it."""
    return all(path.is_file() for path in trial.leaves(folder))


def _outcome(cases: Sequence[Case], store: Store, scale: Amount, out: Path) -> Outcome:
    return Outcome(tuple(Row(case, store[case.trial]) for case in cases), scale, out)


def write_reports(reports: dict[Part, Report], out: Path) -> tuple[tuple[Path, ...], tuple[Path, ...]]:
    """Tables as CSV and Markdown, plots as PNG and SVG; each file whole or not at all."""
    tables, plots = [], []
    results, pictures = make_folder(out / RESULTS), make_folder(out / PLOTS)
    for report in reports.values():
        for table in report.tables:
            for suffix, text in (("csv", table.to_csv()), ("md", table.to_markdown())):
                tables.append(results / f"{table.name}.{suffix}")
                replace_file(tables[-1], text.encode())
        for name, figure in report.figures.items():
            for suffix, data in (("png", to_png(figure)), ("svg", to_svg(figure))):
                plots.append(pictures / f"{name}.{suffix}")
                replace_file(plots[-1], data)
    return tuple(tables), tuple(plots)


def _write_page(asked: Experiment, scale: Amount, reports: dict[Part, Report], out: Path) -> Path:
    """One page with every table and plot, and what they were measured on."""
    lines = [f"# {asked.title}", "", scale.sentence]
    machine = describe_machine()
    lines += ["", "Measured on " + ", ".join(f"{name} {value}" for name, value in machine.items()) + ".", ""]
    for part, report in reports.items():
        lines += [f"## {part.name}: {part.title}", ""]
        lines += [table.to_markdown() for table in report.tables]
        lines += [f"![{name}]({PLOTS}/{name}.png)\n" for name in report.figures]
    path = out / REPORT_FILE
    replace_file(path, "\n".join(lines).encode())
    with disk_errors(out):
        replace_file(out / "machine.json", json.dumps(machine, indent=1).encode() + b"\n")
    return path
