"""What the harness asks of a trial and of a clip, whatever their kind: enough to run them and to keep their results.

A kind of trial is a frozen dataclass with these properties; its result a dataclass of numbers, text and tuples, kept as
one line of JSON.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol


class RunnableClip(Protocol):
    """What several trials look at; a value, so that trials of one clip are found."""

    @property
    def seed(self) -> int:
        """Clips of one seed are not independent of each other."""
        ...

    @property
    def scene(self) -> str:
        """What it is beside its seed: trials of two conditions on the same scene and seed are a pair."""
        ...

    def prepare(self, folder: Path, trials: Sequence[Any]) -> None:
        """Make what these trials need of the clip in the experiment's folder, unless it is there."""
        ...

    def drop(self, folder: Path) -> None:
        """Delete what is large and can be made again."""
        ...


class RunnableTrial(Protocol):
    """One clip, and what is done with it; a value."""

    @property
    def clip(self) -> Any:
        """A `RunnableClip`."""
        ...

    @property
    def description(self) -> dict[str, Any]:
        """Everything that decides the result, as JSON values."""
        ...

    @property
    def digest(self) -> str:
        """The key under which the result is kept: of the description."""
        ...

    @property
    def kernels(self) -> Hashable:
        """Trials that agree in it run the same compiled code; None: nothing is compiled."""
        ...

    def leaves(self, folder: Path) -> tuple[Path, ...]:
        """Files that reports read beside the result: without them the trial has to be run again."""
        ...

    def rehearse(self, folder: Path) -> None:
        """Run something short, so that what is compiled lies in the cache."""
        ...

    def run(self, folder: Path) -> Any:
        """The result; `clip.prepare` has been called with this trial and the same folder."""
        ...

    def result(self, values: Mapping[str, Any]) -> Any:
        """The result from `asdict` by way of JSON, where NaN is null; ValueError, KeyError or TypeError: it is none."""
        ...
