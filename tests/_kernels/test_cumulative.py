"""Cumulative histogram maps against counting, exactly: the counts are whole numbers, and the shares one division."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge._kernels.cumulative import LARGEST_BOX, round_boxes
from muybridge.people.histograms import BinMap, count_histograms, cumulative_map
from reference.cumulative import shares


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(4)


def boxes_in(rng: np.random.Generator, count: int, width: int, height: int) -> np.ndarray:
    """Boxes of all sizes, some empty, some beyond the picture."""
    corners = np.sort(rng.integers(-6, (width + 6, height + 6), (count, 2, 2)), axis=1)
    return corners.reshape(count, 4)


def test_against_counting_pixel_by_pixel(rng: np.random.Generator) -> None:
    image = rng.integers(0, 256, (23, 31, 3), dtype=np.uint8)
    bins = BinMap.equalising(image[4:15, 6:20])
    boxes = boxes_in(rng, 40, 31, 23)
    expected = [shares(image, bins.lanes, np.clip(box, 0, [31, 23, 31, 23])) for box in boxes]
    np.testing.assert_allclose(cumulative_map(image, bins).histograms(boxes), expected, rtol=0, atol=1e-7)
    np.testing.assert_allclose(count_histograms(image, bins, boxes), expected, rtol=0, atol=1e-7)


def test_maps_and_direct_histograms_are_equal_to_the_bit(rng: np.random.Generator) -> None:
    image = rng.integers(0, 256, (120, 160, 3), dtype=np.uint8)
    bins, boxes = BinMap.equalising(image), boxes_in(rng, 600, 160, 120)
    np.testing.assert_array_equal(cumulative_map(image, bins).histograms(boxes), count_histograms(image, bins, boxes))


def test_a_part_of_the_picture_is_enough(rng: np.random.Generator) -> None:
    image = rng.integers(0, 256, (60, 80, 3), dtype=np.uint8)
    bins = BinMap.even()
    boxes = boxes_in(rng, 50, 30, 25) + [20, 15, 20, 15]
    hull = boxes[:, 0].min(), boxes[:, 1].min(), boxes[:, 2].max(), boxes[:, 3].max()
    part = cumulative_map(image, bins, hull)
    assert part.table.shape[0] < 61 and part.table.shape[1] < 81
    np.testing.assert_array_equal(part.histograms(boxes), cumulative_map(image, bins).histograms(boxes))


def test_what_a_bin_carries_over_is_taken_back() -> None:
    """A picture of one colour with more pixels than a bin of the table holds; boxes hold fewer, and are exact."""
    side = 1460
    assert side * side > LARGEST_BOX
    image = np.full((side, side, 3), 77, np.uint8)
    image[-40:, -30:] = 200
    table = cumulative_map(image, BinMap.even())
    found = table.histograms(np.array([[side - 60, side - 80, side, side], [0, 0, 1400, 1400]]))
    expected = np.zeros((2, 24))
    expected[0, [77 // 32, 8 + 77 // 32, 16 + 77 // 32]] = 1 - 1200 / 4800
    expected[0, [200 // 32, 8 + 200 // 32, 16 + 200 // 32]] = 1200 / 4800
    expected[1, [77 // 32, 8 + 77 // 32, 16 + 77 // 32]] = 1
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-7)


def test_a_box_holds_the_pixels_whose_centres_it_holds() -> None:
    """A box of width 3 about x = 5 reaches from 3.5 to 6.5: pixels 4, 5, 6; about 5.5 from 4 to 7: 4, 5, 6 as well."""
    states = np.array([[5.0, 2.0, 3.0, 1.0], [5.5, 2.0, 3.0, 1.0], [5.6, 2.0, 3.0, 1.0]])
    out = np.empty((3, 4), np.int64)
    hull = round_boxes(states, out)
    assert out.tolist() == [[4, 2, 7, 3], [4, 2, 7, 3], [5, 2, 8, 3]]
    assert hull == (4, 2, 8, 3)
