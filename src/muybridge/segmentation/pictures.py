"""What every background model needs of a picture: channels, size, a smaller copy, a median."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError


class Learner(Protocol):
    """A model that is made of one picture after the other."""

    def learn(self, image: NDArray) -> Any:
        """Learn a picture."""
        ...


Model = TypeVar("Model", bound=Learner)

#: Levels between the channels of a grey picture: one step of a video's chroma moves a channel by so much.
GREY_RANGE = 3


def with_channels(image: NDArray) -> NDArray:
    """The picture as (H, W, channels); a grey (H, W) picture gets its one channel.

    Parameters
    ----------
    image : (H, W) or (H, W, 1) or (H, W, 3) uint8 or float32
    """
    picture = np.asarray(image)
    if picture.ndim == 2:
        picture = picture[..., None]
    if picture.ndim != 3 or picture.shape[2] not in (1, 3) or 0 in picture.shape:
        raise InputError("picture", expected="(H, W), (H, W, 1) or (H, W, 3)", got=str(np.shape(image)))
    return picture


def has_colour(image: NDArray) -> bool:
    """Whether the channels differ anywhere; those of a grey recording that was decoded as BGR do not.

    Parameters
    ----------
    image : (H, W) or (H, W, 1) or (H, W, 3) uint8 or float32
    """
    return bool((np.ptp(with_channels(image), axis=2) > GREY_RANGE).any())


def check_same_shape(image: NDArray, shape: tuple[int, ...]) -> NDArray:
    """The picture as (H, W, channels), refused unless it has the shape the model was trained on."""
    picture = with_channels(image)
    if picture.shape != shape:
        raise InputError(
            "picture for the background model",
            expected=_words(shape),
            got=_words(picture.shape),
            remedy="train and apply the model at the same size and number of channels",
        )
    return picture


def learn_each(pictures: Iterable[NDArray], make: Callable[[tuple[int, ...]], Model]) -> Model:
    """A model made for the first picture's shape (H, W, C), that has learnt all of them, one at a time."""
    model: Model | None = None
    for picture in pictures:
        model = model or make(with_channels(picture).shape)
        model.learn(picture)
    if model is None:
        raise InputError("pictures to learn the background from", expected="at least one", got="none")
    return model


def thinned(pictures: Iterable[NDArray], most: int) -> list[NDArray]:
    """All pictures, or at least half of `most` and no more than `most`, evenly spread, without holding more at a
    time."""
    kept: list[NDArray] = []
    step = 1
    for number, picture in enumerate(pictures):
        if number % step == 0:
            kept.append(picture)
        if len(kept) > most:
            kept, step = kept[::2], 2 * step
    return kept


def reduce_image(image: NDArray, factor: float) -> NDArray:
    """The picture `factor` times as large, each new pixel the mean over its area: fewer pixels and less noise.

    Pixel centres follow `Camera.scaled(factor)`: u' = (u + 0.5) factor - 0.5. Where 1 / factor is whole, rows and
    columns left over at the right and bottom are dropped so that this holds exactly.

    Parameters
    ----------
    image : (H, W) or (H, W, 3) uint8 or float32
    factor : float
        In (0, 1].

    Returns
    -------
    (H', W') or (H', W', 3), type of `image`
    """
    if not 0 < factor <= 1:
        raise InputError("reduction factor", expected="in (0, 1]", got=f"{factor:g}")
    if factor == 1:
        return image
    import cv2

    height, width = image.shape[:2]
    step = round(1 / factor)
    if abs(step * factor - 1) < 1e-9 and min(height, width) >= step:
        image = image[: height // step * step, : width // step * step]
        return cv2.resize(image, (width // step, height // step), interpolation=cv2.INTER_AREA)
    size = (max(1, round(width * factor)), max(1, round(height * factor)))
    return cv2.resize(image, size, interpolation=cv2.INTER_AREA)


def median_picture(pictures: Sequence[NDArray], valid: Sequence[NDArray] | None = None) -> NDArray:
    """The median over pictures, pixel by pixel, over the valid ones where that is said.

    Parameters
    ----------
    pictures : sequence of (H, W) or (H, W, channels) uint8
    valid : sequence of (H, W) bool, optional
        False where a picture shows something that is not background. A pixel that is never valid takes the median
        over all pictures.

    Returns
    -------
    (H, W) or (H, W, channels) uint8
    """
    if not len(pictures):
        raise InputError("background pictures", expected="at least one", got="none")
    if len({np.shape(picture) for picture in pictures}) > 1:
        raise InputError("background pictures", expected="one size", got="several sizes")
    stack = np.stack(pictures)
    plain = np.median(stack, axis=0)
    if valid is None:
        return np.rint(plain).astype(np.uint8)
    keep = np.stack(valid).reshape(stack.shape[:3] + (1,) * (stack.ndim - 3))
    return np.rint(_masked_median(stack, np.broadcast_to(keep, stack.shape), plain)).astype(np.uint8)


def _masked_median(stack: NDArray, keep: NDArray, otherwise: NDArray) -> NDArray:
    """Sort with the invalid values last, then take the middle of the valid ones."""
    ordered = np.sort(np.where(keep, stack.astype(np.int16), np.int16(999)), axis=0)
    count = keep.sum(axis=0)
    low, high = np.maximum(count - 1, 0) // 2, count // 2
    last = len(stack) - 1
    middle = [np.take_along_axis(ordered, np.minimum(at, last)[None], axis=0)[0] for at in (low, high)]
    return np.where(count > 0, (middle[0] + middle[1]) / 2, otherwise)


def _words(shape: tuple[int, ...]) -> str:
    return f"{shape[1]} x {shape[0]}, {shape[2]} channel{'s' * (shape[2] > 1)}"
