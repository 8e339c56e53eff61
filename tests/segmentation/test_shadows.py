"""Which changes of light and colour count as a shadow."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.segmentation import ShadowConfig
from muybridge.segmentation.shadows import remove_shadows, shadow_mask

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


class TestNoise:
    """Half the light, and a sensor's noise of 3 grey values in every channel: L = 240 of light.

    A pixel's chromaticity then errs by two normal components of s = 3 / 240 = 0.0125 across the grey line; what may
    change is r = 0.025 (0.5 / 0.9)^2 = 0.0077. So 1 - exp(-(r / s)^2 / 2) = 17 % of the pixels pass by themselves.
    Means over 3 x 3 pixels err by a third of s, and may change by 0.015 (0.5 / 0.9)^2 = 0.0046: 46 %, and 99.8 % of the
    pixels are excused, since their own colour is within r + 9 / 240 = 0.045.
    """

    SIZE = 120  # squares of 9 pixels: 1600 of them; five standard errors of a share: 5 sqrt(.25 / 1600) = 0.06
    TOLERANCE = 0.06

    def shadow(self, change: float = 0.0) -> np.ndarray:
        clean = np.tile(changed(0.5, change), (self.SIZE, self.SIZE, 1))
        return clean + np.random.default_rng(0).normal(0.0, 3.0, clean.shape).astype(np.float32)

    def share(self, config: ShadowConfig, change: float = 0.0) -> float:
        plate = np.tile(WALL, (self.SIZE, self.SIZE, 1))
        return float(shadow_mask(self.shadow(change), plate, config).mean())

    def test_is_excused_by_the_square_around(self) -> None:
        """46 % of the squares, and some pixels besides that pass by themselves."""
        assert self.share(ShadowConfig(window=3, noise=3.0)) > 0.46 - self.TOLERANCE

    def test_means_may_be_trusted_as_far_as_pixels(self) -> None:
        """0.025 for both: 1 - exp(-(0.0077 / 0.0042)^2 / 2) = 82 % of the squares."""
        assert self.share(ShadowConfig(mean_change=0.025)) > 0.82 - self.TOLERANCE

    def test_is_not_excused_by_the_pixel_itself(self) -> None:
        for window, noise in ((1, 3.0), (1, 0.0)):
            share = self.share(ShadowConfig(window=window, noise=noise))
            assert share == pytest.approx(0.173, abs=self.TOLERANCE)

    def test_nor_where_there_should_be_none(self) -> None:
        """A sensor without noise: pixels have to pass by themselves."""
        assert self.share(ShadowConfig(window=3, noise=0.0)) == self.share(ShadowConfig(window=1, noise=0.0))

    def test_excuses_no_other_colour(self) -> None:
        """0.03 off, 5 standard deviations of a mean beyond r: as dark, but no shadow. Some pass by chance alone."""
        taken, alone = (self.share(ShadowConfig(window=window), change=0.03) for window in (3, 1))
        assert taken - alone < 1e-3 and taken < 0.05

    def test_nor_a_pixel_that_is_another(self) -> None:
        """One of another colour in an even shadow: its square passes, and its own colour is off by more than noise."""
        picture, plate = np.tile(changed(0.5, 0.0), (9, 9, 1)), np.tile(WALL, (9, 9, 1))
        for change, shadow in ((0.04, True), (0.05, False)):  # r + 9 / 240 = 0.0452
            picture[4, 4] = changed(0.5, change)[0, 0]
            found = shadow_mask(picture, plate)
            assert found[4, 4] == shadow and np.delete(found.ravel(), 40).all()

    @pytest.mark.parametrize("window", [1, 3, 5])
    def test_on_the_mask_alone_is_the_same(self, window: int) -> None:
        """`remove_shadows` looks at the mask's pixels and what surrounds them."""
        config = ShadowConfig(window=window)
        mask = np.zeros((self.SIZE, self.SIZE), bool)
        mask[30:70, 0:50] = mask[90:120, 80:110] = True
        picture, plate = self.shadow(), np.tile(WALL, (self.SIZE, self.SIZE, 1))
        kept = remove_shadows(mask, picture, plate, config)
        np.testing.assert_array_equal(kept, mask & ~shadow_mask(picture, plate, config))
        assert 0 < kept.sum() < mask.sum()


@pytest.mark.parametrize(
    ("setting", "value"),
    [
        ("sure_above", 0.0),
        ("mean_change", -0.1),
        ("window", 0),
        ("window", -3),
        ("noise", -0.1),
        ("noise", np.nan),
        ("chroma_change", -0.1),
    ],
)
def test_a_setting_that_makes_no_sense(setting: str, value: float) -> None:
    with pytest.raises(InputError, match=setting):
        ShadowConfig(**{setting: value})
