"""Let a figure do what a `Motion` says, or a `Recorded` one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from muybridge.synthetic import footwork, gaits, lowered
from muybridge.synthetic.angles import Angles, rotations
from muybridge.synthetic.clip import KINDS, Motion, Track
from muybridge.synthetic.limbs import leg_length
from muybridge.synthetic.planting import lowest, planted
from muybridge.synthetic.recorded import Recorded, pose
from muybridge.synthetic.route import route
from muybridge.synthetic.skinning import Figure
from muybridge.synthetic.stepping import Steps, heading_at, step

__all__ = ["KINDS", "Motion", "Recorded", "Track", "perform"]

#: Angles of the whole body, and the share (T, 2) of the weight on the left and right foot.
FROM_ANGLES: dict[str, Callable[[np.random.Generator, Motion], tuple[Angles, np.ndarray]]] = {
    "walk": gaits.walk,
    "wave": gaits.wave,
    "crouch": lowered.crouch,
    "punch": gaits.punch,
    "bend": lowered.bend,
    "lie": lowered.lie,
}
#: Angles of all but the legs, and the steps; the last argument is the length of the legs in metres.
FROM_STEPS: dict[str, Callable[[np.random.Generator, Motion, float], tuple[Angles, Steps]]] = {
    "jog": footwork.jog,
    "hop": footwork.hop,
    "jump": footwork.jump,
    "turn": footwork.turn,
    "sidestep": footwork.sidestep,
}


def perform(figure: Figure, motion: Motion | Recorded) -> Track:
    """Let the figure do the motion."""
    worlds, places = pose(figure, motion) if isinstance(motion, Recorded) else _made(figure, motion)
    joints = np.array([figure.joints(world, place) for world, place in zip(worlds, places, strict=True)])
    return Track(motion.times, worlds, places, joints)


def _made(figure: Figure, motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """(T, B, 3, 3) and (T, B, 3) metres, world: a motion that needs no recording."""
    rng = np.random.default_rng([motion.seed, KINDS.index(motion.kind)])
    if motion.way:
        return route(rng, figure, motion)
    return (_by_steps if motion.kind in FROM_STEPS else _by_angles)(rng, figure, motion)


def _by_angles(rng: np.random.Generator, figure: Figure, motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """Angles, then feet on the floor without sliding, then the path's place."""
    angles, bearing = FROM_ANGLES[motion.kind](rng, motion)
    turn_rate = motion.turn_rate if motion.kind == "walk" else 0.0
    heading = motion.heading + turn_rate * (motion.times - 0.5 * motion.times[-1])
    worlds, places = _posed(figure, rotations(figure, angles, heading))
    places += planted(figure, worlds, places, bearing, motion)[:, None]
    if motion.kind == "lie":
        places[..., 2] -= lowest(figure, worlds, places)[:, None]
    return worlds, places


def _by_steps(rng: np.random.Generator, figure: Figure, motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """The path and its footprints, then legs that reach them."""
    angles, steps = FROM_STEPS[motion.kind](rng, motion, leg_length(figure))
    heading = heading_at(steps, motion.times - 0.5 * motion.times[-1], motion.heading)
    worlds, places = _posed(figure, rotations(figure, angles, heading))
    step(figure, worlds, places, steps, motion.times, motion.heading)
    places[..., :2] += np.asarray(motion.place) - places[len(places) // 2, 0, :2]
    return worlds, places


def _posed(figure: Figure, local: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(T, B, 3, 3) and (T, B, 3): world rotations and places, the pelvis at the origin."""
    worlds, places = zip(*(figure.frames(turns, np.zeros(3)) for turns in local), strict=True)
    return np.array(worlds), np.array(places)
