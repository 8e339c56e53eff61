"""What a made clip tells of its scene: the ground, the silhouette, the pole that hides people."""

from __future__ import annotations

import numpy as np
import pytest

from made_people import ASPECT, CROWD, HEIGHT, OFFSET, SLOPE, WIDTH, Walker, empty_scene, mask_of, pole
from muybridge.errors import InputError
from muybridge.people.blobs import BlobConfig
from muybridge.people.ground import GroundScale
from muybridge.people.occluders import find_occluders
from muybridge.people.scene import Scene, describe
from muybridge.people.silhouette import Silhouette

EMPTY = empty_scene()
GROUND = GroundScale(OFFSET, SLOPE, ASPECT)
SMALL = BlobConfig(smallest=100)


def busy(hidden: np.ndarray | None) -> list[np.ndarray]:
    """Masks of a path that is walked at three distances, 1 pixel a frame: a column sees a head of 8 pixels 8 times."""
    walkers = [Walker((10, feet), (310, feet), 300 * k, 300 * k + 299, k) for k, feet in enumerate((120, 150, 180))]
    return [mask_of(walkers, frame, hidden) for frame in range(900)]


def test_the_ground_is_found() -> None:
    masks = [mask_of(CROWD, frame) for frame in range(0, 90, 2)]
    scene = describe(EMPTY, masks, SMALL)
    assert scene.ground is not None and scene.size == (WIDTH, HEIGHT)
    for feet in (120.0, 160.0, 220.0):
        # Edges are whole pixels, both ends; and everybody's stature may be off by half a step of those that are tried,
        # 1.25 % of 75 pixels.
        assert abs(float(scene.ground.height(feet)) - (OFFSET + SLOPE * feet)) < 3


def test_the_silhouette_is_the_drawn_one() -> None:
    """Drawn: the head takes the middle third of the width, the trunk two thirds; beside the head there is nothing."""
    scene = describe(EMPTY, busy(None)[::6], SMALL)
    share = scene.silhouette.share
    assert share.shape == (8, 5)
    assert share[0, 0] < 0.1 and share[0, 4] < 0.1 and share[0, 2] > 0.8  # head
    assert (share[2:4, 1:4] > 0.8).all()  # trunk
    np.testing.assert_allclose(share, share[:, ::-1], atol=0.15)  # they walk one way, but stand upright


def test_the_pole_is_found_where_people_pass_and_nowhere_else() -> None:
    found = find_occluders(busy(pole()), GROUND)
    there = pole()
    heads, feet = 120 - 50, 180
    assert found[heads + 10 : feet - 10, 152:168].mean() > 0.9
    assert not found[:, :145].any() and not found[:, 175:].any()
    assert (found & ~there).sum() < 0.02 * there.sum()


def test_without_a_pole_nothing_is_found() -> None:
    assert not find_occluders(busy(None), GROUND).any()


def test_a_gap_wider_than_people_is_no_occluder() -> None:
    """Somebody is seen left and right of it, but it may be where nobody goes."""
    assert not find_occluders(busy(pole(110, 210)), GROUND).any()


def test_an_empty_clip_has_no_ground() -> None:
    scene = describe(EMPTY, [np.zeros((HEIGHT, WIDTH), bool)] * 5)
    assert scene.ground is None and scene.occluders is None and scene.silhouette.share.shape == (1, 1)


def test_drawn_occluders_are_added() -> None:
    drawn = np.zeros((HEIGHT, WIDTH), bool)
    drawn[:20, :20] = True
    scene = describe(EMPTY, busy(pole()), SMALL, drawn)
    assert scene.occluders is not None and scene.occluders[:20, :20].all() and scene.occluders[100, 160]
    with pytest.raises(InputError, match="occluders"):
        describe(EMPTY, busy(None), SMALL, drawn[:-1])


def test_bad_silhouettes_are_one_line() -> None:
    with pytest.raises(InputError, match="silhouette"):
        Silhouette(np.array([[1.5]]))
    assert Scene(EMPTY).silhouette.mean == pytest.approx(0.55)
