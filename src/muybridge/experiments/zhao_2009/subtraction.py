"""One background model on one clip: its ROC, its masks as they come, and some of them kept for pictures.

The model learns the empty hall, then learns and tests every picture, as `muybridge background` does. A curve's points
are thresholds on the score, each mask closed and opened as the thesis has it (6.1); OpenCV's models have no score, so
each of their points is a run with another threshold. Where `FOUND` of the foreground is found, the threshold is looked
for between two of them: interpolated, a rate of nought would be .05 %. Pixels within one of a person's outline count
nowhere, as in changedetection.net; shadows count as background.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from muybridge.experiments.zhao_2009.conditions import description_of, digest_of
from muybridge.experiments.zhao_2009.hall import HallClip
from muybridge.io.disk import make_folder
from muybridge.segmentation import MaskCounts, ScoringModel, build_background, close_open

VERSION = 3  # raise it when a trial of the same description gives another result
EVERY = 4
"""Every fourth picture is judged; all are learnt and tested."""
MOMENTS = (0.45, 0.57, 0.66, 0.82)
"""Of the clip: when masks are kept."""
MASKS = "masks"
CLOSING, OPENING = 3, 5
MODELS = {
    "gaussian": "GBM",
    "mixture": "MBM",
    "spatial": "SBM",
    "auto": "auto",
    "kde": "KDE",
    "mog2": "MOG2",
    "knn": "KNN",
}
"""The thesis' three, what is beyond it, and OpenCV's: names, and what figures call them."""
RUNS: dict[str, tuple[float, ...]] = {
    "mog2": (6.0, 16.0, 40.0, 100.0, 250.0),
    "knn": (60.0, 160.0, 400.0, 1000.0, 2500.0),
}
"""Thresholds of models without a score."""
POINTS = np.geomspace(1e-4, 0.7, 24)
"""Shares of all pixels that lie above the thresholds of a curve."""
FOUND = 0.8
"""True positive rate at which false positives are compared, as in the thesis."""
HALVINGS = 12
"""Of the stretch between two thresholds of a curve, in looking for that rate."""


@dataclass(frozen=True)
class BackgroundResult:
    """Points of the curve, after cleaning; and counts with the model's own settings.

    false_where_found : false positives of each judged picture where `FOUND` of the foreground is found in all of them;
        none where the curve does not get there
    """

    true_rates: tuple[float, ...]
    false_rates: tuple[float, ...]
    true_positives: int
    false_positives: int
    false_negatives: int
    true_negatives: int
    false_where_found: tuple[int, ...] = ()

    @property
    def counts(self) -> MaskCounts:
        """Of the masks as they come."""
        return MaskCounts(self.true_positives, self.false_positives, self.false_negatives, self.true_negatives)

    def false_rate_at(self, true_rate: float) -> float:
        """The false positive rate where so much of the foreground is found, between the two nearest points; (0, 0) and
        (1, 1) belong to every curve."""
        order = np.lexsort((self.false_rates, self.true_rates))
        true, false = (np.concatenate([[0.0], np.array(rates)[order], [1.0]])
                       for rates in (self.true_rates, self.false_rates))  # fmt: skip
        return float(np.interp(true_rate, true, false))


@dataclass(frozen=True)
class BackgroundTrial:
    """A model of `BACKGROUND_MODELS`, at its defaults but for `settings`, on a clip."""

    clip: HallClip
    model: str
    settings: tuple[tuple[str, Any], ...] = ()

    @property
    def description(self) -> dict[str, Any]:
        return description_of(self, VERSION)

    @property
    def digest(self) -> str:
        return digest_of(self.description)

    @property
    def kernels(self) -> str:
        return self.model

    def leaves(self, folder: Path) -> tuple[Path, ...]:
        """See `RunnableTrial`; nothing."""
        return ()

    def rehearse(self, folder: Path) -> None:
        """Two small pictures of noise."""
        rng = np.random.default_rng(0)
        pictures = rng.integers(0, 255, (8, 24, 32, 3), dtype=np.uint8)
        model = build_background(self.model, pictures, **dict(self.settings))
        for picture in pictures[:2]:
            if isinstance(model, ScoringModel):
                model.score(picture)
            model.apply(picture)

    def run(self, folder: Path) -> BackgroundResult:
        """All pictures, once or once for each threshold."""
        pictures, truths = self.clip.load(folder)
        judged = range(0, len(truths), EVERY)
        masks, scores = self._masks_and_scores(pictures, judged)
        counted = {frame: _beside_outlines(truths[frame]) for frame in judged}

        def counts_at(level: float) -> list[MaskCounts]:
            if scores:
                found = [close_open(score > level, CLOSING, OPENING) for score in scores]
            else:
                found = self._masks_and_scores(pictures, judged, threshold=level)[0]
            return counts_of(found, truths, counted)

        levels = np.quantile(np.stack(scores)[:, ::3, ::3], 1.0 - POINTS) if scores else RUNS[self.model]
        curve = [counts_at(float(level)) for level in levels]
        where_found = at_rate(FOUND, levels, curve, counts_at)
        points = [added(counts) for counts in (*curve, where_found) if counts]
        self._keep(folder, pictures, truths, masks)
        return BackgroundResult(
            tuple(p.recall for p in points),
            tuple(p.false_positive_rate for p in points),
            **asdict(added(counts_of(masks, truths, counted))),
            false_where_found=tuple(counts.false_positives for counts in where_found),
        )

    def _masks_and_scores(
        self, pictures: NDArray, judged: range, **changed: float
    ) -> tuple[list[NDArray], list[NDArray]]:
        """Of the pictures that are judged; no scores where the model has none."""
        empty = self.clip.empty
        model = build_background(self.model, pictures[:empty], **{**dict(self.settings), **changed})
        masks, scores = [], []
        for frame, picture in enumerate(pictures[empty:]):
            if frame in judged and isinstance(model, ScoringModel):
                scores.append(model.score(picture))
            mask = model.apply(picture)
            if frame in judged:
                masks.append(mask)
        return masks, scores

    def masks_file(self, folder: Path) -> Path:
        """At MOMENTS: an NPZ with `masks`, `truths` (M, H, W) bool and `pictures` (M, H, W, 3) uint8."""
        return folder / MASKS / f"{self.digest}.npz"

    def _keep(self, folder: Path, pictures: NDArray, truths: NDArray, masks: list[NDArray]) -> None:
        chosen = [int(moment * len(masks)) for moment in MOMENTS]
        frames = [EVERY * number for number in chosen]
        path = make_folder(folder / MASKS) / f"{self.digest}.npz"
        shown = np.stack([pictures[self.clip.empty + frame] for frame in frames])
        np.savez_compressed(path, masks=np.stack([masks[n] for n in chosen]), truths=truths[frames], pictures=shown)

    def result(self, values: Mapping[str, Any]) -> BackgroundResult:
        """From `asdict` by way of JSON."""
        rates = {name: tuple(values[name]) for name in ("true_rates", "false_rates", "false_where_found")}
        return BackgroundResult(**{**values, **rates})


def counts_of(masks: list[NDArray], truths: NDArray, counted: Mapping[int, NDArray]) -> list[MaskCounts]:
    """Of the masks of the judged frames."""
    return [MaskCounts.of(mask, truths[frame], where)
            for mask, (frame, where) in zip(masks, counted.items(), strict=True)]  # fmt: skip


def added(counts: Sequence[MaskCounts]) -> MaskCounts:
    """Of all pictures together."""
    return sum(counts, MaskCounts())


def at_rate(
    rate: float,
    levels: Sequence[float] | NDArray,
    curve: Sequence[Sequence[MaskCounts]],
    counts_at: Callable[[float], list[MaskCounts]],
) -> list[MaskCounts]:
    """Counts of each picture at the level where the true positive rate of all comes down to `rate`, found by halving.

    levels, curve : those known; the higher a level, the less is found
    counts_at : of a level
    """
    recalls = np.array([added(counts).recall for counts in curve])
    enough, less = ((float(level) for level, kind in zip(levels, kinds, strict=True) if kind)
                    for kinds in (recalls >= rate, recalls < rate))  # fmt: skip
    low = max(enough, default=None)
    high = min((level for level in less if low is not None and level > low), default=None)
    if low is None or high is None:
        return []
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if added(counts_at(middle)).recall >= rate else (low, middle)
    return counts_at(low)


def _beside_outlines(truth: NDArray) -> NDArray:
    """(H, W) bool: everything but the pixels on either side of an outline."""
    import cv2

    around = cv2.morphologyEx(truth.astype(np.uint8), cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8))
    return around == 0
