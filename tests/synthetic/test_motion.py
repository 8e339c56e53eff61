"""What a figure does must look like what people do: upright, forward, on its feet."""

from __future__ import annotations

import numpy as np
import pytest

from motion_measures import facing, fastest, lowest, of, soles
from muybridge.errors import InputError
from muybridge.synthetic.motion import KINDS, Motion, perform
from muybridge.synthetic.skinning import figure_names, load_figure

FIGURE = load_figure("man")


#: Metres per second and per second squared that joints stay below. A walk's hand is slower than 4 m/s, and what stands
#: or steps is gentler than 6 g. The foot of a jog swings at three times the body's 2 m/s. A landing pushes the pelvis
#: with 2.1 g (half in the air: pi / 2 * 2 g - g) and bends the knee out of line by as much again and more.
#: The head of who falls like a rod, of height h, comes down at sqrt(3 g h) = 7.3 m/s.
LIMITS = dict.fromkeys(KINDS, (4.0, 60.0)) | {
    "jog": (7.0, 90.0),
    "hop": (4.0, 90.0),
    "jump": (4.0, 90.0),
    "lie": (7.3, 60.0),
}
FLYING = ("jog", "hop", "jump")


class TestErrors:
    def test_unknown_kind(self):
        with pytest.raises(InputError, match="expected one of walk, wave, crouch, jog, .*, got 'fly'"):
            Motion("fly")

    @pytest.mark.parametrize("name", ["duration", "rate", "cadence", "vigour"])
    @pytest.mark.parametrize("value", [0.0, -1.0, float("nan")])
    def test_not_positive(self, name, value):
        with pytest.raises(InputError, match=f"motion: {name}"):
            Motion(**{name: value})

    @pytest.mark.parametrize("values", [{"kind": "jump", "cadence": 0.3}, {"kind": "jog", "vigour": 4.0}])
    def test_more_than_legs_can_do(self, values):
        with pytest.raises(InputError, match=r"cadence and vigour: .* got hips 0\.\d+ m .*; raise cadence"):
            perform(FIGURE, Motion(**values))


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
        for seed in (0, 1):
            speed, acceleration = fastest(perform(FIGURE, Motion(kind, seed=seed)))
            assert speed < LIMITS[kind][0] and acceleration < LIMITS[kind][1]

    def test_a_jump_is_seen(self, kind):
        """The control: a joint that is 10 cm off in one frame is not smooth."""
        track = perform(FIGURE, Motion(kind))
        track.joints[40, 5] += 0.1
        assert fastest(track)[1] > LIMITS[kind][1]

    @pytest.mark.parametrize("name", ["man", "woman"])
    def test_feet_on_the_floor(self, kind, name):
        """The lowest vertex is within 1.5 cm of the floor: soles are rounded, and the body's height is smoothed.

        What flies comes down to it at times and is above it at others, by no more than a leap of 0.3 s is high.
        """
        figure = load_figure(name)
        low = lowest(figure, perform(figure, Motion(kind, turn_rate=0.3)), every=5)
        assert low.min() > -0.015
        if kind in FLYING:
            assert low.min() < 0.015 < low.max() < 9.81 * 0.3**2 / 8 + 0.05
        else:
            assert low.max() < 0.015

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


class TestFlight:
    @pytest.mark.parametrize("kind", FLYING)
    def test_free_fall(self, kind):
        """With no sole within 1 cm of the floor, the pelvis falls at g: a parabola's second differences are exact."""
        track = perform(FIGURE, Motion(kind, rate=240.0))
        off = soles(FIGURE, track)[..., 2].min(axis=(1, 2)) > 0.01
        alone = off[:-2] & off[1:-1] & off[2:]
        falls = np.diff(track.places[:, 0, 2], 2) * 240.0**2
        assert alone.mean() > {"jog": 0.05, "hop": 0.25, "jump": 0.25}[kind]
        np.testing.assert_allclose(falls[alone], -9.81, atol=1e-6)

    @pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in (*FLYING, "lie")])
    def test_others_never_leave_the_floor(self, kind):
        """The control: what walks or stands has a sole within 2 cm of the floor at any time."""
        assert soles(FIGURE, perform(FIGURE, Motion(kind)))[..., 2].min(axis=(1, 2)).max() < 0.02

    @pytest.mark.parametrize(("kind", "share"), [("jog", 0.33), ("jump", 0.5), ("turn", 0.66), ("sidestep", 0.62)])
    def test_a_bearing_foot_stands_still(self, kind, share):
        """The ball of each foot does not move at all for as much of the time as the foot bears, and moves otherwise."""
        track = perform(FIGURE, Motion(kind, duration=4.0, rate=120.0, turn_rate=0.6))
        balls = soles(FIGURE, track)[:, :, 1, :2]
        still = np.linalg.norm(np.diff(balls, axis=0), axis=-1) * 120.0 < 1e-3
        if kind == "jump":  # on the spot: balls are nearly still in flight as well
            assert (still.mean(axis=0) > share - 0.02).all()
        else:
            np.testing.assert_allclose(still.mean(axis=0), share, atol=0.06)

    def test_hop_uses_one_leg(self):
        for seed in range(4):
            low = soles(FIGURE, perform(FIGURE, Motion("hop", seed=seed)))[..., 2].min(axis=(0, 2))
            assert low.min() < 0.01 and low.max() > 0.08

    def test_both_legs_are_used_for_hopping(self):
        used = {
            int(soles(FIGURE, perform(FIGURE, Motion("hop", 1.0, seed=s)))[..., 2].min(axis=(0, 2)).argmin())
            for s in range(8)
        }
        assert used == {0, 1}


