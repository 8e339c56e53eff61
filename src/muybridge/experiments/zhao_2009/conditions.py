"""How much is run, and what the kinds of trials share: a digest of their own fields, a clip that needs nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from muybridge.errors import InputError
from muybridge.experiments.experiment import DEFAULT_SEEDS, QUICK_SEEDS, Amount
from muybridge.io.run_log import job_digest


def amount_of(quick: bool, seeds: int | None = None) -> Amount:
    """Two seeds for a quick look, ten for the whole."""
    if seeds is not None and seeds < 1:
        raise InputError("seeds", expected="at least 1", got=str(seeds))
    return Amount(quick, seeds or (QUICK_SEEDS if quick else DEFAULT_SEEDS))


def description_of(trial: Any, version: int) -> dict[str, Any]:
    """A trial's fields, its kind and the version of what it measures, as JSON values."""
    return {"kind": type(trial).__name__, "version": version, **asdict(trial)}


def digest_of(description: dict[str, Any]) -> str:
    """The key of a description."""
    return job_digest(description)[:16]


@dataclass(frozen=True)
class Bench:
    """The clip of trials that look at none: pictures are made on the spot."""

    seed: int = 0
    scene: str = "bench"

    def prepare(self, folder: Path, trials: Sequence[Any]) -> None:
        """Nothing is needed."""

    def drop(self, folder: Path) -> None:
        """Nothing is kept."""
