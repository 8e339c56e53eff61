"""Legs that reach for a place: inverse kinematics of hip, knee and ankle, in closed form."""

from __future__ import annotations

import numpy as np

from muybridge.synthetic.skinning import FORWARD, Figure

SIDES = ("left", "right")
#: Share of the leg's length from which on a straightening leg gives way, so that a knee never snaps.
STRETCHED = 0.995


def leg_length(figure: Figure) -> float:
    """Metres, from hip to ankle, the knee straight."""
    return sum(_lengths(figure, "left"))


def reach(figure: Figure, worlds: np.ndarray, places: np.ndarray, side: str, ankles: np.ndarray) -> None:
    """Turn thigh and shank so that the ankle comes to where it should be; foot and toes keep their orientation.

    Parameters
    ----------
    worlds, places : (T, B, 3, 3) and (T, B, 3) metres, world; both are changed
        The knee bends to where the thigh's front looks.
    ankles : (T, 3) metres, world; a place farther than the leg is long is reached for, but not reached
    """
    thigh, shank, foot, toes = (figure.bone(f"{side}_{part}") for part in ("thigh", "shank", "foot", "toes"))
    upper, lower = _lengths(figure, side)
    to_ankle = ankles - places[:, thigh]
    distance = np.linalg.norm(to_ankle, axis=1)
    along = to_ankle / distance[:, None]
    distance = np.maximum(_yielding(distance, upper + lower), 1.001 * abs(upper - lower))
    front = worlds[:, thigh] @ FORWARD
    front -= (front * along).sum(axis=1, keepdims=True) * along
    front /= np.linalg.norm(front, axis=1, keepdims=True)
    cosine = np.clip((upper**2 + distance**2 - lower**2) / (2 * upper * distance), -1.0, 1.0)[:, None]
    knees = upper * (cosine * along + np.sqrt(1.0 - cosine**2) * front)
    reached = distance[:, None] * along
    hinge = np.cross(front, along)  # to the left, as FORWARD x DOWN is
    worlds[:, thigh] = _pointing(knees / upper, hinge)
    worlds[:, shank] = _pointing((reached - knees) / lower, hinge)
    places[:, shank] = places[:, thigh] + knees
    places[:, foot] = places[:, thigh] + reached
    places[:, toes] = places[:, foot] + worlds[:, foot] @ figure.neutral_offsets[toes]


def _lengths(figure: Figure, side: str) -> tuple[float, float]:
    """Metres: thigh and shank."""
    thigh, shank = (np.linalg.norm(figure.neutral_offsets[figure.bone(f"{side}_{part}")]) for part in ("shank", "foot"))
    return float(thigh), float(shank)


def _yielding(distance: np.ndarray, length: float) -> np.ndarray:
    """(T,) metres: the distance itself, from STRETCHED on nearing the leg's length and never passing it."""
    limit = STRETCHED * length
    room = length - limit
    over = np.maximum(distance - limit, 0.0)
    return np.minimum(distance, limit) + room * (1.0 - np.exp(-over / room))


def _pointing(downward: np.ndarray, leftward: np.ndarray) -> np.ndarray:
    """(T, 3, 3): the bone frames whose -z and +y are these perpendicular unit vectors (T, 3)."""
    return np.stack([np.cross(leftward, -downward), leftward, -downward], axis=-1)
