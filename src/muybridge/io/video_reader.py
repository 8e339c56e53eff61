"""Frame-exact reading of a video file.

The container is demuxed once, without decoding, to learn every frame's timestamp; the header's frame count is not
trusted. A frame is found by its timestamp: seek to the key frame before it, decode forward. Memory does not grow with
the length of the video, apart from 8 bytes a frame for the timestamps.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

import numpy as np

from muybridge.errors import InputError
from muybridge.io.decoder import Decoder, index_frames

# How many key frames back to try where a container seeks to a place after the one asked for.
_SEEK_TRIES = 3
# Rates stated and measured that differ by less than this part are the same; timestamps may be rounded to milliseconds.
_RATE_TOLERANCE = 0.005


class VideoReader:
    """A video file as a sequence of pictures.

    Parameters
    ----------
    path : str or Path
        Any container and codec that FFmpeg reads; variable frame rate and rotation metadata are honoured.
    threads : int
        Decoder threads; 0 lets FFmpeg choose. The pictures do not depend on it.
    colour : bool
        True gives (H, W, 3) uint8 BGR, False grey (H, W) uint8.

    Attributes
    ----------
    timestamps : (T,) float64, seconds, as the container states them
    frame_rate : float, frames per second; the mean where the rate varies
    size : (width, height), pixels, after rotation
    damage : str, one line where not everything could be read, else empty; it is also warned once
    """

    def __init__(self, path: str | Path, *, threads: int = 1, colour: bool = True) -> None:
        self.path, self.threads, self.colour = Path(path), threads, colour
        self.name = str(path)
        self.damage = ""
        self._warned: set[str] = set()
        self._decoder: Decoder | None = None
        self._ahead: Iterator[tuple[int, np.ndarray]] = iter(())
        self._next = -1
        self._index = index_frames(self.path, threads)
        with Decoder(self.path, threads, colour) as decoder:
            stated_rate = float(decoder.stream.average_rate or 0)
            first = next(decoder.frames(self._index), None)
            if first is None:
                raise InputError(self.name, expected="a video with pictures", got="no frame that can be decoded")
            height, width = decoder.picture(first[1]).shape[:2]
        self.size = (width, height)
        self.timestamps = self._index.ticks * self._index.time_base
        self.timestamps.flags.writeable = False
        self.frame_rate = _frame_rate(self.timestamps, stated_rate)
        self._report_truncation()

    @property
    def frame_count(self) -> int:
        """Frames that can be read."""
        return len(self._index.ticks)

    def __len__(self) -> int:
        return self.frame_count

    def __iter__(self) -> Iterator[tuple[int, float, np.ndarray]]:
        return self.frames()

    def frames(self, start: int = 0) -> Iterator[tuple[int, float, np.ndarray]]:
        """Yield (index, time in seconds, picture) from frame `start` to the end; each call reads on its own.

        A picture in the middle that cannot be decoded is replaced by the one before it, as a player would do, and
        `damage` says so.
        """
        self._check_index(start, self.frame_count)
        if start == self.frame_count:
            return
        due, previous = start, None
        with Decoder(self.path, self.threads, self.colour) as decoder:
            for index, picture in self._decode_from(decoder, start):
                if index > due:
                    self._warn(f"frame {due} could not be decoded; its neighbour is shown in such places")
                for missing in range(due, index):
                    yield missing, float(self.timestamps[missing]), picture if previous is None else previous
                yield index, float(self.timestamps[index]), picture
                due, previous = index + 1, picture
        if due < self.frame_count:
            self._warn(f"decoding ended after {due} of {self.frame_count} frames")

    def read(self, index: int) -> np.ndarray:
        """The picture of one frame, exactly; reading on from the frame before does not seek."""
        self._check_index(index, self.frame_count - 1)
        if self._decoder is None or not self._lies_ahead(index):
            self.close()
            self._decoder = Decoder(self.path, self.threads, self.colour)
            self._ahead = self._decode_from(self._decoder, index)
        for found, picture in self._ahead:
            self._next = found + 1
            if found == index:
                return picture
            if found > index:
                break
        self.close()
        raise InputError(f"{self.name}, frame {index}", expected="a picture", got="data that cannot be decoded")

    def close(self) -> None:
        """Give the file back; reading opens it again."""
        self._ahead = iter(())
        if self._decoder is not None:
            self._decoder.close()
        self._decoder, self._next = None, -1

    def __enter__(self) -> VideoReader:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def _decode_from(self, decoder: Decoder, start: int) -> Iterator[tuple[int, np.ndarray]]:
        """Yield (index, picture) from frame `start` on, having gone to a key frame before it."""
        ticks, keys = self._index.ticks, self._index.key_ticks
        usable = keys[(keys <= ticks[start]) & (keys > ticks[0])] if self._index.timed else keys[:0]
        for place in [*usable[::-1][:_SEEK_TRIES], None]:
            decoder.rewind(None if place is None else int(place))
            frames = decoder.frames(self._index)
            first = next(frames, None)
            if first is not None and first[0] <= start:
                break
        for index, frame in () if first is None else chain([first], frames):
            if index >= start:
                yield index, self._checked(index, decoder.picture(frame))

    def _lies_ahead(self, index: int) -> bool:
        """Whether decoding on reaches `index` without passing a key frame, so that seeking would gain nothing."""
        if not 0 <= self._next <= index:
            return False
        low, high = self._index.ticks[self._next], self._index.ticks[index]
        keys = self._index.key_ticks
        return index == self._next or not np.any((keys > low) & (keys <= high))

    def _check_index(self, index: int, last: int) -> None:
        if not 0 <= index <= last:
            raise InputError(f"{self.name}: frame number", expected=f"0 to {self.frame_count - 1}", got=str(index))

    def _checked(self, index: int, picture: np.ndarray) -> np.ndarray:
        if (picture.shape[1], picture.shape[0]) != self.size:
            expected = f"{self.size[0]} x {self.size[1]} pixels as in the first frame"
            got = f"{picture.shape[1]} x {picture.shape[0]}"
            raise InputError(f"{self.name}, frame {index}", expected=expected, got=got)
        return picture

    def _report_truncation(self) -> None:
        index = self._index
        if index.packets < index.expected:
            self._warn(f"truncated: {self.frame_count} of {index.expected} frames can be read")
        elif index.damaged:
            self._warn(f"damaged: {self.frame_count} of {max(index.packets, index.expected)} frames can be read")

    def _warn(self, line: str) -> None:
        kind = line.split()[0]
        if kind not in self._warned:
            self._warned.add(kind)
            self.damage = f"{self.damage}; {line}" if self.damage else f"{self.name}: {line}"
            warnings.warn(f"{self.name}: {line}", stacklevel=3)


def _frame_rate(timestamps: np.ndarray, stated: float) -> float:
    """Frames per second: the stated mean rate where the timestamps bear it out, else theirs."""
    if len(timestamps) < 2:
        return stated or 1.0
    measured = (len(timestamps) - 1) / float(timestamps[-1] - timestamps[0])
    return stated if abs(stated - measured) < _RATE_TOLERANCE * measured else measured
