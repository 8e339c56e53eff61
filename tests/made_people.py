"""People made of a head, a trunk and two legs who walk over flat ground before a fixed camera, with their truth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

WIDTH, HEIGHT = 320, 240
OFFSET, SLOPE = 20.0, 0.25
"""A person whose feet are in row y is OFFSET + SLOPE y pixels tall."""
ASPECT = 0.36
SKIN = (120, 150, 200)
CLOTHES = (((40, 40, 200), (120, 60, 30)), ((40, 160, 40), (40, 40, 40)), ((200, 80, 40), (90, 90, 160)))
"""BGR of trunk and legs, one pair a person."""


@dataclass(frozen=True)
class Walker:
    """Somebody whose feet go from one place to another between two frames, both included."""

    start: tuple[float, float]
    stop: tuple[float, float]
    first: int
    last: int
    clothes: int = 0
    stature: float = 1.0
    breadth: float = 1.0

    def feet(self, frame: int) -> tuple[float, float] | None:
        """Column and row of the feet; None outside the frames."""
        if not self.first <= frame <= self.last:
            return None
        share = (frame - self.first) / max(1, self.last - self.first)
        return tuple(a + share * (b - a) for a, b in zip(self.start, self.stop))  # type: ignore[return-value]

    def box(self, frame: int) -> np.ndarray | None:
        """(4,) left, top, width, height; pixel i reaches from i to i + 1."""
        feet = self.feet(frame)
        if feet is None:
            return None
        height = self.stature * (OFFSET + SLOPE * feet[1])
        width = self.breadth * ASPECT * height
        return np.array([feet[0] - width / 2, feet[1] - height, width, height])


def empty_scene(seed: int = 0) -> np.ndarray:
    """(H, W, 3) uint8 BGR: soft stains of grey and green."""
    import cv2

    noise = np.random.default_rng(seed).normal(0, 40, (HEIGHT, WIDTH, 3)).astype(np.float32)
    stains = cv2.GaussianBlur(noise, (0, 0), 6) * 6
    return np.clip(stains + (130, 150, 140), 0, 255).astype(np.uint8)


def pole(left: int = 150, right: int = 170) -> np.ndarray:
    """(H, W) bool: a pole that stands before everybody."""
    mask = np.zeros((HEIGHT, WIDTH), bool)
    mask[:, left:right] = True
    return mask


def silhouette(box: np.ndarray, stride: float) -> list[tuple[slice, slice, int]]:
    """Rectangles of head (0), trunk (1) and legs (2); `stride` in 0..1 sets the legs apart."""
    left, top, width, height = box
    middle = left + width / 2

    def part(x0: float, x1: float, y0: float, y1: float, kind: int) -> tuple[slice, slice, int]:
        edges = [max(0, int(round(v))) for v in (top + y0 * height, top + y1 * height, x0, x1)]
        return slice(edges[0], edges[1]), slice(edges[2], edges[3]), kind

    apart = 0.05 * width + 0.25 * width * stride
    leg = 0.2 * width
    return [
        part(middle - apart - leg, middle - apart + leg, 0.5, 1.0, 2),
        part(middle + apart - leg, middle + apart + leg, 0.5, 1.0, 2),
        part(middle - 0.32 * width, middle + 0.32 * width, 0.15, 0.55, 1),
        part(middle - 0.18 * width, middle + 0.18 * width, 0.0, 0.16, 0),
    ]


def picture_of(
    walkers: list[Walker], frame: int, empty: np.ndarray, hidden: np.ndarray | None = None, seed: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """(picture, foreground) of a frame: the far ones first, sensor noise of 2 grey values."""
    picture, mask = empty.copy(), np.zeros(empty.shape[:2], bool)
    for colours, part in _painted(walkers, frame):
        picture[part[:2]] = colours[part[2]]
        mask[part[:2]] = True
    if hidden is not None:
        picture[hidden], mask = empty[hidden], mask & ~hidden
    noise = np.random.default_rng([seed, frame]).normal(0, 2, picture.shape)
    return np.clip(picture + noise, 0, 255).astype(np.uint8), mask


def mask_of(walkers: list[Walker], frame: int, hidden: np.ndarray | None = None) -> np.ndarray:
    """The foreground alone, (H, W) bool."""
    mask = np.zeros((HEIGHT, WIDTH), bool)
    for _, part in _painted(walkers, frame):
        mask[part[:2]] = True
    return mask if hidden is None else mask & ~hidden


def _painted(walkers: list[Walker], frame: int):
    """(colours, part) of everybody who is there, the far ones first."""
    there = [walker for walker in walkers if walker.box(frame) is not None]
    for walker in sorted(there, key=lambda walker: walker.feet(frame)[1]):  # type: ignore[index]
        for part in silhouette(walker.box(frame), abs(np.sin(0.5 * frame))):  # type: ignore[arg-type]
            yield (SKIN, *CLOTHES[walker.clothes]), part


def truth_of(walkers: list[Walker], frames: int) -> list[tuple[int, int, np.ndarray]]:
    """(frame, walker, box) of all who are there."""
    rows = [(frame, i, walker.box(frame)) for frame in range(frames) for i, walker in enumerate(walkers)]
    return [(frame, i, box) for frame, i, box in rows if box is not None]


CROWD = [
    Walker((20, 150), (300, 150), 0, 59, 0),
    Walker((300, 200), (20, 200), 5, 64, 1),
    Walker((60, 235), (260, 120), 20, 79, 2),
    Walker((250, 110), (40, 230), 30, 89, 0),
]
"""Enough people in enough places to tell how the ground lies."""


def part_boxes(walker: Walker, frame: int) -> np.ndarray:
    """(3, 4) left, top, width, height of head, trunk, and the legs' upper halves."""
    box = walker.box(frame)
    assert box is not None
    left, right, trunk, head = (
        [rows.start, rows.stop, columns.start, columns.stop]
        for rows, columns, _ in silhouette(box, abs(np.sin(0.5 * frame)))
    )
    legs = [left[0], (left[0] + left[1]) // 2, min(left[2], right[2]), max(left[3], right[3])]
    return np.array([[x0, y0, x1 - x0, y1 - y0] for y0, y1, x0, x1 in (head, trunk, legs)], dtype=np.float64)


def shots_of(walkers: list[Walker], frames: int, empty: np.ndarray, seed: int = 0):
    """As a rendered scene would be: pictures with who is where, part by part."""
    from muybridge.synthetic.crowd import PeopleShot

    for frame in range(frames):
        there = [k for k, walker in enumerate(walkers) if walker.box(frame) is not None]
        ids = np.zeros(empty.shape[:2], np.uint8)
        for k in sorted(there, key=lambda k: walkers[k].feet(frame)[1]):  # type: ignore[index]
            ids[mask_of([walkers[k]], frame)] = k + 1
        boxes = np.array([walkers[k].box(frame) for k in there]).reshape(-1, 4)
        parts = np.array([part_boxes(walkers[k], frame) for k in there]).reshape(-1, 3, 4)
        alone = [np.count_nonzero(mask_of([walkers[k]], frame)) for k in there]
        visible = np.array([np.count_nonzero(ids == k + 1) / max(1, n) for k, n in zip(there, alone)])
        yield PeopleShot(picture_of(walkers, frame, empty, seed=seed)[0], ids, np.array(there, np.int64) + 1, boxes,
                         visible, parts, np.repeat(visible[:, None], 3, axis=1))  # fmt: skip
