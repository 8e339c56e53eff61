"""The tree: kinematics against a literal product of 4 x 4 matrices, scaling, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from muybridge.body import Body, Landmark, Rotation, Segment, Shape, catalogue, named_body
from muybridge.errors import InputError
from reference import chain

BODIES = [named_body(name) for name in catalogue()]
CONE = Shape((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.1, 0.1))


def any_poses(body: Body, seed: int, count: int = 1) -> np.ndarray:
    """(N, D): places within metres, angles of up to two turns either way."""
    return np.random.default_rng(seed).uniform(-4 * np.pi, 4 * np.pi, (count, len(body.dof_names)))


def two_links() -> Body:
    """A shoulder and an elbow, both turning about x, a metre each, upright at zero."""
    segments = (
        Segment("upper", rotations=(Rotation("shoulder", "x"),), shape=CONE, length_group="upper"),
        Segment("lower", "upper", at_tip=True, rotations=(Rotation("elbow", "x"),), shape=CONE, block="lower"),
    )
    return Body("links", segments, {"hand": Landmark("lower", at_tip=True)})


class TestKinematics:
    @pytest.mark.parametrize("body", BODIES, ids=catalogue())
    def test_equals_the_literal_chain(self, body: Body) -> None:
        """A dozen products of rotations of a few metres lose under 1e-14 each; 1e-11 leaves room for long chains."""
        poses = any_poses(body, 1, 20)
        expected = np.array([chain.frames(pose, body.arrays) for pose in poses])
        np.testing.assert_allclose(body.frames(poses), expected, atol=1e-11)

    @settings(max_examples=40, deadline=None)
    @given(st.sampled_from(BODIES), st.integers(0, 2**32 - 1))
    def test_rotations_are_orthonormal(self, body: Body, seed: int) -> None:
        turns = body.frames(any_poses(body, seed))[0, :, :, :3]
        assert np.abs(turns @ turns.transpose(0, 2, 1) - np.eye(3)).max() < 1e-12
        assert np.abs(np.linalg.det(turns) - 1).max() < 1e-12

    @settings(max_examples=20, deadline=None)
    @given(st.sampled_from(BODIES), st.integers(0, 2**32 - 1))
    def test_bones_keep_their_lengths(self, body: Body, seed: int) -> None:
        """Whatever the pose, a segment's two ends stay as far apart, and a child stays on its parent."""
        pose, a = any_poses(body, seed)[0], body.arrays
        frames, rest = body.frames(pose)[0], body.frames(0 * pose)[0]
        for child, parent in enumerate(a.parent):
            if parent >= 0:
                spans = [np.linalg.norm(f[child, :, 3] - f[parent, :, 3]) for f in (frames, rest)]
                assert spans[0] == pytest.approx(spans[1], abs=1e-12)

    def test_two_links_in_closed_form(self) -> None:
        a, b = 0.3, 0.9
        hand = two_links().joints(np.array([1.0, 2.0, 3.0, a, b]))[0]
        expected = [1.0, 2.0 - np.sin(a) - np.sin(a + b), 3.0 + np.cos(a) + np.cos(a + b)]
        np.testing.assert_allclose(hand, expected, atol=1e-15)

    def test_a_negative_axis_turns_the_other_way(self) -> None:
        body = two_links()
        flipped = replace(body.segments[1], rotations=(Rotation("elbow", "-x"),))
        other = replace(body, segments=(body.segments[0], flipped))
        pose = np.array([0, 0, 0, 0.4, 0.7])
        np.testing.assert_allclose(other.joints(pose), body.joints(pose * [1, 1, 1, 1, -1]), atol=1e-15)

    def test_one_pose_and_many(self) -> None:
        body = named_body("person")
        poses = any_poses(body, 2, 3)
        assert body.joints(poses).shape == (3, 15, 3)
        np.testing.assert_array_equal(body.joints(poses[1]), body.joints(poses)[1])
        assert body.joints(poses[:0]).shape == (0, 15, 3)

    def test_a_pose_of_another_length(self) -> None:
        with pytest.raises(InputError, match="^pose of body 'links': expected 5 numbers, got 6$"):
            two_links().joints(np.zeros(6))

    def test_a_body_without_joints_has_none(self) -> None:
        assert replace(two_links(), landmarks={}).joints(np.zeros(5)).shape == (0, 3)


