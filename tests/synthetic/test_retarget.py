"""A figure's own motion, written to a file with other names, units, orders and rest postures, comes back the same."""

from __future__ import annotations

import numpy as np
import pytest

from made_recording import BY_JOINTS, CMU, MIXAMO, bvh_text, named
from muybridge.errors import InputError
from muybridge.io.bvh import read_bvh
from muybridge.synthetic.bone_names import matched
from muybridge.synthetic.limbs import leg_length
from muybridge.synthetic.motion import Motion, Track, perform
from muybridge.synthetic.retarget import retarget
from muybridge.synthetic.skinning import load_figure

FIGURE = load_figure("man")
JOG = perform(FIGURE, Motion("jog", duration=0.8, heading=0.4))
NAMES = {
    "mixamo": named(MIXAMO, "mixamorig:"),
    "joints": named(BY_JOINTS),
    "cmu": named(CMU, short=True),
    "swapped": lambda bone: named(MIXAMO)(bone.replace("left", "?").replace("right", "left").replace("?", "right")),
}
#: Bones whose orientation a recording decides alone; abdomen and neck are put between their neighbours.
DECIDED = [name for name in FIGURE.bone_names if name not in ("abdomen", "neck")]


@pytest.fixture
def back(tmp_path):
    def back(track: Track, figure=FIGURE, name="mixamo", **how) -> tuple[np.ndarray, np.ndarray]:
        """World rotations and places of a figure, after the track has been through a file."""
        (tmp_path / "made.bvh").write_text(bvh_text(FIGURE, track, NAMES[name], **how))
        return retarget(figure, read_bvh(tmp_path / "made.bvh"), "made.bvh")

    return back


def turned(first: np.ndarray, second: np.ndarray) -> float:
    """Degrees: the largest angle between two sets of rotations."""
    trace = np.einsum("...ij,...ij->...", first, second)
    return float(np.degrees(np.arccos(np.clip((trace - 1) / 2, -1, 1))).max())


class TestSameFigure:
    @pytest.mark.parametrize(
        ("name", "how"),
        [
            ("mixamo", {}),
            ("joints", {}),
            ("cmu", {"order": "XYZ"}),
            ("mixamo", {"order": "YXZ", "unit": 0.0254 / 0.45}),
            ("mixamo", {"unit": 1.0, "spread": 45.0}),
            ("mixamo", {"unit": 0.001, "spread": 0.0}),
        ],
    )
    def test_comes_back(self, back, name, how):
        """Six decimals of a degree and a unit: nothing is lost but rounding."""
        worlds, places = back(JOG, name=name, **how)
        for bone in DECIDED:
            index = FIGURE.bone(bone)
            assert turned(worlds[:, index], JOG.rotations[:, index]) < 0.01, bone
        for bone in ("left_thigh", "left_foot", "right_shank", "right_toes"):
            np.testing.assert_allclose(places[:, FIGURE.bone(bone)], JOG.places[:, FIGURE.bone(bone)], atol=1e-4)

    def test_spine_in_between(self, back):
        """Abdomen and neck turn half way: within the trunk's few degrees, and what they carry within 2 cm."""
        worlds, places = back(JOG)
        for bone in ("abdomen", "neck"):
            assert turned(worlds[:, FIGURE.bone(bone)], JOG.rotations[:, FIGURE.bone(bone)]) < 10.0
        for bone in ("left_upper_arm", "right_hand", "head"):
            error = np.linalg.norm(places[:, FIGURE.bone(bone)] - JOG.places[:, FIGURE.bone(bone)], axis=1)
            assert error.max() < 0.02

    def test_sides_are_told_apart(self, back):
        """The control: with left and right exchanged in the file, the same comparison fails by tens of degrees."""
        worlds, _ = back(JOG, name="swapped")
        assert turned(worlds[:, FIGURE.bone("left_thigh")], JOG.rotations[:, FIGURE.bone("left_thigh")]) > 20.0

    def test_straight_limbs_take_the_usual_roll(self, back):
        """Nothing bends: elbows and knees keep the axes that a T-pose has."""
        still = Track(
            JOG.times, np.tile(np.eye(3), (len(JOG.times), 21, 1, 1)), JOG.places * 0 + (0, 0, 0.95), JOG.joints
        )
        worlds, _ = back(still)
        assert turned(worlds, np.broadcast_to(np.eye(3), worlds.shape)) < 0.01


class TestOtherFigure:
    def test_directions_stay_and_paths_scale_with_the_legs(self, back):
        woman = load_figure("woman")
        worlds, places = back(JOG, figure=woman)
        assert turned(worlds[:, FIGURE.bone("left_forearm")], JOG.rotations[:, FIGURE.bone("left_forearm")]) < 0.01
        hips = [
            0.5 * (p[:, f.bone("left_thigh")] + p[:, f.bone("right_thigh")])
            for p, f in ((places, woman), (JOG.places, FIGURE))
        ]
        np.testing.assert_allclose(hips[0], leg_length(woman) / leg_length(FIGURE) * hips[1], atol=1e-4)


class TestNames:
    REAL = tuple(NAMES["mixamo"](bone) for bone in FIGURE.bone_names)

    def test_every_bone(self):
        found = matched(self.REAL, "file")
        assert {bone: self.REAL[index] for bone, index in found.items()} == {
            bone: NAMES["mixamo"](bone) for bone in DECIDED if bone != "thorax"
        }

    def test_unknown_names(self):
        names = tuple(name.replace("LeftLeg", "Left_knee_thing").replace("RightFoot", "X") for name in self.REAL)
        with pytest.raises(InputError) as caught:
            matched(names, "some.bvh")
        text = str(caught.value)
        assert "bones of some.bvh: expected bones for left_shank, right_foot by the names of BVH by segments" in text
        assert "Left_knee_thing" in text and "\n" not in text

    def test_toes_and_clavicles_may_be_absent(self):
        names = tuple(name for name in self.REAL if "Toe" not in name and "Shoulder" not in name)
        assert "left_toes" not in matched(names, "file")

    @pytest.mark.parametrize(
        "change", [str.upper, lambda n: n.replace("Left", "Left_"), lambda n: n.replace("Left", "L ")]
    )
    def test_spellings(self, change):
        assert matched(tuple(map(change, self.REAL)), "file") == matched(self.REAL, "file")
