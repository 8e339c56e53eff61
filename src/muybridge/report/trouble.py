"""What went wrong in a run, as spans of frames: found from the run alone, and from the truth where there is one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from muybridge.evaluation.joints import LOST_FRAME_MM, JointErrors
from muybridge.io.run_folder import JointSeries

COLLAPSE_SHARE = 0.05
"""Effective particles below this share of all: a few particles carry the estimate."""
UNSURE_FACTOR = 3.0
"""A frame whose mean standard deviation is this many times the run's median."""
FASTEST_JOINT = 15.0
"""Metres a second. A sprinter's foot swings forward at about 15 to 20 (twice the running speed); indoors nothing is
faster."""


@dataclass(frozen=True)
class Trouble:
    """A span of frames, first and last included, and what was found in it."""

    first: int
    last: int
    what: str
    remedy: str


def find_trouble(
    series: JointSeries,
    sizes: np.ndarray | None = None,
    particles: int | None = None,
    errors: JointErrors | None = None,
) -> tuple[Trouble, ...]:
    """Spans of frames that deserve a look, in order of time.

    Parameters
    ----------
    series : JointSeries
    sizes : (T,) float64, optional
        Effective sample sizes.
    particles : int, optional
    errors : JointErrors, optional
        Against the truth.

    Returns
    -------
    tuple of Trouble
    """
    frames = series.frames
    found = _spans(frames, np.isnan(series.positions).any(axis=(1, 2)), "no estimate", "start again from a known pose")
    found += _spans(
        frames, _too_fast(series), f"a joint faster than {FASTEST_JOINT:g} m/s", "see whether a limb was lost and found"
    )
    found += _spans(
        frames,
        _unsure(series),
        f"uncertainty above {UNSURE_FACTOR:g} times its median",
        "see whether the person was hidden, or a mask failed",
    )
    if sizes is not None and particles:
        found += _spans(
            frames,
            sizes < COLLAPSE_SHARE * particles,
            "effective sample size below 5 %",
            "more particles or layers, or a likelihood less sharp",
        )
    if errors is not None:
        found += _spans(
            errors.frames,
            errors.frame_means_mm > LOST_FRAME_MM,
            "lost: mean error above 200 mm",
            "see the overlay where it begins",
        )
        found += _spans(
            errors.frames,
            np.isin(errors.frames, errors.swapped_frames),
            "left and right leg exchanged",
            "another camera, or a smaller step noise of the hips",
        )
    return tuple(sorted(found, key=lambda trouble: (trouble.first, trouble.what)))


def _spans(frames: np.ndarray, holds: np.ndarray, what: str, remedy: str) -> list[Trouble]:
    """Neighbouring rows in which it holds, as spans."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], holds, [False]]).astype(int)))
    return [
        Trouble(int(frames[a]), int(frames[b - 1]), what, remedy) for a, b in zip(edges[::2], edges[1::2], strict=True)
    ]


def _too_fast(series: JointSeries) -> np.ndarray:
    fast = np.zeros(len(series.frames), bool)
    if len(fast) > 1:
        steps = np.linalg.norm(np.diff(series.positions, axis=0), axis=-1)
        seconds = np.diff(series.times)[:, None]
        fast[1:] = (steps > FASTEST_JOINT * seconds).any(axis=1) & (seconds[:, 0] > 0)
    return fast


def _unsure(series: JointSeries) -> np.ndarray:
    means = mean_deviation(series)
    known = means[np.isfinite(means)]
    limit = UNSURE_FACTOR * float(np.median(known)) if len(known) else np.inf
    return np.nan_to_num(means, nan=0.0) > max(limit, 1e-9)


def mean_deviation(series: JointSeries) -> np.ndarray:
    """Mean standard deviation of each frame's joints, (T,) float64, metres; NaN where none is stated."""
    known = np.isfinite(series.sd)
    return np.where(known, series.sd, 0.0).sum(axis=1) / np.where(known.any(axis=1), known.sum(axis=1), np.nan)