class TestTree:
    def test_parents_come_first_whatever_the_order(self) -> None:
        body = two_links()
        assert replace(body, segments=body.segments[::-1]).segment_names == ("upper", "lower")

    def test_names_limits_and_blocks_go_together(self) -> None:
        for body in BODIES:
            count = len(body.dof_names)
            assert body.lower.shape == body.upper.shape == (count,)
            assert np.isneginf(body.lower[:3]).all() and np.isposinf(body.upper[:3]).all()
            assert body.usual.shape == (2, count) and np.isposinf(body.usual[1, :3]).all()
            assert np.isfinite(body.usual[0]).all() and (body.usual[1] > 0).all()
            np.testing.assert_array_equal(np.sort(np.concatenate(list(body.blocks.values()))), np.arange(count))
            np.testing.assert_array_equal(body.blocks["root"][:3], [0, 1, 2])

    def test_a_block_holds_its_limbs_degrees_of_freedom(self) -> None:
        body = named_body("du-2005")
        names = [body.dof_names[i] for i in body.blocks["left_leg"]]
        assert names == ["left_hip_flexion", "left_hip_abduction", "left_hip_rotation", "left_knee_flexion"]

    def test_what_is_usual_follows_the_names(self) -> None:
        body = two_links()
        bent = replace(body.segments[1], rotations=(Rotation("elbow", "x", usual=0.4, usual_sd=0.2),))
        usual = dict(
            zip(body.dof_names, replace(body, segments=(body.segments[0], bent)).usual.T.tolist(), strict=True)
        )
        assert usual["elbow"] == [0.4, 0.2] and usual["shoulder"] == [0.0, np.inf] == usual["root_x"]

    def test_usual_angles_lie_within_the_limits(self) -> None:
        for body in BODIES:
            assert ((body.usual[0] >= body.lower) & (body.usual[0] <= body.upper)).all(), body.name

    @pytest.mark.parametrize(
        ("segments", "message"),
        [
            ((Segment("a"), Segment("b", "c"), Segment("c", "b")), "expected a tree, got a cycle among b, c; mend the"),
            ((Segment("a", "b"), Segment("b", "a")), "exactly one root segment, got none"),
            ((Segment("a"), Segment("b", "elbow")), "parent of 'b': expected one of a, b, got 'elbow'"),
            ((Segment("a"), Segment("b")), "exactly one root segment, got a, b"),
            ((Segment("a"), Segment("a", "a")), "every segment named once, got a"),
            ((), "exactly one root segment"),
            (
                (Segment("a", rotations=(Rotation("t", "x"), Rotation("t", "y"))),),
                "every degree of freedom named once, got t",
            ),
            ((Segment("a", rotations=(Rotation("root_x", "x"),)),), "degree of freedom named once, got root_x"),
        ],
    )
    def test_what_is_no_tree_is_refused(self, segments: tuple[Segment, ...], message: str) -> None:
        with pytest.raises(InputError, match=message) as error:
            Body("odd", segments)
        assert "\n" not in str(error.value) and str(error.value).startswith("body 'odd'")

    def test_a_joint_on_no_segment_is_refused(self) -> None:
        with pytest.raises(InputError, match="joint 'toe': expected a segment of the body, got 'foot'"):
            replace(two_links(), landmarks={"toe": Landmark("foot")})


