"""The background models by name. A row here makes a model appear in jobs, commands and conformance tests."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields
from itertools import chain
from typing import Any, Protocol, runtime_checkable

from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.segmentation.auto import AutoBackground, AutoConfig
from muybridge.segmentation.gaussian import GaussianBackground, GaussianConfig
from muybridge.segmentation.hue_key import HueKey, HueKeyConfig
from muybridge.segmentation.kde import KdeBackground, KdeConfig
from muybridge.segmentation.mixture import MixtureBackground, MixtureConfig
from muybridge.segmentation.opencv import KnnConfig, Mog2Config, OpenCVBackground
from muybridge.segmentation.pictures import median_picture, thinned
from muybridge.segmentation.plate import PlateBackground, PlateConfig
from muybridge.segmentation.spatial import SpatialBackground, SpatialConfig

COUNTS, USUAL_RATE = ("rest", "patience"), 30.0
"""Settings that count pictures, and the pictures a second that their defaults are for."""
PLATE_PICTURES = 50
"""A plate is the median of at most so many pictures, spread evenly over those given."""


@runtime_checkable
class BackgroundModel(Protocol):
    """Picture in, mask out; may learn from what it sees where its settings say so."""

    def apply(self, image: NDArray) -> NDArray:
        """Foreground (H, W) bool of a picture (H, W) or (H, W, 3) uint8 of the size the model was trained on."""
        ...


@runtime_checkable
class ScoringModel(BackgroundModel, Protocol):
    """A model that can also say how unlike the background each pixel is, for thresholds of one's own."""

    def score(self, image: NDArray) -> NDArray:
        """(H, W) float32, more where foreground is likelier, in units of the model's own; learns nothing."""
        ...


@dataclass(frozen=True)
class ModelEntry:
    """A row of the registry: the settings' type, and how a model is made of pictures of the scene.

    Pictures are taken one after the other, and none is kept that need not be.
    """

    config: type
    build: Callable[[Iterable[NDArray], Any], BackgroundModel]
    needs_pictures: bool = True


BACKGROUND_MODELS: dict[str, ModelEntry] = {
    "plate": ModelEntry(PlateConfig, lambda pictures, config: PlateBackground(_plate(pictures), config)),
    "gaussian": ModelEntry(GaussianConfig, GaussianBackground.train),
    "hue_key": ModelEntry(HueKeyConfig, lambda _, config: HueKey(config), needs_pictures=False),
    "mixture": ModelEntry(MixtureConfig, MixtureBackground.train),
    "spatial": ModelEntry(SpatialConfig, SpatialBackground.train),
    "auto": ModelEntry(AutoConfig, AutoBackground.train),
    "kde": ModelEntry(KdeConfig, KdeBackground.train),
    "mog2": ModelEntry(Mog2Config, OpenCVBackground.train),
    "knn": ModelEntry(KnnConfig, OpenCVBackground.train),
}


def build_background(name: str, pictures: Iterable[NDArray] = (), **settings: Any) -> BackgroundModel:
    """Make the model `name` of pictures of the scene.

    Parameters
    ----------
    name : str
        A key of `BACKGROUND_MODELS`.
    pictures : iterable of (H, W) or (H, W, 3) uint8
        The empty scene; `plate` takes their median, `hue_key` none. Those that learn on line (`mixture` and below)
        bear people who pass through.
    settings
        Fields of the model's config.
    """
    if name not in BACKGROUND_MODELS:
        raise InputError("background model", expected=" or ".join(BACKGROUND_MODELS), got=repr(name))
    entry = BACKGROUND_MODELS[name]
    known = [field.name for field in fields(entry.config)]
    unknown = sorted(set(settings) - set(known))
    if unknown:
        raise InputError(f"setting of the {name} background", expected=" or ".join(known), got=", ".join(unknown))
    config, rest = entry.config(**settings), iter(pictures)
    first = next(rest, None) if entry.needs_pictures else None
    if entry.needs_pictures and first is None:
        raise InputError(
            f"{name} background",
            expected="pictures of the empty scene",
            got="none",
            remedy="give a plate or a clip without the person, or use hue_key before a blue screen",
        )
    return entry.build(rest if first is None else chain([first], rest), config)


def settings_at(name: str, frame_rate: float) -> dict[str, Any]:
    """Those settings of a model that count pictures, at another rate (Hz) than the 30 that their defaults suit."""
    defaults = BACKGROUND_MODELS[name].config()
    counts = {key: getattr(defaults, key) for key in COUNTS if hasattr(defaults, key)}
    return {key: max(1, round(count * frame_rate / USUAL_RATE)) for key, count in counts.items()}


def _plate(pictures: Iterable[NDArray]) -> NDArray:
    """One picture as it is, of several the median."""
    kept = thinned(pictures, PLATE_PICTURES)
    return kept[0] if len(kept) == 1 else median_picture(kept)
