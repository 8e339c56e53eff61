"""H.264 video that browsers play: yuv420p, even sizes, the index at the front.

The video grows under a temporary name beside its target, in fragments that can be played without an end. When it is
finished it is copied, packet by packet, into one piece and given its name. Whatever interrupts the writing (an error, a
full disk, a kill), the fragments so far can be played under the temporary name and cannot be taken for the whole.
"""

from __future__ import annotations

import os
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from muybridge.errors import InputError
from muybridge.io.disk import disk_errors, make_folder, temporary_name

# A key frame this often: players seek quickly, and an interrupted video loses no more than this.
_KEY_FRAME_SECONDS = 2.0
_GROWING = {"movflags": "+frag_keyframe+empty_moov+default_base_moof", "flush_packets": "1"}


class VideoWriter:
    """Write BGR pictures, one after the other, to an .mp4.

    Parameters
    ----------
    path : str or Path
    frame_rate : float
        Frames per second.
    quality : int
        x264's constant rate factor: 0 lossless (browsers then may not play it), 18 fine, 23 usual, 51 worst.
    preset : str
        x264's trade of time for size.

    Examples
    --------
    >>> with VideoWriter("overlay.mp4", frame_rate=60) as video:  # doctest: +SKIP
    ...     video.write(picture)
    """

    def __init__(self, path: str | Path, frame_rate: float, *, quality: int = 23, preset: str = "veryfast") -> None:
        if not 0 < frame_rate < float("inf"):
            raise InputError(f"{path}: frame rate", expected="a positive number", got=str(frame_rate))
        if not 0 <= quality <= 51:
            raise InputError(f"{path}: quality", expected="0 (best) to 51 (worst)", got=str(quality))
        self.path, self.frame_rate = Path(path), Fraction(frame_rate).limit_denominator(100_000)
        self.unfinished = temporary_name(self.path)
        self.frame_count = 0
        self.size: tuple[int, int] | None = None
        # Without B-frames the fragments need no edit list, and the first frame is shown at time 0.
        self._options = {"crf": str(quality), "preset": preset, "bf": "0"}
        self._container: Any = None

    def write(self, picture: np.ndarray) -> None:
        """Append one picture, (H, W, 3) uint8 BGR or (H, W) grey; bool masks become black and white."""
        picture = self._checked(picture)
        if self._container is None:
            self._open()
        self._encode(picture)
        self._file.raise_refusal(self.path)
        self.frame_count += 1

    def close(self) -> None:
        """Finish the video and give it its name; a writer that was given no picture leaves no file."""
        if self._container is None:
            return
        self._finish()
        whole = temporary_name(self.unfinished)
        try:
            with disk_errors(self.path):
                _in_one_piece(self.unfinished, whole)
                os.replace(whole, self.path)
        finally:
            whole.unlink(missing_ok=True)
        self.unfinished.unlink()

    def abandon(self) -> None:
        """Finish what was written, readable, under the temporary name."""
        if self._container is None:
            return
        try:
            self._finish()
        except InputError:
            pass  # the error that led here is the one to report; a full disk refuses this too

    def __enter__(self) -> VideoWriter:
        return self

    def __exit__(self, kind: type[BaseException] | None, *rest: object) -> None:
        self.close() if kind is None else self.abandon()

    def _checked(self, picture: np.ndarray) -> np.ndarray:
        if picture.dtype == np.bool_:
            picture = picture.view(np.uint8) * np.uint8(255)
        shaped = picture.ndim == 2 or (picture.ndim == 3 and picture.shape[2] == 3)
        if picture.dtype != np.uint8 or not shaped or 0 in picture.shape:
            got = f"{picture.shape} {picture.dtype}"
            raise InputError(f"{self.path}: picture", expected="(H, W, 3) or (H, W) uint8", got=got)
        size = (picture.shape[1], picture.shape[0])
        if self.size is None:
            self.size = size
        if size != self.size:
            expected = f"{self.size[0]} x {self.size[1]} pixels as the first"
            raise InputError(
                f"{self.path}: picture {self.frame_count}", expected=expected, got=f"{size[0]} x {size[1]}"
            )
        return picture

    def _open(self) -> None:
        import av
        from av.video.reformatter import VideoReformatter

        assert self.size is not None
        make_folder(self.path.parent)
        with disk_errors(self.path):
            self._file = _PatientFile(self.unfinished)
        self._container = av.open(self._file, "w", format="mp4", options=_GROWING)
        self._stream = self._container.add_stream("libx264", rate=self.frame_rate, options=self._options)
        self._stream.width, self._stream.height = (side + side % 2 for side in self.size)
        self._stream.pix_fmt = "yuv420p"
        self._stream.codec_context.time_base = 1 / self.frame_rate
        self._stream.codec_context.gop_size = max(1, round(_KEY_FRAME_SECONDS * self.frame_rate))
        # One thread: the bytes then do not depend on the machine.
        self._stream.codec_context.thread_count = 1
        self._reformatter = VideoReformatter()

    def _encode(self, picture: np.ndarray) -> None:
        import av

        odd_height, odd_width = picture.shape[0] % 2, picture.shape[1] % 2
        if odd_height or odd_width:
            margin = ((0, odd_height), (0, odd_width), (0, 0))[: picture.ndim]
            picture = np.pad(picture, margin, mode="edge")
        layout = "gray" if picture.ndim == 2 else "bgr24"
        frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format=layout)
        frame = self._reformatter.reformat(frame, format="yuv420p", threads=1)
        frame.pts, frame.time_base = self.frame_count, 1 / self.frame_rate
        for packet in self._stream.encode(frame):
            self._container.mux(packet)

    def _finish(self) -> None:
        container, self._container = self._container, None
        for packet in self._stream.encode(None):
            container.mux(packet)
        container.close()
        self._file.close()
        self._file.raise_refusal(self.path)


class _PatientFile:
    """A file that FFmpeg writes to and that never refuses: FFmpeg 8 crashes where a fragment cannot be written.

    The first refusal of the system is kept for `raise_refusal`, and nothing is written after it.
    """

    def __init__(self, path: Path) -> None:
        self._file = open(path, "wb", buffering=0)
        self._refusal: OSError | None = None

    def write(self, data: bytes) -> int:
        """Write what the system takes; says that it was all, for FFmpeg's sake."""
        rest = memoryview(data)
        try:
            while rest and self._refusal is None:
                rest = rest[self._file.write(rest) :]
        except OSError as error:
            self._refusal = error
        return len(data)

    def close(self) -> None:
        """Close the file; what was refused is still known."""
        self._file.close()

    def raise_refusal(self, path: Path) -> None:
        """Raise InputError about `path` if the system refused anything so far."""
        if self._refusal is not None:
            with disk_errors(path):
                raise self._refusal


def _in_one_piece(fragments: Path, target: Path) -> None:
    """Copy the packets into a file whose index comes first, so that a browser can start before it has everything."""
    import av

    with (
        av.open(str(fragments)) as source,
        av.open(str(target), "w", format="mp4", options={"movflags": "+faststart"}) as copy,
    ):
        stream = copy.add_stream_from_template(source.streams.video[0])
        for packet in source.demux(source.streams.video[0]):
            if packet.dts is not None:
                packet.stream = stream
                copy.mux(packet)
