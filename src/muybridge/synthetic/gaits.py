"""Motions as joint angles over time, each varied by a seed.

The walk's joint angles are tables of normal gait over one stride (heel strike to heel strike; after D. A. Winter,
Biomechanics and Motor Control of Human Movement, 4th ed., chapter 4, smoothed). `planting` then moves the body so that
the foot that bears it stays nearly still, and raises it so that it touches the floor: steps and speed follow from the
legs.
"""

from __future__ import annotations

import numpy as np

from muybridge.synthetic.angles import Angles, add, periodic, smooth_step
from muybridge.synthetic.clip import Motion
from muybridge.synthetic.limbs import SIDES

#: Degrees at equal steps of the stride of the same leg: flexion of hip and knee, dorsiflexion of ankle and toes. They
#: were fitted, near normal gait, so that a body carried by them goes at an even speed and a steady height.
HIP = (19, 17, 16.4, 14.8, 11.1, 5.5, -1.2, -7.5, -11.3, -12, -10.7, -7.8, -3.3, 4, 11, 17, 21, 22.5, 22, 20.5)
KNEE = (5, 13, 17, 9, 4, 18, 38, 61, 50, 19)
ANKLE = (2, -2, 2, 8, 8, 11, -12, -7, 5, 1)
TOES = (8, 0, 0, 0, 4, 24, 26, 8, 6, 8)
#: Share of the stride at which a foot takes and gives up the body's weight (begin, end of each change).
TAKES, GIVES = (0.0, 0.10), (0.50, 0.62)


def walk(rng: np.random.Generator, motion: Motion, strides: np.ndarray | None = None) -> tuple[Angles, np.ndarray]:
    """Normal gait: legs by tables, arms against them; strides (T,) done so far, at an even cadence where None."""
    phase = rng.uniform() + (motion.cadence * motion.times if strides is None else strides)
    swing, lag = rng.uniform(17, 25), rng.uniform(-0.03, 0.03)
    angles = standing(rng, motion)
    for side, shift in (("left", 0.0), ("right", 0.5)):
        own = phase + shift
        lean = np.sin(2 * np.pi * own)
        add(angles, f"{side}_thigh", motion.vigour * periodic(HIP, own), -1.5 - 5.0 * lean)
        add(angles, f"{side}_shank", -motion.vigour * periodic(KNEE, own))
        add(angles, f"{side}_foot", periodic(ANKLE, own))
        add(angles, f"{side}_toes", periodic(TOES, own))
        arm = -np.cos(2 * np.pi * (own + lag - 0.03)) * motion.vigour  # back at the heel strike of its own side
        add(angles, f"{side}_upper_arm", 1.0 + swing * arm)
        add(angles, f"{side}_forearm", 12.0 + 0.6 * swing * np.maximum(0.0, arm + 0.35))
    left = 2 * np.pi * phase
    add(angles, "pelvis", -2.0 + 1.0 * np.cos(2 * left), 3.5 * np.sin(left), -5.0 * np.cos(left))
    add(angles, "abdomen", 1.0, -2.5 * np.sin(left), 5.0 * np.cos(left))
    add(angles, "thorax", -1.0, -1.0 * np.sin(left), 5.0 * np.cos(left))
    add(angles, "neck", 0.0, 0.5 * np.sin(left), -4.5 * np.cos(left))
    return angles, np.stack([_bearing(phase), _bearing(phase + 0.5)], axis=1)


def wave(rng: np.random.Generator, motion: Motion) -> tuple[Angles, np.ndarray]:
    """Standing, one arm up, the forearm to and fro."""
    side = "right" if rng.uniform() < 0.7 else "left"
    angles = standing(rng, motion)
    raised = smooth_step(motion.times / 0.9) * motion.vigour
    swing = np.sin(2 * np.pi * 1.6 * motion.cadence * motion.times)
    add(angles, f"{side}_clavicle", 0.0, 14.0 * raised)
    add(angles, f"{side}_upper_arm", 84.0 * raised, 0.0, (-48.0 if side == "right" else 48.0) * raised)
    add(angles, f"{side}_forearm", 78.0 * raised, (6.0 + 26.0 * swing) * raised)
    add(angles, "thorax", 0.0, (-4.0 if side == "right" else 4.0) * raised)
    add(angles, "head", 0.0, 0.0, (8.0 if side == "left" else -8.0) * raised)
    return angles, np.ones((len(motion.times), 2))


