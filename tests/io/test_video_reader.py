"""Every frame of every test video says its own number: reading is exact or it is wrong, there is no tolerance."""

from __future__ import annotations

import importlib
import random

import numpy as np
import pytest

from conftest import shared_data
from muybridge.errors import InputError
from muybridge.io.video_reader import VideoReader

from .videos import number_in, numbered_picture, write_video

COUNT = 90
# Steps of 5 to 90 ms: 11 to 200 frames per second within one video.
IRREGULAR = [int(tick) for tick in np.cumsum(np.random.default_rng(1).integers(5, 90, COUNT))]
CASES = {
    "h264.mp4": ("libx264", {}),
    "open_gop.mp4": ("libx264", {"options": {"x264-params": "open-gop=1"}}),
    "vp9.webm": ("libvpx-vp9", {"options": {"deadline": "realtime", "cpu-used": "8"}}),
    "vp8_hidden_frames.webm": ("libvpx", {"options": {"auto-alt-ref": "1", "lag-in-frames": "16"}}),
    "mjpeg.avi": ("mjpeg", {}),
    "reordered.avi": ("libx264", {}),
    "transport.ts": ("libx264", {}),
    "raw.h264": ("libx264", {}),
    "irregular.mp4": ("libx264", {"ticks": IRREGULAR}),
    "irregular.mkv": ("mjpeg", {"ticks": IRREGULAR}),
}


@pytest.fixture(scope="module")
def videos(tmp_path_factory):
    folder = tmp_path_factory.mktemp("videos")
    made = {}

    def get(name):
        if name not in made:
            codec, more = CASES[name]
            made[name] = write_video(folder / name, COUNT, codec, **more)
        return made[name]

    return get


@pytest.mark.parametrize("name", CASES)
def test_iteration_gives_every_frame_once_and_in_order(videos, name):
    with VideoReader(videos(name)) as video:
        frames = [(index, number_in(picture)) for index, _, picture in video]
    assert len(video) == video.frame_count == COUNT
    assert frames == [(index, index) for index in range(COUNT)]
    assert video.damage == ""


@pytest.mark.parametrize("name", CASES)
def test_seeking_is_exact_in_any_order(videos, name):
    with VideoReader(videos(name)) as video:
        order = random.Random(0).sample(range(COUNT), 20)
        assert [number_in(video.read(index)) for index in order] == order
        assert [number_in(video.read(index)) for index in range(40, 60)] == list(range(40, 60))
        assert number_in(next(video.frames(71))[2]) == 71


@pytest.mark.parametrize("name", ["irregular.mp4", "irregular.mkv"])
def test_timestamps_of_a_variable_rate_are_the_containers(videos, name):
    video = VideoReader(videos(name))
    # Both containers keep milliseconds (mp4 in a finer base), so half of one bounds the rounding.
    np.testing.assert_allclose(video.timestamps, np.array(IRREGULAR) / 1000, atol=0.5e-3)
    assert [time_s for _, time_s, _ in video] == video.timestamps.tolist()
    assert video.frame_rate == pytest.approx((COUNT - 1) * 1000 / (IRREGULAR[-1] - IRREGULAR[0]), rel=0.005)


def test_rate_size_and_layout(videos):
    video = VideoReader(videos("vp9.webm"))  # its timestamps are rounded to milliseconds, its rate is not
    picture = video.read(3)
    assert (video.frame_rate, video.size) == (30.0, (160, 64))
    assert picture.shape == (64, 160, 3) and picture.dtype == np.uint8 and picture.flags.c_contiguous
    # The plain part is (60, 110, 160) in BGR; quantisation to 4:2:0 YCbCr and back costs a few levels.
    np.testing.assert_allclose(picture[50:, 20:140].mean((0, 1)), (60, 110, 160), atol=6)


def test_grey_reading(videos):
    grey = VideoReader(videos("h264.mp4"), colour=False).read(5)
    assert grey.shape == (64, 160) and number_in(np.stack([grey] * 3, axis=-1)) == 5


def test_pictures_do_not_depend_on_the_number_of_threads(videos):
    one, many = (list(VideoReader(videos("h264.mp4"), threads=threads)) for threads in (1, 3))
    assert all(np.array_equal(a[2], b[2]) for a, b in zip(one, many, strict=True))


