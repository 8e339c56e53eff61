"""Results on disk: one JSON line a trial, appended and synced, so that nothing finished is lost whatever happens.

A folder belongs to one experiment at one size; `experiment.json` says which. A last line that was torn off is left out,
and cut off before the next one is written.
"""

from __future__ import annotations

import json
import math
import os
from dataclasses import asdict
from pathlib import Path
from typing import Any

from muybridge.errors import InputError
from muybridge.experiments.runnable import RunnableTrial
from muybridge.io.disk import disk_errors, make_folder, replace_file

ROWS_FILE, CONFIGURATION_FILE = "results.jsonl", "experiment.json"


class Store:
    """The results of an experiment's folder, by the digest of their trial, which knows how to read them."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / ROWS_FILE
        self._results: dict[str, dict[str, Any]] = {}
        whole = 0
        if self.path.is_file():
            with disk_errors(self.path):
                data = self.path.read_bytes()
            whole = data.rfind(b"\n") + 1
            for line in data[:whole].splitlines():
                entry = _entry(line)
                if entry is not None:
                    self._results[entry[0]] = entry[1]
        with disk_errors(self.path):
            self._file = open(self.path, "ab")
            self._file.truncate(whole)

    def __contains__(self, trial: RunnableTrial) -> bool:
        try:
            self[trial]
        except (ValueError, KeyError, TypeError):
            return False
        return True

    def __getitem__(self, trial: RunnableTrial) -> Any:
        return trial.result(self._results[trial.digest])

    def append(self, trial: RunnableTrial, result: Any) -> None:
        """Keep a result, a dataclass; it is on the disk when this returns."""
        entry = {"digest": trial.digest, "trial": trial.description, "result": _finite(asdict(result))}
        with disk_errors(self.path):
            self._file.write(json.dumps(entry, allow_nan=False).encode() + b"\n")
            self._file.flush()
            os.fsync(self._file.fileno())
        self._results[trial.digest] = entry["result"]

    def close(self) -> None:
        """Close the file; doing so twice is fine."""
        self._file.close()

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


def claim(folder: Path, configuration: dict[str, Any], *, resume: bool) -> Path:
    """Take a folder for an experiment: an empty or new one, or with `resume` one of the same configuration.

    Raises
    ------
    InputError
        It belongs to something else, to another configuration, or has results and `resume` was not given.
    """
    path = folder / CONFIGURATION_FILE
    found = _read_configuration(path)
    if found is None:
        if folder.is_dir() and any(folder.iterdir()):
            raise InputError(
                str(folder),
                expected="an empty folder, or one of an experiment",
                got="other files",
                remedy="choose another --out",
            )
        if folder.exists() and not folder.is_dir():
            raise InputError(str(folder), expected="a folder", got="a file", remedy="choose another --out")
    elif found != configuration:
        raise InputError(
            str(folder),
            expected=_described(configuration),
            got=f"results of {_described(found)}",
            remedy="choose another --out",
        )
    elif not resume:
        raise InputError(
            str(folder), expected="no results yet", got="those of this experiment", remedy="go on with --resume"
        )
    make_folder(folder)
    if found is None:
        replace_file(path, json.dumps(configuration, indent=1).encode() + b"\n")
    return folder


def _read_configuration(path: Path) -> dict[str, Any] | None:
    if not path.is_file():
        return None
    with disk_errors(path):
        text = path.read_text(encoding="utf-8")
    try:
        found = json.loads(text)
    except json.JSONDecodeError as error:
        raise InputError(str(path), expected="JSON", got=str(error), remedy="choose another --out") from error
    return found if isinstance(found, dict) else {}


def _described(configuration: dict[str, Any]) -> str:
    return " ".join(f"{name}={value}" for name, value in configuration.items())


def _entry(line: bytes) -> tuple[str, dict[str, Any]] | None:
    """A line's digest and result; None where it is something else, which is left alone."""
    try:
        entry = json.loads(line)
        return str(entry["digest"]), dict(entry["result"])
    except (ValueError, KeyError, TypeError):
        return None


def _finite(value: Any) -> Any:
    """NaN and infinities as null."""
    if isinstance(value, dict):
        return {name: _finite(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
