"""TRAIN.toml: what a silhouette regressor is trained on. docs/train.md lists every key."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from msgspec import Meta, field

from muybridge.io import _tables, _toml
from muybridge.io._tables import Table

Count = Annotated[int, Meta(ge=1)]
Seed = Annotated[int, Meta(ge=0)]


class SceneSource(Table, frozen=True):
    """`[[scene]]`: rendered people whose pose is known: every figure with every motion and every seed."""

    preset: str = "humaneva"
    figures: Annotated[tuple[str, ...], Meta(min_length=1)] = ("man",)
    motions: Annotated[tuple[str, ...], Meta(min_length=1)] = ("walk",)
    seeds: Annotated[tuple[Seed, ...], Meta(min_length=1)] = (0,)
    cameras: Annotated[int, Meta(ge=1, le=8)] = 3
    frames: Annotated[int, Meta(ge=2)] | None = None
    """Of each clip; the preset's where absent."""
    every: Count = 1
    """Every so many frames one is taken."""


class RecordingSource(Table, frozen=True):
    """`[[recording]]`: a finished run whose poses are trusted, with the job that it came from."""

    job: Path
    run: Path
    every: Count = 1


class Training(Table, frozen=True):
    """A whole training file; `scenes` is the file's `[[scene]]`, `recordings` its `[[recording]]`."""

    body: str = "person"
    """Of the catalogue: whose turns are learnt."""
    seed: Seed = 0
    held_out: Annotated[float, Meta(ge=0.05, le=0.5)] = 0.2
    """Share of the people (of the clips, where there is one) kept apart, to find out how far guesses deserve trust."""
    scenes: tuple[SceneSource, ...] = field(default=(), name="scene")
    recordings: tuple[RecordingSource, ...] = field(default=(), name="recording")
    regressor: dict[str, Any] = {}
    """Settings of `regression.Config`."""

    def __post_init__(self) -> None:
        if not self.scenes and not self.recordings:
            raise ValueError("expected at least one [[scene]] or [[recording]]")


def read(path: Path | str, overrides: Sequence[str] = ()) -> Training:
    """Read a training file; relative paths start from its folder, overrides win over it: `"seed=3"`."""
    path = Path(path)
    tables: dict[str, Any] = _tables.copied(_toml.load(path, "a training file"))
    for text in overrides:
        _tables.override(tables, text)
    return _tables.convert(tables, Training, path.parent.absolute(), path.name)
