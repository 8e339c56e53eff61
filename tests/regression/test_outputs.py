"""Poses and outputs: there and back for every body, and headings that mean what they say."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.body import named_body
from muybridge.cameras import Camera
from muybridge.errors import InputError
from muybridge.regression.outputs import PoseOutputs, bearing

BODIES = ["person", "sedai-2013", "bodytrack", "du-2005", "dog", "robot-arm"]


def camera_at(place, target):
    """An upright camera at a place (3,), looking at a target (3,), metres."""
    forward = np.subtract(target, place) / np.linalg.norm(np.subtract(target, place))
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(forward, right), forward])
    matrix = np.array([[600.0, 0, 319.5], [0, 600.0, 239.5], [0, 0, 1]])
    return Camera("c", (640, 480), matrix, np.zeros(5), rotation, -rotation @ np.asarray(place, float))


def some_poses(body, count=20, seed=0):
    rng = np.random.default_rng(seed)
    return rng.uniform(np.maximum(body.lower, -1.2), np.minimum(body.upper, 1.2), (count, len(body.dof_names)))


@pytest.mark.parametrize("name", BODIES)
def test_there_and_back(name):
    """The same frames in space; angles may differ by turns, and where two orders of root turns say the same."""
    body = named_body(name)
    outputs, poses = PoseOutputs(body), some_poses(body)
    bearings = np.random.default_rng(1).uniform(-3, 3, len(poses))
    found = outputs.from_poses(poses, bearings)
    assert found.shape == (len(poses), len(body.dof_names) - 3)
    back = outputs.to_poses(found, poses[:, :3], bearings)
    np.testing.assert_allclose(body.frames(back), body.frames(poses), atol=1e-12)


@pytest.mark.parametrize("name", BODIES)
def test_a_person_turned_about_the_vertical_changes_the_heading_alone(name):
    body = named_body(name)
    outputs, poses = PoseOutputs(body), some_poses(body)
    found = outputs.from_poses(poses)
    moved = found.copy()
    moved[:, outputs.components.heading] += 0.7
    turn = np.array([[np.cos(0.7), -np.sin(0.7), 0], [np.sin(0.7), np.cos(0.7), 0], [0, 0, 1]])
    frames = body.frames(outputs.to_poses(moved, np.zeros(3)))
    still = body.frames(outputs.to_poses(found, np.zeros(3)))
    np.testing.assert_allclose(frames, np.einsum("ab,nsbc->nsac", turn, still), atol=1e-12)
    np.testing.assert_allclose(
        outputs.components.wrapped(outputs.from_poses(poses, -0.7) - moved), 0.0, atol=1e-12
    )  # and so does another view


@pytest.mark.parametrize("name", ["person", "sedai-2013", "bodytrack", "du-2005"])
@pytest.mark.parametrize(("facing", "side"), [(0.0, None), (0.5 * np.pi, 1), (-0.5 * np.pi, -1), (np.pi, None)])
def test_facing_zero_faces_the_camera_and_a_quarter_the_pictures_right(name, facing, side):
    """Seen through the camera: who faces it has the left hip on the picture's right; who faces right has the knee,
    raised in front of the body, there."""
    body = named_body(name)
    outputs = PoseOutputs(body)
    camera = camera_at([3.0, 2.0, 1.4], [0.0, 0.0, 1.0])
    neutral = np.zeros((1, len(outputs.components)))
    flexion = "left_hip_flexion" if "left_hip_flexion" in body.dof_names else None
    if flexion:
        neutral[0, outputs.components.names.index(flexion)] = np.pi / 3
    neutral[0, outputs.components.heading] = facing
    pose = outputs.to_poses(neutral, np.array([0.0, 0.0, 0.9]), bearing(camera, camera.world_to_pixel(np.zeros(3))))
    joints = dict(zip(body.joint_names, camera.world_to_pixel(body.joints(pose)[0]), strict=True))
    if side is None:
        assert np.sign(joints["left_hip"][0] - joints["right_hip"][0]) == (1 if facing == 0.0 else -1)
    elif flexion:
        assert np.sign(joints["left_knee"][0] - joints["left_hip"][0]) == side


def test_the_bearing_is_along_the_ray():
    camera = camera_at([4.0, 0.0, 1.5], [0.0, 0.0, 1.5])
    assert bearing(camera) == pytest.approx(0.0)
    person = np.array([0.5, 1.0, 0.9])
    seen = bearing(camera, camera.world_to_pixel(person))
    assert seen == pytest.approx(np.arctan2(-1.0, 3.5))  # from the person to the camera
    assert abs(seen) > np.radians(15)  # by which the axis would be wrong


def test_a_camera_from_above_has_no_bearing():
    down = Camera("top", (640, 480), np.array([[600.0, 0, 320], [0, 600, 240], [0, 0, 1]]), np.zeros(5),
                  np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, 4.0]))  # fmt: skip
    with pytest.raises(InputError, match="straight up or down"):
        bearing(down)
    assert np.isfinite(bearing(down, np.array([20.0, 20.0])))  # what it sees at its border it sees from a side


def test_of_equal_headings_the_nearest_to_the_last():
    body = named_body("person")
    outputs = PoseOutputs(body)
    found = outputs.from_poses(some_poses(body))
    yaw = outputs.to_poses(found, np.zeros(3), near=20.0)[:, 3]
    assert (np.abs(yaw - 20.0) <= np.pi).all()
    plain = outputs.to_poses(found, np.zeros(3))[:, 3]
    np.testing.assert_allclose(np.mod(yaw - plain + 1, 2 * np.pi), 1.0, atol=1e-9)


def test_limits_are_kept():
    body = named_body("person")
    outputs = PoseOutputs(body)
    poses = outputs.to_poses(np.full((2, len(outputs.components)), -3.0), np.zeros(3))
    assert (poses >= body.lower).all() and (poses <= body.upper).all()


def test_what_wraps():
    components = PoseOutputs(named_body("person")).components
    assert [components.names[index] for index in components.circular] == ["root_yaw", "root_roll", "root_pitch"]
    assert components.names[components.heading] == "root_yaw"
    components = PoseOutputs(named_body("du-2005")).components
    assert components.names[components.heading] == "root_yaw"


def test_a_root_that_does_not_turn_about_the_vertical():
    from dataclasses import replace

    body = named_body("robot-arm")
    pedestal = replace(body.segments[0], rotations=())
    with pytest.raises(InputError, match="turns of the root about z, .*got none"):
        PoseOutputs(replace(body, segments=(pedestal, *body.segments[1:])))


def test_poses_of_another_body():
    with pytest.raises(InputError, match="33 numbers"):
        PoseOutputs(named_body("person")).from_poses(np.zeros((2, 27)))
