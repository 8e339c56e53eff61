"""`muybridge bench`."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from muybridge.cli.reporting import DEFAULT_REPORTING, Reporting

if TYPE_CHECKING:
    from muybridge.experiments.speed import Measurement


def bench(*names: str, out: Path | None = None, seed: int = 1, reporting: Reporting = DEFAULT_REPORTING) -> None:
    """Measure how fast the parts are on this machine.

    Parameters
    ----------
    names
        What to measure: likelihood, demc, observation, filters, render, background; all where none is named.
    out
        Also write bench.json into this folder.
    seed
        Of the poses measured.
    """
    import json

    import numpy as np

    from muybridge.cli.reporting import plain
    from muybridge.errors import InputError
    from muybridge.experiments.machine import describe_machine
    from muybridge.experiments.speed import BENCHMARKS

    for name in names:
        if name not in BENCHMARKS:
            raise InputError("benchmark", expected=" or ".join(BENCHMARKS), got=repr(name))
    machine = describe_machine()
    reporting.say(", ".join(f"{key} {value}" for key, value in machine.items()))
    measured = []
    for name in names or BENCHMARKS:
        for row in BENCHMARKS[name](np.random.default_rng(seed)):
            measured.append(asdict(row))
            wanted = _wanted(row)
            reporting.say(f"{row.what:<56}{row.value:10.2f} {row.unit}{wanted}")
    record = plain({"machine": machine, "seed": seed, "measurements": measured})
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
        (out / "bench.json").write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    reporting.finish(record)


def _wanted(row: Measurement) -> str:
    """What was to be reached, where something was."""
    named = [f"{word} {value:g}" for word, value in (("at least", row.floor), ("aim", row.aim)) if value is not None]
    return f"   ({', '.join(named)})" if named else ""