def punch(rng: np.random.Generator, motion: Motion) -> tuple[Angles, np.ndarray]:
    """In a boxer's stance, the fists before the chin: straight punches, now one arm, now the other."""
    angles = standing(rng, motion)
    lead, rear = SIDES if rng.uniform() < 0.6 else SIDES[::-1]
    sign = 1.0 if lead == "left" else -1.0
    phase = rng.uniform() + 0.8 * motion.cadence * motion.times
    thrust = {lead: _thrust(phase), rear: _thrust(phase - 0.45)}
    twist = sign * 15.0 * (thrust[rear] - 0.8 * thrust[lead])
    add(angles, "pelvis", -5.0, 0.0, 0.3 * twist - 14.0 * sign)
    add(angles, "abdomen", -6.0, 0.0, 0.5 * twist)
    add(angles, "thorax", -4.0, 0.0, 0.6 * twist)
    add(angles, "neck", 4.0, 0.0, 14.0 * sign - 0.8 * twist)
    for side, inward in (("left", -1.0), ("right", 1.0)):
        out = thrust[side] * min(motion.vigour, 1.1)
        turned = 1.4 * twist - 14.0 * sign + 10.0 * inward  # of trunk and clavicle; the fist goes straight ahead
        add(angles, f"{side}_clavicle", 0.0, 6.0 * out, 10.0 * out * inward)
        add(angles, f"{side}_upper_arm", 28.0 + 54.0 * out, 4.0 - 6.0 * out, -turned * out)
        add(angles, f"{side}_forearm", 122.0 - 112.0 * out, 0.0, inward * 10.0 * (1.0 - out))
    for side, ahead in ((lead, 1.0), (rear, -1.0)):
        add(angles, f"{side}_thigh", 14.0 + 10.0 * ahead, 5.0)
        add(angles, f"{side}_shank", -28.0)
        add(angles, f"{side}_foot", 14.0 - 10.0 * ahead)
    return angles, np.ones((len(motion.times), 2))


def _thrust(phase: np.ndarray) -> np.ndarray:
    """(T,) 0 with the fist at the chin, 1 with the arm straight: out in a fifth of the time, back in a little more."""
    own = phase % 1.0
    return smooth_step(own / 0.2) * (1.0 - smooth_step((own - 0.22) / 0.28))


def standing(rng: np.random.Generator, motion: Motion) -> Angles:
    """Upright and alive: arms a little off the body, slow sway, breathing."""
    sway = [np.sin(2 * np.pi * (rng.uniform(0.2, 0.45) * motion.times + rng.uniform())) for _ in range(4)]
    angles: Angles = {}
    for side, k in (("left", 0), ("right", 1)):
        add(angles, f"{side}_upper_arm", 2.0 * sway[k], 9.0 + 1.0 * sway[1 - k])
        add(angles, f"{side}_forearm", 6.0 + 2.0 * sway[k])
        add(angles, f"{side}_hand", 6.0)
        add(angles, f"{side}_thigh", 0.0, 1.0)
    add(angles, "thorax", 0.6 * sway[2], 0.8 * sway[3])
    add(angles, "head", 2.0 * sway[2], 0.0, 4.0 * sway[3])
    return angles


def _bearing(phase: np.ndarray) -> np.ndarray:
    """(T,) share of the weight that a leg bears at this phase of its stride."""
    phase = phase % 1.0
    taken = smooth_step((phase - TAKES[0]) / (TAKES[1] - TAKES[0]))
    return taken * (1.0 - smooth_step((phase - GIVES[0]) / (GIVES[1] - GIVES[0])))
