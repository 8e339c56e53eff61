"""Results made up for tests: no tracking is needed to see whether a table is right."""

from __future__ import annotations

from pathlib import Path

from muybridge.experiments.experiment import Case, Outcome, Part, Row, Scale
from muybridge.experiments.running import Result
from muybridge.experiments.trial import Clip, Trial

SMALL = Scale(True, 2, ("man",), ("walk",), 4)


def result(error: float = 20.0, frames: int = 4, **changed: object) -> Result:
    """A result whose every frame has the same error, mm."""
    values = {
        "mean_mm": error,
        "root_mm": 1.1 * error,
        "angle_deg": 3.0,
        "lost_share": 0.0,
        "lost_wrists": 0.0,
        "place_mm": 0.5 * error,
        "legs_mm": error,
        "arms_mm": 2.0 * error,
        "swapped_share": 0.25,
        "inside": (0.5, 0.8, 0.95),
        "scale": 1.0,
        "sd_mm": 12.0,
        "evaluations": 1000.0,
        "ms": 10.0,
        "cost": 0.1,
        "moves": 2.0,
        "status": "tracked",
        "frame_mm": (error,) * frames,
    }
    return Result(**{**values, **changed})  # type: ignore[arg-type]


def row(label: str, seed: int, error: float, *, motion: str = "walk") -> Row:
    """A row of one seed and motion."""
    return Row(Case(label, Trial(Clip(motion=motion, seed=seed), seed=seed)), result(error))


def outcome(part: Part, folder: Path, scale: Scale = SMALL) -> Outcome:
    """Every case of a part, with errors that differ."""
    rows = [Row(case, result(20.0 + 3.0 * i, scale.frames)) for i, case in enumerate(part.cases(scale))]
    return Outcome(tuple(rows), scale, folder)
