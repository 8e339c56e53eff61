"""Picture -> foreground of all people: the light of the empty scene, a background model, closing and opening.

Of a plate, what differs clearly is foreground, and so is what differs faintly where the two touch: legs before a floor
of nearly their colour belong to a shirt, noise and what sways in the wind to nobody.

Differences from Zhao (2009), 6.1: the defaults open by 3 x 3, not 5 x 5, which a person of 60 pixels does not survive.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.people.blobs import Mask
from muybridge.people.things import Things
from muybridge.segmentation import BACKGROUND_MODELS, BackgroundModel, build_background, median_picture
from muybridge.segmentation.lasting import lasting_picture
from muybridge.segmentation.light import relit
from muybridge.segmentation.plate import PlateBackground
from muybridge.segmentation.plate_making import keep_touching
from muybridge.segmentation.shadows import remove_shadows

BORDER = 7  # side of the square, pixels, by which people are grown before the rest of a picture is learnt


@dataclass(frozen=True, kw_only=True)
class MaskConfig:
    """Settings of the foreground."""

    model: str = "plate"  # a name of `segmentation.BACKGROUND_MODELS`
    threshold: float = 15.0  # of that model; 15 suits `plate` at full resolution
    faint: float = 0.4  # of the threshold of `plate`: what differs so much counts where it touches what differs clearly
    shadows: bool = True  # whether what looks like a shadow is removed
    close: int = 3  # side of the closing, pixels; 1 leaves it out
    open: int = 3  # of the opening
    rest: int = 100  # pictures after which foreground that has not moved at all is a thing, no person; 0: never

    def __post_init__(self) -> None:
        if self.model not in BACKGROUND_MODELS:
            raise InputError("background model", expected=" | ".join(BACKGROUND_MODELS), got=repr(self.model))
        if not (self.threshold > 0 and 0 < self.faint <= 1 and self.close >= 1 and self.open >= 1 and self.rest >= 0):
            got = f"{self.threshold}, {self.faint}, {self.close}, {self.open}, {self.rest}"
            expected = "threshold above 0, faint above 0 up to 1, close and open from 1, rest from 0"
            raise InputError("foreground", expected=expected, got=got)


@dataclass(frozen=True, eq=False)
class Masks:
    """A trained model and what follows it.

    empty : (H, W, 3) uint8 BGR, the empty scene
    """

    model: BackgroundModel
    empty: NDArray[np.uint8]
    config: MaskConfig
    things: Things | None = None  # of a plate: other models learn them themselves

    @classmethod
    def train(
        cls, pictures: Sequence[NDArray[np.uint8]], config: MaskConfig | None = None, *, ended: bool = True
    ) -> Masks:
        """From pictures (H, W, 3) uint8 BGR in the order of time, far enough apart that people have moved.

        ended : whether the last is the end of a clip, see `lasting_picture`
        """
        config = config or MaskConfig()
        usual = median_picture(pictures)
        pictures = [relit(picture, usual) for picture in pictures]
        empty = lasting_picture(pictures, ended=ended)
        known = {field.name for field in fields(BACKGROUND_MODELS[config.model].config)}
        # Light is taken out of pictures before they come here: a model that does so itself would do it twice.
        wanted: dict[str, Any] = {"threshold": config.threshold, "light": False}
        settings = {name: value for name, value in wanted.items() if name in known}
        # A plate is one picture of the empty scene, which there is now; other models learn from many.
        shown = [empty] if config.model == "plate" else list(pictures)
        model = build_background(config.model, shown, **settings)
        things = Things(model, config.rest) if isinstance(model, PlateBackground) else None
        return cls(model, empty, config, things)

    def relit(self, picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """A picture (H, W, 3) uint8 BGR in the light of the empty scene: as all that looks at people wants it."""
        return relit(picture, self.empty)

    def apply(self, picture: NDArray[np.uint8]) -> Mask:
        """Foreground (H, W) bool of a picture (H, W, 3) uint8 BGR in the light of the empty scene."""
        if self.things is None:
            return self._cleaned(self.model.apply(picture), picture, self.empty)
        difference, background = self.things.compare(picture)
        faint = self._cleaned(difference > self.config.faint * self.config.threshold, picture, background)
        self.things.learn(picture, faint)
        return keep_touching(faint, self._opened(difference > self.config.threshold))

    def without_people(self, picture: NDArray[np.uint8], mask: Mask) -> NDArray[np.uint8]:
        """A picture (H, W, 3) that may be learnt: where its foreground (H, W) is, and around, the empty scene."""
        import cv2

        grown = cv2.dilate(mask.view(np.uint8), np.ones((BORDER, BORDER), np.uint8)).astype(bool)
        return np.where(grown[..., None], self.empty, picture)

    def _cleaned(self, mask: Mask, picture: NDArray[np.uint8], background: NDArray[np.uint8]) -> Mask:
        return self._opened(remove_shadows(mask, picture, background) if self.config.shadows else mask)

    def _opened(self, mask: Mask) -> Mask:
        """Closed, then opened."""
        import cv2

        whole: NDArray[Any] = mask.astype(np.uint8)
        for operation, side in ((cv2.MORPH_CLOSE, self.config.close), (cv2.MORPH_OPEN, self.config.open)):
            if side > 1:
                whole = cv2.morphologyEx(whole, operation, np.ones((side, side), np.uint8))
        return whole.astype(bool)