@pytest.mark.parametrize("rotation", [90, 180, -90])
def test_rotation_metadata_is_honoured(tmp_path, rotation):
    video = VideoReader(write_video(tmp_path / "rotated.mp4", 4, rotation=rotation))
    upright = np.rot90(video.read(2), -rotation // 90)  # metadata counts counter-clockwise
    assert video.size == ((160, 64) if rotation == 180 else (64, 160))
    assert video.read(2).shape[:2] == video.size[::-1]
    assert number_in(upright) == 2


def test_two_passes_at_once_do_not_disturb_each_other(videos):
    video = VideoReader(videos("h264.mp4"))
    for (first, _, a), (_, _, b) in zip(video.frames(), video.frames(1), strict=False):
        assert (number_in(a), number_in(b), number_in(video.read(first))) == (first, first + 1, first)


@pytest.mark.parametrize("name", ["vp9.webm", "mjpeg.avi", "h264.mp4"])
def test_a_truncated_file_gives_what_is_there_and_says_how_much(videos, tmp_path, name):
    if name == "h264.mp4":  # with its index in front; behind, nothing could be read
        whole = write_video(tmp_path / "front.mp4", COUNT, container_options={"movflags": "+faststart"})
    else:
        whole = videos(name)
    short = tmp_path / f"short_{name}"
    short.write_bytes(whole.read_bytes()[: int(whole.stat().st_size * 0.6)])
    with pytest.warns(UserWarning, match=r"truncated: \d+ of 90 frames can be read"):
        video = VideoReader(short)
    assert 10 < len(video) < COUNT
    assert [number_in(picture) for _, _, picture in video] == list(range(len(video)))
    assert f"{len(video)} of {COUNT}" in video.damage


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_frames_keep_their_numbers_behind_a_damaged_place(videos, tmp_path):
    data = bytearray(videos("h264.mp4").read_bytes())
    middle = len(data) // 2
    data[middle : middle + 300] = np.random.default_rng(0).bytes(300)
    damaged = tmp_path / "damaged.mp4"
    damaged.write_bytes(bytes(data))
    video = VideoReader(damaged)
    numbers = [number_in(picture) for _, _, picture in video]
    assert len(numbers) == COUNT and "could not be decoded" in video.damage
    assert numbers[:30] == list(range(30)) and numbers[-6:] == list(range(COUNT - 6, COUNT))


@pytest.mark.parametrize(
    ("content", "said"), [(None, "no such file"), (b"", "empty"), (b"not a video " * 99, "Invalid data")]
)
def test_what_is_no_video_is_refused_in_one_line(tmp_path, content, said):
    path = tmp_path / "broken.mp4"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=said) as caught:
        VideoReader(path)
    assert str(path) in str(caught.value) and "\n" not in str(caught.value)


def test_sound_without_pictures_is_refused(tmp_path):
    av = importlib.import_module("av")
    path = tmp_path / "sound.wav"
    with av.open(str(path), "w") as container:
        stream = container.add_stream("pcm_s16le", rate=8000)
        frame = av.AudioFrame.from_ndarray(np.zeros((1, 800), np.int16), format="s16", layout="mono")
        frame.sample_rate = 8000
        container.mux(stream.encode(frame))
    with pytest.raises(InputError, match="expected a video stream"):
        VideoReader(path)


@pytest.mark.parametrize("index", [-1, COUNT, 10**9])
def test_frames_outside_are_refused(videos, index):
    with pytest.raises(InputError, match="0 to 89"):
        VideoReader(videos("h264.mp4")).read(index)


def test_real_video_agrees_with_itself():
    video = VideoReader(shared_data("beam") / "videos" / "cam01.mp4")
    assert (len(video), video.frame_rate, video.size) == (100, 60.0, (1080, 1920))
    np.testing.assert_allclose(video.timestamps, np.arange(100) / 60, atol=1e-4)
    kept = {index: picture for index, _, picture in video if index in (3, 50, 99)}
    for index in (50, 3, 99):
        assert np.array_equal(video.read(index), kept[index])


def test_number_survives_its_own_drawing():
    assert [number_in(numbered_picture(number)) for number in range(256)] == list(range(256))
