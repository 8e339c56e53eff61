"""How much of annotated people a background model finds on real pictures, by what it calls foreground beside them.

    python benchmarks/background_boxes.py VIDEO BOXES [--models spatial auto gaussian kde] [--set auto.calm=0.9 ...]

The model learns from the first 5 s, with whoever is in them, then learns and tests 120 pictures from 5 on, reduced by
half. Boxes hold ground beside people too, so that 1 is not to be had. Prints the share of the boxes that is foreground
where 0.10, 0.15 and 0.30 % of the picture further than 4 pixels from them is, by thresholds on the score, and the
threshold there; masks are closed and opened as `background` does by default.
"""

from __future__ import annotations

import argparse
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from muybridge.io.boxes import BoxSeries, read_boxes
from muybridge.io.video import open_pictures
from muybridge.segmentation import build_background, close_open, reduce_image, settings_at

LEARN_S, BEGIN, JUDGED, HALF, APART = 5.0, 5, 120, 0.5, 4
SHARES = np.geomspace(0.004, 0.06, 24)  # of all pixels above a threshold
OUTSIDE = (0.10, 0.15, 0.30)  # per cent


def scores_of(name: str, pictures: list[np.ndarray], rate: float, settings: dict[str, Any]) -> list[np.ndarray]:
    """Of the judged pictures; all after those that are learnt from are learnt on line."""
    learnt = round(LEARN_S * rate)
    model = build_background(name, pictures[:learnt], **{**settings_at(name, rate), **settings})
    scores = []
    for number, picture in enumerate(pictures[learnt:]):
        if number >= BEGIN:
            scores.append(model.score(picture))  # type: ignore[attr-defined]
        model.apply(picture)
    return scores


def curve(scores: list[np.ndarray], boxes: BoxSeries, first: int) -> np.ndarray:
    """(SHARES, 3): per cent outside, share of the boxes that is covered, threshold; by what is outside."""
    places = []
    for number, score in enumerate(scores):
        inside, near = [], np.zeros(score.shape, bool)
        for left, top, width, height in boxes.where(boxes.frames == first + number).boxes * HALF:
            x0, y0, x1, y1 = (max(0, round(value)) for value in (left, top, left + width, top + height))
            near[max(0, y0 - APART) : y1 + APART, max(0, x0 - APART) : x1 + APART] = True
            if score[y0:y1, x0:x1].size:
                inside.append((slice(y0, y1), slice(x0, x1)))
        places.append((inside, near))
    rows = []
    for level in np.quantile(np.stack(scores)[:, ::2, ::2], 1 - SHARES):
        masks = [close_open(score > level, 3, 5) for score in scores]
        covered = [mask[at].mean() for mask, (inside, _) in zip(masks, places, strict=True) for at in inside]
        outside = [(mask & ~near).mean() for mask, (_, near) in zip(masks, places, strict=True)]
        rows.append((100 * np.mean(outside), np.mean(covered), level))
    found = np.array(rows)
    return found[found[:, 0].argsort()]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("video", type=Path)
    parser.add_argument("boxes", type=Path)
    parser.add_argument("--models", nargs="+", default=["spatial", "auto", "gaussian", "kde"])
    parser.add_argument("--set", nargs="+", default=[], help="MODEL.KEY=NUMBER")
    arguments = parser.parse_args()
    settings: dict[str, dict[str, float]] = {name: {} for name in arguments.models}
    for given in arguments.set:
        key, value = given.split("=")
        settings[key.split(".")[0]][key.split(".")[1]] = float(value)
    with open_pictures(arguments.video) as source:
        rate = float(source.frame_rate)
        first = round(LEARN_S * rate) + BEGIN
        pictures = [reduce_image(picture, HALF) for _, _, picture in islice(source, first + JUDGED)]
    boxes = read_boxes(arguments.boxes)
    for name in arguments.models:
        outside, covered, levels = curve(scores_of(name, pictures, rate, settings[name]), boxes, first).T
        told = ((at, np.interp(at, outside, covered), np.interp(at, outside, levels)) for at in OUTSIDE)
        print(f"{name:9s}", *(f"{share:.3f} at {at:.2f} % ({level:.1f})" for at, share, level in told), flush=True)


if __name__ == "__main__":
    main()
