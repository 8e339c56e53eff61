"""D of (4.13) worked out by hand, and what it prefers in a picture with a target, a look-alike and background."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.people.box import states_from_boxes
from muybridge.people.colour_likelihood import ColourConfig, ColourTarget, updated_background
from muybridge.people.histograms import count_histograms

TARGET = states_from_boxes(np.array([[20, 10, 12, 30]]))[0]


@pytest.fixture
def scene() -> tuple[np.ndarray, np.ndarray]:
    """Picture and background (60, 80, 3), taken as Y Cr Cb: a target with two colours before soft noise."""
    rng = np.random.default_rng(3)
    background = rng.integers(90, 140, (60, 80, 3), dtype=np.uint8)
    picture = np.clip(background + rng.normal(0, 2, background.shape), 0, 255).astype(np.uint8)
    picture[10:25, 20:32] = rng.integers(30, 60, (15, 12, 3))
    picture[25:40, 20:32] = rng.integers(160, 200, (15, 12, 3))
    return picture, background


def test_by_hand(scene: tuple[np.ndarray, np.ndarray]) -> None:
    picture, background = scene
    config = ColourConfig(spread=0.3, floor=0.05)
    target = ColourTarget.learn(picture, TARGET, config)
    boxes = np.array([[20, 10, 32, 40], [24, 12, 36, 42], [50, 20, 62, 50]])
    states = states_from_boxes(np.column_stack([boxes[:, :2], boxes[:, 2:] - boxes[:, :2]]))
    z, b = (count_histograms(image, target.bins, boxes) for image in (picture, background))
    distance = np.linalg.norm(z - target.histogram, axis=1) / np.maximum(np.linalg.norm(z - b, axis=1), 0.05)
    # float32 sums of 24 terms below 1: some 24 roundings of 6e-8.
    np.testing.assert_allclose(target.observe(picture, background).distances(states), distance, rtol=5e-6, atol=1e-7)
    np.testing.assert_allclose(
        target.observe(picture, background).log_prob(states), -0.5 * (distance / 0.3) ** 2, rtol=1e-5, atol=1e-6
    )
    assert distance[0] == 0


def test_the_target_is_the_best_place(scene: tuple[np.ndarray, np.ndarray]) -> None:
    """Of all places of a box of its size, none but its neighbours comes near; background is worst of all."""
    picture, background = scene
    likelihood = ColourTarget.learn(picture, TARGET).observe(picture, background)
    x, y = np.meshgrid(np.arange(6, 74), np.arange(15, 45))
    states = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 12.0), np.full(x.size, 30.0)]).astype(float)
    distances = likelihood.distances(states)
    best = states[np.argmin(distances)]
    assert np.abs(best[:2] - TARGET[:2]).max() <= 1
    elsewhere = np.abs(states[:, :2] - TARGET[:2]).max(axis=1) > 30
    assert distances[elsewhere].min() > 1 > distances.min()


def test_no_box_without_pixels_is_possible(scene: tuple[np.ndarray, np.ndarray]) -> None:
    picture, background = scene
    likelihood = ColourTarget.learn(picture, TARGET).observe(picture, background)
    outside = np.array([[-50.0, 20.0, 10.0, 10.0], TARGET[:4]])
    assert np.isneginf(likelihood.log_prob(outside)).tolist() == [True, False]


def test_asking_beyond_the_first_boxes_changes_nothing(scene: tuple[np.ndarray, np.ndarray]) -> None:
    picture, background = scene
    target = ColourTarget.learn(picture, TARGET)
    near, far = TARGET[None, :4], np.array([[70.0, 50.0, 14.0, 16.0]])
    likelihood = target.observe(picture, background)
    first = likelihood.log_prob(near)
    np.testing.assert_array_equal(likelihood.log_prob(far), target.observe(picture, background).log_prob(far))
    np.testing.assert_array_equal(likelihood.log_prob(near), first)


def test_models_follow_at_their_rates(scene: tuple[np.ndarray, np.ndarray]) -> None:
    """After n updates with the same Q, what is left of the first H is (1 - alpha)^n: (4.10), and (4.11) likewise."""
    picture, background = scene
    target = ColourTarget.learn(picture, TARGET, ColourConfig(update_rate=0.1))
    seen = np.full(24, 1 / 8, np.float32)
    later = target
    for _ in range(5):
        later = later.updated(seen)
    expected = seen + 0.9**5 * (target.histogram - seen)
    np.testing.assert_allclose(later.histogram, expected, rtol=0, atol=1e-6)
    moved = updated_background(background.astype(np.float32), picture, 0.25)
    np.testing.assert_allclose(moved, 0.75 * background + 0.25 * picture.astype(float), rtol=0, atol=1e-4)


def test_bad_settings_are_one_line() -> None:
    for wrong in ({"spread": 0.0}, {"floor": 0.0}, {"update_rate": 1.5}):
        with pytest.raises(InputError, match="colour likelihood"):
            ColourConfig(**wrong)
    with pytest.raises(InputError, match="update rate"):
        updated_background(np.zeros((2, 2, 3), np.float32), np.zeros((2, 2, 3), np.uint8), 2.0)
