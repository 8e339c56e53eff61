"""Bin edges that fit the target: what equalising does, and that it tells apart what even bins do not."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.people.histograms import BinMap, cumulative_map, to_luma_chroma

ALL = np.array([[0, 0, 64, 64]])


def patch(centre: float, spread: float, seed: int) -> np.ndarray:
    """(64, 64, 3) uint8 of normal noise about one value, in all channels."""
    values = np.random.default_rng(seed).normal(centre, spread, (64, 64, 3))
    return np.clip(values.round(), 0, 255).astype(np.uint8)


def test_equal_shares_of_a_region_whose_values_are_all_different() -> None:
    """256 values, each 16 times: every bin takes 32 values, exactly."""
    region = np.repeat(np.arange(256), 16).reshape(64, 64)[..., None].repeat(3, axis=2).astype(np.uint8)
    histogram = cumulative_map(region, BinMap.equalising(region)).histograms(ALL)[0]
    np.testing.assert_array_equal(histogram, np.full(24, 1 / 8, np.float32))


def test_shares_differ_by_no_more_than_one_value_holds() -> None:
    """A value goes whole into a bin: a bin's share is 1/8 up to the share of the most frequent value."""
    region = patch(100, 9, 1)
    histogram = cumulative_map(region, BinMap.equalising(region)).histograms(ALL)[0]
    most = max(np.bincount(region[..., c].ravel()).max() for c in range(3)) / 4096
    assert np.abs(histogram - 1 / 8).max() <= most


def test_a_flat_region_keeps_bins_for_what_is_darker_and_brighter() -> None:
    bins = BinMap.equalising(np.full((4, 4, 3), 90, np.uint8))
    assert (bins.lanes[0, :90] == 0).all() and bins.lanes[0, 90] == 4 and (bins.lanes[0, 91:] == 7).all()


def test_colours_that_share_an_even_bin_are_told_apart() -> None:
    """The claim of 4.2.1: 132 and 144, 4 wide, lie in one even bin (128..159) and hardly overlap in equalised ones."""
    target, other = patch(132 + 8, 3, 2), patch(144 + 8, 3, 3)

    def distance(bins: BinMap) -> float:
        a, b = (cumulative_map(image, bins).histograms(ALL)[0] for image in (target, other))
        return float(np.linalg.norm(a - b))

    assert distance(BinMap.even()) < 0.2
    # Four standard deviations apart: nearly all of the other's pixels are in one channel's highest bin, so that each
    # channel's distance is nearly that of (1/8 .. 1/8) to (0 .. 0, 1), sqrt(7/8); over three channels sqrt(21/8) = 1.6.
    assert distance(BinMap.equalising(target)) > 1.4


def test_bad_input_is_one_line() -> None:
    for wrong in (np.zeros((4, 4), np.uint8), np.zeros((4, 4, 3))):
        with pytest.raises(InputError, match="picture"):
            to_luma_chroma(wrong)
    with pytest.raises(InputError, match="reference histogram"):
        BinMap.equalising(np.zeros((0, 3), np.uint8))
    with pytest.raises(InputError, match="bin map"):
        BinMap(np.zeros((3, 256), np.uint8))
