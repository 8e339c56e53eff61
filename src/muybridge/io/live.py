"""A camera's pictures as they come: a webcam, or the address of a stream (RTSP, HTTP and what else FFmpeg opens).

A thread reads as fast as the camera sends. Who is slower than the camera loses pictures, never memory: a queue holds
the latest few, and those that fall out of it are counted. A stream that ends, breaks or stalls is opened again, a
bounded number of times in a row, after waits that double.
"""

from __future__ import annotations

import re
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.io.video import PictureSource

FACTS = ("received", "dropped", "repeated", "reconnects", "ended")
Picture = NDArray[np.uint8]
LONGEST_WAIT = 30.0  # seconds before another try
#: The last of what a camera sent counts, not all of it; packets over TCP are not lost.
OPTIONS = {"rtsp_transport": "tcp", "fflags": "nobuffer", "analyzeduration": "1000000"}


@dataclass(frozen=True, kw_only=True)
class LiveConfig:
    """How a stream is read."""

    depth: int = 8  # pictures that wait; when one more comes the oldest is dropped
    stall_s: float = 10.0  # without a picture for so long, a stream is given up and opened again
    reconnects: int = 5  # tries in a row without a picture, then it is over
    wait_s: float = 1.0  # before the first of them; doubled each time

    def __post_init__(self) -> None:
        if not (self.depth >= 1 and self.stall_s > 0 and self.reconnects >= 0 and self.wait_s >= 0):
            raise InputError("stream", expected="depth from 1, stall_s above 0, reconnects and wait_s not below 0",
                             got=str(self))  # fmt: skip


def is_live(address: str) -> bool:
    """Whether this is a webcam's number or an address, and no file or folder."""
    return ("://" in address or address.isdigit()) and not Path(address).exists()


def without_password(address: str) -> str:
    """The address without who logs in to it, for messages and logs.

    Examples
    --------
    >>> without_password("rtsp://me:secret@camera/1")
    'rtsp://camera/1'
    """
    return re.sub(r"//[^/@]*@", "//", address)


class LiveSource:
    """Pictures (H, W, 3) uint8 BGR of a camera, the latest first to be given up.

    Parameters
    ----------
    address : a webcam's number, or a URL
    prepare : applied to each picture in the reading thread, so that what waits may be smaller
    connect : (address, seconds until a stall) -> pictures; FFmpeg, or OpenCV for a webcam, where absent

    Attributes
    ----------
    size : (width, height), pixels, of what the camera sends; (0, 0) before the first
    frame_rate : None: it shows as pictures come
    received, dropped, repeated, reconnects : int, so far; repeated pictures are the same as the one before
    ended : str, why there are no more; empty before
    """

    def __init__(
        self,
        address: str,
        config: LiveConfig | None = None,
        *,
        prepare: Callable[[Picture], Picture] | None = None,
        connect: Callable[[str, float], Iterator[Picture]] | None = None,
    ) -> None:
        self.name, self.config = without_password(address), config or LiveConfig()
        self._address = address
        self.size: tuple[int, int] = (0, 0)
        self.frame_rate: float | None = None
        self.received = self.dropped = self.repeated = self.reconnects = 0
        self.ended = ""
        self._prepare, self._connect = prepare, connect or connected
        self._waiting: deque[tuple[int, float, Picture]] = deque()
        self._change, self._stop = threading.Condition(), threading.Event()
        self._before: Picture | None = None
        self._failure: BaseException | None = None
        self._thread = threading.Thread(target=self._read, name="live", daemon=True)

    def frames(self) -> Iterator[tuple[int, float, Picture]]:
        """Yield (number, seconds since the first, picture) until the stream is over; numbers count what was dropped."""
        self._thread.start()
        try:
            while True:
                with self._change:
                    self._change.wait_for(lambda: self._waiting or self.ended or self._failure)
                    if not self._waiting:
                        if self._failure is not None:
                            raise self._failure
                        return
                    item = self._waiting.popleft()
                yield item
        finally:
            self.close()

    def close(self) -> None:
        """Stop reading."""
        self._stop.set()

    def facts(self) -> dict[str, Any]:
        """What happened on the way, for a summary."""
        return {name: getattr(self, name) for name in FACTS}

    def _read(self) -> None:
        """Read, and open again, until nobody wants more or it is in vain."""
        try:
            begun, tries = time.monotonic(), 0
            while not self._stop.is_set():
                before = self.received
                reason = self._read_once(begun)
                tries = 0 if self.received > before else tries
                if self.received == 0 or tries == self.config.reconnects or self._stop.is_set():
                    return self._finish(reason)
                self._stop.wait(min(self.config.wait_s * 2**tries, LONGEST_WAIT))
                tries += 1
                self.reconnects += 1
            self._finish("it was not read on")
        except BaseException as error:  # noqa: BLE001 - handed to the reader, who raises it
            with self._change:
                self._failure = error
                self._change.notify()

    def _read_once(self, begun: float) -> str:
        """One connection; why it was over."""
        import av

        try:
            for picture in self._connect(self._address, self.config.stall_s):
                self._offer(time.monotonic() - begun, self._checked(picture))
                if self._stop.is_set():
                    break
        except _OtherSize as error:
            self._stop.set()
            return str(error)
        except (av.FFmpegError, OSError) as error:
            return getattr(error, "strerror", None) or str(error)
        except InputError:
            if self.received == 0:
                raise
            return "it could not be opened again"
        return "it ended"

    def _checked(self, picture: Picture) -> Picture:
        """The picture, prepared; all are of one size."""
        size = picture.shape[1], picture.shape[0]
        if self.size not in ((0, 0), size):
            raise _OtherSize(f"pictures of another size: {size[0]} x {size[1]} after {self.size[0]} x {self.size[1]}")
        self.size = size
        return picture if self._prepare is None else self._prepare(picture)

    def _offer(self, seconds: float, picture: Picture) -> None:
        with self._change:
            self.repeated += self._before is not None and np.array_equal(self._before, picture)
            self._before = picture
            if len(self._waiting) == self.config.depth:
                self._waiting.popleft()
                self.dropped += 1
            self._waiting.append((self.received, seconds, picture))
            self.received += 1
            self._change.notify()

    def _finish(self, reason: str) -> None:
        with self._change:
            self.ended = reason
            if self.received == 0:
                self._failure = InputError(self.name, expected="a stream with pictures", got=reason)
            self._change.notify()


