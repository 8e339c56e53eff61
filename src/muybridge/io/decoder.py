"""One open video container, turned into frames; `video_reader` is the door to it.

Packets are demuxed and decoded one at a time. Data that cannot be decoded is skipped, never guessed at: frames that the
decoder marks as concealed are left out, and who asks for frames by their number learns which are missing.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import chain, islice
from pathlib import Path
from typing import Any

import numpy as np

from muybridge.errors import InputError

# A VP8 packet may hold an alternate reference that is never shown, so its packets do not count its frames.
_PACKETS_ARE_NOT_FRAMES = frozenset({"vp8"})
# A container that states no frame count is called truncated where this much of its stated duration is missing.
_MISSING_SECONDS = 0.5
# AVI stores no times, and those FFmpeg makes up are wrong where frames are coded out of order; this many frames tell.
_STORES_NO_TIMES = frozenset({"avi"})
_PROBED_FRAMES = 64


@dataclass(frozen=True)
class FrameIndex:
    """When each frame is shown, and where decoding can start.

    Attributes
    ----------
    ticks : (T,) int64, time of each frame in units of `time_base`, ascending
    key_ticks : (K,) int64, the times of the key frames among them, ascending
    time_base : float, seconds
    timed : bool, False where the container has no usable timestamps and frames are told apart by counting
    expected : int, frames that the header promises; 0 where it promises nothing
    packets : int, packets found, shown or not
    damaged : bool, the container broke off, or holds data that FFmpeg calls corrupt
    """

    ticks: np.ndarray
    key_ticks: np.ndarray
    time_base: float
    timed: bool
    expected: int
    packets: int
    damaged: bool


class Decoder:
    """An open container and its first video stream.

    Parameters
    ----------
    path : Path
    threads : int
        Decoder threads; 0 lets FFmpeg choose.
    colour : bool
        Pictures as BGR (H, W, 3), or grey (H, W).
    """

    def __init__(self, path: Path, threads: int = 1, colour: bool = True) -> None:
        from av.video.reformatter import VideoReformatter

        self.path, self.threads, self.format = path, threads, "bgr24" if colour else "gray"
        self.damaged = False
        self._reformatter = VideoReformatter()
        self._open()

    def _open(self) -> None:
        self.container = open_container(self.path)
        self.stream = video_stream(self.container, self.path)
        self.stream.codec_context.thread_count = self.threads
        self.stream.codec_context.thread_type = "NONE" if self.threads == 1 else "AUTO"

    def close(self) -> None:
        """Give the file back; `rewind(None)` opens it again."""
        self.container.close()

    def __enter__(self) -> Decoder:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def rewind(self, ticks: int | None) -> None:
        """Go to the key frame at or before `ticks`; None opens the file again, which works for every container."""
        import av

        if ticks is not None:
            try:
                return self.container.seek(ticks, stream=self.stream, backward=True, any_frame=False)
            except av.FFmpegError:
                pass  # this container cannot seek: read it from the start
        self.close()
        self._open()

    def raw_frames(self) -> Iterator[Any]:
        """Decode forward; broken packets are skipped, and the end of readable data is the end."""
        import av

        # A packet of None at the end flushes what the decoder still holds.
        for packet in chain(self.packets(), [None]):
            try:
                decoded = self.stream.codec_context.decode(packet)
            except (av.FFmpegError, EOFError):
                continue
            yield from (frame for frame in decoded if not frame.is_corrupt)

    def packets(self) -> Iterator[Any]:
        """Demux forward, past damage where the container can be picked up behind it; `damaged` says so."""
        import av

        progress = True
        while progress:
            progress = False
            try:
                for packet in self.container.demux(self.stream):
                    if packet.size:
                        progress = True
                        self.damaged |= packet.is_corrupt
                        yield packet
                return
            except av.FFmpegError:
                self.damaged = True

    def frames(self, index: FrameIndex) -> Iterator[tuple[int, Any]]:
        """Yield (number, frame) in ascending order from where the container stands."""
        if not index.timed:
            yield from enumerate(self.raw_frames())
            return
        last = -1
        for frame in self.raw_frames():
            number = int(np.searchsorted(index.ticks, -1 if frame.pts is None else frame.pts))
            # Frames outside the index are ones the container says not to show.
            if last < number < len(index.ticks) and index.ticks[number] == frame.pts:
                yield number, frame
                last = number

    def picture(self, frame: Any) -> np.ndarray:
        """The frame as it is to be shown: (H, W, 3) uint8 BGR or (H, W), contiguous, rotated as the file says."""
        image = self._reformatter.reformat(frame, format=self.format, threads=1).to_ndarray()
        quarter_turns = round(frame.rotation / 90)  # counter-clockwise, as numpy counts them
        return np.ascontiguousarray(np.rot90(image, quarter_turns) if quarter_turns else image)


def open_container(path: Path) -> Any:
    """Open a video file, or say in one line why not."""
    import av

    if not path.is_file():
        raise InputError(str(path), expected="a video file", got="a folder" if path.is_dir() else "no such file")
    if path.stat().st_size == 0:
        raise InputError(str(path), expected="a video file", got="an empty file")
    try:
        return av.open(str(path))
    except (av.FFmpegError, OSError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        remedy = "is it a video, and was it written to the end?"
        raise InputError(str(path), expected="a video that FFmpeg reads", got=reason, remedy=remedy) from error


def video_stream(container: Any, path: Path) -> Any:
    """The first stream of moving pictures (a cover picture of a sound file is none)."""
    from av.stream import Disposition

    for stream in container.streams.video:
        if not stream.disposition & Disposition.attached_pic and stream.codec_context is not None:
            return stream
    container.close()
    raise InputError(str(path), expected="a video stream that FFmpeg decodes", got="none")


def index_frames(path: Path, threads: int = 1) -> FrameIndex:
    """Learn every frame's time: by demuxing where the container can be believed, by decoding everything where not."""
    with Decoder(path, threads) as decoder:
        index = _index_by_demuxing(decoder)
        decoder_format = decoder.container.format.name
        doubtful = decoder.stream.codec_context.name in _PACKETS_ARE_NOT_FRAMES
    if decoder_format in _STORES_NO_TIMES:
        doubtful |= not _times_hold(path, threads, index)
    if index.timed and not doubtful:
        whole = not index.damaged and index.packets >= index.expected
        return index if whole else _without_unreadable_end(path, threads, index)
    with Decoder(path, threads) as decoder:
        return _index_by_decoding(decoder, index)


