"""Plates of scenes that were never empty: a person who hardly leaves the place, and a picture of somebody elsewhere."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.segmentation import make_plate, median_picture

HEIGHT, WIDTH = 400, 480
SKIN, SHORTS = (120, 150, 215), (25, 25, 25)
OTHER = (60, 190, 60), (200, 60, 60)


def person(picture, left, trunk=SKIN, shorts=SHORTS):
    """100 wide and 200 high."""
    picture[120:240, left : left + 100] = trunk
    picture[240:320, left : left + 100] = shorts
    return picture


def empty_scene(rng):
    texture = rng.integers(90, 170, (HEIGHT // 16, WIDTH // 16, 1)) + rng.integers(
        -8, 8, (HEIGHT // 16, WIDTH // 16, 3)
    )
    return np.repeat(np.repeat(texture, 16, 0), 16, 1).astype(np.uint8)


def recording(elsewhere_left):
    """21 frames in which the person sways by 120 pixels about column 250, and the other picture, 4 % darker."""
    rng = np.random.default_rng(0)
    empty = empty_scene(rng)
    lefts = 200 + (60 * np.sin(np.arange(21) / 3)).round().astype(int)
    frames = [person(empty.copy(), left) for left in lefts]
    frames = [np.clip(frame + rng.normal(0, 2, frame.shape), 0, 255).astype(np.uint8) for frame in frames]
    return empty, frames, (person(empty.copy(), elsewhere_left, *OTHER) * 0.96).astype(np.uint8)


def wrong(plate, empty):
    return np.abs(plate.astype(int) - empty).max(2) > 25


@pytest.mark.parametrize("left", [375, 290])
def test_somebody_elsewhere_gives_the_empty_scene(left):
    """At 375 the two share 15 columns, at 290 nearly all of the other's, which only colour tells apart.

    Measured: no pixel wrong. Where the person never leaves the other's place (220 and less) a ghost remains.
    """
    empty, frames, elsewhere = recording(left)
    assert wrong(make_plate(frames, elsewhere), empty).mean() < 0.002
    # negative controls: each half alone holds a person of a tenth of the picture
    assert wrong(median_picture(frames), empty).mean() > 0.08
    assert wrong(elsewhere, empty).mean() > 0.08


def test_too_few_frames_and_other_sizes():
    _, frames, elsewhere = recording(360)
    with pytest.raises(InputError, match="3 or more"):
        make_plate(frames[:2], elsewhere)
    with pytest.raises(InputError, match="the size of the video"):
        make_plate(frames, elsewhere[:-8])
