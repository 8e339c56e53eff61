"""Recordings as motions: cut, resampled, placed, put on their feet; and the real ones that lie beside the checkout."""

from __future__ import annotations

import os

import numpy as np
import pytest

from conftest import shared_data
from io_motion import AMC, ASF
from made_recording import MIXAMO, bvh_text, named
from motion_measures import facing, fastest, lowest, of, soles
from muybridge.errors import InputError
from muybridge.io.asf_amc import read_amc
from muybridge.synthetic.contacts import SLOW, bearing_spells, grip_velocity
from muybridge.synthetic.limbs import SIDES
from muybridge.synthetic.motion import Motion, Recorded, Track, perform
from muybridge.synthetic.retarget import retarget
from muybridge.synthetic.skinning import load_figure

FIGURE = load_figure("man")
WALK = perform(FIGURE, Motion("walk", duration=2.5, rate=60.0, heading=0.4))


@pytest.fixture
def walk(tmp_path) -> str:
    """The path of a walk of 2.5 s, 150 frames at 60 per second."""
    path = tmp_path / "walk.bvh"
    path.write_text(bvh_text(FIGURE, WALK, named(MIXAMO)))
    return str(path)


class TestErrors:
    @pytest.mark.parametrize(
        ("values", "message"),
        [
            ({"file": "walk.fbx"}, r"motion file: expected a name that ends in .amc or .bvh, got 'walk.fbx'"),
            ({"rate": 0.0}, "recorded motion: rate: expected a positive number, got 0.0"),
            ({"file_rate": float("nan")}, "recorded motion: file_rate"),
            ({"scale": -1.0}, "recorded motion: scale"),
            ({"place": (float("nan"), 0.0)}, "heading and place: expected finite numbers"),
        ],
    )
    def test_values(self, values, message):
        with pytest.raises(InputError, match=message):
            Recorded(**({"file": "walk.bvh"} | values))

    @pytest.mark.parametrize(("start", "end"), [(1.0, 1.0), (2.0, 1.0), (0.0, 9.0), (-1.0, 1.0), (float("nan"), 1.0)])
    def test_span(self, walk, start, end):
        with pytest.raises(InputError, match=r"start and end of .*walk\.bvh: expected 0 <= start < end <= 2\.48 s"):
            _ = Recorded(walk, start, end).duration

    def test_absent(self, tmp_path):
        with pytest.raises(InputError, match=r"absent\.bvh: expected a file, got No such file"):
            perform(FIGURE, Recorded(str(tmp_path / "absent.bvh")))

    def test_unknown_bones(self, tmp_path):
        (tmp_path / "made.asf").write_text(ASF)
        (tmp_path / "made_1.amc").write_text(AMC)
        with pytest.raises(
            InputError, match=r"bones of .*made_1\.amc: expected bones for head, left_upper_arm, .*; rename"
        ):
            perform(FIGURE, Recorded(str(tmp_path / "made_1.amc")))


