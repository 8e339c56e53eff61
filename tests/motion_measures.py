"""What the tests of motion measure on a track."""

from __future__ import annotations

import numpy as np

from muybridge.evaluation.names import JOINTS
from muybridge.synthetic.clip import Track
from muybridge.synthetic.limbs import SIDES
from muybridge.synthetic.planting import sole
from muybridge.synthetic.skinning import Figure


def of(track: Track, name: str) -> np.ndarray:
    """(T, 3) metres: a joint."""
    return track.joints[:, JOINTS.index(name)]


def facing(track: Track) -> np.ndarray:
    """(T, 2) unit: ahead, from the line of the hips."""
    across = (of(track, "left_hip") - of(track, "right_hip"))[:, :2]
    ahead = np.stack([across[:, 1], -across[:, 0]], axis=1)
    return ahead / np.linalg.norm(ahead, axis=1, keepdims=True)


def soles(figure: Figure, track: Track) -> np.ndarray:
    """(T, 2, 5, 3) metres: heel, ball, tip and edges of the left and right sole, as `foot_points`."""
    return np.stack([sole(figure, track.rotations, track.places, side) for side in SIDES], axis=1)


def fastest(track: Track) -> tuple[float, float]:
    """Largest speed and acceleration of a joint: metres per second, and per second squared."""
    moved, bent = (np.linalg.norm(np.diff(track.joints, n, axis=0), axis=-1).max() for n in (1, 2))
    return moved / track.interval, bent / track.interval**2


def lowest(figure: Figure, track: Track, every: int = 6) -> np.ndarray:
    """(T / every,) metres: the mesh's lowest vertex."""
    frames = range(0, len(track.times), every)
    return np.array([figure.skin(track.rotations[t], track.places[t])[:, 2].min() for t in frames])