class TestPaths:
    def test_jog_goes_where_it_is_headed(self):
        track = perform(FIGURE, Motion("jog", heading=-2.0))
        went = (of(track, "pelvis")[-1] - of(track, "pelvis")[0])[:2]
        assert 1.7 < np.linalg.norm(went) / (89 / 30) < 2.4
        assert went / np.linalg.norm(went) @ (np.cos(-2.0), np.sin(-2.0)) > np.cos(np.radians(3))
        assert (facing(track) @ (np.cos(-2.0), np.sin(-2.0))).min() > np.cos(np.radians(15))

    @pytest.mark.parametrize(("kind", "rate"), [("jog", 0.8), ("turn", -1.1)])
    def test_turns(self, kind, rate):
        ahead = facing(perform(FIGURE, Motion(kind, turn_rate=rate)))
        turned = np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
        assert turned[-1] - turned[0] == pytest.approx(rate * 89 / 30, abs=np.radians(14))

    def test_turn_stays_on_the_spot_and_has_a_side_of_its_own(self):
        sides = set()
        for seed in range(6):
            track = perform(FIGURE, Motion("turn", seed=seed))
            assert np.ptp(track.places[:, 0, :2], axis=0).max() < 0.05
            ahead = facing(track)
            sides.add(np.sign(np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))[[0, -1]] @ (-1, 1)))
        assert sides == {-1.0, 1.0}

    @pytest.mark.parametrize("name", figure_names())
    def test_sidestep_goes_sideways_without_crossing(self, name):
        track = perform(load_figure(name), Motion("sidestep", heading=0.5))
        went = (of(track, "pelvis")[-1] - of(track, "pelvis")[0])[:2]
        assert abs(went @ (-np.sin(0.5), np.cos(0.5))) > 0.95 * np.linalg.norm(went) > 0.8
        left = np.array([-np.sin(0.5), np.cos(0.5)])
        apart = (of(track, "left_ankle") - of(track, "right_ankle"))[:, :2] @ left
        assert apart.min() > 0.08

    @pytest.mark.parametrize("kind", ["jog", "turn", "sidestep"])
    def test_frame_rate_only_samples(self, kind):
        """Footprints are functions of time; only the body's height is found from the frames: a few millimetres."""
        slow, fast = (perform(FIGURE, Motion(kind, rate=rate, place=(1, 2))) for rate in (30.0, 60.0))
        shift = (fast.joints[::2] - slow.joints) - (fast.joints[90] - slow.joints[45])
        assert np.abs(shift).max() < 0.03


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

    def test_punch_reaches_out_with_both_arms(self):
        track = perform(FIGURE, Motion("punch", heading=0.0))
        for side in ("left", "right"):
            reach = np.linalg.norm(of(track, f"{side}_wrist") - of(track, f"{side}_shoulder"), axis=1)
            forward = (of(track, f"{side}_wrist") - of(track, f"{side}_shoulder"))[reach.argmax()]
            assert reach.min() < 0.35 and reach.max() > 0.5
            assert forward[0] > 0.8 * reach.max()

    @pytest.mark.parametrize("name", figure_names())
    @pytest.mark.parametrize("seed", [0, 1, 2])
    def test_bend_lowers_the_trunk_to_half_of_the_height_and_raises_it(self, name, seed):
        figure = load_figure(name)
        track = perform(figure, Motion("bend", duration=6.0, seed=seed))
        highest = track.joints[..., 2].max(axis=1)
        assert highest.min() < 0.55 * highest[0] and highest[-1] == pytest.approx(highest[0], abs=0.01)
        ankles = np.stack([of(track, f"{side}_ankle") for side in ("left", "right")])
        assert np.ptp(ankles, axis=1)[..., :2].max() < 0.1  # of a shoe of 0.28: it does not step

    @pytest.mark.parametrize("seed", range(4))
    def test_who_lies_lies_flat_and_stands_up_again(self, seed):
        """No joint is higher than a knee bent by 30 degrees is: sin 30 of 0.43 m, over the hip's 0.12."""
        track = perform(FIGURE, Motion("lie", duration=8.0, seed=seed))
        highest = track.joints[..., 2].max(axis=1)
        assert highest.min() < 0.34
        assert np.count_nonzero(highest < 0.34) > 30  # of its 4.8 s, it falls in one and gets up in less than two
        trunk = (of(track, "thorax") - of(track, "pelvis"))[highest.argmin()]
        assert abs(trunk[2]) < 0.3 * np.linalg.norm(trunk)
        assert highest[[0, -1]].min() > 1.7

    def test_some_lie_on_the_back_and_some_on_the_face(self):
        """The shoes' tips point up or down: toes are above the ankles, or below."""
        sides = set()
        for seed in range(6):
            track = perform(FIGURE, Motion("lie", duration=6.0, seed=seed))
            lowest_at = track.joints[..., 2].max(axis=1).argmin()
            toes, foot = (track.places[lowest_at, FIGURE.bone(f"left_{bone}"), 2] for bone in ("toes", "foot"))
            sides.add(toes > foot)
        assert sides == {True, False}