class TestScaling:
    @pytest.mark.parametrize("body", BODIES, ids=catalogue())
    def test_height_scales_everything(self, body: Body) -> None:
        tall = body.with_height(1.2 * body.height)
        pose = np.r_[np.zeros(3), any_poses(body, 3)[0, 3:]]
        np.testing.assert_allclose(tall.joints(pose), 1.2 * body.joints(pose), atol=1e-12)
        np.testing.assert_allclose(tall.arrays.half_axes, 1.2 * body.arrays.half_axes, atol=1e-12)
        assert tall.height == 1.2 * body.height

    @pytest.mark.parametrize("height", [0.0, -1.0, np.nan, np.inf])
    def test_a_height_is_positive(self, height: float) -> None:
        with pytest.raises(InputError, match="^height: expected a positive number of metres, got "):
            named_body("person", height)

    def test_a_length_moves_what_hangs_below_on_both_sides(self) -> None:
        body = named_body("person")
        moved = body.scaled(lengths={"thigh": 1.1}).joints(np.zeros(33)) - body.joints(np.zeros(33))
        for name, shift in zip(body.joint_names, moved, strict=True):
            below = name.endswith(("knee", "ankle"))
            np.testing.assert_allclose(shift, [0, 0, -0.0425 if below else 0.0], atol=1e-12)

    def test_an_offset_between_joints_is_a_length_too(self) -> None:
        body = named_body("person")
        moved = body.scaled(lengths={"hip_width": 1.2}).joints(np.zeros(33)) - body.joints(np.zeros(33))
        for name, shift in zip(body.joint_names, moved, strict=True):
            sideways = {"left": -0.018, "right": 0.018}[name.split("_")[0]] if "_" in name and name != "head_top" else 0
            leg = name.endswith(("hip", "knee", "ankle"))
            np.testing.assert_allclose(shift, [sideways if leg else 0.0, 0, 0], atol=1e-12)

    def test_a_joints_offset_is_part_of_its_segments_length(self) -> None:
        body = named_body("du-2005")
        longer = body.scaled(lengths={"lower_arm_and_hand": 1.2})
        wrist, elbow = (body.joint_names.index(f"left_{name}") for name in ("wrist", "elbow"))
        joints = longer.joints(np.zeros(24))
        assert np.linalg.norm(joints[wrist] - joints[elbow]) == pytest.approx(1.2 * 0.25)

    def test_widths_and_depths_are_apart(self) -> None:
        body = named_body("du-2005")
        torso = body.arrays.half_axes[0]
        wide = body.scaled(widths={"torso": 1.3}).arrays.half_axes
        deep = body.scaled(depths={"torso": 0.8}).arrays.half_axes
        np.testing.assert_allclose(wide[0], torso * [[1.3], [1.0], [1.0]], atol=1e-15)
        np.testing.assert_allclose(deep[0], torso * [[1.0], [0.8], [1.0]], atol=1e-15)
        np.testing.assert_array_equal(wide[1:], body.arrays.half_axes[1:])

    @pytest.mark.parametrize("body", BODIES, ids=catalogue())
    def test_back_again_is_where_it_was(self, body: Body) -> None:
        lengths = {group: 1.25 for group in body.length_groups}
        girths = {group: 0.8 for group in body.radius_groups}
        there = body.scaled(lengths, girths, girths)
        back = there.scaled({k: 0.8 for k in lengths}, {k: 1.25 for k in girths}, {k: 1.25 for k in girths})
        np.testing.assert_allclose(back.arrays.fixed, body.arrays.fixed, atol=1e-14)
        np.testing.assert_allclose(back.arrays.half_axes, body.arrays.half_axes, atol=1e-14)
        assert back.scaled() == back

    def test_unknown_groups_and_factors_that_are_none(self) -> None:
        body = named_body("person")
        with pytest.raises(InputError, match="body 'person': length 'tail': expected one of pelvis, torso"):
            body.scaled(lengths={"tail": 1.0})
        with pytest.raises(InputError, match="factor of depth 'torso': expected a positive number, got 0"):
            body.scaled(depths={"torso": 0})
