from __future__ import annotations

import cv2
import numpy as np
import pytest

from conftest import shared_data
from muybridge.errors import InputError
from muybridge.io.image_sequence import DEFAULT_FRAME_RATE, ImageSequence, read_image
from muybridge.io.video import MaskSource, PictureSource, VideoReader, open_masks, open_pictures

from .videos import number_in, numbered_picture, write_video


def write_images(folder, numbers, name="image{:04d}.png", colour=True):
    folder.mkdir(exist_ok=True)
    for number in numbers:
        picture = numbered_picture(number)
        cv2.imwrite(str(folder / name.format(number)), picture if colour else picture[:, :, 0])
    return folder


@pytest.mark.parametrize(
    ("pattern", "name"),
    [
        ("image%04d.png", "image{:04d}.png"),
        ("image%d.bmp", "image{}.bmp"),
        ("*.png", "image{}.png"),
        ("image?*.bmp", "image{}.bmp"),
        ("", "image{}.png"),
    ],
)
def test_every_way_to_name_pictures_gives_them_in_order(tmp_path, pattern, name):
    folder = write_images(tmp_path / "CAM1", range(5, 17), name)
    (folder / "readme.txt").write_text("not a picture")
    source = open_pictures(folder / pattern, frame_rate=50)
    assert isinstance(source, ImageSequence) and isinstance(source, PictureSource)
    assert [number_in(picture) for _, _, picture in source] == list(range(5, 17))
    assert [time_s for _, time_s, _ in source] == pytest.approx(np.arange(12) / 50)
    assert (len(source), source.size, source.frame_rate) == (12, (160, 64), 50)
    assert number_in(next(source.frames(7))[2]) == 12


def test_the_default_rate_says_that_it_is_assumed(tmp_path):
    source = ImageSequence(write_images(tmp_path / "a", range(2)))
    assert (source.frame_rate, source.frame_rate_is_assumed) == (DEFAULT_FRAME_RATE, True)


@pytest.mark.parametrize("colour", [True, False])
@pytest.mark.parametrize("suffix", ["bmp", "png"])
def test_grey_and_colour_are_given_as_asked(tmp_path, colour, suffix):
    grey = np.arange(64 * 160, dtype=np.uint8).reshape(64, 160)
    cv2.imwrite(str(tmp_path / f"grey.{suffix}"), grey)
    picture = read_image(tmp_path / f"grey.{suffix}", colour)
    assert np.array_equal(picture, np.stack([grey] * 3, axis=-1) if colour else grey)
    assert picture.flags.c_contiguous


def test_masks_from_images_and_from_video_are_the_same(tmp_path):
    masks = [numbered_picture(number)[:, :, 0] > 127 for number in range(6)]
    white = [np.stack([mask.view(np.uint8) * 255] * 3, axis=-1) for mask in masks]
    for number, picture in enumerate(white):
        cv2.imwrite(str(tmp_path / f"{number}.png"), picture[:, :, 0])
    video = write_video(tmp_path / "masks.mp4", 6, pictures=white, options={"crf": "10"})
    for source in (open_masks(tmp_path / "%d.png", 30), open_masks(video)):
        assert isinstance(source, MaskSource) and isinstance(source, PictureSource)
        for (_, _, mask), wanted in zip(source, masks, strict=True):
            assert mask.dtype == np.bool_ and np.array_equal(mask, wanted)
        assert np.array_equal(source.read(4), masks[4])


def test_masks_of_ones_are_not_taken_for_empty_ones(tmp_path):
    mask = numbered_picture(5)[:, :, 0] > 127
    cv2.imwrite(str(tmp_path / "0.png"), mask.view(np.uint8))
    with pytest.raises(InputError, match="expected values 0 and 255, got 0 and 1; give threshold=0"):
        open_masks(tmp_path / "%d.png")
    assert np.array_equal(open_masks(tmp_path / "%d.png", threshold=0).read(0), mask)


@pytest.mark.parametrize("threshold", [-1, 255])
def test_a_threshold_that_no_mask_can_pass_is_refused(tmp_path, threshold):
    with pytest.raises(InputError, match="0 to 254"):
        open_masks(tmp_path / "%d.png", threshold=threshold)


def test_a_video_is_opened_as_one(tmp_path):
    assert isinstance(open_pictures(write_video(tmp_path / "a.mp4", 2)), VideoReader)


def test_a_gap_in_the_numbers_is_refused(tmp_path):
    folder = write_images(tmp_path / "a", [3, 4, 6])
    with pytest.raises(InputError, match="none numbered 5"):
        ImageSequence(folder / "image%04d.png")
    assert len(ImageSequence(folder / "*.png")) == 3


@pytest.mark.parametrize(("pattern", "said"), [("none%d.png", "no file that fits"), ("away/*.png", "no such folder")])
def test_an_empty_pattern_is_refused(tmp_path, pattern, said):
    with pytest.raises(InputError, match=said):
        open_pictures(tmp_path / pattern)


@pytest.mark.parametrize("content", [b"", b"no picture at all", b"\x89PNG\r\n\x1a\n" + bytes(40)])
def test_an_unreadable_picture_is_named(tmp_path, content):
    folder = write_images(tmp_path / "a", range(3))
    (folder / "image0001.png").write_bytes(content)
    source = ImageSequence(folder / "image%04d.png")
    with pytest.raises(InputError, match=r"image0001\.png: expected a picture"):
        list(source)


def test_pictures_of_changing_size_are_refused(tmp_path):
    folder = write_images(tmp_path / "a", range(3))
    cv2.imwrite(str(folder / "image0002.png"), np.zeros((10, 20, 3), np.uint8))
    with pytest.raises(InputError, match=r"image0002\.png: expected 160 x 64 .* got 20 x 10"):
        list(ImageSequence(folder / "image%04d.png"))


@pytest.mark.parametrize("rate", [0, -5, float("nan"), float("inf")])
def test_a_rate_must_be_positive(tmp_path, rate):
    with pytest.raises(InputError, match="frame rate"):
        ImageSequence(write_images(tmp_path / "a", [0]), rate)


def test_real_grey_pictures_and_masks():
    folder = shared_data("bodytrack") / "sequenceB_2"
    pictures = open_pictures(folder / "CAM1" / "image%04d.bmp", 60)
    masks = open_masks(folder / "FG1" / "image%04d.bmp", 60)
    assert len(pictures) == len(masks) == 2 and pictures.size == masks.size == (640, 480)
    assert pictures.read(0).shape == (480, 640, 3)
    assert 0.01 < masks.read(0).mean() < 0.3  # one person in a room
