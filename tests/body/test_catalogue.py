"""Every body of the catalogue keeps the conventions; the published ones have the published degrees of freedom."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.body import Body, catalogue, named_body
from muybridge.body.parts import AXIS_CODES
from muybridge.tracking import start

REPORTED = ("pelvis", "thorax", "head_top") + tuple(
    f"{side}_{joint}" for side in ("left", "right") for joint in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")
)
PEOPLE = ("bodytrack", "du-2005", "person", "sedai-2013")
#: bodytrack is one recorded person, with frames, sides and measures of the recording's own.
STANDARD_PEOPLE = ("du-2005", "person", "sedai-2013")
SYMMETRIC = (*STANDARD_PEOPLE, "dog")


def standing(name: str) -> tuple[Body, np.ndarray]:
    body = named_body(name)
    return body, np.zeros(len(body.dof_names))


def surface(body: Body, pose: np.ndarray) -> np.ndarray:
    """The six extreme points of both ends' half axes of every shape, world: (K, 3) metres."""
    a, frames = body.arrays, body.frames(pose)[0]
    local = a.ends[:, :, None] + np.concatenate([a.half_axes, -a.half_axes], axis=2)
    world = np.einsum("sab,sekb->seka", frames[:, :, :3], local) + frames[:, None, None, :, 3]
    return world[a.shaped].reshape(-1, 3)


def swapped(name: str) -> str:
    side, _, rest = name.partition("_")
    return {"left": f"right_{rest}", "right": f"left_{rest}"}.get(side, name)


def mirrored(body: Body, pose: np.ndarray) -> np.ndarray:
    """The pose seen in a mirror at x = 0: a turn about x is kept by the mirror, those about y and z change sign."""
    out = pose * np.r_[-1, 1, 1, np.zeros(len(pose) - 3)]
    by_name = {segment.name: segment for segment in body.segments}
    for segment in body.segments:
        for mine, other in zip(segment.rotations, by_name[swapped(segment.name)].rotations, strict=True):
            assert mine.axis[-1] == other.axis[-1] and swapped(mine.name) == other.name
            same = AXIS_CODES[mine.axis] == AXIS_CODES[other.axis]
            sign = (1.0 if same else -1.0) * (1.0 if mine.axis[-1] == "x" else -1.0)
            out[body.dof_names.index(other.name)] = sign * pose[body.dof_names.index(mine.name)]
    return out


@pytest.mark.parametrize("name", catalogue())
class TestEveryBody:
    def test_is_named_after_its_file_and_has_a_source(self, name: str) -> None:
        body = named_body(name)
        assert body.name == name and body.source

    def test_has_finite_joints_with_names_of_their_own(self, name: str) -> None:
        body, pose = standing(name)
        joints = body.joints(pose)
        assert joints.shape == (len(body.joint_names), 3) and np.isfinite(joints).all() and len(joints) >= 5

    def test_can_be_turned_about_the_vertical(self, name: str) -> None:
        """The automatic start turns `root_yaw` only: all points must go round a vertical line, keeping their height."""
        body, pose = standing(name)
        turned = pose.copy()
        turned[body.dof_names.index("root_yaw")] = np.pi / 2
        quarter = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
        np.testing.assert_allclose(body.joints(turned), body.joints(pose) @ quarter.T, atol=1e-12)

    def test_stands_within_its_limits(self, name: str) -> None:
        body, pose = standing(name)
        assert (body.lower <= pose).all() and (pose <= body.upper).all()

    def test_can_be_started(self, name: str) -> None:
        body = named_body(name)
        place = np.array([1.0, 2.0, 0.9])
        poses = np.array(start._candidates(body, place, 8))
        np.testing.assert_allclose(body.joints(poses).mean(axis=1), np.tile(place, (len(poses), 1)), atol=1e-12)
        assert (poses >= body.lower).all() and (poses <= body.upper).all()


