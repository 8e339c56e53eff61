"""Let a figure do what a `Motion` says."""

from __future__ import annotations

import numpy as np

from muybridge.synthetic.angles import rotations
from muybridge.synthetic.clip import KINDS, Motion, Track
from muybridge.synthetic.gaits import crouch, walk, wave
from muybridge.synthetic.planting import planted
from muybridge.synthetic.skinning import Figure

__all__ = ["KINDS", "Motion", "Track", "perform"]

ANGLES = {"walk": walk, "wave": wave, "crouch": crouch}


def perform(figure: Figure, motion: Motion) -> Track:
    """Let the figure do the motion: angles, then feet on the floor without sliding, then the path's place."""
    rng = np.random.default_rng([motion.seed, KINDS.index(motion.kind)])
    angles, bearing = ANGLES[motion.kind](rng, motion)
    turn_rate = motion.turn_rate if motion.kind == "walk" else 0.0
    heading = motion.heading + turn_rate * (motion.times - 0.5 * motion.times[-1])
    local = rotations(figure, angles, heading)
    worlds, places = zip(*(figure.frames(turns, np.zeros(3)) for turns in local), strict=True)
    worlds, places = np.array(worlds), np.array(places)
    places += planted(figure, worlds, places, bearing, motion)[:, None]
    joints = np.array([figure.joints(world, place) for world, place in zip(worlds, places, strict=True)])
    return Track(motion.times, worlds, places, joints)