def _without_unreadable_end(path: Path, threads: int, index: FrameIndex) -> FrameIndex:
    """Leave out the frames after the last that decodes; gaps before it stay, so that frames keep their numbers."""
    with Decoder(path, threads) as decoder:
        last = max((frame.pts for frame in decoder.raw_frames() if frame.pts is not None), default=-(2**62))
    return replace(index, ticks=index.ticks[index.ticks <= last], key_ticks=index.key_ticks[index.key_ticks <= last])


def _index_by_demuxing(decoder: Decoder) -> FrameIndex:
    times: list[int] = []
    keys: list[int] = []
    packets, timed = 0, True
    for packet in decoder.packets():
        packets += 1
        timed &= packet.pts is not None
        if packet.is_discard or packet.pts is None:
            continue
        if packet.is_keyframe:
            keys.append(packet.pts)
        if keys:  # nothing can be decoded before the first key frame
            times.append(packet.pts)
    ticks = np.unique(np.array(times, np.int64))
    if keys:
        ticks = ticks[ticks >= keys[0]]
    time_base = float(decoder.stream.time_base or 1.0)
    expected = _promised_frames(decoder, ticks, time_base)
    return FrameIndex(ticks, np.unique(np.array(keys, np.int64)), time_base, timed, expected, packets, decoder.damaged)


def _promised_frames(decoder: Decoder, ticks: np.ndarray, time_base: float) -> int:
    """Frames that the header promises; estimated from its duration only where clearly less is there."""
    stream, container = decoder.stream, decoder.container
    if stream.frames:
        return stream.frames
    alone = len(container.streams) == 1
    duration = stream.duration * time_base if stream.duration else (container.duration or 0) / 1e6 if alone else 0.0
    if not len(ticks) or not stream.average_rate or duration <= 0:
        return 0
    shown = (ticks[-1] - ticks[0]) * time_base
    missing = duration - shown - 1 / float(stream.average_rate)
    return round(duration * float(stream.average_rate)) if missing > _MISSING_SECONDS else 0


def _times_hold(path: Path, threads: int, index: FrameIndex) -> bool:
    """Whether the first decoded frames carry the times that their packets promised."""
    with Decoder(path, threads) as decoder:
        times = [frame.pts for frame in islice(decoder.raw_frames(), _PROBED_FRAMES)]
    return times == index.ticks[: len(times)].tolist()


def _index_by_decoding(decoder: Decoder, index: FrameIndex) -> FrameIndex:
    times = [frame.pts for frame in decoder.raw_frames()]
    known = [time for time in times if time is not None]
    if len(known) == len(times) and np.all(np.diff(known) > 0):
        ticks = np.array(known, np.int64)
        return replace(index, ticks=ticks, key_ticks=index.key_ticks[np.isin(index.key_ticks, ticks)], timed=True)
    rate = float(decoder.stream.average_rate or decoder.stream.guessed_rate or 25)
    ticks = np.arange(len(times), dtype=np.int64)
    return replace(index, ticks=ticks, key_ticks=ticks[:1], time_base=1 / rate, timed=False)
