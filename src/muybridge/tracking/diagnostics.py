"""`diagnostics.csv`: what the filter said of itself, frame by frame; the report's plots come from it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from muybridge.io.disk import disk_errors
from muybridge.io.run_folder import fixed

DIAGNOSTICS_FILE = "diagnostics.csv"


class DiagnosticsWriter:
    """Columns: frame, time_s, status, ess, acceptance, and one silhouette cost a camera."""

    def __init__(self, folder: Path, cameras: Sequence[str]) -> None:
        self.path = folder / DIAGNOSTICS_FILE
        with disk_errors(self.path):
            self._file = open(self.path, "w", encoding="utf-8", newline="\n")
        self._line(["frame", "time_s", "status", "ess", "acceptance", *(f"cost_{name}" for name in cameras)])

    def write(self, frame: int, time_s: float, status: str, ess: float, acceptance: float, costs: np.ndarray) -> None:
        """One frame; costs (C,) in [0, 1]."""
        numbers = [fixed(ess, 2), fixed(acceptance, 4), *(fixed(float(cost), 4) for cost in costs)]
        self._line([str(frame), fixed(time_s, 6), status, *numbers])

    def _line(self, cells: Sequence[str]) -> None:
        with disk_errors(self.path):
            self._file.write(",".join(cells) + "\n")
            self._file.flush()

    def close(self) -> None:
        """Close the table; every frame written is in it."""
        with disk_errors(self.path):
            self._file.close()

    def __enter__(self) -> DiagnosticsWriter:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()
