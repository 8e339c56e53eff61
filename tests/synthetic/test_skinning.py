"""The baked people: their mesh follows their bones, and their joints are where a person's are."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.evaluation.names import JOINTS
from muybridge.synthetic.skinning import SEGMENTS, Figure, figure_names, load_figure

STATURE = {
    "man": 1.79,
    "woman": 1.67,
    "heavy_man": 1.88,
    "slight_woman": 1.55,
    "old_man": 1.72,
    "old_woman": 1.59,
    "strong_man": 1.84,
    "child": 1.42,
}
LITRES = {"child": (25, 55), "heavy_man": (95, 170)}  # others weigh 45 to 110 kg


def still(figure: Figure) -> np.ndarray:
    return np.tile(np.eye(3), (len(figure.bone_names), 1, 1))


def neutral_joints(figure: Figure) -> dict[str, np.ndarray]:
    return dict(zip(JOINTS, figure.joints(*figure.frames(still(figure), np.zeros(3))), strict=True))


def random_posture(figure: Figure, rng: np.random.Generator) -> np.ndarray:
    turns, _ = np.linalg.qr(rng.normal(size=(len(figure.bone_names), 3, 3)))
    return turns * np.sign(np.linalg.det(turns))[:, None, None]


@pytest.fixture(params=STATURE, scope="module")
def figure(request) -> Figure:
    return load_figure(request.param)


class TestFile:
    def test_names(self):
        assert figure_names() == tuple(sorted(STATURE))

    def test_segments_share_the_bones_out(self, figure):
        bones = [bone for group in SEGMENTS.values() for bone in group]
        assert sorted(bones) == sorted(figure.bone_names)

    def test_constants_check_themselves(self, figure):
        assert np.allclose(figure.weights.sum(axis=1), 1)
        assert figure.faces.min() == 0 and figure.faces.max() == len(figure.vertices) - 1
        assert (figure.parents[1:] < np.arange(1, len(figure.parents))).all() and figure.parents[0] == -1
        assert len(figure.face_labels) == len(figure.corner_uv) == len(figure.faces)
        assert figure.corner_uv.min() >= 0 and figure.corner_uv.max() <= 1
        assert figure.looseness.min() == 0 and figure.looseness.max() > 0.9

    def test_every_label_is_worn(self, figure):
        worn = set(np.unique(figure.regions)) | set(np.unique(figure.face_labels)) - {-1}
        assert worn == set(range(len(figure.label_names)))
        assert set(np.unique(figure.labels)) <= worn

    def test_stature_and_floor(self, figure):
        # Hair and soles add up to 3 cm to the bare person that was baked.
        assert 0 <= np.ptp(figure.vertices[:, 2]) - STATURE[figure.name] < 0.03
        assert figure.vertices[:, 2].min() == pytest.approx(0, abs=1e-6)

    def test_left_is_plus_y_and_front_plus_x(self, figure):
        heads = dict(zip(figure.bone_names, figure.heads, strict=True))
        assert heads["left_hand"][1] > 0.2 > -0.2 > heads["right_hand"][1]
        assert heads["left_toes"][0] - heads["left_foot"][0] > 0.1

    def test_volume_is_a_persons(self, figure):
        # Divergence theorem; faces run outward, and a person weighs about 1 kg a litre. Clothes and hair included.
        a, b, c = figure.vertices[figure.faces].transpose(1, 0, 2)
        low, high = LITRES.get(figure.name, (45, 110))
        assert low < 1e3 * np.einsum("fi,fi->f", a, np.cross(b, c)).sum() / 6 < high


class TestSkin:
    def test_at_rest_nothing_moves(self, figure):
        vertices = figure.skin(figure.to_neutral.transpose(0, 2, 1).copy(), figure.heads)
        np.testing.assert_allclose(vertices, figure.vertices, atol=1e-12)

    def test_moves_with_the_root(self, figure):
        turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
        posture = still(figure)
        before = figure.skin(*figure.frames(posture, np.zeros(3)))
        posture[0] = turn
        after = figure.skin(*figure.frames(posture, np.array([1.0, 2, 3])))
        np.testing.assert_allclose(after, before @ turn.T + (1, 2, 3), atol=1e-12)

    def test_turns_are_rotations(self, figure):
        turns = figure.to_neutral
        np.testing.assert_allclose(
            turns @ turns.transpose(0, 2, 1), np.broadcast_to(np.eye(3), turns.shape), atol=1e-12
        )
        assert (np.linalg.det(turns) > 0).all()

    def test_bones_keep_their_length(self, figure):
        rng = np.random.default_rng(3)
        expected = np.linalg.norm(figure.heads[1:] - figure.heads[figure.parents[1:]], axis=1)
        for _ in range(5):
            _, places = figure.frames(random_posture(figure, rng), rng.normal(size=3))
            np.testing.assert_allclose(
                np.linalg.norm(places[1:] - places[figure.parents[1:]], axis=1), expected, rtol=1e-9
            )


class TestJoints:
    def test_neutral_posture_is_straight(self, figure):
        at = neutral_joints(figure)
        for side in ("left", "right"):
            for upper, lower in (("shoulder", "elbow"), ("elbow", "wrist"), ("hip", "knee"), ("knee", "ankle")):
                along = at[f"{side}_{lower}"] - at[f"{side}_{upper}"]
                assert along[2] < 0 and np.abs(along[:2]).max() < 1e-9

    def test_symmetric(self, figure):
        at = neutral_joints(figure)
        for name in JOINTS:
            if name.startswith("left_"):
                np.testing.assert_allclose(at[name] * (1, -1, 1), at["right_" + name[5:]], atol=2e-3)

    def test_proportions(self, figure):
        """Shares of stature against Drillis and Contini's: within 15 %, for they are one person's, not the mean's."""
        at, tall = neutral_joints(figure), STATURE[figure.name]
        for upper, lower, share in (
            ("left_shoulder", "left_elbow", 0.172),  # to the joint centres, 1.4 % of stature less than to the acromion
            ("left_elbow", "left_wrist", 0.146),
            ("left_hip", "left_knee", 0.245),
            ("left_knee", "left_ankle", 0.246),
        ):
            assert np.linalg.norm(at[upper] - at[lower]) / tall == pytest.approx(share, rel=0.15), (upper, lower)

    def test_inside_the_mesh(self, figure):
        """Every joint but the top of the head lies within its limb: all around it there is skin within 15 cm."""
        world, places = figure.frames(still(figure), np.zeros(3))
        vertices = figure.skin(world, places)
        for name, joint in zip(JOINTS, figure.joints(world, places), strict=True):
            slab = vertices[np.abs(vertices[:, 2] - joint[2]) < 0.02] - joint
            near = slab[np.hypot(slab[:, 0], slab[:, 1]) < (0.25 if name in ("pelvis", "thorax") else 0.15)]
            quadrants = {(x > 0, y > 0) for x, y in near[:, :2]}
            assert len(quadrants) == 4 or name == "head_top", name
