"""Down and up again: crouch, bend, lie, each as joint angles by how far down one is, varied by a seed.

On the spot, or at a stop of a walk (`route`).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from muybridge.synthetic.angles import Angles, add, smooth_step
from muybridge.synthetic.clip import Motion
from muybridge.synthetic.gaits import standing
from muybridge.synthetic.limbs import SIDES

#: Strides' time to go down, and to come up: at the usual 0.9 strides a second one falls within a second.
TAKES: dict[str, tuple[float, float]] = {"crouch": (0.9, 0.9), "bend": (0.9, 0.9), "lie": (0.9, 1.6)}
DOWN_FROM, DOWN_TO = 0.25, 0.85  # of a clip without a way: begins to go down, is up again
STILLER = 0.7  # share of an upright body's sway that the floor takes from who lies on it


def crouch(rng: np.random.Generator, motion: Motion) -> tuple[Angles, np.ndarray]:
    """Down and up again, on both feet."""
    angles = standing(rng, motion)
    depth = 0.5 - 0.5 * np.cos(2 * np.pi * np.clip(motion.cadence * motion.times / 2.4, 0, 1))
    _crouched(rng, angles, motion.vigour * depth)
    return angles, np.ones((len(motion.times), 2))


def bend(rng: np.random.Generator, motion: Motion) -> tuple[Angles, np.ndarray]:
    """Deep down at the hips, as to pick something up, and up again."""
    return _in_the_middle(rng, motion)


def lie(rng: np.random.Generator, motion: Motion) -> tuple[Angles, np.ndarray]:
    """A fall on the back or the face, a while there, and up again."""
    return _in_the_middle(rng, motion)


def lower(rng: np.random.Generator, motion: Motion, angles: Angles, begin: float, seconds: float) -> np.ndarray:
    """Add to the angles of who stands there what goes down from a time on, for so many seconds.

    Returns
    -------
    (T,) : how far down one is, 0 to 1
    """
    down, up = (strides / motion.cadence for strides in TAKES[motion.kind])
    since = motion.times - begin
    depth = smooth_step(since / down) * (1.0 - smooth_step((since - seconds + up) / up))
    POSTURES[motion.kind](rng, angles, motion.vigour * depth)
    return depth


def _in_the_middle(rng: np.random.Generator, motion: Motion) -> tuple[Angles, np.ndarray]:
    angles = standing(rng, motion)
    length = motion.times[-1]
    lower(rng, motion, angles, DOWN_FROM * length, (DOWN_TO - DOWN_FROM) * length)
    return angles, np.ones((len(motion.times), 2))


def _crouched(rng: np.random.Generator, angles: Angles, depth: np.ndarray) -> None:
    depth = np.minimum(depth, 1.1) * rng.uniform(0.85, 1.0)
    for side in SIDES:
        add(angles, f"{side}_thigh", 85.0 * depth, 9.0 * depth)
        add(angles, f"{side}_shank", -105.0 * depth)
        add(angles, f"{side}_foot", 28.0 * depth)
        add(angles, f"{side}_upper_arm", 62.0 * depth, 8.0 * depth)
        add(angles, f"{side}_forearm", 25.0 * depth)
    add(angles, "pelvis", -8.0 * depth)
    add(angles, "abdomen", -14.0 * depth)
    add(angles, "thorax", -10.0 * depth)
    add(angles, "neck", 14.0 * depth)


def _bent(rng: np.random.Generator, angles: Angles, depth: np.ndarray) -> None:
    """The trunk horizontal and lower, the hips back, the knees bent, the arms hanging."""
    depth = np.minimum(depth, 1.1) * rng.uniform(0.9, 1.0)
    for side in SIDES:
        add(angles, f"{side}_thigh", 112.0 * depth, 4.0 * depth)
        add(angles, f"{side}_shank", -80.0 * depth)
        add(angles, f"{side}_foot", 28.0 * depth)
        add(angles, f"{side}_upper_arm", 100.0 * depth, 4.0 * depth)
        add(angles, f"{side}_forearm", 40.0 * depth)
    add(angles, "pelvis", -60.0 * depth)
    add(angles, "abdomen", -32.0 * depth)
    add(angles, "thorax", -24.0 * depth)
    add(angles, "neck", -4.0 * depth)


def _lying(rng: np.random.Generator, angles: Angles, depth: np.ndarray) -> None:
    """The knees give way, the trunk falls on the back or the face; then one leg is bent and the arms are spread."""
    depth = np.minimum(depth, 1.0)
    for bone, turned in angles.items():
        angles[bone] = turned * (1.0 - STILLER * depth[:, None])
    on_back = rng.uniform() < 0.5
    giving_way = 4.0 * depth * (1.0 - depth)
    bent = SIDES[int(rng.uniform() < 0.5)]
    add(angles, "pelvis", (90.0 if on_back else -90.0) * depth)
    for side in SIDES:
        raised = rng.uniform(10, 30) if on_back and side == bent else 0.0
        add(angles, f"{side}_thigh", 45.0 * giving_way + raised * depth, rng.uniform(4, 14) * depth)
        add(angles, f"{side}_shank", -70.0 * giving_way - 1.6 * raised * depth)
        add(angles, f"{side}_foot", 25.0 * giving_way - (0.0 if on_back else 60.0) * depth)
        add(angles, f"{side}_upper_arm", 0.0, rng.uniform(15, 55) * depth)
        add(angles, f"{side}_forearm", rng.uniform(5, 50) * giving_way)


POSTURES: dict[str, Callable[[np.random.Generator, Angles, np.ndarray], None]] = {
    "crouch": _crouched,
    "bend": _bent,
    "lie": _lying,
}
