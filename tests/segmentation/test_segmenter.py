"""Reduction, shadows and the whole chain, on made pictures."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.segmentation import (
    ShadowConfig,
    build_segmenter,
    has_colour,
    mask_scores,
    median_picture,
    reduce_image,
    remove_shadows,
    shadow_mask,
)


def scene(rng, height=120, width=160):
    """An empty scene with texture, and the same with a person and the person's shadow."""
    texture = 90 + 60 * rng.random((height // 8, width // 8, 3))
    empty = np.repeat(np.repeat(texture, 8, 0), 8, 1)
    picture = empty.copy()
    person, shadow = np.zeros((height, width), bool), np.zeros((height, width), bool)
    person[24:104, 60:84], shadow[96:112, 84:132] = True, True
    picture[shadow] *= 0.65
    picture[person] = (60, 90, 200)
    noise = rng.normal(0, 3, (2, height, width, 3))
    empty, picture = (np.clip(np.rint(a), 0, 255).astype(np.uint8) for a in (empty + noise[0], picture + noise[1]))
    return empty, picture, person, shadow


def grey_decoded(picture):
    """The first channel three times, as a reader of colour pictures gives a grey recording."""
    return np.repeat(picture[..., :1], 3, axis=2)


def test_reduction_is_the_mean_over_each_block():
    picture = np.random.default_rng(0).integers(0, 256, (8, 12, 3), dtype=np.uint8)
    expected = picture.reshape(2, 4, 3, 4, 3).mean((1, 3))
    assert np.abs(reduce_image(picture, 0.25).astype(float) - expected).max() <= 0.5  # rounding
    assert reduce_image(picture, 1) is picture
    assert reduce_image(picture[:, :11], 0.25).shape == (2, 2, 3)  # what is left over is dropped
    assert reduce_image(picture, 0.4).shape == (3, 5, 3)
    with pytest.raises(InputError):
        reduce_image(picture, 1.5)


def test_reduction_keeps_the_centroid_where_the_camera_expects_it():
    """u' = (u + 0.5) factor - 0.5, exact for a blob whose edges lie on block borders."""
    picture = np.zeros((40, 80), np.uint8)
    picture[8:20, 16:36] = 240
    small = reduce_image(picture, 0.25)
    for full, reduced in zip(np.nonzero(picture), np.nonzero(small), strict=True):
        assert reduced.mean() == pytest.approx((full.mean() + 0.5) * 0.25 - 0.5)


def test_median_picture_leaves_invalid_pixels_out():
    pictures = [np.full((2, 2, 3), value, np.uint8) for value in (10, 20, 90, 100, 110)]
    valid = [np.full((2, 2), True) for _ in pictures]
    for mask in valid[2:]:
        mask[0, 0] = False
    valid[4][0, 1] = False
    for mask in valid:
        mask[1, 1] = False
    median = median_picture(pictures, valid)
    assert median[0, 0, 0] == 15 and median[0, 1, 0] == 55 and median[1, 0, 0] == 90 and median[1, 1, 0] == 90
    assert median_picture(pictures)[0, 0, 0] == 90


def test_the_shadow_test_takes_the_shadow_and_leaves_the_person():
    empty, picture, person, shadow = scene(np.random.default_rng(1))
    small = [reduce_image(image, 0.25) for image in (picture, empty)]
    found = shadow_mask(*small)
    assert found[shadow[::4, ::4]].mean() > 0.95
    assert found[person[::4, ::4]].mean() < 0.05
    mask = np.random.default_rng(0).random(found.shape) < 0.5
    assert np.array_equal(remove_shadows(mask, *small), mask & ~found)


def test_grey_shadows_need_an_even_ratio():
    rng = np.random.default_rng(2)
    empty = np.repeat(np.repeat(rng.integers(80, 200, (15, 20)), 8, 0), 8, 1).astype(float)
    picture = empty.copy()
    picture[20:60, 20:60] *= 0.7
    other_texture = rng.permutation(empty[20:60, 80:120].ravel()).reshape(40, 40)
    picture[20:60, 80:120] = 0.7 * other_texture
    shadow = shadow_mask(picture.astype(np.uint8), empty.astype(np.uint8))
    assert shadow[25:55, 25:55].all()
    assert shadow[25:55, 85:115].mean() < 0.05


def test_a_dark_plate_is_never_shadow():
    dark = np.full((6, 6, 3), 5, np.uint8)
    assert not shadow_mask(dark, dark).any()


def test_the_chain_finds_the_person_without_the_shadow():
    empty, picture, person, _ = scene(np.random.default_rng(3))
    truth = reduce_image(person.astype(np.uint8) * 255, 0.25) > 127
    mask = build_segmenter("plate", [empty]).apply(picture)
    scores = mask_scores(mask, truth)
    # a 3 x 3 median costs the person's 4 corners of 120 pixels; nothing else may go
    assert scores["recall"] > 0.96 and scores["iou"] > 0.9
    with_shadow = build_segmenter("plate", [empty], shadows=False).apply(picture)
    assert mask_scores(with_shadow, truth)["iou"] < 0.8  # negative control: the shadow is a third of the person


@pytest.mark.parametrize("name", ["plate", "gaussian", "hue_key"])
def test_the_chain_runs_with_every_model_and_reduction(name):
    empty, picture, *_ = scene(np.random.default_rng(4))
    for factor in (1, 0.5, 0.25):
        mask = build_segmenter(name, [empty] * 5, factor=factor).apply(picture)
        assert mask.shape == (int(120 * factor), int(160 * factor)) and mask.dtype == bool


def test_scores_of_known_masks():
    truth, mask = np.zeros((4, 4), bool), np.zeros((4, 4), bool)
    truth[:2], mask[1:] = True, True
    assert mask_scores(mask, truth) == {"recall": 0.5, "precision": 4 / 12, "iou": 0.25}
    assert mask_scores(~mask & mask, truth & ~truth)["iou"] == 1


def test_shadows_are_removed_in_colour_only_unless_said():
    empty, *_ = scene(np.random.default_rng(5))
    assert build_segmenter("plate", [empty]).shadows == ShadowConfig()
    assert build_segmenter("plate", [empty[..., 0]]).shadows is None
    assert build_segmenter("plate", [grey_decoded(empty)]).shadows is None
    assert build_segmenter("hue_key").shadows is None  # nothing to compare with
    assert build_segmenter("plate", [empty[..., 0]], shadows=True).shadows == ShadowConfig()
    assert build_segmenter("plate", [empty], shadows=False).shadows is None


def test_colour_is_a_difference_between_channels():
    """One step of a video's chroma, 3 levels, is none; one pixel of colour is enough."""
    grey = grey_decoded(np.random.default_rng(6).integers(0, 250, (8, 8, 3), dtype=np.uint8))
    assert not has_colour(grey) and not has_colour(grey[..., 0]) and not has_colour(grey[..., :1])
    assert not has_colour(grey + np.uint8([0, 3, 0]))
    grey[4, 5, 2] += 4
    assert has_colour(grey)


@pytest.mark.parametrize("settings", [{"darkest": 1.2}, {"chroma_change": -1}])
def test_senseless_shadow_settings(settings):
    with pytest.raises(InputError):
        ShadowConfig(**settings)
