"""Cleaning: what must go, what must stay."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.segmentation import CleaningConfig, clean, near
from muybridge.segmentation.cleaning import beside, drop_small, fill_holes, keep_near_main


def body():
    mask = np.zeros((120, 100), bool)
    mask[20:100, 40:60] = True
    return mask


def test_a_clean_body_stays_as_it_is_but_for_its_corners():
    mask = body()
    assert np.count_nonzero(clean(mask) ^ mask) <= 4  # a 3 x 3 median rounds each corner by one pixel


def test_a_forearm_next_to_the_body_stays_and_a_far_blob_goes():
    mask = body()
    mask[50:55, 64:76] = True  # 4 pixels beside the trunk
    mask[5:15, 2:12] = True  # 30 pixels and more away
    kept = clean(mask, CleaningConfig(gap=10))
    assert kept[52, 70] and not kept[10, 6]
    assert clean(mask, CleaningConfig(gap=np.inf))[10, 6]


def test_the_box_decides_which_component_is_the_person():
    mask = body()
    mask[60:90, 2:12] = True
    kept = keep_near_main(mask, 5, box=(0, 60, 15, 90))
    assert kept[70, 5] and not kept[70, 50]
    assert keep_near_main(mask, 5, box=(90, 0, 99, 10))[70, 50]  # an empty box falls back to the largest


def test_holes_up_to_a_size_are_filled_and_the_surroundings_never():
    mask = body()
    mask[40:43, 45:48] = False
    mask[60:70, 45:55] = False
    filled = fill_holes(mask, 9)
    assert filled[41, 46] and not filled[65, 50]
    assert np.array_equal(fill_holes(mask, 10**6)[:20], mask[:20])


def test_small_components_go():
    mask = body()
    mask[3:5, 3:5] = True
    assert np.array_equal(drop_small(mask, 5), body())
    assert np.array_equal(drop_small(mask, 4), mask)


@pytest.mark.parametrize("full", [False, True])
def test_empty_and_full_masks_pass(full):
    mask = np.full((30, 20), full)
    assert np.array_equal(clean(mask), mask)


def test_near_keeps_the_box_with_its_edges():
    mask = near(np.ones((10, 10), bool), (2, 3, 4, 5), margin=1)
    rows, columns = np.nonzero(mask)
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == (2, 6, 1, 5)


@pytest.mark.parametrize("settings", [{"median": 4}, {"median": 0}, {"gap": -1}])
def test_senseless_settings(settings):
    with pytest.raises(InputError):
        CleaningConfig(**settings)


def test_cleaning_a_part_equals_cleaning_the_whole():
    """`clean` works inside bounds and in fewer passes; the steps one after the other on the whole mask must agree."""
    rng = np.random.default_rng(0)
    for _ in range(20):
        mask = np.zeros((60, 50), bool)
        top, left = rng.integers(0, 30, 2)
        mask[top : top + 25, left : left + 20] = rng.random((25, 20)) < 0.7
        config, box = CleaningConfig(median=1, largest_hole=3, smallest_fragment=4, gap=2), (20.0, 20.0, 30.0, 30.0)
        whole = fill_holes(keep_near_main(drop_small(mask, 4), 2, box), 3)
        assert np.array_equal(clean(mask, config, box), whole)


def test_what_lies_beside_a_mask_is_a_border_as_wide_as_asked():
    mask = body()
    border = beside(mask, 2)
    assert not (border & mask).any() and border.sum() == 84 * 24 - 80 * 20
    assert border[18, 38] and not border[17, 50]