class PlayedBack:
    """A file's pictures as a stream: each of them, however long it takes; sizes and times are the file's."""

    def __init__(self, pictures: PictureSource, prepare: Callable[[Picture], Picture] | None = None) -> None:
        self.name, self.size, self.frame_rate = pictures.name, pictures.size, pictures.frame_rate
        self._pictures, self._prepare, self.received = pictures, prepare, 0

    def frames(self) -> Iterator[tuple[int, float, Picture]]:
        """Yield (number, seconds, picture) to the end of the file."""
        for number, seconds, picture in self._pictures.frames():
            self.received = number + 1
            yield number, seconds, picture if self._prepare is None else self._prepare(picture)

    def facts(self) -> dict[str, Any]:
        """What happened on the way: nothing is dropped."""
        return {**dict.fromkeys(FACTS, 0), "received": self.received, "ended": self._pictures.damage or "it ended"}


class _OtherSize(Exception):
    """The camera's pictures have changed their size."""


def connected(address: str, stall_s: float) -> Iterator[Picture]:
    """Open a camera and yield its pictures, (H, W, 3) uint8 BGR, whatever it sends."""
    return _webcam(int(address)) if address.isdigit() else _stream(address, stall_s)


def _webcam(number: int) -> Iterator[Picture]:
    import cv2

    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)  # what is wrong is said here, once
    camera = cv2.VideoCapture(number)
    try:
        if not camera.isOpened():
            raise InputError(f"camera {number}", expected="a webcam", got="none that opens",
                             remedy="is it plugged in, and used by nothing else?")  # fmt: skip
        while True:
            there, picture = camera.read()
            if not there:
                return
            yield _colour(picture)
    finally:
        camera.release()


def _stream(address: str, stall_s: float) -> Iterator[Picture]:
    import av

    try:
        container = av.open(address, timeout=(stall_s, stall_s), options=OPTIONS)
    except (av.FFmpegError, OSError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        what = without_password(address)
        raise InputError(what, expected="a stream that FFmpeg opens", got=reason) from error
    with container:
        if not container.streams.video:
            raise InputError(without_password(address), expected="a stream of pictures", got="none")
        for packet in container.demux(container.streams.video[0]):
            try:
                frames = packet.decode()
            except av.FFmpegError:
                continue  # a broken packet costs its picture, not the stream
            for frame in frames:
                yield np.asarray(frame.to_ndarray(format="bgr24"), dtype=np.uint8)


def _colour(picture: Any) -> Picture:
    """(H, W, 3) uint8 of a grey or four-channel picture."""
    picture = np.atleast_3d(np.asarray(picture, dtype=np.uint8))
    return np.ascontiguousarray(np.repeat(picture, 3, axis=2) if picture.shape[2] == 1 else picture[..., :3])
