"""Chain and outline against matrices and densely sampled, exactly projected surfaces."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge._kernels.chain import segment_frames
from muybridge._kernels.draw import outline_spans
from muybridge._kernels.outline import KIND, OUTLINE_COLUMNS, outlines_of, row_span
from muybridge.body import Body, Segment, Shape
from reference import chain as slow_chain
from reference import outline as slow
from reference.scene import WIDE, camera, count, random_poses, rows, standing
from reference.silhouette import outlines


@pytest.mark.parametrize("name", ["person", "bodytrack"])
def test_chain_is_a_product_of_matrices(name):
    body, pose = standing(name)
    poses = random_poses(np.random.default_rng(1), pose, 5, 1.0, 2.0)
    fast = segment_frames(poses, *body.arrays[:4])
    # a chain is at most 6 segments with 3 turns of 4 rounded products each: some 100 roundings of numbers below 10
    np.testing.assert_allclose(fast, [slow_chain.frames(p, body.arrays) for p in poses], atol=1e-13 * 10)


@pytest.mark.parametrize("distortion", [(0.0,) * 5, WIDE])
@pytest.mark.parametrize("name", ["person", "bodytrack"])
def test_spans_are_the_sampled_hull_to_half_a_pixel(name, distortion):
    """Also with distortion, where lines are no longer straight; 320 x 240, the person 200 pixels tall."""
    body, pose = standing(name)
    view = camera(0.3, (320, 240), distortion=distortion)
    worst = 0.0
    for p in random_poses(np.random.default_rng(2), pose, count(4)):
        frames = segment_frames(p[None], *body.arrays[:4])[0]
        for outline, s in zip(outlines(p, body.arrays, rows(view)[0]), body.arrays.shaped, strict=True):
            corners = slow.hull(view, frames[s], body.arrays.ends[s], body.arrays.half_axes[s])
            low, high = corners[:, 1].min(), corners[:, 1].max()
            for y in range(int(np.ceil(low + 0.5)), int(np.floor(high - 0.5)) + 1, 3):
                worst = max(worst, _distance_to_span(corners, *row_span(outline, float(y)), y))
    assert worst < 0.5


def _distance_to_span(corners, left, right, y):
    """How far the two ends of a span lie from the polygon's outline (not along the row: a flat cap is nearly
    parallel to it).
    """
    a, b = corners, np.roll(corners, -1, axis=0)
    distances = []
    for x in (left, right):
        along = np.clip(
            ((x - a[:, 0]) * (b - a)[:, 0] + (y - a[:, 1]) * (b - a)[:, 1])
            / np.maximum(1e-12, np.sum((b - a) ** 2, axis=1)),
            0,
            1,
        )
        nearest = a + along[:, None] * (b - a)
        distances.append(np.min(np.hypot(nearest[:, 0] - x, nearest[:, 1] - y)))
    return max(distances)


def test_vector_spans_are_the_rows_spans():
    body, pose = standing()
    view = rows(camera(0.3))[0]
    first, last = np.zeros(96, np.int64), np.zeros(96, np.int64)
    for p in random_poses(np.random.default_rng(3), pose, count(12), 0.4, 0.6):
        for outline in outlines(p, body.arrays, view):
            if outline[KIND] == 0:
                continue
            top, number, word, end = outline_spans(outline, 96, 72, first, last)
            for y in range(72):
                left, right = row_span(outline, float(y))
                wanted = [x for x in range(96) if left <= x <= right]
                drawn = list(range(first[y - top], last[y - top] + 1)) if top <= y < top + number else []
                assert drawn == wanted
                assert all(word <= x // 64 < end for x in wanted)


@pytest.mark.parametrize("distance", [-4.0, -0.3, 0.0, 0.03])
def test_behind_the_camera_nothing_is_drawn(distance):
    body, pose = standing()
    pose[:3] = 0.0
    view = camera(0.0, distance=4.0)
    behind = pose + np.r_[4.0 - distance, np.zeros(len(pose) - 1)]
    for outline, s in zip(outlines(behind, body.arrays, rows(view)[0]), body.arrays.shaped, strict=True):
        frame = segment_frames(behind[None], *body.arrays[:4])[0][s]
        depths = [view.world_to_camera(frame[:, :3] @ end + frame[:, 3])[2] for end in body.arrays.ends[s]]
        assert (outline[KIND] == 0) == (min(depths) <= 0.05)
        assert np.all(np.isfinite(outline)) or outline[KIND] == 0


@pytest.mark.parametrize("ends", ["round", "flat", "sphere"])
def test_any_cone_is_the_sampled_hull_to_half_a_pixel(ends):
    """Radii of 2 to 15 cm, any direction (flat ends also edge on), elliptical, 4 m away.

    The first-order ellipse of a rounded end is off by its share of the depth squared, (0.15 / 4)^2 of 15 pixels.
    """
    rng, view = np.random.default_rng(21), camera(0.0, (320, 240), distortion=WIDE)
    worst = 0.0
    for _ in range(count(120)):
        arrays = Body("cone", (Segment("cone", shape=_random_shape(rng, ends)),)).arrays
        rotation, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        frame = np.column_stack([rotation, rng.uniform(-0.6, 0.6, 3)])
        out = np.empty((1, OUTLINE_COLUMNS))
        outlines_of(rows(view)[0], frame[None], arrays.shaped, arrays.ends, arrays.half_axes, out)
        corners = slow.hull(view, frame, arrays.ends[0], arrays.half_axes[0])
        for y in range(int(np.ceil(corners[:, 1].min() + 0.5)), int(corners[:, 1].max() - 0.5) + 1, 2):
            worst = max(worst, _distance_to_span(corners, *row_span(out[0], float(y)), y))
    assert worst < 0.5


def _random_shape(rng, ends):
    length = 0.0 if ends == "sphere" else rng.uniform(0.1, 0.5)
    first, second = rng.uniform(0.02, 0.15, 2)
    radii = (first, first) if ends == "sphere" else (first, second)
    return Shape(
        (0.0, 0.0, 0.0), (0.0, 0.0, length), radii, tuple(rng.uniform(0.5, 1.0, 2)), round_ends=ends == "round"
    )
