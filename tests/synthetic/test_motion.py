"""What a figure does must look like what people do: upright, forward, on its feet."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.evaluation.names import JOINTS
from muybridge.synthetic.motion import KINDS, Motion, perform
from muybridge.synthetic.skinning import load_figure

FIGURE = load_figure("man")


def of(track, name: str) -> np.ndarray:
    return track.joints[:, JOINTS.index(name)]


def facing(track) -> np.ndarray:
    """(T, 2) unit: ahead, from the line of the hips."""
    across = (of(track, "left_hip") - of(track, "right_hip"))[:, :2]
    ahead = np.stack([across[:, 1], -across[:, 0]], axis=1)
    return ahead / np.linalg.norm(ahead, axis=1, keepdims=True)


class TestErrors:
    def test_unknown_kind(self):
        with pytest.raises(InputError, match="expected one of walk, wave, crouch, got 'fly'"):
            Motion("fly")

    @pytest.mark.parametrize("name", ["duration", "rate", "cadence", "vigour"])
    @pytest.mark.parametrize("value", [0.0, -1.0, float("nan")])
    def test_not_positive(self, name, value):
        with pytest.raises(InputError, match=f"motion: {name}"):
            Motion(**{name: value})


@pytest.mark.parametrize("kind", KINDS)
class TestEvery:
    def test_same_seed_same_motion(self, kind):
        first, second = (perform(FIGURE, Motion(kind, duration=1.0, seed=4)).joints for _ in range(2))
        assert np.array_equal(first, second)

    def test_seeds_differ(self, kind):
        first, second = (perform(FIGURE, Motion(kind, duration=1.0, seed=seed)).joints for seed in (1, 2))
        assert np.abs(first - second).max() > 0.01

    def test_rotations(self, kind):
        turns = perform(FIGURE, Motion(kind, turn_rate=0.4)).rotations
        np.testing.assert_allclose(
            turns @ np.swapaxes(turns, -1, -2), np.broadcast_to(np.eye(3), turns.shape), atol=1e-9
        )

    def test_smooth(self, kind):
        """No joint is faster than a fast hand (4 m/s), none jumps: accelerations stay below 6 g."""
        joints = perform(FIGURE, Motion(kind)).joints
        assert np.linalg.norm(np.diff(joints, axis=0), axis=-1).max() * 30 < 4.0
        assert np.linalg.norm(np.diff(joints, 2, axis=0), axis=-1).max() * 900 < 60.0

    @pytest.mark.parametrize("name", ["man", "woman"])
    def test_feet_on_the_floor(self, kind, name):
        """The lowest vertex is within 1.5 cm of the floor: soles are rounded, and the body's height is smoothed."""
        figure = load_figure(name)
        track = perform(figure, Motion(kind, turn_rate=0.3))
        low = [figure.skin(track.rotations[t], track.places[t])[:, 2].min() for t in range(0, 90, 6)]
        assert -0.015 < min(low) and max(low) < 0.015

    def test_middle_of_the_clip_is_at_its_place(self, kind):
        track = perform(FIGURE, Motion(kind, place=(0.7, -0.4)))
        assert np.allclose(track.places[len(track.times) // 2, 0, :2], (0.7, -0.4))


class TestWalk:
    track = perform(FIGURE, Motion("walk", heading=0.9))

    def test_goes_where_it_is_headed_and_faces_there(self):
        step = of(self.track, "pelvis")[-1, :2] - of(self.track, "pelvis")[0, :2]
        assert np.degrees(abs(np.arctan2(step[1], step[0]) - 0.9)) < 5
        # The pelvis itself turns by 5 degrees.
        assert (facing(self.track) @ (step / np.linalg.norm(step))).min() > np.cos(np.radians(15))

    def test_even_speed(self):
        speed = np.linalg.norm(np.diff(of(self.track, "pelvis")[:, :2], axis=0), axis=1) * 30
        assert 0.7 < speed.mean() < 1.5
        assert speed.min() > 0.7 * speed.mean() and speed.max() < 1.3 * speed.mean()

    def test_upright(self):
        trunk = of(self.track, "thorax") - of(self.track, "pelvis")
        assert (trunk[:, 2] / np.linalg.norm(trunk, axis=1)).min() > np.cos(np.radians(12))
        assert (of(self.track, "head_top")[:, 2] > 1.7).all()

    def test_pelvis_rises_and_falls(self):
        height = of(self.track, "pelvis")[:, 2]
        assert 0.015 < np.ptp(height) < 0.06

    @pytest.mark.parametrize("side", ["left", "right"])
    def test_knees_bend_backward_and_elbows_forward(self, side):
        ahead = np.concatenate([facing(self.track), np.zeros((90, 1))], axis=1)
        for upper, hinge, lower, sign in (("hip", "knee", "ankle", 1), ("shoulder", "elbow", "wrist", -1)):
            ends = [of(self.track, f"{side}_{name}") for name in (upper, hinge, lower)]
            offset = np.einsum("ti,ti->t", ends[1] - 0.5 * (ends[0] + ends[2]), ahead)
            assert (sign * offset).min() > -0.03 and (sign * offset).max() > 0.03

    def test_arms_swing_against_the_legs(self):
        ahead = facing(self.track)
        arm = ((of(self.track, "left_wrist") - of(self.track, "left_shoulder"))[:, :2] * ahead).sum(axis=1)
        leg = ((of(self.track, "left_ankle") - of(self.track, "left_hip"))[:, :2] * ahead).sum(axis=1)
        assert np.corrcoef(arm, leg)[0, 1] < -0.6

    def test_bearing_foot_hardly_slips(self):
        """In half of all frames an ankle is slower than 15 cm/s: a foot is planted, while the body goes at 1 m/s."""
        ankles = np.stack([of(self.track, f"{side}_ankle")[:, :2] for side in ("left", "right")], axis=1)
        speed = np.linalg.norm(np.diff(ankles, axis=0), axis=-1) * 30
        assert np.median(speed.min(axis=1)) < 0.15

    def test_turns(self):
        track = perform(FIGURE, Motion("walk", turn_rate=0.5))
        ahead = np.unwrap(np.arctan2(*facing(track)[:, ::-1].T))
        # The pelvis turns by 5 degrees on its own, at both ends.
        assert ahead[-1] - ahead[0] == pytest.approx(0.5 * 89 / 30, abs=np.radians(11))

    def test_frame_rate_only_samples(self):
        slow, fast = (perform(FIGURE, Motion("walk", rate=rate)).joints for rate in (30.0, 60.0))
        # Planting adds up steps, so that rates differ by a discretisation error: well below the slip itself.
        assert np.abs(slow - fast[::2]).max() < 0.03


class TestOthers:
    def test_wave_raises_one_hand(self):
        track = perform(FIGURE, Motion("wave"))
        hands = [of(track, f"{side}_wrist")[60:, 2].min() for side in ("left", "right")]
        assert max(hands) > of(track, "thorax")[60:, 2].max() and min(hands) < 1.1
        ankles = np.stack([of(track, "left_ankle"), of(track, "right_ankle")])
        assert np.ptp(ankles, axis=1).max() < 0.02

    def test_crouch_goes_down_and_up(self):
        height = of(perform(FIGURE, Motion("crouch", cadence=0.9)), "pelvis")[:, 2]
        assert height[0] - height.min() > 0.25
        assert height[-1] > height[0] - 0.02
