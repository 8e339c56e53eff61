"""Layers against their literal twins.

Bounds: compositing L = 3 layers in float32 is at most 3 L roundings of 2^-24 relative on values up to 255: 2e-4.
"""

from __future__ import annotations

import numpy as np
import pytest

from muybridge._kernels.layers import composite, mark_parts
from reference import layers as twins

ROUNDING = 255 * 9 * 2.0**-24


def random_layers(rng: np.random.Generator, count: int) -> tuple[np.ndarray, ...]:
    """A background, and layers that cover nothing, all or a part of a pixel, some at the same depth."""
    shape = (count, 7, 9)
    coverage = rng.choice([0.0, 0.25, 0.5, 1.0], shape).astype(np.float32)
    colours = (rng.uniform(0, 255, (*shape, 3)) * coverage[..., None]).astype(np.float32)
    depth = rng.choice([1.0, 2.0, 3.0, np.inf], shape).astype(np.float32)
    return rng.uniform(0, 255, (*shape[1:], 3)).astype(np.float32), coverage, colours, depth


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("count", [1, 2, 3])
def test_composite_is_its_twin(seed: int, count: int) -> None:
    background, coverage, colours, depth = random_layers(np.random.default_rng(seed), count)
    expected, seen = twins.composite(background, coverage, colours, depth)
    visible = np.zeros_like(coverage)
    composite(background, coverage, colours, depth, visible)
    np.testing.assert_allclose(background, expected, atol=ROUNDING, rtol=0)
    np.testing.assert_allclose(visible, seen, atol=1e-6)


def test_the_order_matters() -> None:
    """Negative control: with the depths turned round the twin's picture is another."""
    background, coverage, colours, depth = random_layers(np.random.default_rng(1), 3)
    expected, _ = twins.composite(background, coverage, colours, -depth)
    composite(background, coverage, colours, depth, np.zeros_like(coverage))
    assert np.abs(background - expected).max() > 1


@pytest.mark.parametrize("seed", range(5))
def test_marks_are_their_twin(seed: int) -> None:
    """Random corners are nowhere near an edge through a pixel's centre but with probability 0: no rounding to allow."""
    rng = np.random.default_rng(seed)
    pixels = rng.uniform(-4, 16, (12, 2))
    pixels[3] = np.nan
    faces = rng.permuted(np.tile(np.arange(12), (8, 1)), axis=1)[:, :3].astype(np.int32)
    parts = rng.integers(0, 32, 8).astype(np.int32)
    marks = np.zeros((11, 13), dtype=np.uint32)
    mark_parts(pixels, np.ones(12), faces, parts, marks)
    np.testing.assert_array_equal(marks, twins.mark_parts(pixels, faces, parts, 11, 13))
    assert marks.any()


def test_nothing_behind_the_camera_is_marked() -> None:
    marks = np.zeros((4, 4), dtype=np.uint32)
    pixels = np.array([[-1.0, -1.0], [9.0, -1.0], [-1.0, 9.0]])
    mark_parts(pixels, np.array([1.0, 1.0, -1.0]), np.array([[0, 1, 2]], np.int32), np.zeros(1, np.int32), marks)
    assert not marks.any()