class TestClip:
    def test_times(self, walk):
        motion = Recorded(walk, 0.5, 1.5, rate=25.0)
        assert motion.duration == 1.0 and len(motion.times) == 25
        track = perform(FIGURE, motion)
        assert np.array_equal(track.times, motion.times) and len(track.joints) == 25

    def test_whole_file(self, walk):
        assert Recorded(walk).span == pytest.approx((0.0, 149 / 60), abs=1e-4)

    def test_is_a_value(self, walk):
        assert hash(Recorded(walk)) == hash(Recorded(walk)) and Recorded(walk) == Recorded(walk) != Recorded(walk, 0.1)

    def test_place_and_heading(self, walk):
        track = perform(FIGURE, Recorded(walk, 0.3, 2.3, heading=-2.5, place=(3.0, -1.0)))
        np.testing.assert_allclose(track.places[len(track.times) // 2, 0, :2], (3.0, -1.0))
        # The pelvis turns by 5 degrees either way, and a second holds not quite a stride.
        assert facing(track).mean(axis=0) @ (np.cos(-2.5), np.sin(-2.5)) > np.cos(np.radians(8))

    def test_frame_rate_only_samples(self, walk):
        slow, fast = (perform(FIGURE, Recorded(walk, 0.5, 1.5, rate=rate)) for rate in (20.0, 40.0))
        turn = fast.rotations[0, 0] @ slow.rotations[0, 0].T  # the direction faced is a mean over frames
        np.testing.assert_allclose(turn @ slow.rotations, fast.rotations[::2], atol=1e-9)

    def test_between_frames_rotations_lie_between(self, walk):
        """At 600 frames per second steps within a frame of the file are even, and rotations stay rotations."""
        turns = perform(FIGURE, Recorded(walk, 0.5, 1.0, rate=600.0)).rotations
        np.testing.assert_allclose(
            turns @ np.swapaxes(turns, -1, -2), np.broadcast_to(np.eye(3), turns.shape), atol=1e-9
        )
        pelvis = np.linalg.norm(np.diff(turns[:, 0], axis=0), axis=(1, 2)).reshape(-1)[: 10 * 29].reshape(29, 10)
        np.testing.assert_allclose(pelvis, np.broadcast_to(pelvis[:, :1], pelvis.shape), rtol=1e-3)

    def test_the_motion_comes_back(self, walk):
        """The same, up to its place; but the made walk slips by 0.1 to 0.2 m/s in each spell of 0.6 s, and that
        is taken back: half of it at either end, 6 cm at most, for feet only.
        """
        track = perform(FIGURE, Recorded(walk, rate=60.0, heading=0.0))
        middle = len(track.times) // 2
        angle = np.arctan2(*(WALK.rotations[middle, 0] @ track.rotations[middle, 0].T)[[1, 0], 0])
        turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
        ours = (track.joints - track.places[middle, 0]) @ turn.T
        error = np.linalg.norm(ours - (WALK.joints - WALK.places[middle, 0])[: len(ours)], axis=-1)
        assert error.mean() < 0.015 and error.max() < 0.07

    def test_leading_posture_is_left_out(self, walk, tmp_path):
        """A first frame with all angles 0, the T-pose that converters add, does not belong to the clip."""
        text = open(walk).read().replace("Frames: 150", "Frames: 151")
        head, _, rows = text.partition("Frame Time: 0.0166667\n")
        zeros = " ".join(["0"] * len(rows.splitlines()[0].split()))
        path = tmp_path / "posed.bvh"
        path.write_text(f"{head}Frame Time: 0.0166667\n{zeros}\n{rows}")
        assert Recorded(str(path)).span[0] == pytest.approx(1 / 60, rel=1e-4)
        assert Recorded(str(path), 0.0).span[0] == 0.0

    def test_a_changed_file_is_read_again(self, walk):
        motion = Recorded(walk)
        before = motion.duration
        text = open(walk).read().replace("Frame Time: 0.0166667", "Frame Time: 0.02")
        with open(walk, "w") as stream:
            stream.write(text)
        os.utime(walk, ns=(1, 1))
        assert motion.duration == pytest.approx(1.2 * before, rel=1e-4)


#: CMU subject 02: what is done, seconds of it, and how far (metres) the lowest vertex leaves the floor at most.
CLIPS = {
    "02_01": ("walks", 2.8, 0.02),
    "02_03": ("jogs", 1.4, 0.12),
    "02_04": ("jumps", 4.0, 0.6),
    "02_05": ("punches", 6.0, 0.02),
    "02_06": ("bends", 8.0, 0.02),
}


def slip(figure, track) -> float:
    """Metres per second: how fast bearing feet move where they touch the floor, the median; 60 frames per second."""
    found = []
    for feet in np.swapaxes(soles(figure, track), 0, 1):
        speed = np.linalg.norm(grip_velocity(feet, 60.0), axis=1)
        found.extend(speed[begin:end] for begin, end in bearing_spells(feet[..., 2].min(axis=1), speed, 60.0))
    return float(np.median(np.concatenate(found)))


@pytest.mark.parametrize("name", ["man", "woman"])
@pytest.mark.parametrize("clip", CLIPS)
class TestRealRecordings:
    def performed(self, name, clip):
        path = shared_data("mocap") / clip[:2] / f"{clip}.amc"
        figure = load_figure(name)
        return figure, perform(figure, Recorded(str(path), 0.0, CLIPS[clip][1], rate=60.0, heading=0.3))

    def unsettled(self, name, clip):
        """The control: every second frame of the capture at 120 per second, its feet where legs take them."""
        recording = read_amc(shared_data("mocap") / clip[:2] / f"{clip}.amc")
        frames = slice(0, round(120 * CLIPS[clip][1]), 2)
        worlds, places = (part[frames] for part in retarget(load_figure(name), recording, clip))
        places[..., 2] -= np.percentile(
            soles(load_figure(name), Track(None, worlds, places, None))[..., 2].min((1, 2)), 10
        )
        return Track(recording.times[frames], worlds, places, None)

    def test_feet(self, name, clip):
        """Bearing feet slip by less than 6 cm/s in half of their time, about half of what they did before they were set
        down; soles sink by less than 1 cm; what does not leap stays on the floor. In 02_06 a hand touches the floor:
        with other arms, fingers may dip in by 3 cm.
        """
        figure, track = self.performed(name, clip)
        before = slip(figure, self.unsettled(name, clip))
        assert slip(figure, track) < min(0.06, 0.55 * before)
        assert soles(figure, track)[..., 2].min() > -0.01
        mesh = lowest(figure, track, every=6)
        assert mesh.min() > -0.03 and mesh.max() < CLIPS[clip][2]

    def test_upright_and_forward(self, name, clip):
        """Left is left of where the toes point, heads are up, and the clip faces where it was told to."""
        figure, track = self.performed(name, clip)
        feet = [track.places[:, figure.bone(f"{side}_toes")] - of(track, f"{side}_ankle") for side in SIDES]
        assert np.median((np.mean(feet, axis=0)[:, :2] * facing(track)).sum(axis=1)) > 0.05
        middle = len(track.times) // 2
        assert facing(track)[middle] @ (np.cos(0.3), np.sin(0.3)) > np.cos(np.radians(25))
        assert np.median(of(track, "head_top")[:, 2]) > 1.2

    def test_smooth(self, name, clip):
        """People: hands below 9 m/s, and nothing above the 15 g with which this capture's own neck jerks."""
        speed, acceleration = fastest(self.performed(name, clip)[1])
        assert speed < 9.0 and acceleration < 160.0


class TestRealFormats:
    def test_amc_and_bvh_perform_alike(self):
        """01_01 as both: alike but for rounding, except where it tips a contact over by a frame.

        There a foot's correction differs by what it slips in that frame, at most `SLOW[1]` / 120 Hz: 8 mm.
        Control: a frame later in the file, which is 8 ms, differs by more at most times.
        """
        folder = shared_data("mocap") / "01"
        amc = perform(FIGURE, Recorded(str(folder / "01_01.amc"), 0.0, 10.0)).joints
        bvh, late = (
            perform(FIGURE, Recorded(str(folder / "01_01.bvh"), frame / 120, 10.0 + frame / 120)).joints
            for frame in (1, 2)
        )
        apart = np.linalg.norm(amc - bvh, axis=-1).max(axis=1)
        assert np.median(apart) < 0.0005 and apart.max() < SLOW[1] / 120
        assert np.median(np.linalg.norm(amc - late, axis=-1).max(axis=1)) > 0.002

    def test_the_bvhs_t_pose_is_left_out(self):
        assert Recorded(str(shared_data("mocap") / "01" / "01_01.bvh")).span[0] == pytest.approx(1 / 120, rel=1e-3)
