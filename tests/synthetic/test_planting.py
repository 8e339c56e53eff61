"""The points that stand for a sole: where a shoe's are, on every figure alike."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.synthetic.planting import foot_points
from muybridge.synthetic.skinning import figure_names, load_figure


@pytest.mark.parametrize("name", figure_names())
class TestFootPoints:
    def test_ball_is_in_the_middle_of_the_sole(self, name: str) -> None:
        """Across, it lies in the middle third of the sole there, so that footprints are where the foot's middle goes.

        Control: the nearest vertex of the sole, which some meshes have at the edge, does not.
        """
        figure = load_figure(name)
        shoes = figure.vertices[figure.labels == figure.label_names.index("shoes")]
        low = shoes[(shoes[:, 1] > 0) & (shoes[:, 2] < 0.025)]
        foot, toes = figure.bone("left_foot"), figure.bone("left_toes")
        near = low[np.abs(low[:, 0] - figure.heads[toes, 0]) < 0.02]
        inner, width = near[:, 1].min(), np.ptp(near[:, 1])
        ball = figure.heads[foot] + figure.to_neutral[foot].T @ foot_points(figure, "left")[1]
        assert 1 / 3 < (ball[1] - inner) / width < 2 / 3
        nearest = low[np.argmin(np.abs(low[:, 0] - figure.heads[toes, 0]) + low[:, 2])]
        assert not 1 / 3 < (nearest[1] - inner) / width < 2 / 3

    def test_heel_ball_and_tip_follow_each_other(self, name: str) -> None:
        figure = load_figure(name)
        for side in ("left", "right"):
            heel, ball, tip, right, left = foot_points(figure, side)
            toes = figure.neutral_offsets[figure.bone(f"{side}_toes")]
            assert heel[0] < -0.03 < 0.1 < ball[0] < (toes + tip)[0]
            # Shoes are 7 to 13 cm wide there, and the ball is far from either edge.
            assert right[1] < ball[1] - 0.025 and left[1] > ball[1] + 0.025 and 0.07 < left[1] - right[1] < 0.13

    def test_sides_mirror_each_other(self, name: str) -> None:
        figure = load_figure(name)
        left, right = (foot_points(figure, side) for side in ("left", "right"))
        np.testing.assert_allclose(left[[0, 1, 2, 4, 3]] * (1, -1, 1), right, atol=1e-3)