@pytest.mark.parametrize("name", PEOPLE)
def test_people_have_the_reported_joints(name: str) -> None:
    assert set(named_body(name).joint_names) == set(REPORTED)


@pytest.mark.parametrize("name", PEOPLE)
def test_people_stand_upright(name: str) -> None:
    body, pose = standing(name)
    height = dict(zip(body.joint_names, body.joints(pose)[:, 2], strict=True))
    for side in ("left", "right"):
        order = [height[f"{side}_{joint}"] for joint in ("ankle", "knee", "hip", "shoulder")]
        assert order == sorted(order) and height[f"{side}_ankle"] < height["pelvis"] - 0.4 * body.height
    assert height["pelvis"] < height["thorax"] < height["head_top"]


@pytest.mark.parametrize("name", STANDARD_PEOPLE)
class TestStandardPeople:
    def test_are_as_tall_as_they_say(self, name: str) -> None:
        for height in (1.55, 1.75, 1.95):
            body = named_body(name, height)
            points = surface(body, np.zeros(len(body.dof_names)))
            assert abs(np.ptp(points[:, 2]) - height) < 0.05
            top = body.joints(np.zeros(len(body.dof_names)))[body.joint_names.index("head_top"), 2]
            assert abs(top - points[:, 2].max()) < 0.03

    def test_agree_on_where_joints_are(self, name: str) -> None:
        """The same person in all three: joints of one height differ by less than 3 cm, pelvis at the origin."""
        person, body = named_body("person"), named_body(name)
        where = [body.joint_names.index(joint) for joint in person.joint_names]
        theirs = body.joints(np.zeros(len(body.dof_names)))[where]
        ours = person.joints(np.zeros(len(person.dof_names)))
        assert np.linalg.norm((theirs - theirs[0]) - (ours - ours[0]), axis=1).max() < 0.03

    @pytest.mark.parametrize(
        ("dof", "joint", "direction"),
        [
            ("left_shoulder_flexion", "left_wrist", (0, 1, 0)),
            ("right_shoulder_abduction", "right_wrist", (1, 0, 0)),
            ("left_shoulder_abduction", "left_wrist", (-1, 0, 0)),
            ("right_elbow_flexion", "right_wrist", (0, 1, 0)),
            ("left_hip_flexion", "left_knee", (0, 1, 0)),
            ("left_hip_abduction", "left_ankle", (-1, 0, 0)),
            ("right_knee_flexion", "right_ankle", (0, -1, 0)),
            ("root_pitch", "head_top", (0, -1, 0)),
            ("root_roll", "head_top", (1, 0, 0)),
            ("root_yaw", "right_hip", (0, 1, 0)),
        ],
    )
    def test_names_mean_the_same_directions(self, name: str, dof: str, joint: str, direction: tuple) -> None:
        body, pose = standing(name)
        turned = pose.copy()
        turned[body.dof_names.index(dof)] = 0.2
        moved = (body.joints(turned) - body.joints(pose))[body.joint_names.index(joint)]
        assert moved @ direction > 0.9 * np.linalg.norm(moved * [1, 1, 0]) > 0


@pytest.mark.parametrize("name", SYMMETRIC)
def test_left_is_the_mirror_of_right(name: str) -> None:
    body = named_body(name)
    rng = np.random.default_rng(3)
    swaps = [body.joint_names.index(swapped(joint)) for joint in body.joint_names]
    for pose in rng.uniform(-1, 1, (5, len(body.dof_names))):
        expected = body.joints(pose)[swaps] * [-1, 1, 1]
        np.testing.assert_allclose(body.joints(mirrored(body, pose)), expected, atol=1e-12)
    by_name = {segment.name: segment for segment in body.segments}
    for segment in body.segments:
        other = by_name[swapped(segment.name)]
        assert segment.shape == other.shape and segment.length_group == other.length_group
        widths = [[r.upper - r.lower for r in s.rotations] for s in (segment, other)]
        assert widths[0] == widths[1]


