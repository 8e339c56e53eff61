"""What is known of a scene while it is watched: it is learnt from moments of the past, and anew as there are more.

A clip can be looked over before anybody is followed; a stream cannot. Its first seconds make the first empty scene;
moments are kept from then on, and when there are too many every other one is forgotten, so that those that are left
reach back twice as far. Memory stays the same. Once people are known in a picture, the rest of it is learnt: whoever
stands stays foreground for as long as they stir (`things`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.people.blobs import BlobConfig, Mask
from muybridge.people.masks import MaskConfig, Masks
from muybridge.people.scene import Scene, describe

Picture = NDArray[np.uint8]
Item = TypeVar("Item")


@dataclass(frozen=True, kw_only=True)
class LearningConfig:
    """When a stream's scene is learnt; seconds."""

    first_s: float = 10.0  # nobody is followed before so long
    again_s: float = 60.0  # the longest between two times; the first are as far apart as what they look back on is long
    longest_s: float = 10.0  # between two moments that are kept: 60 pictures then reach back ten minutes
    settle_s: float = 10.0  # tracks are written, and final, after so long

    def __post_init__(self) -> None:
        if not min(self.first_s, self.again_s, self.longest_s, self.settle_s) > 0:
            raise InputError("stream", expected="seconds above 0", got=str(self))


class Moments(Generic[Item]):
    """At most so many of what is offered, evenly over the past.

    Parameters
    ----------
    most : int
    interval, longest : float, seconds between two moments, to begin with and at most

    Examples
    --------
    >>> kept = Moments(most=4, interval=1.0, longest=100.0)
    >>> for second in range(12):
    ...     _ = kept.offer(second, str(second))
    >>> kept.items
    ['0', '4', '8']
    """

    def __init__(self, most: int, interval: float, longest: float) -> None:
        self.most, self.interval, self.longest = most, interval, longest
        self.items: list[Item] = []
        self._due = -np.inf

    def offer(self, time: float, item: Item) -> bool:
        """Whether it was taken."""
        if time < self._due:
            return False
        self.items.append(item)
        if len(self.items) > self.most:
            if 2 * self.interval <= self.longest:
                self.items, self.interval = self.items[::2], 2 * self.interval
            else:
                del self.items[0]
        self._due = time + 0.999 * self.interval  # times that are sums of fractions
        return True


class SceneLearner:
    """Keeps moments of a stream, and makes of them what `people.scene` makes of a clip.

    Parameters
    ----------
    pictures, masks : int, how many moments of each are kept
    drawn : (H, W) bool, optional, occluders known beforehand
    """

    def __init__(
        self,
        config: LearningConfig,
        foreground: MaskConfig,
        blobs: BlobConfig,
        *,
        pictures: int,
        masks: int,
        drawn: Mask | None = None,
    ) -> None:
        self.config, self.foreground, self.blobs, self.drawn = config, foreground, blobs, drawn
        interval = config.first_s / pictures
        self._pictures: Moments[Picture] = Moments(pictures, interval, config.longest_s)
        self._masks: Moments[NDArray[np.uint8]] = Moments(masks, interval, config.longest_s)
        self._begun: float | None = None
        self._due = np.inf
        self._shape: tuple[int, int] = (0, 0)

    def see(self, time: float, picture: Picture, mask: Mask | None = None) -> None:
        """A picture (H, W, 3) uint8 BGR at `time` seconds, and its foreground where it is known."""
        if self._begun is None:
            self._begun, self._due = time, time + self.config.first_s
        self._shape = picture.shape[0], picture.shape[1]
        self._pictures.offer(time, picture)
        if mask is not None:
            self._masks.offer(time, np.packbits(mask))

    def is_due(self, time: float) -> bool:
        """Whether enough was seen to learn, again."""
        return time >= self._due

    def learn(self, time: float, before: tuple[Masks, Scene] | None = None) -> tuple[Masks, Scene]:
        """The foreground's model and the scene; `before` is what was known so far.

        A model that goes on learning by itself is kept. What people look like is kept where too few were seen lately.
        """
        assert self._begun is not None, "nothing was seen"
        masks = before[0] if before and self.foreground.model != "plate" else self._trained()
        if before and masks.things is not None and before[0].things is not None:
            masks.things.go_on_from(before[0].things)
        scene = describe(masks.empty, self._seen(masks), self.blobs, self.drawn)
        if scene.ground is None and before is not None:
            known = before[1]
            scene = Scene(masks.empty, known.ground, known.silhouette, known.occluders)
        self._due = time + float(np.clip(time - self._begun, self.config.first_s, self.config.again_s))
        return masks, scene

    def _trained(self) -> Masks:
        return Masks.train(self._pictures.items, self.foreground, ended=False)

    def _seen(self, masks: Masks) -> Sequence[Mask]:
        """Foreground of many moments: as it was seen then, or, with too few of those, of the pictures that are kept."""
        if len(self._masks.items) < len(self._pictures.items):
            return [masks.apply(masks.relit(picture)) for picture in self._pictures.items]
        count = self._shape[0] * self._shape[1]
        return [np.unpackbits(row, count=count).reshape(self._shape).astype(bool) for row in self._masks.items]
