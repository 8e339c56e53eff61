"""How well several people were followed: HOTA, MOTA and IDF1 of boxes with identities against a truth.

The numbers are `trackeval`'s, the scorer of MOTChallenge; it is not installed with muybridge. Boxes match by
intersection over union: MOTA and IDF1 from 0.5 on, HOTA as the mean over 0.05, 0.10 .. 0.95.

References: Bernardin and Stiefelhagen (2008) for MOTA; Ristani et al. (2016) for IDF1; Luiten et al. (2021) for HOTA.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.io.boxes import BoxSeries

REMEDY = "pip install --no-deps trackeval==1.3.0 tabulate pycocotools"
"""Without its dependencies: it asks for opencv-python, which overwrites the files of opencv-python-headless."""


@dataclass(frozen=True)
class BoxScores:
    """Scores of one video. Shares of 1, higher is better; counts are of boxes, switches and people."""

    hota: float
    mota: float
    idf1: float
    detection: float
    """DetA: the part of HOTA that says whether people were found."""
    association: float
    """AssA: the part that says whether they kept their identity."""
    recall: float
    precision: float
    overlap: float
    """MOTP: mean intersection over union of the boxes that match."""
    misses: int
    false_alarms: int
    switches: int
    fragments: int
    people: int
    mostly_tracked: int
    mostly_lost: int
    frames: int

    def to_dict(self) -> dict[str, Any]:
        """Names to numbers."""
        return asdict(self)

    def to_table(self) -> str:
        """A few lines for people."""
        return (
            f"HOTA {self.hota:.3f} (detection {self.detection:.3f}, association {self.association:.3f})   "
            f"MOTA {self.mota:.3f}   IDF1 {self.idf1:.3f}\n"
            f"recall {self.recall:.3f}, precision {self.precision:.3f}, overlap {self.overlap:.3f}; "
            f"{self.misses} misses, {self.false_alarms} false alarms, {self.switches} switches, "
            f"{self.fragments} fragments in {self.frames} frames\n"
            f"{self.people} people: {self.mostly_tracked} mostly tracked, {self.mostly_lost} mostly lost"
        )


def score_boxes(estimate: BoxSeries, truth: BoxSeries) -> BoxScores:
    """Scores of an estimate; truth with confidence 0 is left out. Frames run to the last one that either has."""
    metrics = scorer()
    truth = truth.where(truth.confidence != 0)
    if not len(truth):
        raise InputError("truth for scoring", expected="boxes", got="none")
    data = _as_trackeval(estimate, truth)
    options = {"PRINT_CONFIG": False}
    hota = metrics.HOTA().eval_sequence(data)
    clear = metrics.CLEAR(dict(options)).eval_sequence(data)
    identity = metrics.Identity(dict(options)).eval_sequence(data)
    return BoxScores(
        hota=float(np.mean(hota["HOTA"])), mota=float(clear["MOTA"]), idf1=float(identity["IDF1"]),
        detection=float(np.mean(hota["DetA"])), association=float(np.mean(hota["AssA"])),
        recall=float(clear["CLR_Re"]), precision=float(clear["CLR_Pr"]), overlap=float(clear["MOTP"]),
        misses=int(clear["CLR_FN"]), false_alarms=int(clear["CLR_FP"]), switches=int(clear["IDSW"]),
        fragments=int(clear["Frag"]), people=data["num_gt_ids"], mostly_tracked=int(clear["MT"]),
        mostly_lost=int(clear["ML"]), frames=data["num_timesteps"],
    )  # fmt: skip


def overlaps(boxes: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, M) intersection over union of boxes (N, 4) with others (M, 4): left, top, width, height; 0 of empty ones."""
    a, b = np.reshape(boxes, (-1, 1, 4)), np.reshape(others, (1, -1, 4))
    meet = np.minimum(a[..., :2] + a[..., 2:], b[..., :2] + b[..., 2:]) - np.maximum(a[..., :2], b[..., :2])
    shared = np.maximum(meet, 0).prod(axis=-1)
    union = a[..., 2:].prod(axis=-1) + b[..., 2:].prod(axis=-1) - shared
    share: NDArray[np.float64] = np.where(union > 0, shared / np.where(union > 0, union, 1), 0.0)
    return share


def scorer() -> Any:
    """The scorer's metrics; InputError with the remedy where it is not installed."""
    try:
        from trackeval import metrics
    except ImportError as error:
        raise InputError("scoring of boxes", expected="the package trackeval", got=str(error), remedy=REMEDY) from None
    return metrics


def _as_trackeval(estimate: BoxSeries, truth: BoxSeries) -> dict[str, Any]:
    """What its metrics take: per frame, identities from 0 on and similarities."""
    frames = 1 + max(int(series.frames.max()) if len(series) else 0 for series in (estimate, truth))
    first = min(int(series.frames.min()) if len(series) else frames - 1 for series in (estimate, truth))
    data: dict[str, Any] = {"num_timesteps": frames - first, "seq": "video", "similarity_scores": []}
    rows = {}
    for name, series in (("gt", truth), ("tracker", estimate)):
        known, numbers = np.unique(series.ids, return_inverse=True)
        edges = np.searchsorted(series.frames, np.arange(first, frames + 1))
        rows[name] = [series.boxes[a:b] for a, b in zip(edges[:-1], edges[1:])]
        data[f"{name}_ids"] = [numbers[a:b].astype(int) for a, b in zip(edges[:-1], edges[1:])]
        data |= {f"num_{name}_dets": len(series), f"num_{name}_ids": len(known)}
    data["similarity_scores"] = [overlaps(a, b) for a, b in zip(rows["gt"], rows["tracker"], strict=True)]
    return data
