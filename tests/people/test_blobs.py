"""People from masks whose answer is drawn: components, small ones, valleys."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.people.blobs import BlobConfig, components, find_people, valley

SMALL = BlobConfig(smallest=100)


def boxes(mask: np.ndarray, config: BlobConfig = SMALL) -> list[list[float]]:
    return [blob.box.tolist() for blob in find_people(mask, config)]


def empty() -> np.ndarray:
    return np.zeros((60, 120), bool)


def test_separate_people_from_left_to_right() -> None:
    mask = empty()
    mask[10:50, 80:95] = mask[20:55, 5:17] = True
    mask[5:8, 50:60] = True  # 30 pixels: noise
    assert boxes(mask) == [[5, 20, 12, 35], [80, 10, 15, 40]]
    assert [blob.area for blob in find_people(mask, SMALL)] == [12 * 35, 15 * 40]


def test_three_who_touch_are_cut_at_the_valleys() -> None:
    """Three trunks of 16 x 40 joined by arms of 6 x 4: 60 wide and 40 high is too wide for one, 38 wide passes."""
    mask = empty()
    for left in (10, 32, 54):
        mask[10:50, left : left + 16] = True
    mask[20:24, 10:70] = True
    found = boxes(mask, BlobConfig(smallest=100, widest=0.9))
    assert len(found) == 3
    for box, left in zip(found, (10, 32, 54)):
        assert abs(box[0] - left) <= 6 and abs(box[0] + box[2] - left - 16) <= 6 and box[3] == 40


def test_a_piece_that_is_too_small_goes() -> None:
    """As in the paper's figure 5.1: of two pieces, one is less than a person."""
    mask = empty()
    mask[10:50, 10:45] = True
    mask[44:50, 45:65] = True
    # The valley is columns 45 to 53, all 6 high (54 is too near the side); its middle is 49.
    assert boxes(mask, BlobConfig(smallest=400, widest=1.0)) == [[10, 10, 39, 40]]
    assert len(boxes(mask, BlobConfig(smallest=20, widest=1.0))) == 5  # negative control: the foot stays, in four


def test_a_block_without_a_valley_is_halved() -> None:
    mask = empty()
    mask[10:40, 10:60] = True
    assert boxes(mask, BlobConfig(smallest=100, widest=1.0)) == [[10, 10, 25, 30], [35, 10, 25, 30]]


def test_the_sides_are_no_valley() -> None:
    triangle = np.tri(20, 20, dtype=bool)
    assert valley(triangle, 0.2) == 15
    assert valley(np.ones((5, 1), bool), 0.2) is None


def test_pieces_hold_the_mask() -> None:
    """Property: pieces do not overlap, and each lies in the mask."""
    mask = np.random.default_rng(1).random((60, 120)) < 0.55
    seen = np.zeros(mask.shape, int)
    for blob in find_people(mask, BlobConfig(smallest=20, widest=0.8)):
        part = seen[blob.top : blob.top + blob.mask.shape[0], blob.left : blob.left + blob.mask.shape[1]]
        part += blob.mask
    assert seen.max() == 1 and not (seen > mask).any()


def test_bad_input_is_one_line() -> None:
    with pytest.raises(InputError, match="bool"):
        components(np.zeros((5, 5)), 1)
    with pytest.raises(InputError, match="blobs"):
        BlobConfig(margin=0.5)
