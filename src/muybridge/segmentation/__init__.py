"""Picture -> mask: which pixels show the person.

=============  ==============================================  =================================================
name           a pixel is foreground where                      choose it when
=============  ==============================================  =================================================
`plate`        it differs from a picture of the empty scene     there is a clean plate, or one can be made
`gaussian`     it leaves the range seen in N empty pictures     there is a clip of the empty scene (paper, 5.1)
`hue_key`      its hue is not the screen's                      the person stands before a blue or green screen
=============  ==============================================  =================================================

A model alone is `model.apply(image)`; a `Segmenter` adds what comes before (reduction) and after (shadows, cleaning).
"""

from muybridge.segmentation.cleaning import CleaningConfig, clean, near
from muybridge.segmentation.gaussian import GaussianBackground, GaussianConfig
from muybridge.segmentation.hue_key import HueKey, HueKeyConfig
from muybridge.segmentation.pictures import has_colour, median_picture, reduce_image
from muybridge.segmentation.plate import PlateBackground, PlateConfig
from muybridge.segmentation.plate_making import make_plate
from muybridge.segmentation.registry import BACKGROUND_MODELS, BackgroundModel, build_background
from muybridge.segmentation.scores import mask_scores
from muybridge.segmentation.segmenter import Segmenter, build_segmenter
from muybridge.segmentation.shadows import ShadowConfig, remove_shadows, shadow_mask

__all__ = [
    "BACKGROUND_MODELS",
    "BackgroundModel",
    "CleaningConfig",
    "GaussianBackground",
    "GaussianConfig",
    "HueKey",
    "HueKeyConfig",
    "PlateBackground",
    "PlateConfig",
    "Segmenter",
    "ShadowConfig",
    "build_background",
    "build_segmenter",
    "clean",
    "has_colour",
    "make_plate",
    "mask_scores",
    "median_picture",
    "near",
    "reduce_image",
    "remove_shadows",
    "shadow_mask",
]
