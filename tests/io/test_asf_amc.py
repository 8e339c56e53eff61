"""ASF and AMC: bones turn about their own axes; what does not fit together is said with its line."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from conftest import shared_data
from io_motion import AMC, ASF
from muybridge.errors import InputError
from muybridge.io.asf_amc import beside, read_amc

UNIT = 0.0254 / 0.5


@pytest.fixture
def read(tmp_path):
    def read(asf: str = ASF, amc: str = AMC, **options):
        (tmp_path / "made.asf").write_text(asf)
        (tmp_path / "made_01.amc").write_text(amc)
        return read_amc(tmp_path / "made_01.amc", **options)

    return read


def turned(order: str, *degrees: float) -> np.ndarray:
    """The file's X, Y, Z are the world's y, z, x; lower case: turns about fixed axes, the first one innermost."""
    named = order.translate(str.maketrans("xyz", "yzx"))
    return Rotation.from_euler(named, degrees, degrees=True).as_matrix()


class TestValues:
    def test_skeleton(self, read):
        skeleton = read().skeleton
        assert skeleton.names == ("root", "thigh", "spine", "shank")
        assert skeleton.parents.tolist() == [-1, 0, 0, 1]
        np.testing.assert_allclose(skeleton.offsets, [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, -8 * UNIT]])
        np.testing.assert_allclose(skeleton.tips, UNIT * np.array([[0, 0, 0], [0, 0, -8], [0, 0, 10], [0, 0, -7]]))

    def test_path_and_rate(self, read):
        recording = read(rate=60.0)
        np.testing.assert_allclose(recording.times, [0, 1 / 60, 2 / 60])
        np.testing.assert_allclose(recording.root_places, UNIT * np.array([[3, 1, 20], [3, 2, 20], [3, 3, 20]]))

    def test_root_turns_in_its_order(self, read):
        np.testing.assert_allclose(read().rotations[2, 0], turned("xyz", 10, 20, 30), atol=1e-12)
        other = read(ASF.replace("RX RY RZ", "RZ RX RY"))
        np.testing.assert_allclose(other.rotations[2, 0], turned("zxy", 10, 20, 30), atol=1e-12)

    def test_bones_turn_about_their_own_axes(self, read):
        own = turned("z", 20)
        np.testing.assert_allclose(read().rotations[0, 1], own @ turned("x", 30) @ own.T, atol=1e-12)
        np.testing.assert_allclose(read().rotations[2, 1], own @ turned("xz", 1, 2) @ own.T, atol=1e-12)

    def test_order_of_a_bones_axes(self, read):
        """Their three angles stand in the order of the letters."""
        own = turned("zyx", 10, 0, 20)
        other = read(ASF.replace("axis 0 0 20 XYZ", "axis 10 0 20 ZYX"))
        np.testing.assert_allclose(other.rotations[0, 1], own @ turned("x", 30) @ own.T, atol=1e-12)

    @pytest.mark.parametrize("radians_in", ["asf", "amc"])
    def test_radians(self, read, radians_in):
        """Either file may say so; the AMC's word counts for its own angles."""
        lines = []
        for line in AMC.splitlines():
            words = line.split()
            if words[0][0] in "#:":
                words = [line]
            kept = 4 if words[0] == "root" else 1
            lines.append(" ".join([*words[:kept], *(f"{np.radians(float(word)):.12g}" for word in words[kept:])]))
        amc = "\n".join(lines)
        if radians_in == "amc":
            got = read(amc=amc.replace(":DEGREES", ":RADIANS"))
        else:
            asf = ASF.replace("angle deg", "angle rad").replace("0 0 20 XYZ", f"0 0 {np.radians(20):.12g} XYZ")
            got = read(asf, amc.replace(":DEGREES\n", ""))
        np.testing.assert_allclose(got.rotations, read().rotations, atol=1e-9)

    def test_frames_may_begin_anywhere(self, read):
        amc = AMC.replace("\n1\n", "\n7\n").replace("\n2\n", "\n8\n").replace("\n3\n", "\n9\n")
        assert np.array_equal(read(amc=amc).rotations, read().rotations)

    def test_scale_given(self, read):
        np.testing.assert_allclose(read(scale=0.1).skeleton.tips[1], [0, 0, -0.8])