class TestDu:
    #: Table 4.1: widths of the ranges, degrees. Elbow and knee turn about one axis each, which is x in our frames.
    WIDTHS = {
        "neck_flexion": 90,
        "neck_bend": 90,
        "shoulder_flexion": 225,
        "shoulder_abduction": 255,
        "shoulder_rotation": 180,
        "elbow_flexion": 180,
        "hip_flexion": 180,
        "hip_abduction": 135,
        "hip_rotation": 180,
        "knee_flexion": 150,
    }

    def test_fourteen_segments_of_which_the_head_is_a_sphere(self) -> None:
        body = named_body("du-2005")
        assert len(body.segments) == len(body.arrays.shaped) == 14
        assert [s.name for s in body.segments if s.shape and s.shape.length == 0] == ["head"]
        assert body.segment_names[0] == "torso" and body.segments[0].shape.base == (0, 0, 0)
        assert not any(s.shape.round_ends for s in body.segments if s.name != "head")

    def test_twenty_four_degrees_of_freedom(self) -> None:
        names = named_body("du-2005").dof_names
        assert len(names) == 24
        root = ("root_x", "root_y", "root_z", "root_pitch", "root_roll", "root_yaw")
        assert names[:6] == root
        pooled = sorted(name.removeprefix("left_").removeprefix("right_") for name in names[6:])
        twice = [name for name in self.WIDTHS if not name.startswith("neck")]
        assert pooled == sorted([*self.WIDTHS, *twice])

    def test_ranges_are_as_wide_as_in_the_table(self) -> None:
        body = named_body("du-2005")
        for name, lower, upper in list(zip(body.dof_names, body.lower, body.upper, strict=True))[6:]:
            width = self.WIDTHS[name.removeprefix("left_").removeprefix("right_")]
            assert np.degrees(upper - lower) == pytest.approx(width) and lower < 0 < upper
        assert np.isinf(body.upper[:6]).all()

    def test_the_root_turns_about_x_then_y_then_z(self) -> None:
        """R = Rx(a) Ry(b) Rz(c), chapter 4."""
        body, pose = standing("du-2005")
        a, b, c = pose[3:6] = 0.3, -0.5, 1.1
        x = [[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]]
        y = [[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]]
        z = [[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]]
        np.testing.assert_allclose(body.frames(pose)[0, 0, :, :3], np.array(x) @ y @ z, atol=1e-15)


def test_sedai_has_ten_parts_and_twenty_seven_degrees_of_freedom() -> None:
    body = named_body("sedai-2013")
    turns = {segment.name: len(segment.rotations) for segment in body.segments}
    sides = {"upper_arm": 3, "forearm": 1, "upper_leg": 3, "lower_leg": 2}
    expected = {"torso": 3, "head": 3} | {f"{side}_{k}": n for side in ("left", "right") for k, n in sides.items()}
    assert turns == expected and len(body.arrays.shaped) == 10 and len(body.dof_names) == 27


def test_bodytrack_has_ten_shapes_and_thirty_one_degrees_of_freedom() -> None:
    body = named_body("bodytrack")
    assert len(body.arrays.shaped) == 10 and len(body.dof_names) == 31


def test_a_dog_stands_on_four_paws() -> None:
    body, pose = standing("dog")
    floor = surface(body, pose)[:, 2].min()
    joints = dict(zip(body.joint_names, body.joints(pose), strict=True))
    for leg in ("left_fore_paw", "right_fore_paw", "left_hind_paw", "right_hind_paw"):
        assert joints[leg][2] - floor < 0.03
    assert joints["withers"][2] - floor == pytest.approx(body.height, abs=0.02)
    assert joints["tail_tip"][1] < joints["pelvis"][1] < joints["withers"][1] < joints["nose"][1]
    assert not set(body.dof_names) & {"left_hip_flexion", "left_shoulder_flexion"}, "people's postures are not a dog's"
