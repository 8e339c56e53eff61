"""What an experiment is: parts, each a list of labelled trials and a function from their results to tables and figures.

A new experiment is a package with an `EXPERIMENT` and a row of `EXPERIMENTS`; it then appears in the command line.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from muybridge.errors import InputError
from muybridge.experiments.scenes import known_figures, known_motions
from muybridge.experiments.tables import Table
from muybridge.experiments.trial import Clip

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LOST_MM = 1000.0
"""A frame counts at most this: once lost, how far off is chance, and one lost run would be the whole mean."""
DEFAULT_SEEDS, QUICK_SEEDS = 10, 2


@dataclass(frozen=True)
class Amount:
    """How much is run: a quick look or the whole; seeds, of scene and tracker together."""

    quick: bool
    seeds: int

    def few(self, seeds: int) -> int:
        """How many seeds where a trial is dear: so many, and one for a quick look."""
        return 1 if self.quick else seeds

    @property
    def sentence(self) -> str:
        """For people."""
        return f"{self.seeds} seeds."


@dataclass(frozen=True)
class Scale(Amount):
    """How much a 3D tracker is run.

    figures, motions : who does what; frames, rate : of a clip; preset : where
    """

    figures: tuple[str, ...]
    motions: tuple[str, ...]
    frames: int
    preset: str = "studio"
    rate: float = 30.0

    def clips(self, *, view: str = "ring", seeds: int | None = None, reduction: int | None = 2) -> tuple[Clip, ...]:
        """Every figure with every motion for every seed; seeds run slowest, so that what is done first is whole."""
        return tuple(
            Clip(figure, motion, view, 3 if view == "ring" else 1, seed, self.frames, self.rate, self.preset, reduction)
            for seed in range(self.seeds if seeds is None else min(seeds, self.seeds))
            for figure in self.figures
            for motion in self.motions
        )

    @property
    def sentence(self) -> str:
        """For people."""
        return (f"{self.seeds} seeds, {self.frames} frames a clip; people: {', '.join(self.figures)}; "
                f"motions: {', '.join(self.motions)}.")  # fmt: skip

    def walks(self, *, view: str = "ring", seeds: int | None = None, reduction: int | None = 2) -> tuple[Clip, ...]:
        """The walks among the clips."""
        return tuple(c for c in self.clips(view=view, seeds=seeds, reduction=reduction) if c.motion == "walk")


def scale_of(quick: bool, seeds: int | None = None) -> Scale:
    """A quick look (one person's walk, under a second) or the whole: three people, three motions, 1.5 seconds."""
    if seeds is not None and seeds < 1:
        raise InputError("seeds", expected="at least 1", got=str(seeds))
    if quick:
        return Scale(True, seeds or QUICK_SEEDS, known_figures()[:1], known_motions()[:1], 12)
    return Scale(False, seeds or DEFAULT_SEEDS, known_figures()[:3], known_motions()[:3], 45)


@dataclass(frozen=True)
class Case:
    """A trial and the line of a table it counts to; `x` is where it stands on an axis, in parts that draw curves."""

    label: str
    trial: Any
    """A `RunnableTrial`."""
    x: float = float("nan")


@dataclass(frozen=True, eq=False)
class Row:
    """A case that was run."""

    case: Case
    result: Any
    """What the trial's `run` returned."""

    @property
    def key(self) -> tuple[int, str]:
        """Seed and scene: rows of two filters with the same key are a pair."""
        clip = self.case.trial.clip
        return clip.seed, clip.scene

    @property
    def error_mm(self) -> float:
        """Of a 3D track: mean joint error, a frame counting at most LOST_MM."""
        return float(np.minimum(self.result.frame_mm, LOST_MM).mean())


@dataclass(frozen=True, eq=False)
class Outcome:
    """The rows of one part, where files lie, and how much was run."""

    rows: tuple[Row, ...]
    scale: Any
    """The experiment's `Amount`."""
    folder: Path

    def groups(self, rows: Sequence[Row] | None = None) -> Mapping[str, list[Row]]:
        """Rows by label, in the order of the cases."""
        found: dict[str, list[Row]] = {}
        for row in self.rows if rows is None else rows:
            found.setdefault(row.case.label, []).append(row)
        return found

    def of_view(self, view: str) -> list[Row]:
        """Rows of clips seen so."""
        return [row for row in self.rows if row.case.trial.clip.view == view]


@dataclass(frozen=True, eq=False)
class Report:
    """What a part leaves: tables, and figures by file name."""

    tables: tuple[Table, ...] = ()
    figures: Mapping[str, Figure] = field(default_factory=dict)


def no_cases(scale: Amount) -> Iterator[Case]:
    """For parts that only draw."""
    return iter(())


@dataclass(frozen=True)
class Part:
    """One question.

    Parameters
    ----------
    name : as in `--only`
    title : the question
    report : tables and figures from the outcome
    cases : which trials
    """

    name: str
    title: str
    report: Callable[[Outcome], Report]
    cases: Callable[[Any], Iterator[Case]] = no_cases


def nothing_first(scale: Amount, folder: Path, workers: int) -> None:
    """For experiments whose trials need nothing but themselves."""


@dataclass(frozen=True)
class Experiment:
    """A paper's experiments.

    Parameters
    ----------
    name : as on the command line; title : the paper; parts : its questions
    scale : how much is run, from `quick` and a number of seeds
    prepare : what is made in the folder before any trial, unless it is there: scale, folder, workers
    """

    name: str
    title: str
    parts: tuple[Part, ...]
    scale: Callable[[bool, int | None], Amount] = scale_of
    prepare: Callable[[Any, Path, int], None] = nothing_first

    def chosen(self, only: Sequence[str] = ()) -> tuple[Part, ...]:
        """The parts named, in the experiment's order; all where none is named."""
        known = {part.name.lower(): part for part in self.parts}
        for name in only:
            if name.lower() not in known:
                raise InputError("only", expected=" | ".join(part.name for part in self.parts), got=repr(name))
        wanted = {name.lower() for name in only}
        return tuple(part for name, part in known.items() if not wanted or name in wanted)