class TestErrorsInTheMotion:
    @pytest.mark.parametrize(
        ("old", "new", "message"),
        [
            (AMC, "", r"AMC file .*made_01\.amc: expected frames, got none"),
            ("shank -40", "shin -40", r"line 7: bone: expected a bone of made\.asf, got 'shin'; use the \.asf"),
            ("shank -40\n", "", "line 7: expected numbers for every bone of frame 1, got none for shank"),
            (
                "shank 3\n",
                "",
                "end of the file: expected numbers for every bone of frame 3, got none for shank; .* cut",
            ),
            ("\n2\n", "\n4\n", "line 8: expected frame 2, got frame 4; frames are missing"),
            ("\n2\n", "\n1\n", "line 8: expected frame 2, got frame 1"),
            ("\n2\n", "\n", "line 8: expected each bone once a frame, got root again"),
            ("thigh 30 0", "thigh 30", "line 6: thigh: expected 2 numbers, got 1"),
            ("shank -40", "shank -40 1", "line 7: shank: expected 1 number, got 2"),
            ("thigh 30 0", "thigh 30 nan", "line 6: thigh: expected finite numbers, got '30 nan'; fill the gap first"),
            ("thigh 30 0", "thigh 30 O", "line 6: thigh: expected numbers, got '30 O'"),
            ("\n1\n", "\n", "line 4: expected a frame's number, got 'root 1 20"),
        ],
    )
    def test_one_line_each(self, read, old, new, message):
        assert old in AMC
        with pytest.raises(InputError, match=message) as caught:
            read(amc=AMC.replace(old, new, 1))
        assert "\n" not in str(caught.value)

    @pytest.mark.parametrize("rate", [0.0, -1.0, float("nan")])
    def test_rate(self, read, rate):
        with pytest.raises(InputError, match="frame rate of an AMC: expected a positive number"):
            read(rate=rate)


class TestErrorsInTheSkeleton:
    @pytest.mark.parametrize(
        ("old", "new", "message"),
        [
            (ASF, "", "got no hierarchy"),
            ("length 0.5", "length 0", "line 6: length: expected a number above 0, got 0"),
            ("length 0.5", "length half", "line 6: length: expected numbers, got 'half'"),
            ("angle deg", "angle gon", "line 7: angle: expected deg or rad, got 'gon'"),
            ("TX TY TZ RX RY RZ", "TX TY TZ RX RY RW", "line 11: degrees of freedom: .* got RW"),
            ("dof rx rz", "dof rx tz", "degrees of freedom: expected rx, ry, rz, got tz"),
            ("axis 0 0 20 XYZ", "axis 0 0 20 XYX", "order of axes: expected X, Y and Z in some order, got 'XYX'"),
            ("axis 0 0 20 XYZ", "axis 0 0 XYZ", "axis of thigh: expected 3 numbers, got 2"),
            ("direction 0 -1 0", "direction 0 -1 inf", "direction of thigh: expected finite numbers"),
            ("name shank", "name thigh", "expected a name of its own for each bone, got 'thigh'"),
            ("thigh shank", "thigh shin", "hierarchy: expected bones of :bonedata, got shin"),
            ("root thigh spine", "root thigh", "expected every bone in :hierarchy, got none for spine"),
            ("root thigh spine", "root thigh spine thigh", "hierarchy: expected one parent a bone"),
            ("root thigh spine", "spine thigh", "hierarchy: expected parents before children, got 'spine'"),
            ("  begin\n     id 1", "     id 1", "line 16: expected begin, got 'id'"),
        ],
    )
    def test_one_line_each(self, read, old, new, message):
        assert old in ASF
        with pytest.raises(InputError, match=message) as caught:
            read(ASF.replace(old, new, 1))
        assert "\n" not in str(caught.value)


class TestBeside:
    def test_by_name(self, tmp_path):
        for name in ("02.asf", "03.asf"):
            (tmp_path / name).touch()
        assert beside(tmp_path / "02_01.amc").name == "02.asf"

    def test_alone(self, tmp_path):
        (tmp_path / "someone.ASF").touch()
        assert beside(tmp_path / "walk.amc").name == "someone.ASF"

    @pytest.mark.parametrize(("files", "got"), [((), "none"), (("a.asf", "b.asf"), "a.asf, b.asf")])
    def test_unclear(self, tmp_path, files, got):
        for name in files:
            (tmp_path / name).touch()
        with pytest.raises(InputError, match=f"expected one .asf beside it, such as 02.asf, got {got}; name the"):
            beside(tmp_path / "02_01.amc")


class TestRealRecording:
    def test_people_stand_on_their_feet(self):
        """02_01 walks: hips are 0.8 to 1.05 m high, toes come to within 10 cm of the floor, left is left."""
        recording = read_amc(shared_data("mocap") / "02" / "02_01.amc")
        places = dict(zip(recording.skeleton.names, np.swapaxes(recording.posed()[1], 0, 1), strict=True))
        assert 0.8 < places["lfemur"][:, 2].min() and places["rfemur"][:, 2].max() < 1.05
        assert all(0.0 < places[name][:, 2].min() < 0.1 for name in ("ltoes", "rtoes"))
        ahead = np.diff(places["root"][[0, -1]], axis=0)[0, :2]
        across = (places["lfemur"] - places["rfemur"])[:, :2]
        left = np.array([-ahead[1], ahead[0]]) / np.linalg.norm(ahead)
        assert np.linalg.norm(ahead) > 2.0 and (across @ left).min() > 0.1
