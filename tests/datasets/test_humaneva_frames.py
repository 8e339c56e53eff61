"""HumanEva's synchronisation and its published parts."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.datasets.humaneva_frames import StreamOffset, part_frames, read_offset, synchronise
from muybridge.errors import InputError

# What another program says of the same parts: data/prepare_data_humaneva.py of facebookresearch/VideoPose3D. Frames
# from 0, the last one not included: for each motion where validation ends and where training ends.
VIDEOPOSE3D = {
    ("S1", "Walking_1"): (590, 1203), ("S1", "Jog_1"): (367, 740), ("S1", "ThrowCatch_1"): (473, 945),
    ("S1", "Gestures_1"): (395, 801), ("S1", "Box_1"): (385, 789), ("S2", "Walking_1"): (438, 876),
    ("S2", "Jog_1"): (398, 795), ("S2", "ThrowCatch_1"): (550, 1128), ("S2", "Gestures_1"): (500, 901),
    ("S2", "Box_1"): (382, 734), ("S3", "Walking_1"): (448, 939), ("S3", "Jog_1"): (401, 842),
    ("S3", "ThrowCatch_1"): (493, 1027), ("S3", "Gestures_1"): (533, 1102), ("S3", "Box_1"): (512, 1021),
}  # fmt: skip


def test_by_hand():
    """C1's picture 4 and C2's picture 3 are mocap frame 7: C2 was started a picture later, its picture 1 is C1's 2."""
    found = synchronise({"C1": StreamOffset(4, 7, 2), "C2": StreamOffset(3, 7, 2)})
    assert found.first == {"C1": 1, "C2": 0}
    # C1's picture 2 is mocap frame 7 - 2 * 2 = 3, row 2.
    assert (found.mocap_first, found.mocap_step) == (2, 2)
    np.testing.assert_array_equal(found.mocap_rows([0, 1, 5]), [2, 4, 12])


def test_cameras_that_were_there_before_the_motion_capture():
    """Picture 9 is mocap frame 3, so picture 8 is frame 1, the first; nothing before it counts."""
    found = synchronise({"C1": StreamOffset(9, 3, 2), "C2": StreamOffset(10, 3, 2)})
    assert found.first == {"C1": 7, "C2": 8} and found.mocap_first == 0


def test_a_moment_that_a_camera_noted_itself_may_differ():
    """C3 noted mocap frame 9 at picture 4, which is frame 7 at picture 3: it is C2 again."""
    two = {"C1": StreamOffset(4, 7, 2), "C2": StreamOffset(3, 7, 2)}
    assert synchronise(two | {"C3": StreamOffset(4, 9, 2)}).first["C3"] == synchronise(two).first["C2"]


@pytest.mark.parametrize("seed", range(20))
def test_every_camera_keeps_to_its_own_equation(seed):
    """mocap frame = o_mocap + (picture - o_picture) s, for every camera and frame.

    First pictures are whole: off by up to half a picture, s / 2 mocap frames. Equal s, so that its mean adds nothing.
    """
    rng = np.random.default_rng(seed)
    step = float(rng.uniform(1.9, 2.1))
    offsets = {
        f"C{n}": StreamOffset(*rng.uniform(1, 200, 2), step) for n in range(1, 5)
    }  # fmt: skip
    found = synchronise(offsets)
    frames = np.arange(0, 1000, 97)
    for name, offset in offsets.items():
        picture = found.first[name] + frames + 1  # from 1
        theirs = offset.mocap + (picture - offset.picture) * offset.step
        assert np.abs(found.mocap_rows(frames) + 1 - theirs).max() <= step / 2 + 1e-9
    assert min(found.first.values()) >= 0 and found.mocap_first >= -1e-9
    # Nothing is given away: some camera, or the motion capture, begins within a frame.
    assert min(found.first.values()) == 0 or found.mocap_first < 1e-9


def test_how_far_the_motion_capture_reaches():
    found = synchronise({"C1": StreamOffset(1, 3, 2)})  # rows 2, 4, 6, ...
    for rows, frames in [(2, 0), (3, 1), (4, 1), (5, 2), (101, 50)]:
        assert found.mocap_frames(rows) == frames == (found.mocap_rows(np.arange(100)) <= rows - 1).sum()


@pytest.mark.parametrize("motion", VIDEOPOSE3D, ids="-".join)
def test_parts_are_what_another_program_takes(motion):
    validation, training = VIDEOPOSE3D[motion]
    assert part_frames(*motion, "validate") == (5, validation - 1)
    assert part_frames(*motion, "train") == (validation, training - 1)


def test_other_parts():
    assert part_frames("S4", "Box_2", "test") == (5, 573)
    assert part_frames("S2", "Combo_1", "test") == (0, 1201)  # HumanEva-II
    assert part_frames("S4", "Combo_4", "test") == (1, 1257)


@pytest.mark.parametrize("subject, motion, part, words", [
    ("S1", "Walking_1", "test", "train or validate"), ("S1", "Walking_2", "train", "expected test"),
    ("S1", "Walking_3", "train", "no parts"), ("S9", "Walking_1", "train", "no parts"), ("S1", "Walk", "x", "no parts"),
])  # fmt: skip
def test_parts_that_there_are_not(subject, motion, part, words):
    with pytest.raises(InputError, match=words):
        part_frames(subject, motion, part)


@pytest.mark.parametrize("text, words", [("1\n2\n", "3 numbers, got 2"), ("1 2 x", "3 numbers"), ("1 2 0", "above 0")])
def test_offsets_that_are_none(tmp_path, text, words):
    (tmp_path / "a.ofs").write_text(text)
    with pytest.raises(InputError, match=words):
        read_offset(tmp_path / "a.ofs")
