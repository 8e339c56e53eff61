"""From joint angles to a body on the floor: soles touch it, and the foot that bears the weight hardly slips."""

from __future__ import annotations

import numpy as np

from muybridge.synthetic.clip import Motion
from muybridge.synthetic.skinning import Figure

#: Seconds (standard deviation) over which the body's speed is evened out; the price is a foot that slips a little.
SURGE = 0.06
#: Metres along the foot within which vertices lie beside its ball.
BESIDE = 0.02


def planted(figure: Figure, worlds: np.ndarray, places: np.ndarray, bearing: np.ndarray, motion: Motion) -> np.ndarray:
    """(T, 3) metres: shift of the body so that soles touch the floor, and the foot that bears it stays where it is."""
    soles = np.stack([sole(figure, worlds, places, side) for side in ("left", "right")], axis=1)  # (T, 2, points, 3)
    lowest = soles[..., 2].min(axis=2)
    shift = np.zeros((len(worlds), 3))
    shift[:, 2] = -smoothed(lowest.min(axis=1), width=0.02 * motion.rate)
    grip = np.exp(-(soles[..., 2] - lowest[..., None]) / 0.01)
    share = (bearing + 1e-6)[..., None] * grip / grip.sum(axis=2, keepdims=True)
    weight = share[1:] + share[:-1]
    steps = np.diff(soles[..., :2], axis=0)
    slide = (weight[..., None] * steps).sum(axis=(1, 2)) / weight.sum(axis=(1, 2))[:, None]
    # The legs alone would make the body surge twice a stride more than people do.
    speed = np.stack([smoothed(column, width=SURGE * motion.rate) for column in slide.T], axis=1)
    shift[1:, :2] = -np.cumsum(speed, axis=0)
    shift[:, :2] += np.asarray(motion.place) - (places[:, 0] + shift)[len(shift) // 2, :2]
    return shift


def sole(figure: Figure, worlds: np.ndarray, places: np.ndarray, side: str) -> np.ndarray:
    """(T, points, 3): the points of a shoe's sole in the order of `foot_points`; they stand for its lowest vertices."""
    foot, toes = figure.bone(f"{side}_foot"), figure.bone(f"{side}_toes")
    points = []
    for reach, bone in zip(foot_points(figure, side), (foot, foot, toes, foot, foot), strict=True):
        points.append(places[:, bone] + worlds[:, bone] @ reach)
    return np.stack(points, axis=1)


def lowest(figure: Figure, worlds: np.ndarray, places: np.ndarray) -> np.ndarray:
    """(T,) metres: the height of the mesh's lowest vertex, for bodies that more than soles bear."""
    return np.array([figure.skin(*frame)[:, 2].min() for frame in zip(worlds, places, strict=True)])


def foot_points(figure: Figure, side: str) -> np.ndarray:
    """(5, 3) metres: heel, ball, tip, and the sole's right and left edge beside the ball, in the neutral posture.

    They count from the ankle, the tip from the head of the toes. The ball lies under the head of the toes: footprints
    are where balls are, and the nearest vertex lies on either edge, as the mesh has it, 6 cm to the side.
    """
    shoes = np.flatnonzero(figure.labels == figure.label_names.index("shoes"))
    left = figure.vertices[shoes, 1] > 0
    own = figure.vertices[shoes[left if side == "left" else ~left]]
    foot, toes = figure.bone(f"{side}_foot"), figure.bone(f"{side}_toes")
    low = own[own[:, 2] < 0.025]
    ball = figure.heads[toes]
    beside = low[np.abs(low[:, 0] - ball[0]) < BESIDE]
    ends = [low[np.argmin(low[:, 0])], ball, low[np.argmax(low[:, 0])]]
    edges = [beside[np.argmin(beside[:, 1])], beside[np.argmax(beside[:, 1])]]
    return np.stack(
        [
            figure.to_neutral[bone] @ (point * (1, 1, 0) - figure.heads[bone])
            for point, bone in zip([*ends, *edges], (foot, foot, toes, foot, foot), strict=True)
        ]
    )


def smoothed(values: np.ndarray, width: float) -> np.ndarray:
    """Gaussian running mean, so that the change of feet has no corner."""
    reach = max(1, int(np.ceil(3 * width)))
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / max(width, 1e-6)) ** 2)
    padded = np.pad(values, reach, mode="edge")
    return np.convolve(padded, kernel / kernel.sum(), mode="valid")
