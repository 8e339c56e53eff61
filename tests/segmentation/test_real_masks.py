"""Masks of the man on the beam, at a quarter of the resolution.

Predicted: an earlier trial on these pictures found recall .91 and IoU .69 against a truth of its own. Here the truth is
made of capsules round the detected joints, which miss hands, feet and half of the shorts' width: cameras 3 and 4, whose
masks look perfect, reach recall .89 and IoU .77 (measured, 12 pictures). The bounds below leave the spread over frames,
.05.
"""

from __future__ import annotations

import json

import numpy as np
import pytest

from conftest import shared_data
from muybridge.datasets.fitting import fit_picture
from muybridge.io.image_sequence import read_image
from muybridge.io.video import open_pictures
from muybridge.segmentation import build_segmenter, mask_scores

LIMBS = (
    (5, 7, 0.045), (7, 9, 0.035), (6, 8, 0.045), (8, 10, 0.035), (11, 13, 0.075), (13, 15, 0.05), (12, 14, 0.075),
    (14, 16, 0.05), (17, 18, 0.08), (5, 11, 0.06), (6, 12, 0.06), (5, 12, 0.06), (6, 11, 0.06), (5, 6, 0.07),
    (11, 12, 0.07),
)  # fmt: skip
"""Pairs of detected points and the radius between them, metres."""
PIXELS_PER_METRE = {"cam03": 500, "cam04": 530}
"""On the beam at full resolution: focal length 1680 over a distance of 3.2 to 3.4 m."""


def capsules(points, seen, radius_unit, shape):
    rows, columns = np.indices(shape)
    grid = np.stack([columns, rows], -1).astype(float)
    mask = np.zeros(shape, bool)
    for a, b, radius in LIMBS:
        if seen[a] and seen[b]:
            along = points[b] - points[a]
            share = np.clip(((grid - points[a]) @ along) / max(along @ along, 1e-9), 0, 1)
            mask |= np.linalg.norm(grid - points[a] - share[..., None] * along, axis=-1) < radius * radius_unit
    return mask


@pytest.mark.parametrize("name", ["cam03", "cam04"])
def test_masks_of_the_man_on_the_beam(name):
    folder = shared_data("beam")
    with open_pictures(folder / "videos" / f"{name}.mp4") as video:
        plate = fit_picture(read_image(folder / "plates" / f"{name}_plate_1088x1920.png"), video.size)
        segmenter, scores = build_segmenter("plate", [plate]), []
        for index in (10, 50):
            mask = segmenter.apply(video.read(index))
            found = folder / "reference" / "openpose_body25b" / f"{name}_json" / f"{name}.{index:04d}.json"
            points = np.reshape(json.loads(found.read_text())["people"][0]["pose_keypoints_2d"], (-1, 3))
            truth = capsules(
                (points[:, :2] + 0.5) / 4 - 0.5, points[:, 2] > 0.05, PIXELS_PER_METRE[name] / 4, mask.shape
            )
            scores.append(mask_scores(mask, truth))
    assert np.mean([score["recall"] for score in scores]) > 0.84
    assert np.mean([score["iou"] for score in scores]) > 0.72
    # negative control: without the plate's own picture, a plate of the wrong camera frame scores nothing
    shifted = build_segmenter("plate", [np.roll(plate, 80, axis=1)]).apply(plate)
    assert mask_scores(shifted, truth)["iou"] < 0.3
