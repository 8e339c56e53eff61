"""Small videos and pictures whose frames say their own number, made by the tests themselves."""

from __future__ import annotations

import struct
from fractions import Fraction
from pathlib import Path

import av
import numpy as np

BITS = 8
BLOCK = 16


def numbered_picture(number: int, width: int = 160, height: int = 64) -> np.ndarray:
    """`number` as eight black or white blocks of 16 pixels, which no lossy codec blurs away."""
    picture = np.full((height, width, 3), (60, 110, 160), np.uint8)
    for bit in range(BITS):
        picture[16:32, BLOCK * (bit + 1) : BLOCK * (bit + 2)] = 255 if number >> bit & 1 else 0
    return picture


def number_in(picture: np.ndarray) -> int:
    """The number that `numbered_picture` drew, read from the middle of each block."""
    row = picture[20:28].astype(float)
    values = [row[:, BLOCK * (bit + 1) + 4 : BLOCK * (bit + 2) - 4].mean() for bit in range(BITS)]
    return sum(1 << bit for bit, value in enumerate(values) if value > 127)


def write_video(
    path: Path,
    count: int,
    codec: str = "libx264",
    *,
    rate: int = 30,
    ticks: list[int] | None = None,
    gop: int = 12,
    rotation: int = 0,
    pictures: list[np.ndarray] | None = None,
    options: dict[str, str] | None = None,
    container_options: dict[str, str] | None = None,
) -> Path:
    """A video of numbered pictures; `ticks` are presentation times in units of 1/1000 s for a variable rate."""
    pictures = pictures or [numbered_picture(number) for number in range(count)]
    with av.open(str(path), "w", options=container_options or {}) as container:
        stream = container.add_stream(codec, rate=rate, options=options or {})
        stream.width, stream.height = pictures[0].shape[1], pictures[0].shape[0]
        stream.pix_fmt = "yuvj420p" if codec == "mjpeg" else "yuv420p"
        stream.codec_context.gop_size = gop
        stream.codec_context.time_base = Fraction(1, 1000) if ticks else Fraction(1, rate)
        for number, picture in enumerate(pictures):
            frame = av.VideoFrame.from_ndarray(picture, format="bgr24").reformat(format=stream.pix_fmt)
            frame.time_base = stream.codec_context.time_base
            frame.pts = ticks[number] if ticks else number
            for packet in stream.encode(frame):
                container.mux(packet)
        for packet in stream.encode(None):
            container.mux(packet)
    if rotation:
        _turn_mp4(path, rotation)
    return path


def _turn_mp4(path: Path, degrees: int) -> None:
    """Write a rotation, counter-clockwise, into the matrix of the track header (ISO 14496-12, 8.3.2)."""
    cosine, sine = {90: (0, 1), 180: (-1, 0), -90: (0, -1)}[degrees]
    data = bytearray(path.read_bytes())
    matrix = data.index(b"tkhd") + 44  # behind type, flags, times, track, duration, layer, group, volume
    data[matrix : matrix + 20] = struct.pack(">5i", cosine << 16, -sine << 16, 0, sine << 16, cosine << 16)
    path.write_bytes(bytes(data))
