"""The background models by name. A row here makes a model appear in jobs, commands and conformance tests."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import Any, Protocol, runtime_checkable

from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.segmentation.gaussian import GaussianBackground, GaussianConfig
from muybridge.segmentation.hue_key import HueKey, HueKeyConfig
from muybridge.segmentation.pictures import median_picture
from muybridge.segmentation.plate import PlateBackground, PlateConfig


@runtime_checkable
class BackgroundModel(Protocol):
    """Picture in, mask out; may learn from what it sees where its settings say so."""

    def apply(self, image: NDArray) -> NDArray:
        """Foreground (H, W) bool of a picture (H, W) or (H, W, 3) uint8 of the size the model was trained on."""
        ...


@dataclass(frozen=True)
class ModelEntry:
    """A row of the registry: the settings' type, and how a model is made of pictures of the empty scene."""

    config: type
    build: Callable[[Sequence[NDArray], Any], BackgroundModel]
    needs_pictures: bool = True


BACKGROUND_MODELS: dict[str, ModelEntry] = {
    "plate": ModelEntry(PlateConfig, lambda pictures, config: PlateBackground(_one(pictures), config)),
    "gaussian": ModelEntry(GaussianConfig, GaussianBackground.train),
    "hue_key": ModelEntry(HueKeyConfig, lambda _, config: HueKey(config), needs_pictures=False),
}


def build_background(name: str, pictures: Sequence[NDArray] = (), **settings: Any) -> BackgroundModel:
    """Make the model `name` of pictures of the empty scene.

    Parameters
    ----------
    name : str
        A key of `BACKGROUND_MODELS`.
    pictures : sequence of (H, W) or (H, W, 3) uint8
        The empty scene; `plate` takes their median, `hue_key` none.
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
    if entry.needs_pictures and not len(pictures):
        raise InputError(
            f"{name} background",
            expected="pictures of the empty scene",
            got="none",
            remedy="give a plate or a clip without the person, or use hue_key before a blue screen",
        )
    return entry.build(pictures, entry.config(**settings))


def _one(pictures: Sequence[NDArray]) -> NDArray:
    return pictures[0] if len(pictures) == 1 else median_picture(pictures)
