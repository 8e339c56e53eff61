"""Motions that are told by where the feet go: jog, hop, jump, turn, sidestep; `stepping` moves the legs.

Each gives the angles of trunk and arms, and the steps. Lengths are for legs of 0.88 m and scale with the figure's.
Shares of time on the ground and heights of flight follow each other: the rest is free fall.
"""

from __future__ import annotations

import numpy as np

from muybridge.synthetic.angles import Angles, add
from muybridge.synthetic.clip import Motion
from muybridge.synthetic.gaits import standing
from muybridge.synthetic.limbs import SIDES
from muybridge.synthetic.stepping import Steps

LEG = 0.88


def jog(rng: np.random.Generator, motion: Motion, leg: float) -> tuple[Angles, Steps]:
    """An easy run, about 2 m/s and 2.7 steps a second at the default cadence: each foot bears 33 % of the stride."""
    rate, begin = 1.5 * motion.cadence * np.sqrt(LEG / leg), rng.uniform()
    speed = 2.0 * motion.vigour * rng.uniform(0.92, 1.08) * leg / LEG
    steps = Steps(
        rate,
        begin,
        bears=(0.33, 0.33),
        speed=speed,
        turn_rate=motion.turn_rate,
        apart=0.05 * leg / LEG,
        ahead=-0.02,
        lift=rng.uniform(0.10, 0.13) * leg / LEG,
        pitch=((0.0, 2.0), (0.1, 0.0), (0.18, 4.0), (0.33, 38.0), (0.54, 92.0), (0.68, 70.0), (0.86, 12.0)),
        flight=True,
    )
    angles = standing(rng, motion)
    swing, bend = rng.uniform(20, 30), rng.uniform(72, 92)
    left = 2 * np.pi * (begin + rate * motion.times - 0.18)  # 0: the middle of the left foot's bearing
    for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
        arm = -sign * np.sin(left + 0.9) * motion.vigour  # forward with the other leg
        add(angles, f"{side}_upper_arm", -8.0 + swing * arm, 5.0, 12.0 if side == "right" else -12.0)
        add(angles, f"{side}_forearm", bend + 12.0 * arm)
    add(angles, "pelvis", -6.0, 3.0 * np.cos(left), -6.0 * np.sin(left + 0.9))
    add(angles, "abdomen", -3.0, -2.0 * np.cos(left), 7.0 * np.sin(left + 0.9))
    add(angles, "thorax", -2.0, -1.0 * np.cos(left), 7.0 * np.sin(left + 0.9))
    add(angles, "neck", 7.0, 0.0, -8.0 * np.sin(left + 0.9))
    return angles, steps


def hop(rng: np.random.Generator, motion: Motion, leg: float) -> tuple[Angles, Steps]:
    """On one leg, on the spot: the free foot is kept behind, the arms help; half of the time in the air."""
    left = rng.uniform() < 0.5
    bears = (0.5, 0.0) if left else (0.0, 0.5)
    angles, steps = _hops(rng, motion, leg, bears, 2.2 * motion.cadence, apart=0.035)
    own, free = SIDES if left else SIDES[::-1]
    add(angles, f"{free}_thigh", rng.uniform(14.0, 32.0), 3.0)
    add(angles, f"{free}_shank", -rng.uniform(85.0, 100.0) + 8.0 * _beat(steps, motion))
    add(angles, f"{free}_foot", -8.0)
    add(angles, "pelvis", 0.0, 4.0 if left else -4.0)
    add(angles, "abdomen", 0.0, -5.0 if left else 5.0)
    add(angles, f"{own}_upper_arm", 0.0, 10.0)
    return angles, steps


def jump(rng: np.random.Generator, motion: Motion, leg: float) -> tuple[Angles, Steps]:
    """On both legs, on the spot, again and again; half of the time in the air."""
    return _hops(rng, motion, leg, (0.5, 0.5), 1.9 * motion.cadence, apart=0.1)


