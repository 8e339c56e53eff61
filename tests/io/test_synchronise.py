from __future__ import annotations

import threading

import numpy as np
import pytest

from conftest import shared_data
from muybridge.errors import InputError
from muybridge.io.prefetch import prefetched
from muybridge.io.synchronise import check_synchronised, synchronised
from muybridge.io.video import open_masks, open_pictures

from .videos import number_in, write_video


@pytest.fixture
def cameras(tmp_path):
    def make(*counts, **more):
        return [open_pictures(write_video(tmp_path / f"cam{k}.mp4", n, **more)) for k, n in enumerate(counts)]

    return make


@pytest.mark.parametrize("ahead", [0, 3])
def test_frames_of_all_cameras_come_together(cameras, ahead):
    sources = cameras(20, 20, 20)
    seen = [(index, time_s, [number_in(p) for p in ps]) for index, time_s, ps in synchronised(sources, ahead=ahead)]
    assert seen == [(k, sources[0].timestamps[k], [k] * 3) for k in range(20)]
    middle = [
        index for index, _, pictures in synchronised(sources, 5, 9, ahead=ahead) if number_in(pictures[1]) == index
    ]
    assert middle == [5, 6, 7, 8]


def test_different_counts_name_the_cameras(cameras):
    sources = cameras(20, 18)
    with pytest.raises(InputError, match=r"cam0\.mp4 20, .*cam1\.mp4 18") as caught:
        check_synchronised(sources)
    assert "\n" not in str(caught.value)
    assert check_synchronised(sources, to_shortest=True) == 18
    assert len(list(synchronised(sources, to_shortest=True))) == 18


def test_different_rates_are_refused(tmp_path):
    sources = [open_pictures(write_video(tmp_path / f"{rate}.mp4", 10, rate=rate)) for rate in (25, 30)]
    with pytest.raises(InputError, match=r"one frame rate, got .*25\.mp4 25/s, .*30\.mp4 30/s"):
        check_synchronised(sources)


def test_a_frame_dropped_in_the_middle_is_found(tmp_path):
    # One frame in 301 changes the mean rate by less than its tolerance, so only the timestamps can tell.
    steady = [round(k * 1000 / 30) for k in range(301)]
    sources = [
        open_pictures(write_video(tmp_path / f"{name}.mp4", 300, "mpeg4", ticks=ticks))
        for name, ticks in (("whole", steady[:300]), ("dropped", steady[:40] + steady[41:]))
    ]
    with pytest.raises(
        InputError, match=r"timestamps as in .*whole\.mp4, got .*dropped\.mp4 1\.0 frames apart at frame 40"
    ):
        check_synchronised(sources)


def test_masks_go_along_with_pictures(tmp_path):
    path = write_video(tmp_path / "a.mp4", 5)
    for _, _, (picture, mask) in synchronised([open_pictures(path), open_masks(path)]):
        assert picture.shape == (64, 160, 3) and mask.dtype == np.bool_


@pytest.mark.parametrize("span", [(-1, 3), (4, 2), (0, 21)])
def test_ranges_outside_are_refused(cameras, span):
    with pytest.raises(InputError, match="range within 0 to 20"):
        synchronised(cameras(20), *span)


def test_no_camera_is_refused():
    with pytest.raises(InputError, match="at least one"):
        check_synchronised([])


def test_reading_ahead_keeps_order_and_passes_errors_on():
    def items():
        yield from range(5)
        raise InputError("camera")

    got = []
    with pytest.raises(InputError, match="camera"):
        for item in prefetched(items(), 2):
            got.append(item)
    assert got == [0, 1, 2, 3, 4]


def test_reading_ahead_is_bounded_and_ends_its_thread_when_abandoned():
    made, closed_in = [], []

    def items():
        try:
            for k in range(1000):
                made.append(k)
                yield k
        finally:
            closed_in.append(threading.current_thread().name)

    ahead = prefetched(items(), 3)
    assert [next(ahead), next(ahead)] == [0, 1]
    ahead.close()
    assert len(made) <= 2 + 3 + 2  # taken, waiting, one in the maker's hand and one more as the queue empties
    assert closed_in == ["prefetch"] and all(thread.name != "prefetch" for thread in threading.enumerate())


def test_the_real_cameras_run_together():
    folder = shared_data("beam") / "videos"
    sources = [open_pictures(folder / f"cam0{k}.mp4") for k in (1, 2, 3, 4)]
    assert check_synchronised(sources) == 100
    index, time_s, pictures = next(synchronised(sources, 7))
    assert index == 7 and time_s == pytest.approx(7 / 60, abs=1e-4)
    assert [picture.shape[1] for picture in pictures] == [1080, 1080, 1088, 1088]
