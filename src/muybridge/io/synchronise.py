"""Several cameras as one stream of frames.

Cameras are taken to be synchronised in hardware: frame k of one belongs to frame k of the others. What can be checked
is checked: equal frame counts, equal rates, and timestamps that stay together.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice

import numpy as np

from muybridge.errors import InputError
from muybridge.io.prefetch import prefetched
from muybridge.io.video import PictureSource

RATE_TOLERANCE = 0.005
"""Relative; covers 29.97 against 30 (0.1 %) and rounded timestamps, not 25 against 30."""
DRIFT_TOLERANCE = 0.5
"""Frames by which timestamps, each counted from its first, may come apart."""


def check_synchronised(sources: Sequence[PictureSource], *, to_shortest: bool = False) -> int:
    """Check that the sources can be read frame by frame together.

    Parameters
    ----------
    sources : sequence of picture or mask sources
    to_shortest : bool
        Allow different frame counts and use what all of them have.

    Returns
    -------
    int
        Frames to read.

    Raises
    ------
    InputError
        One line that names the cameras that differ.
    """
    if not sources:
        raise InputError("cameras", expected="at least one", got="none")
    counts = [source.frame_count for source in sources]
    if len(set(counts)) > 1 and not to_shortest:
        remedy = "cut them to the same frames"
        damaged = next((source.damage for source in sources if source.damage), "")
        raise _differ("the same number of frames", sources, map(str, counts), damaged or remedy)
    rates = [source.frame_rate for source in sources]
    if max(rates) > (1 + RATE_TOLERANCE) * min(rates):
        remedy = "convert them to one rate, or state the rate of the image sequences"
        raise _differ("one frame rate", sources, (f"{rate:.6g}/s" for rate in rates), remedy)
    count = min(counts)
    _check_drift(sources, count)
    return count


def synchronised(
    sources: Sequence[PictureSource],
    start: int = 0,
    stop: int | None = None,
    *,
    ahead: int = 0,
    to_shortest: bool = False,
) -> Iterator[tuple[int, float, list[np.ndarray]]]:
    """Yield (index, time in seconds, [picture of each source]); times are those of the first source.

    Parameters
    ----------
    sources : sequence of picture or mask sources
        Both may be mixed: pictures and their masks belong together too.
    start, stop : int
        Frames start to stop - 1; all where `stop` is None.
    ahead : int
        Frames to decode ahead in a thread; memory is bounded by them.
    """
    count = check_synchronised(sources, to_shortest=to_shortest)
    stop = count if stop is None else stop
    if not 0 <= start <= stop <= count:
        raise InputError("frames", expected=f"a range within 0 to {count}", got=f"{start} to {stop}")
    return prefetched(islice(_together(sources, start), stop - start), ahead)


def _together(sources: Sequence[PictureSource], start: int) -> Iterator[tuple[int, float, list[np.ndarray]]]:
    """Step all sources; the first to end, ends all (a reader whose data breaks off has said so itself)."""
    streams = [source.frames(start) for source in sources]
    try:
        for frames in zip(*streams, strict=False):
            yield frames[0][0], frames[0][1], [frame[2] for frame in frames]
    finally:
        for stream in streams:
            stream.close()  # type: ignore[attr-defined]


def _check_drift(sources: Sequence[PictureSource], count: int) -> None:
    elapsed = [source.timestamps[:count] - source.timestamps[0] for source in sources]
    for source, times in zip(sources[1:], elapsed[1:], strict=True):
        apart = np.abs(times - elapsed[0]) * sources[0].frame_rate
        # Equal rates within their tolerance drift apart slowly; that is allowed for.
        allowed = DRIFT_TOLERANCE + RATE_TOLERANCE * np.arange(count)
        if np.any(apart > allowed):
            frame = int(np.argmax(apart > allowed))
            got = f"{source.name} {apart[frame]:.1f} frames apart at frame {frame}"
            remedy = "a frame was dropped there: convert both to a constant rate"
            raise InputError("cameras", expected=f"timestamps as in {sources[0].name}", got=got, remedy=remedy)


def _differ(expected: str, sources: Sequence[PictureSource], values, remedy: str) -> InputError:
    got = ", ".join(f"{source.name} {value}" for source, value in zip(sources, values, strict=True))
    return InputError("cameras", expected=expected, got=got, remedy=remedy)
