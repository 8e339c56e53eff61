"""BVH: what a file says comes out in metres, z up; what is wrong with it is said with its line."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from conftest import shared_data
from io_motion import BVH
from muybridge.errors import InputError
from muybridge.io.asf_amc import read_amc
from muybridge.io.bvh import read_bvh


@pytest.fixture
def read(tmp_path):
    def read(text: str, **options):
        (tmp_path / "made.bvh").write_text(text)
        return read_bvh(tmp_path / "made.bvh", **options)

    return read


class TestValues:
    def test_skeleton(self, read):
        """180 units from the foot's end to the head's: centimetres."""
        skeleton = read(BVH).skeleton
        assert skeleton.names == ("Hips", "LeftUpLeg", "LeftFoot", "Head")
        assert skeleton.parents.tolist() == [-1, 0, 1, 0]
        np.testing.assert_allclose(skeleton.offsets, [[0, 0, 0], [0, 0.1, 0], [0, 0, -0.9], [0, 0, 0.7]])
        np.testing.assert_allclose(skeleton.tips, [[0, 0.1, 0], [0, 0, -0.9], [0.15, 0, -0.05], [0, 0, 0.2]])

    def test_times_and_path(self, read):
        recording = read(BVH)
        np.testing.assert_allclose(recording.times, [0, 0.04, 0.08])
        np.testing.assert_allclose(recording.root_places, [[0.02, k, 0.95] for k in (0.01, 0.02, 0.03)])

    def test_orders_of_channels(self, read):
        """Angles turn in the file's order, about the file's axes: its X is the world's y, Y is z, Z is x."""
        rotations = read(BVH).rotations[1]
        for bone, order, degrees in ((0, "XZY", (10, 20, 30)), (1, "YXZ", (40, 50, 60))):
            expected = Rotation.from_euler(order, degrees, degrees=True).as_matrix()
            np.testing.assert_allclose(rotations[bone], expected, atol=1e-12)

    def test_reordered_columns_are_the_same_motion(self, read):
        """Position channels behind the angles, and their columns with them."""
        text = BVH.replace(
            "Xposition Yposition Zposition Zrotation Yrotation Xrotation",
            "Zrotation Yrotation Xrotation Zposition Xposition Yposition",
        )
        head, _, rows = text.partition("Frame Time: 0.04\n")
        cells = [row.split() for row in rows.splitlines()]
        moved = "\n".join(" ".join([*r[3:6], r[2], r[0], r[1], *r[6:]]) for r in cells)
        expected, got = read(BVH), read(f"{head}Frame Time: 0.04\n{moved}\n")
        assert np.array_equal(expected.rotations, got.rotations)
        assert np.array_equal(expected.root_places, got.root_places)

    def test_braces_behind_names_and_windows_lines(self, read):
        text = re.sub(r"\n\s*\{", " {", BVH).replace("\n", "\r\n")
        assert np.array_equal(read(text).rotations, read(BVH).rotations)

    def test_unit_and_axes_given(self, read):
        recording = read(BVH, scale=1.0, axes="xyz")
        np.testing.assert_allclose(recording.skeleton.offsets[2], [0, -90, 0])

    def test_z_up_is_seen(self, read):
        """The same person, written with Z up: heads are above feet along Z."""
        text = BVH.replace("0 -90 0", "0 0 -90").replace("0 -5 15", "15 0 -5").replace("0 70 0", "0 0 70")
        text = re.sub(r"^(\d) 95 2", r"\1 2 95", text.replace("OFFSET 0 20 0", "OFFSET 0 0 20"), flags=re.MULTILINE)
        recording = read(text)
        np.testing.assert_allclose(recording.skeleton.offsets[3], [0, 0, 0.7])
        np.testing.assert_allclose(recording.root_places[:, 2], 0.95)


