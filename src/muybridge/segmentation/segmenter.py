"""The chain picture -> reduction -> background model -> shadows -> cleaning -> mask, itself a background model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from muybridge.segmentation.cleaning import Box, CleaningConfig, clean
from muybridge.segmentation.pictures import has_colour, reduce_image
from muybridge.segmentation.registry import BackgroundModel, build_background
from muybridge.segmentation.shadows import ShadowConfig, remove_shadows


@dataclass(frozen=True)
class Segmenter:
    """Full-size pictures in, masks at `factor` times the size out.

    The settings are fixed; the model inside may learn on line where its own settings say so.
    """

    model: BackgroundModel
    """Trained at `factor` times the pictures' size."""
    factor: float = 0.25
    """Reduction before anything else, in (0, 1]; masks have the reduced size."""
    shadows: ShadowConfig | None = None
    """None leaves shadows in."""
    cleaning: CleaningConfig | None = None
    """None leaves the mask as the model gave it."""

    def apply(self, image: NDArray, box: Box | None = None) -> NDArray:
        """Foreground (H', W') bool of a picture (H, W) or (H, W, 3) uint8.

        `box`: where the person is expected (left, top, right, bottom), pixels of the mask; see `cleaning.clean`.
        """
        picture = reduce_image(image, self.factor)
        background = getattr(self.model, "background", None)
        mask = self.model.apply(picture)
        if self.shadows is not None and background is not None:
            mask = remove_shadows(mask, picture, background, self.shadows)
        return mask if self.cleaning is None else clean(mask, self.cleaning, box)


def build_segmenter(
    name: str = "plate",
    pictures: Sequence[NDArray] = (),
    *,
    factor: float = 0.25,
    shadows: ShadowConfig | bool | None = None,
    cleaning: CleaningConfig | None = CleaningConfig(),  # noqa: B008 - frozen
    **settings: Any,
) -> Segmenter:
    """A segmenter of the model `name`, trained on full-size pictures of the empty scene.

    Parameters
    ----------
    pictures : sequence of (H, W) or (H, W, 3) uint8
    factor : float
        Reduction, in (0, 1].
    shadows : ShadowConfig or bool, optional
        None: removed where the empty scene has colour. Without colour the test costs more of the person than it gains.
    cleaning : CleaningConfig, optional
        None leaves it out.
    settings
        Fields of the model's config.
    """
    reduced = [reduce_image(picture, factor) for picture in pictures]
    if shadows is None:
        shadows = any(map(has_colour, reduced))
    if isinstance(shadows, bool):
        shadows = ShadowConfig() if shadows else None
    return Segmenter(build_background(name, reduced, **settings), factor, shadows, cleaning)
