"""The right body for a tracker: its joints are the figure's, and its outlines nearly so."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.body import Body, named_body
from muybridge.cameras.model import Rig
from muybridge.cameras.rotations import rotation_from_vector
from muybridge.evaluation.names import JOINTS
from muybridge.likelihood.observation import ImageLikelihood
from muybridge.synthetic.measure import FIGURE_TO_BODY, tracker_body
from muybridge.synthetic.rasterise import coverage_of
from muybridge.synthetic.rigs import looking_at
from muybridge.synthetic.skinning import Figure, figure_names, load_figure

TENTH = 1e-4  # metres
#: Degrees of a walk's step, which the body's girths were not fitted in; flexions forward.
BENT = {"shoulder_flexion": 40.0, "elbow_flexion": 60.0, "hip_flexion": 25.0, "knee_flexion": 40.0}
BONES = {"shoulder": "upper_arm", "elbow": "forearm", "hip": "thigh", "knee": "shank"}


def figure_frames(figure: Figure, bent: dict[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """World turns (B, 3, 3) and places (B, 3) with both sides bent so: flexion turns about -y, a knee's about +y."""
    turns = np.tile(np.eye(3), (len(figure.bone_names), 1, 1))
    for name, degrees in bent.items():
        joint = name.removesuffix("_flexion")
        axis = np.array([0.0, 1.0 if joint == "knee" else -1.0, 0.0])
        for side in ("left", "right"):
            turns[figure.bone(f"{side}_{BONES[joint]}")] = rotation_from_vector(np.radians(degrees) * axis)
    return figure.frames(turns, np.zeros(3))


def figure_joints(figure: Figure, bent: dict[str, float]) -> np.ndarray:
    """(15, 3) metres from the pelvis, in the body's axes."""
    joints = figure.joints(*figure_frames(figure, bent))
    return (joints - joints[JOINTS.index("pelvis")]) @ FIGURE_TO_BODY.T


def body_pose(body: Body, bent: dict[str, float]) -> np.ndarray:
    """(D,) with the pelvis at the origin."""
    return np.radians([bent.get(name.removeprefix("left_").removeprefix("right_"), 0.0) for name in body.dof_names])


class TestJoints:
    @pytest.mark.parametrize("name", figure_names())
    def test_are_the_figures(self, name: str) -> None:
        """Upright, and bent: the segments turn about the same centres. The catalogue's person is 1 cm off and more."""
        figure, body = load_figure(name), tracker_body(name)
        assert body.joint_names == JOINTS
        for bent in ({}, BENT):
            truth = figure_joints(figure, bent)
            away = np.linalg.norm(body.joints(body_pose(body, bent)) - truth, axis=1)
            assert away.max() < TENTH
            other = named_body("person", body.height)
            assert np.linalg.norm(other.joints(body_pose(other, bent)) - truth, axis=1).mean() > 0.01

    @pytest.mark.parametrize("name", figure_names())
    def test_the_rest_is_the_catalogues(self, name: str) -> None:
        """Names, limits and what is usual, so that a tracker takes it as any person."""
        body, person = tracker_body(name), named_body("person")
        assert body.dof_names == person.dof_names and body.segment_names == person.segment_names
        for column in ("lower", "upper", "usual"):
            np.testing.assert_array_equal(getattr(body, column), getattr(person, column))
        assert body.radius_groups == person.radius_groups


class TestGirths:
    @pytest.mark.parametrize("name", figure_names())
    def test_are_a_bodys(self, name: str) -> None:
        """Half axes between those of a child's hand's edge and half of a heavy trunk's width."""
        for segment in tracker_body(name).segments:
            if segment.shape is not None:
                axes = np.outer(segment.shape.radii, segment.shape.scale)
                assert 0.005 < axes.min() and axes.max() < 0.3, segment.name

    def test_a_skirt_is_wider_than_the_legs(self) -> None:
        """What it wears is measured with it, where it hangs: at the knee."""
        wide = {}
        for cut in ("skirt", "shorts"):
            body = tracker_body("woman", cut)
            shape = body.segments[body.segment_names.index("left_thigh")].shape
            assert shape is not None
            wide[cut] = shape.radii[1] * shape.scale[1]
        assert wide["skirt"] > 1.3 * wide["shorts"]


def masks_of(figure: Figure, rig: Rig) -> list[np.ndarray]:
    """(H, W) bool: the bent figure, its pelvis at the origin, in the body's axes."""
    frames = figure_frames(figure, BENT)
    pelvis = figure.joints(*frames)[JOINTS.index("pelvis")]
    vertices = (figure.skin(*frames) - pelvis) @ FIGURE_TO_BODY.T
    return [coverage_of(camera.world_to_pixel(vertices), figure.faces, *camera.size) for camera in rig]


@pytest.mark.parametrize("name", ["woman", "old_man"])
def test_its_outlines_are_nearly_the_figures(name: str) -> None:
    """Against the catalogue's person of that height in the same pose, seen from five sides.

    A person's outline is about 8 m long round 0.6 m^2, so that it adds 0.7 % of cost a millimetre that it is off: 6 %
    are 9 mm, in a pose that the girths were not fitted in, where flesh bulges. Measured: 4.3 and 3.9 % against 9.0 and
    12.1 %.
    """
    figure, body = load_figure(name), tracker_body(name)
    turns = 0.3 + 2 * np.pi * np.arange(5) / 5
    places = 3 * np.column_stack([np.cos(turns), np.sin(turns), np.full(5, 0.13)])
    aim = np.array([0.0, 0.0, -0.1])
    rig = Rig(tuple(looking_at(f"c{i}", at, aim, focal=600.0, size=(480, 480)) for i, at in enumerate(places)))
    masks = masks_of(figure, rig)
    assert all(not (mask[[0, -1]].any() or mask[:, [0, -1]].any()) for mask in masks), "cut off by the picture"
    costs = []
    for each in (body, named_body("person", body.height)):
        costs.append(ImageLikelihood(each, rig, (1,) * 5).observe(masks).costs(body_pose(each, BENT)).mean())
    assert costs[0] < 0.06 and costs[0] < 0.6 * costs[1]