class TestErrors:
    @pytest.mark.parametrize(
        ("old", "new", "message"),
        [
            (BVH, "", r"made\.bvh: expected a line HIERARCHY, then one MOTION, got an empty file"),
            ("HIERARCHY", "HUMBUG", "got a first line 'HUMBUG'"),
            ("MOTION", "", "got neither"),
            ("Frames: 3", "Frames: 4", "expected 4, as line 31 says, and at least 1, got 3; the file is cut off"),
            ("Frames: 3", "Frames: 2", "expected 2, as line 31 says, and at least 1, got 3"),
            ("Frames: 3", "Frames: many", r"line 31: Frames: expected numbers, got 'many'"),
            ("Frames: 3\n", "", "line 31: expected Frames: and Frame Time: after MOTION"),
            ("Frame Time: 0.04", "Frame Time: 0", "line 32: Frame Time: expected seconds above 0, got 0"),
            ("3 95 2 0", "3 95 0", r"line 35: expected 15 numbers, got 14"),
            ("3 95 2 0", "3 95 2 0 0", r"line 35: expected 15 numbers, got 16"),
            ("3 95 2 0", "3 95 2 nan", r"line 35: expected finite numbers, got .*; fill the gap first"),
            ("3 95 2 0", "3 95 2 O", r"line 35: expected numbers, got '3 95 2 O"),
            ("OFFSET 10 0 0", "OFFSET 10 0", "line 8: OFFSET of LeftUpLeg: expected 3 numbers, got 2"),
            ("6 Xposition", "5 Xposition", "line 5: CHANNELS of Hips: expected their number, then names"),
            ("Xrotation Zrotation Y", "Xrotation Qrotation Y", "line 9: CHANNELS of LeftUpLeg: .* got '3 Xrotation Q"),
            ("JOINT Head", "JOINT LeftFoot", "line 20: expected a name of its own for each joint, got 'LeftFoot'"),
            ("JOINT Head", "ROOT Head", "line 20: expected one ROOT, and JOINTs inside it, got ROOT Head"),
            ("JOINT Head\n\t{", "JOINT Head\n", "hierarchy|closed"),
            ("\tJOINT Head\n", "", "line 20: expected ROOT, JOINT or End Site before a brace"),
            ("}\nMOTION", "MOTION", "expected a ROOT whose braces are closed, got 1 open"),
            ("}\nMOTION", "}\n}\nMOTION", "line 30: expected as many braces opened as closed"),
            ("OFFSET 0 70 0", "OFFSETS 0 70 0", "line 22: expected ROOT, then JOINT, .* got 'OFFSETS 0 70 0'"),
            ("OFFSET 0 -90 0", "OFFSET 0 -9000 0", "unit of .*: expected a person of 1.2 to 2.35 m"),
        ],
    )
    def test_one_line_each(self, read, old, new, message):
        assert old in BVH
        with pytest.raises(InputError, match=message) as caught:
            read(BVH.replace(old, new, 1))
        assert "\n" not in str(caught.value)

    def test_cut_off(self, read):
        """Cut anywhere, a file is refused: between lines, inside one, in the hierarchy."""
        for end in (len(BVH) - 31, len(BVH) - 12, 400, 150, 3):
            with pytest.raises(InputError):
                read(BVH[:end])

    def test_absent(self, tmp_path):
        with pytest.raises(InputError, match="expected a readable file, got No such file"):
            read_bvh(tmp_path / "absent.bvh")


class TestRealRecording:
    def test_agrees_with_the_amc_it_was_made_from(self):
        """01_01 exists as both.

        It begins with a T-pose; its neck, shoulders and finger bases have lost the offset from their parents, thorax
        and wrist. All else is rounded to 1e-5 units and 1e-4 degrees: below 0.1 mm at the length of a leg.
        """
        folder = shared_data("mocap") / "01"
        amc, bvh = read_amc(folder / "01_01.amc"), read_bvh(folder / "01_01.bvh")
        assert len(bvh.times) == len(amc.times) + 1
        (amc_turned, amc_places), (bvh_turned, bvh_places) = amc.posed(), bvh.posed()
        pairs = {
            "root": "Hips",
            "lfemur": "LeftUpLeg",
            "ltibia": "LeftLeg",
            "lfoot": "LeftFoot",
            "ltoes": "LeftToeBase",
        }
        pairs |= {"rfemur": "RightUpLeg", "rtibia": "RightLeg", "rfoot": "RightFoot", "thorax": "Spine1"}
        turned_only = {"head": "Head", "lhumerus": "LeftArm", "rradius": "RightForeArm", "rhand": "RightFingerBase"}
        for first, second in (pairs | turned_only).items():
            i, j = amc.skeleton.names.index(first), bvh.skeleton.names.index(second)
            np.testing.assert_allclose(amc_turned[:, i], bvh_turned[1:, j], atol=2e-5)
            if first in pairs:
                np.testing.assert_allclose(amc_places[:, i], bvh_places[1:, j], atol=1e-4)
        shift = [recording.skeleton.names.index(name) for recording, name in ((amc, "lhumerus"), (bvh, "LeftArm"))]
        lost = np.linalg.norm(amc_places[:, shift[0]] - bvh_places[1:, shift[1]], axis=1)
        thorax = np.linalg.norm(amc.skeleton.tips[amc.skeleton.names.index("thorax")])
        np.testing.assert_allclose(lost, thorax, atol=1e-4)
