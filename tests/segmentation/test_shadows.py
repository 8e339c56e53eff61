"""Which changes of light and colour count as a shadow."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.segmentation import ShadowConfig
from muybridge.segmentation.shadows import shadow_mask

WALL = np.array([150.0, 160.0, 170.0], np.float32)


def changed(ratio: float, change: float) -> np.ndarray:
    """The wall with its brightness scaled and its chromaticity moved by `change` (Euclidean): (1, 1, 3)."""
    chroma = WALL / WALL.sum() + change / np.sqrt(2.0) * np.array([-1.0, 0.0, 1.0])
    return (WALL.sum() * ratio * chroma).astype(np.float32)[None, None]


@pytest.mark.parametrize(
    ("ratio", "change", "shadow"),
    [
        (0.95, 0.024, True),  # hardly darker: all of 0.025 is forgiven
        (0.95, 0.026, False),
        (0.6, 0.0105, True),  # 0.025 (0.6 / 0.9)^2 = 0.0111
        (0.6, 0.0117, False),
        (0.46, 0.0, True),
        (0.44, 0.0, False),  # darker than any shadow
        (1.04, 0.0, True),
        (1.06, 0.0, False),
    ],
)
def test_the_darker_the_less_colour_may_change(ratio: float, change: float, shadow: bool) -> None:
    assert shadow_mask(changed(ratio, change), WALL[None, None])[0, 0] == shadow


def test_a_setting_that_makes_no_sense() -> None:
    with pytest.raises(InputError, match="sure_above"):
        ShadowConfig(sure_above=0.0)
