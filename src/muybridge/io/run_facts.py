"""What every run.json says of where it came from: versions, memory, speed."""

from __future__ import annotations

import platform
import resource
from collections.abc import Sequence
from importlib.metadata import version

import numpy as np

PACKAGES = ("muybridge", "numpy", "numba", "opencv-python-headless")


def versions() -> dict[str, str]:
    """Of Python and of the packages that decide about numbers."""
    return {"python": platform.python_version()} | {name: _version(name) for name in PACKAGES}


def peak_memory_mb() -> float:
    """Largest memory this process has had, megabytes."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def speed(milliseconds: Sequence[float]) -> dict[str, float]:
    """Median and 95th percentile of the times of frames; 0 of none."""
    times = np.array(milliseconds if len(milliseconds) else [0.0])
    return {"median": float(np.median(times)), "p95": float(np.percentile(times, 95))}


def _version(name: str) -> str:
    try:
        return version(name)
    except ModuleNotFoundError:
        return "unknown"
