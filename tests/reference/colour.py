"""What `_kernels.colour` means: paint the segments far to near, count the bins of what stays visible."""

from __future__ import annotations

import numpy as np

from muybridge._kernels.outline import END, KIND
from muybridge.body.model import BodyArrays
from reference.silhouette import outlines, segment_mask


def depth_order(rows: np.ndarray) -> list[int]:
    """Segments that are seen, nearest first, by the mean depth of their ends."""
    depths = {k: row[END + 5] + row[END + 11] for k, row in enumerate(rows) if row[KIND] != 0}
    return sorted(depths, key=depths.__getitem__)


def label_image(pose: np.ndarray, arrays: BodyArrays, camera: np.ndarray) -> np.ndarray:
    """(H, W) int: which segment each pixel sees, -1 for none."""
    width, height = int(camera[23]), int(camera[24])
    labels = np.full((height, width), -1)
    rows = outlines(pose, arrays, camera)
    for k in reversed(depth_order(rows)):
        labels[segment_mask(rows[k], width, height)] = k
    return labels


def histograms(labels: np.ndarray, image: np.ndarray, segments: int) -> np.ndarray:
    """Counts (K, 3, 10)."""
    return np.array(
        [
            [np.histogram(image[labels == k][:, j], bins=10, range=(0, 256))[0] for j in range(3)]
            for k in range(segments)
        ]
    )


def distance(reference: np.ndarray, counts: np.ndarray, by_area: bool) -> float:
    """D of (5.5) or (5.3) over the segments that are seen."""
    areas = counts[:, 0].sum(axis=1)
    seen = np.flatnonzero(areas)
    shares = areas[seen] / areas[seen].sum() if by_area else np.full(len(seen), 1 / max(1, len(seen)))
    total = 0.0
    for k, share in zip(seen, shares, strict=True):
        for j in range(3):
            normalised = counts[k, j] / areas[k]
            total += share * np.sqrt(max(0.0, 1 - np.sum(np.sqrt(reference[k, j] * normalised))))
    return total
