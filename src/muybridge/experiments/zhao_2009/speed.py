"""How fast the background models learn and test (thesis, 6.1: SBM 1 frame a second, MBM 10, at 320 x 240)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from muybridge.experiments.experiment import Amount, Case, Outcome, Part, Report
from muybridge.experiments.tables import Column, Table
from muybridge.experiments.zhao_2009.conditions import Bench, description_of, digest_of
from muybridge.segmentation.benchmark import time_backgrounds

VERSION = 2  # raise it when the measurement changes
SIZES = ((320, 240), (640, 480))
PRINTED = {"spatial": 1.0, "mixture": 10.0}
"""Frames a second at 320 x 240 on the thesis' 3 GHz PC."""


@dataclass(frozen=True)
class SpeedResult:
    """Names of models, their frames a second of CPU time on one thread, and of the clock on all cores."""

    names: tuple[str, ...]
    frames_per_second: tuple[float, ...]
    on_all_cores: tuple[float, ...]


@dataclass(frozen=True)
class SpeedTrial:
    """All models in one run, on pictures of one size (width, height)."""

    size: tuple[int, int]
    rounds: int
    clip: Bench = Bench()

    @property
    def description(self) -> dict[str, Any]:
        return description_of(self, VERSION)

    @property
    def digest(self) -> str:
        return digest_of(self.description)

    @property
    def kernels(self) -> None:
        """The first round compiles."""
        return None

    def leaves(self, folder: Path) -> tuple[Path, ...]:
        """See `RunnableTrial`; nothing."""
        return ()

    def rehearse(self, folder: Path) -> None:
        """Not asked for."""

    def run(self, folder: Path) -> SpeedResult:
        """Time the models in turn."""
        timings = time_backgrounds(size=self.size, rounds=self.rounds)
        return SpeedResult(
            tuple(t.name for t in timings), tuple(t.frames_per_second for t in timings),
            tuple(t.on_all_cores for t in timings),
        )  # fmt: skip

    def result(self, values: Mapping[str, Any]) -> SpeedResult:
        """From `asdict` by way of JSON."""
        return SpeedResult(*(tuple(values[name]) for name in ("names", "frames_per_second", "on_all_cores")))


def cases(scale: Amount) -> Iterator[Case]:
    """One trial a size; the smaller one for a quick look."""
    for size in SIZES[: 1 if scale.quick else 2]:
        yield Case(f"{size[0]} x {size[1]}", SpeedTrial(size, 1 if scale.quick else 5))


def report(outcome: Outcome) -> Report:
    """Frames a second, and how many times as fast as OpenCV's MOG2 in the same run."""
    rows = []
    for row in outcome.rows:
        found = dict(zip(row.result.names, row.result.frames_per_second, strict=True))
        cores = dict(zip(row.result.names, row.result.on_all_cores, strict=True))
        for name, rate in found.items():
            printed = PRINTED.get(name, float("nan")) if row.case.trial.size == SIZES[0] else float("nan")
            rows.append((row.case.label, name, rate, cores[name], rate / found["mog2"], printed))
    columns = (Column("pictures"), Column("model"), Column("frames/s", 0), Column("on all cores", 0),
               Column("times MOG2", 2), Column("thesis, frames/s", 0))  # fmt: skip
    notes = ("CPU time of one thread, and the clock with as many threads as there are cores; models learn and test "
             "every picture, and clean the mask.",)  # fmt: skip
    return Report((Table("background-speed", "Background models, frames a second", columns, tuple(rows), notes),))


SPEED = Part("speed", "Background models, frames a second", report, cases)
