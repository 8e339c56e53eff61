"""`muybridge evaluate RUN --truth FILE`."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from muybridge.cli.reporting import DEFAULT_REPORTING, Reporting


def evaluate(
    run: Path,
    /,
    *,
    truth: Path,
    alignment: Literal["none", "root", "rigid", "similarity"] = "none",
    match_by: Literal["frame", "time"] = "frame",
    offset: float = 0.0,
    axes: str | None = None,
    out: Path | None = None,
    reporting: Reporting = DEFAULT_REPORTING,
) -> None:
    """Compare a run with the truth: error per joint in mm.

    Parameters
    ----------
    run
        A run folder, or a joints.csv.
    truth
        A joints.csv, an office scene's truth_joints.csv, or a .trc file.
    alignment
        What is forgiven before distances are taken.
    match_by
        How frames find each other.
    offset
        Added to the truth's frame numbers, or times in seconds, before matching.
    axes
        The world axis of a .trc file's X, Y and Z, such as yzx; found from heads and feet where absent.
    out
        Also write errors.json and errors.txt into this folder.
    """
    import json

    from muybridge.cli.reporting import plain
    from muybridge.evaluation import evaluate as compare

    errors = compare(run, truth, alignment, match_by=match_by, offset=offset, axes=axes)
    record = plain({"run": run, "truth": truth, **errors.to_dict()})
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
        (out / "errors.txt").write_text(errors.to_table() + "\n", encoding="utf-8")
        (out / "errors.json").write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    reporting.say(errors.to_table())
    reporting.finish(record)
