"""`muybridge doctor`: what is installed here, and whether it does what tracking needs of it."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import tempfile
from collections.abc import Callable
from pathlib import Path

from muybridge.cli.reporting import BAD_INPUT, DEFAULT_REPORTING, DONE, Reporting

PACKAGES = (
    "numpy", "numba", "scipy", "opencv-python-headless", "av", "msgspec", "cyclopts", "scikit-learn", "matplotlib",
)  # fmt: skip


def doctor(*, reporting: Reporting = DEFAULT_REPORTING) -> int:
    """Say what is installed and whether it works; exit code 2 where something does not."""
    facts = {"python": platform.python_version(), "system": platform.platform(), "cores": os.cpu_count()}
    facts |= {name: _version(name) for name in PACKAGES}
    width = max(map(len, facts))
    for name, fact in facts.items():
        reporting.say(f"{name:<{width}}  {fact if fact is not None else 'missing'}")
    problems = {name: _try(check) for name, check in CHECKS.items()}
    for name, problem in problems.items():
        reporting.say(f"{name:<{width}}  {'works' if problem is None else problem}")
    reporting.finish({**facts, "problems": {name: problem for name, problem in problems.items() if problem}})
    return BAD_INPUT if any(problems.values()) else DONE


def _version(package: str) -> str | None:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None


def _try(check: Callable[[], None]) -> str | None:
    """What went wrong, in one line; None where nothing did."""
    try:
        check()
    except Exception as error:  # noqa: BLE001 - whatever is broken, the doctor goes on to the next organ
        return " ".join(f"{type(error).__name__}: {error}".split())
    return None


def _compile() -> None:
    from numba import njit

    if njit(lambda value: value + 1)(1) != 2:
        raise RuntimeError("numba compiled a sum and got it wrong")


def _write_video() -> None:
    import av

    av.Codec("libx264", "w")


def _write_cache() -> None:
    """Kernels are kept beside their sources, or in the user's cache where that folder cannot be written."""
    import muybridge._kernels as kernels

    beside = Path(str(kernels.__file__)).parent
    if not os.access(beside, os.W_OK):
        tempfile.TemporaryFile(dir=Path.home()).close()


CHECKS: dict[str, Callable[[], None]] = {
    "compiler": _compile,
    "H.264 encoder": _write_video,
    "kernel cache": _write_cache,
}