def turn(rng: np.random.Generator, motion: Motion, leg: float) -> tuple[Angles, Steps]:
    """Round on the spot in small steps, by `turn_rate`, or by about a radian a second to either side."""
    side = 1.0 if rng.uniform() < 0.5 else -1.0
    turn_rate = motion.turn_rate or side * motion.vigour * rng.uniform(0.9, 1.2)
    rate, begin = 1.0 * motion.cadence, rng.uniform()
    heel = rng.uniform(10.0, 18.0)
    steps = Steps(
        rate,
        begin,
        bears=(0.66, 0.66),
        turn_rate=turn_rate,
        apart=0.1 * leg / LEG,
        ahead=-0.03,
        lift=0.06,
        pitch=((0.0, 0.0), (0.55, 0.0), (0.72, heel), (0.9, 0.5 * heel)),
    )
    angles = standing(rng, motion)
    lean = np.sin(2 * np.pi * (begin + rate * motion.times - 0.08))  # to the side of the foot that bears
    add(angles, "pelvis", 0.0, 2.0 * lean)
    add(angles, "abdomen", 0.0, -2.0 * lean, np.sign(turn_rate) * 4.0)
    add(angles, "neck", 0.0, 0.0, np.sign(turn_rate) * 8.0)
    for name, sign in zip(SIDES, (1.0, -1.0), strict=True):
        add(angles, f"{name}_upper_arm", 6.0 * sign * lean, 4.0)
        add(angles, f"{name}_forearm", 8.0)
    return angles, steps


def sidestep(rng: np.random.Generator, motion: Motion, leg: float) -> tuple[Angles, Steps]:
    """To the left or right, facing ahead; a foot leads, the other one closes, and they do not cross."""
    left = rng.uniform() < 0.5
    rate = 1.1 * motion.cadence
    steps = Steps(
        rate,
        rng.uniform(),
        bears=(0.62, 0.62),
        speed=0.42 * motion.vigour * rng.uniform(0.9, 1.1) * leg / LEG,
        direction=0.5 * np.pi if left else -0.5 * np.pi,
        apart=0.19 * leg / LEG,
        ahead=-0.03,
        lift=0.05,
        pitch=((0.0, 0.0), (0.5, 0.0), (0.66, 16.0), (0.9, 4.0)),
    )
    angles = standing(rng, motion)
    sway = np.sin(2 * np.pi * (steps.begin + rate * motion.times))
    for name in SIDES:
        add(angles, f"{name}_upper_arm", 14.0, 12.0 + 3.0 * sway)
        add(angles, f"{name}_forearm", rng.uniform(30.0, 45.0) + 4.0 * sway)
    add(angles, "pelvis", -4.0, 1.5 * sway)
    add(angles, "abdomen", -4.0, -2.0 * sway)
    add(angles, "neck", 6.0)
    return angles, steps


def _hops(
    rng: np.random.Generator, motion: Motion, leg: float, bears: tuple[float, float], rate: float, apart: float
) -> tuple[Angles, Steps]:
    """Hops on the feet that bear: they land on the ball, the heel comes down, and the toes push off."""
    heel = rng.uniform(26.0, 34.0)
    flying = 0.5 / rate
    steps = Steps(
        rate,
        rng.uniform(),
        shifts=(0.0, 0.0),
        bears=bears,
        apart=apart * leg / LEG,
        ahead=-0.06,
        lift=9.81 * flying**2 / 8,
        pitch=((0.0, 0.7 * heel), (0.2, 3.0), (0.3, 3.0), (0.5, heel), (0.62, 1.3 * heel), (0.9, 0.8 * heel)),
        flight=True,
        rises=1,
    )
    beat = _beat(steps, motion)
    angles = standing(rng, motion)
    spread = rng.uniform(8.0, 20.0)
    for side in SIDES:
        add(angles, f"{side}_upper_arm", 8.0 - 10.0 * beat * motion.vigour, spread + 5.0 * beat)
        add(angles, f"{side}_forearm", 48.0 + 10.0 * beat)
    add(angles, "pelvis", -4.0 + 2.0 * beat)
    add(angles, "abdomen", -4.0 + 3.0 * beat)
    add(angles, "neck", 5.0 - 3.0 * beat)
    return angles, steps


def _beat(steps: Steps, motion: Motion) -> np.ndarray:
    """(T,) -1 at the lowest of each hop, 1 at the highest."""
    return -np.cos(2 * np.pi * (steps.begin + steps.rate * motion.times - 0.25))
