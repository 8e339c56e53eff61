"""A drawn figure cut into its parts: the cuts where its colours change, the boxes in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.people.blobs import Blob
from muybridge.people.parts import PartConfig, best_cuts, decompose

HEIGHT, WIDTH = 100, 30


def figure(neck: int, waist: int) -> tuple[np.ndarray, Blob]:
    """A full block of three colours at (40, 20) in a picture."""
    picture = np.full((150, 120, 3), 128, np.uint8)
    for top, bottom, colour in (
        (0, neck, (200, 130, 120)),
        (neck, waist, (40, 200, 90)),
        (waist, HEIGHT, (90, 90, 210)),
    ):
        picture[20 + top : 20 + bottom, 40 : 40 + WIDTH] = colour
    return picture, Blob(40, 20, np.ones((HEIGHT, WIDTH), bool))


@pytest.mark.parametrize(("neck", "waist"), [(14, 50), (17, 52), (21, 57)])
def test_cuts_lie_where_the_colours_change(neck: int, waist: int) -> None:
    picture, blob = figure(neck, waist)
    own = picture[20:120, 40:70]
    assert best_cuts(own, blob.mask, PartConfig()) == (neck, waist)


def test_cuts_stay_within_reach() -> None:
    """Colours that change far from where a neck may be do not pull it there."""
    picture, blob = figure(35, 80)
    neck, waist = best_cuts(picture[20:120, 40:70], blob.mask, PartConfig())  # type: ignore[misc]
    assert 11 <= neck <= 23 and 46 <= waist <= 58


def test_boxes_in_closed_form() -> None:
    """n rows or columns that are full have a standard deviation of sqrt((n^2 - 1) / 12), (5.3), (5.4)."""
    picture, blob = figure(17, 52)
    parts = decompose(picture, blob, PartConfig(shrink=1.2))
    assert parts is not None
    rows = [17, 35, 24]  # the hip-leg section has 48 rows, of which the upper half is used
    expected = 2 * 1.2 * np.sqrt((np.array(rows) ** 2 - 1) / 12)
    np.testing.assert_allclose(parts[:, 3], expected)
    np.testing.assert_allclose(parts[:, 2], 2 * 1.2 * np.sqrt((WIDTH**2 - 1) / 12))
    np.testing.assert_allclose(parts[:, 0], 40 + (WIDTH - 1) / 2)
    np.testing.assert_allclose(parts[:, 1], 20 + np.array([0, 17, 52]) + (np.array(rows) - 1) / 2)
    assert (parts[:, 4:] == 0).all()


def test_arms_that_stick_out_widen_the_trunk_by_a_third_not_to_double() -> None:
    """30 rows of 30 pixels and 5 of 60: the variance is the mean of theirs, weighed by 900 and 300 pixels."""
    picture, _ = figure(17, 52)
    mask = np.zeros((HEIGHT, 60), bool)
    mask[:, 15:45] = True
    mask[25:30, :] = True  # both arms out
    parts = decompose(picture, Blob(25, 20, mask), PartConfig(shrink=1.2))
    assert parts is not None
    variance = (900 * (30**2 - 1) + 300 * (60**2 - 1)) / 12 / 1200
    np.testing.assert_allclose(parts[1, 2], 2.4 * np.sqrt(variance))
    assert parts[1, 2] < 1.34 * 2.4 * np.sqrt((30**2 - 1) / 12)


def test_too_little_to_cut() -> None:
    assert decompose(np.zeros((9, 9, 3), np.uint8), Blob(2, 2, np.ones((2, 3), bool))) is None


def test_bad_settings_are_one_line() -> None:
    with pytest.raises(InputError, match="whose sum is 1"):
        PartConfig(ratios=(0.2, 0.2, 0.2))
    with pytest.raises(InputError, match="reach"):
        PartConfig(reach=0.2)
