"""A stream of pictures -> a mask for each, and what happened on the way.

The first `learn` pictures make the model. Later a change of the whole scene (a knocked camera, a jump of the
exposure, all lamps off) makes nearly everything foreground at once, which no person does: where more than
`changed_share` of the picture is foreground for `changed_frames` pictures in a row, the model is made anew of the
next `relearn` ones, and says so. Light that drifts is the model's own business (`update_rate`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import chain, islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.segmentation.pictures import with_channels
from muybridge.segmentation.registry import BackgroundModel


@dataclass(frozen=True)
class StreamConfig:
    """When a scene has changed as a whole."""

    changed_share: float = 0.7
    """Share of the picture that is foreground; 1 never starts a model anew."""
    changed_frames: int = 5
    """Pictures in a row."""
    relearn: int = 50
    """Pictures of which the new model is made; their masks are empty."""

    def __post_init__(self) -> None:
        if not 0 < self.changed_share <= 1:
            raise InputError("changed share", expected="above 0, at most 1", got=f"{self.changed_share:g}")
        if self.changed_frames < 1 or self.relearn < 1:
            raise InputError("changed frames and relearn", expected="1 picture or more",
                             got=f"{self.changed_frames} and {self.relearn}")  # fmt: skip


class StreamMask(NamedTuple):
    """What came of one picture."""

    mask: NDArray
    """(H, W) bool."""
    share: float
    """Of the picture that is foreground."""
    restarted: bool
    """Whether the scene has changed with this picture, so that the model is made anew of those that follow."""
    learning: bool
    """Whether the picture was used to make the model: the mask is empty because nothing is known."""


def masks_of(
    pictures: Iterable[NDArray],
    model: BackgroundModel,
    build: Callable[[Iterable[NDArray]], BackgroundModel],
    config: StreamConfig | None = None,
) -> Iterator[StreamMask]:
    """The mask of each picture, in order, one at a time.

    Parameters
    ----------
    pictures : iterable of (H, W) or (H, W, 3) uint8
    model : BackgroundModel
        Learnt already; it goes on learning where its settings say so.
    build : callable
        Makes a new model of the next pictures where the scene has changed.
    """
    config = config or StreamConfig()
    rest, changed = iter(pictures), 0
    for picture in rest:
        mask = model.apply(picture)
        share = float(mask.mean())
        changed = changed + 1 if share > config.changed_share else 0
        restarted = changed == config.changed_frames
        yield StreamMask(mask, share, restarted, False)
        if restarted:
            changed = 0
            first = next(rest, None)
            if first is None:
                return
            taken = _Counted(chain([first], islice(rest, config.relearn - 1)))
            model = build(taken)
            empty = np.zeros(with_channels(first).shape[:2], bool)
            for _ in range(taken.count):
                yield StreamMask(empty, 0.0, False, True)


class _Counted:
    """Pictures, and how many of them were taken."""

    def __init__(self, pictures: Iterable[NDArray]) -> None:
        self._pictures, self.count = iter(pictures), 0

    def __iter__(self) -> Iterator[NDArray]:
        return self

    def __next__(self) -> NDArray:
        picture = next(self._pictures)
        self.count += 1
        return picture
