"""The score worked out pixel by pixel, and what it prefers: the target, what is hidden, others, background."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.people.box import states_from_boxes
from muybridge.people.contrast_likelihood import ContrastConfig, ContrastTarget
from reference.cumulative import contrast_score

TARGET, OTHER, BARE = states_from_boxes(np.array([[20, 9, 12, 30], [50, 9, 12, 30], [35, 9, 12, 30]]))
CONFIG = ContrastConfig(spread=0.5)


@pytest.fixture
def scene() -> tuple[np.ndarray, np.ndarray]:
    """Picture and background (60, 80, 3), as Y Cr Cb: the target dark above, bright below, and the other reversed."""
    rng = np.random.default_rng(3)
    background = rng.integers(90, 140, (60, 80, 3), dtype=np.uint8)
    picture = np.clip(background + rng.normal(0, 2, background.shape), 0, 255).astype(np.uint8)
    dark, bright = rng.integers(30, 60, (15, 12, 3)), rng.integers(160, 200, (15, 12, 3))
    picture[9:24, 20:32], picture[24:39, 20:32] = dark, bright
    picture[9:24, 50:62], picture[24:39, 50:62] = bright, dark
    return picture, background


def test_pixel_by_pixel(scene: tuple[np.ndarray, np.ndarray]) -> None:
    picture, background = scene
    target = ContrastTarget.learn(picture, TARGET, CONFIG)
    shown = np.ones(picture.shape[:2], bool)
    shown[:, 25:40] = False
    corners = np.array([[20, 9], [22, 12], [26, 9], [50, 9], [70, 20], [-6, 33], [27, 9]])
    states = states_from_boxes(np.column_stack([corners, np.full(7, 12), np.full(7, 30)]))
    expected = []
    for left, top in corners:
        bands = np.array([[left, top + 10 * k, left + 12, top + 10 * (k + 1)] for k in range(3)])
        expected.append(
            contrast_score(picture, background, shown, target.bins.lanes, bands, target.histogram, CONFIG.floor)
        )
    found = target.observe(picture, background, shown).log_prob(states) * 2 * CONFIG.spread**2
    # float32 sums of 24 terms of at most 1, over a contrast of at least 0.01: 24 * 6e-8 / 0.01 at the worst.
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1.5e-4)
    assert expected[-1] == 0


def test_order(scene: tuple[np.ndarray, np.ndarray]) -> None:
    """In units of 1 / (2 sigma^2): 1 for the target, 0 for what is hidden, -1 for background, others below 0.

    Background is not quite -1, since |z - b| is noise and not 0. Of the other the middle band is as the target's, half
    dark and half bright, which is a third of 1; the two others outweigh it. With one band the other is the target.
    """
    picture, background = scene
    shown = np.ones(picture.shape[:2], bool)
    shown[:, 65:] = False
    hidden = TARGET + np.array([47, 0, 0, 0, 0, 0])
    scale = 2 * CONFIG.spread**2
    target, hid, other, bare = (
        ContrastTarget.learn(picture, TARGET, CONFIG)
        .observe(picture, background, shown)
        .log_prob(np.array([TARGET, hidden, OTHER, BARE]))
        * scale
    )
    assert target == pytest.approx(1, abs=1e-4) and hid == 0
    assert -1.05 < bare < other < 0
    one = ContrastTarget.learn(picture, TARGET, ContrastConfig(spread=0.5, bands=1))
    assert one.observe(picture, background).log_prob(OTHER[None])[0] * scale == pytest.approx(1, abs=1e-4)


def test_what_is_hidden_is_not_learnt(scene: tuple[np.ndarray, np.ndarray]) -> None:
    picture, background = scene
    target = ContrastTarget.learn(picture, TARGET, CONFIG)
    shown = np.ones(picture.shape[:2], bool)
    shown[30:39] = False
    hidden = target.observe(picture, background, shown).histogram(OTHER)
    np.testing.assert_allclose(hidden.sum(axis=1) / 3, [1, 1, 0.1], atol=1e-6)
    assert target.updated(hidden) is target
    seen = target.observe(picture, background).histogram(OTHER)
    learnt = target.updated(seen).histogram
    np.testing.assert_allclose(learnt, 0.95 * target.histogram + 0.05 * seen, atol=1e-6)
    assert target.observe(picture, background).likeness(TARGET) == pytest.approx(1, abs=1e-3)


def test_bad_settings_are_one_line() -> None:
    for wrong in ({"spread": 0.0}, {"floor": 0.0}, {"update_rate": 1.5}, {"bands": 0}, {"learn_from": -1.0}):
        with pytest.raises(InputError, match="contrast likelihood"):
            ContrastConfig(**wrong)
