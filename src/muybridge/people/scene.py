"""A look over the whole clip before people are followed: the empty scene, the ground's scale, what hides people.

Nothing here is set by hand for a camera: some two hundred moments of the clip say how tall people are where they stand,
what they look like as silhouettes, and behind what they disappear.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.people.blobs import BlobConfig, Mask, find_people
from muybridge.people.ground import GroundScale
from muybridge.people.ground_fit import fit_ground
from muybridge.people.occluders import find_occluders
from muybridge.people.silhouette import Silhouette, learn_silhouette


@dataclass(frozen=True, eq=False)
class Scene:
    """What does not change while people walk through.

    background : (H, W, 3) uint8 BGR, the empty scene
    ground : GroundScale or None, where too few people were seen to tell
    occluders : (H, W) bool or None
    """

    background: NDArray[np.uint8]
    ground: GroundScale | None = None
    silhouette: Silhouette = Silhouette.flat()
    occluders: Mask | None = None

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""
        return self.background.shape[1], self.background.shape[0]


def describe(
    background: NDArray[np.uint8], masks: Sequence[Mask], blobs: BlobConfig | None = None, drawn: Mask | None = None
) -> Scene:
    """What masks (H, W) bool of many moments, in the order of time, tell.

    blobs : BlobConfig
        What may be a person at all; the smaller ones are needed too, so that the ground is known far away.
    drawn : (H, W) bool, optional
        Occluders known beforehand, which are added to those that are found.
    """
    if drawn is not None and drawn.shape != background.shape[:2]:
        raise InputError("occluders", expected=f"the pictures' {background.shape[:2]}", got=str(drawn.shape))
    size = background.shape[1], background.shape[0]
    moments = [find_people(mask, blobs or BlobConfig(smallest=250)) for mask in masks]
    ground = fit_ground(moments, size)
    if ground is None:
        return Scene(background, occluders=drawn)
    occluders = find_occluders(masks, ground)
    if drawn is not None:
        occluders |= drawn
    return Scene(
        background, ground, learn_silhouette([blob for people in moments for blob in people], ground, size), occluders
    )
