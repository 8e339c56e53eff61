"""Picture -> mask: which pixels show the person.

=============  ==============================================  =====================================================
name           a pixel is foreground where                      choose it when
=============  ==============================================  =====================================================
`plate`        it differs from a picture of the empty scene     there is a clean plate, or one can be made
`gaussian`     it leaves the range seen in N empty pictures     there is a clip of the empty scene (Du 2005, 5.1)
`hue_key`      its hue is not the screen's                      the person stands before a blue or green screen
`mixture`      it matches no mode that is seen often            the background has several states; people pass quickly
`spatial`      its colour does not go with its partners'        it moves in blobs; people linger (Zhao 2009, ch. 3)
`auto`         no Gaussian its partners go with is near         nothing is known about the scene
`kde`          none of its recent colours is near               leaves, water; little memory matters (Elgammal 2002)
`mog2`, `knn`  OpenCV says so                                   speed is all, or to compare
=============  ==============================================  =====================================================

A model alone is `model.apply(image)`; most also have `model.score(image)`. A `Segmenter` adds what comes before
(reduction) and after (shadows, cleaning); `masks_of` goes through a stream, and starts a model anew when the scene
has changed.
"""

from muybridge.segmentation.auto import AutoBackground, AutoConfig
from muybridge.segmentation.cleaning import CleaningConfig, clean, close_open, near
from muybridge.segmentation.gaussian import GaussianBackground, GaussianConfig
from muybridge.segmentation.hue_key import HueKey, HueKeyConfig
from muybridge.segmentation.kde import KdeBackground, KdeConfig
from muybridge.segmentation.mixture import MixtureBackground, MixtureConfig
from muybridge.segmentation.opencv import KnnConfig, Mog2Config, OpenCVBackground
from muybridge.segmentation.pictures import has_colour, median_picture, reduce_image
from muybridge.segmentation.plate import PlateBackground, PlateConfig
from muybridge.segmentation.plate_making import make_plate
from muybridge.segmentation.registry import (
    BACKGROUND_MODELS,
    BackgroundModel,
    ScoringModel,
    build_background,
    settings_at,
)
from muybridge.segmentation.roc import RocCurve
from muybridge.segmentation.scores import MaskCounts, mask_scores
from muybridge.segmentation.segmenter import Segmenter, build_segmenter
from muybridge.segmentation.shadows import ShadowConfig, remove_shadows, shadow_mask
from muybridge.segmentation.spatial import SpatialBackground, SpatialConfig
from muybridge.segmentation.stream import StreamConfig, masks_of

__all__ = [
    "BACKGROUND_MODELS",
    "AutoBackground",
    "AutoConfig",
    "BackgroundModel",
    "CleaningConfig",
    "GaussianBackground",
    "GaussianConfig",
    "HueKey",
    "HueKeyConfig",
    "KdeBackground",
    "KdeConfig",
    "KnnConfig",
    "MaskCounts",
    "MixtureBackground",
    "MixtureConfig",
    "Mog2Config",
    "OpenCVBackground",
    "PlateBackground",
    "PlateConfig",
    "RocCurve",
    "ScoringModel",
    "Segmenter",
    "ShadowConfig",
    "SpatialBackground",
    "SpatialConfig",
    "StreamConfig",
    "build_background",
    "build_segmenter",
    "clean",
    "close_open",
    "has_colour",
    "make_plate",
    "mask_scores",
    "masks_of",
    "median_picture",
    "near",
    "reduce_image",
    "remove_shadows",
    "settings_at",
    "shadow_mask",
]
