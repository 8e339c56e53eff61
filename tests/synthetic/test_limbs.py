"""A leg reaches for a place: it gets there, keeps its lengths, and bends the knee to the front."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.synthetic.limbs import STRETCHED, leg_length, reach
from muybridge.synthetic.skinning import DOWN, FORWARD, load_figure

FIGURE = load_figure("man")
LENGTH = leg_length(FIGURE)


def reached(side: str, offsets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The figure standing at the origin, its ankle sent to hip + offsets (T, 3)."""
    neutral = np.tile(np.eye(3), (len(FIGURE.bone_names), 1, 1))
    worlds, places = (np.repeat(part[None], len(offsets), axis=0) for part in FIGURE.frames(neutral, np.zeros(3)))
    reach(FIGURE, worlds, places, side, places[:, FIGURE.bone(f"{side}_thigh")] + offsets)
    return worlds, places


def anywhere(count: int, longest: float) -> np.ndarray:
    """(count, 3) metres below the hip, from 0.3 of the leg's length to `longest`."""
    rng = np.random.default_rng(5)
    directions = rng.normal(size=(count, 3)) * (1, 0.5, 0.5) - (0, 0, 2)
    return (
        directions / np.linalg.norm(directions, axis=1, keepdims=True) * rng.uniform(0.3, longest, (count, 1)) * LENGTH
    )


@pytest.mark.parametrize("side", ["left", "right"])
class TestReach:
    def test_gets_there(self, side):
        offsets = anywhere(200, STRETCHED)
        _, places = reached(side, offsets)
        np.testing.assert_allclose(
            places[:, FIGURE.bone(f"{side}_foot")] - places[:, FIGURE.bone(f"{side}_thigh")], offsets
        )

    def test_is_forward_kinematics(self, side):
        """Bones keep lengths and joints hold: places follow from rotations, which are orthonormal."""
        worlds, places = reached(side, anywhere(50, 1.5))
        np.testing.assert_allclose(
            worlds @ np.swapaxes(worlds, -1, -2), np.broadcast_to(np.eye(3), worlds.shape), atol=1e-9
        )
        for bone in (FIGURE.bone(f"{side}_{part}") for part in ("shank", "foot", "toes")):
            parent = FIGURE.parents[bone]
            held = places[:, parent] + worlds[:, parent] @ FIGURE.neutral_offsets[bone]
            np.testing.assert_allclose(places[:, bone], held, atol=1e-9)

    def test_knee_goes_forward(self, side):
        _, places = reached(side, anywhere(100, 0.9))
        hip, knee, ankle = (places[:, FIGURE.bone(f"{side}_{part}")] for part in ("thigh", "shank", "foot"))
        assert ((knee - 0.5 * (hip + ankle)) @ FORWARD).min() > 0.0

    def test_too_far_is_reached_for(self, side):
        """Beyond the leg's length the ankle stays on the line to the target, short of it, and moves without a jump."""
        distances = np.linspace(0.97, 1.2, 400) * LENGTH
        _, places = reached(side, distances[:, None] * DOWN)
        got = (places[:, FIGURE.bone(f"{side}_foot")] - places[:, FIGURE.bone(f"{side}_thigh")]) @ DOWN
        assert got[-1] <= LENGTH and (np.diff(got) > -1e-12).all()
        assert np.diff(got, 2).min() > -1e-4 * LENGTH  # the yielding has no corner
        np.testing.assert_allclose(got[distances < STRETCHED * LENGTH], distances[distances < STRETCHED * LENGTH])

    def test_other_leg_is_left_alone(self, side):
        other = "right" if side == "left" else "left"
        worlds, _ = reached(side, anywhere(3, 0.8))
        assert np.array_equal(worlds[:, FIGURE.bone(f"{other}_thigh")], np.tile(np.eye(3), (3, 1, 1)))
