from __future__ import annotations

import subprocess
import sys
import textwrap
from pathlib import Path

import av
import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.io.video_reader import VideoReader
from muybridge.io.video_writer import VideoWriter

from .videos import number_in, numbered_picture

SOURCE = Path(__file__).resolve().parents[2] / "src"


def write(path, count=40, rate=30.0, **size):
    with VideoWriter(path, rate) as video:
        for number in range(count):
            video.write(numbered_picture(number, **size))
    return path


@pytest.mark.parametrize("rate", [30.0, 29.97, 7.0, 60.0])
def test_what_is_written_is_read_back(tmp_path, rate):
    video = VideoReader(write(tmp_path / "new" / "overlay.mp4", rate=rate))
    assert [number_in(picture) for _, _, picture in video] == list(range(40))
    assert video.timestamps[0] == 0 and video.frame_rate == pytest.approx(rate, rel=1e-4)
    assert [file.name for file in (tmp_path / "new").iterdir()] == ["overlay.mp4"]


def test_browsers_can_play_it(tmp_path):
    path = write(tmp_path / "a.mp4")
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        assert (stream.codec_context.name, stream.codec_context.pix_fmt, stream.frames) == ("h264", "yuv420p", 40)
    data = path.read_bytes()
    assert data.index(b"moov") < data.index(b"mdat")  # the index comes first


@pytest.mark.parametrize(("width", "height"), [(161, 64), (160, 65), (161, 65)])
def test_odd_sizes_are_padded_with_the_border(tmp_path, width, height):
    video = VideoReader(write(tmp_path / "odd.mp4", 3, width=width, height=height))
    assert video.size == (width + width % 2, height + height % 2)
    picture = video.read(1).astype(int)
    assert np.abs(picture[-1] - picture[-3]).max() < 12 and number_in(video.read(1)) == 1


def test_grey_pictures_and_masks_can_be_written(tmp_path):
    mask = numbered_picture(5)[:, :, 0] > 127
    with VideoWriter(tmp_path / "masks.mp4", 25) as video:
        video.write(mask)
        video.write(numbered_picture(6)[:, :, 0])
    read = VideoReader(tmp_path / "masks.mp4")
    assert np.array_equal(read.read(0)[:, :, 0] > 127, mask) and number_in(read.read(1)) == 6


def test_equal_pictures_give_equal_bytes(tmp_path):
    assert write(tmp_path / "a.mp4").read_bytes() == write(tmp_path / "b.mp4").read_bytes()


def test_after_an_error_the_part_is_readable_and_the_old_file_stays(tmp_path):
    path = tmp_path / "overlay.mp4"
    path.write_bytes(b"the last run's")
    with pytest.raises(RuntimeError), VideoWriter(path, 30) as video:
        for number in range(10):
            video.write(numbered_picture(number))
        raise RuntimeError
    assert path.read_bytes() == b"the last run's"
    part = VideoReader(tmp_path / "overlay.unfinished.mp4")
    assert [number_in(picture) for _, _, picture in part] == list(range(10))


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_killed_writer_leaves_a_readable_part(tmp_path):
    program = textwrap.dedent("""
        import os, signal, numpy as np
        from muybridge.io.video_writer import VideoWriter
        video = VideoWriter("overlay.mp4", 10)
        for number in range(200):
            video.write(np.full((64, 64, 3), number, np.uint8))
        os.kill(os.getpid(), signal.SIGKILL)
    """)
    ended = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, env={"PYTHONPATH": str(SOURCE)}, check=False)
    assert ended.returncode == -9 and not (tmp_path / "overlay.mp4").exists()
    part = VideoReader(tmp_path / "overlay.unfinished.mp4")
    # The encoder holds back some frames and the last fragment (2 s = 20 frames) is open.
    assert len(part) >= 100
    shown = [picture.mean() for _, _, picture in part]
    np.testing.assert_allclose(shown, np.arange(len(part)), atol=5)


def test_no_picture_no_file(tmp_path):
    with VideoWriter(tmp_path / "a.mp4", 30):
        pass
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "picture", [np.zeros((4, 4)), np.zeros((4, 4, 4), np.uint8), np.zeros((0, 4, 3), np.uint8), np.zeros(4, np.uint8)]
)
def test_what_is_no_picture_is_refused(tmp_path, picture):
    with pytest.raises(InputError, match="expected .H, W, 3."), VideoWriter(tmp_path / "a.mp4", 30) as video:
        video.write(picture)


def test_pictures_must_keep_their_size(tmp_path):
    with pytest.raises(InputError, match="expected 160 x 64"), VideoWriter(tmp_path / "a.mp4", 30) as video:
        video.write(numbered_picture(0))
        video.write(numbered_picture(1, width=162))


@pytest.mark.parametrize("bad", [{"frame_rate": 0}, {"frame_rate": float("nan")}, {"frame_rate": 30, "quality": 99}])
def test_settings_are_checked(tmp_path, bad):
    with pytest.raises(InputError):
        VideoWriter(tmp_path / "a.mp4", **bad)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
def test_a_full_disk_is_one_line(tmp_path):
    (tmp_path / "a.unfinished.mp4").symlink_to("/dev/full")
    noise = np.random.default_rng(0).integers(0, 255, (64, 64, 3), np.uint8)
    with (
        pytest.raises(InputError, match="No space left on device") as caught,
        VideoWriter(tmp_path / "a.mp4", 30) as video,
    ):
        for _ in range(300):
            video.write(noise)
    assert "\n" not in str(caught.value) and not (tmp_path / "a.mp4").exists()
