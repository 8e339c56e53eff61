"""A part of a camera's pictures as a source of its own: frame k is picture first + k, whatever it is read from."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.io.synchronise import check_synchronised, synchronised
from muybridge.io.video import PictureRange, PictureSource, open_masks, open_pictures

from .videos import number_in, numbered_picture, write_video


@pytest.fixture(params=["h264", "avi", "images"])
def whole(request, tmp_path):
    """30 numbered pictures: H.264, MPEG-4 with pictures out of order in an AVI, or files."""
    if request.param == "h264":
        return write_video(tmp_path / "a.mp4", 30)
    if request.param == "avi":
        return write_video(tmp_path / "a.avi", 30, "mpeg4", options={"bf": "2", "qscale": "2"})
    for number in range(30):
        cv2.imwrite(str(tmp_path / f"{number:03d}.png"), numbered_picture(number))
    return tmp_path


def test_frames_and_reading(whole):
    with open_pictures(whole, 30, frames=(7, 19)) as part:
        assert isinstance(part, PictureSource) and len(part) == part.frame_count == 13 and part.damage == ""
        seen = [(index, number_in(picture)) for index, _, picture in part]
        assert seen == [(k, 7 + k) for k in range(13)]
        assert [number_in(part.read(k)) for k in (12, 0, 5)] == [19, 7, 12]
        assert [index for index, _, _ in part.frames(11)] == [11, 12] and list(part.frames(13)) == []
        np.testing.assert_allclose(part.timestamps, np.arange(13) / 30, atol=1e-9)
        assert [time for _, time, _ in part] == part.timestamps.tolist()
        for index in (-1, 13):
            with pytest.raises(InputError, match="0 to 12"):
                part.read(index)


def test_cameras_that_were_started_one_after_another(tmp_path):
    """The second video begins three pictures later and goes on longer."""
    write_video(tmp_path / "one.mp4", 20)
    write_video(tmp_path / "two.mp4", 0, pictures=[numbered_picture(k) for k in range(3, 30)])
    sources = [
        open_pictures(tmp_path / "one.mp4", frames=(5, 18)), open_pictures(tmp_path / "two.mp4", frames=(2, 15)),
    ]  # fmt: skip
    assert check_synchronised(sources) == 14
    for index, _, pictures in synchronised(sources, ahead=2):
        assert [number_in(picture) for picture in pictures] == [5 + index] * 2
    for source in sources:
        source.close()


def test_masks(tmp_path):
    for number in range(4):
        cv2.imwrite(str(tmp_path / f"{number}.png"), np.full((8, 8), 255 * (number == 2), np.uint8))
    with open_masks(tmp_path / "%d.png", frames=(1, 2)) as masks:
        assert [bool(mask.all()) for _, _, mask in masks] == [False, True]


@pytest.mark.parametrize("first, last", [(-1, 3), (3, 2), (0, 4)])
def test_parts_that_are_not_there(tmp_path, first, last):
    for number in range(4):
        cv2.imwrite(str(tmp_path / f"{number}.png"), np.zeros((8, 8), np.uint8))
    with pytest.raises(InputError, match="0 to 3"):
        PictureRange(open_pictures(tmp_path / "*.png"), first, last)
