"""Feet of a retargeted recording: on the floor where they bear, not below it anywhere.

A foot bears while its sole is low and slow. Over each such spell its slip, followed where the sole touches, is taken
back, and the sole is set on the floor; between spells the correction goes evenly from one to the next. The body goes up
and down a little with its feet, as far as their corrections agree and the legs can reach; the legs do the rest.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d, maximum_filter1d, minimum_filter1d

from muybridge.synthetic.angles import smooth_step
from muybridge.synthetic.limbs import SIDES, STRETCHED, leg_length, reach
from muybridge.synthetic.planting import sole
from muybridge.synthetic.skinning import Figure

#: Metres over the floor, metres per second: a foot bears below the first of each pair and does not above the second.
LOW, SLOW = (0.03, 0.06), (0.5, 1.0)
#: Seconds: spells shorter than this are none; standard deviations for corrections of feet and of the body. Feet: 15 ms
#: leaves twice the slip on CMU's subject 02 (4 to 11 cm/s), 4 ms a quarter, but knees then jerk by half as much again.
SHORTEST, FEET, BODY = 0.06, 0.008, 0.1
#: Percentile of the lower sole's height that is the floor: most people stand on it most of the time. Other legs, on a
#: floor that was not quite level, come down elsewhere: metres by which the floor may differ, seconds in which it does.
FLOOR, UNEVEN, STRETCH = 10.0, 0.06, 1.2


def settle(figure: Figure, worlds: np.ndarray, places: np.ndarray, rate: float) -> None:
    """Put the feet of a moving body on the floor z = 0.

    Parameters
    ----------
    worlds, places : (T, B, 3, 3) and (T, B, 3) metres, world; both are changed
    rate : frames per second
    """
    soles = np.stack([sole(figure, worlds, places, side) for side in SIDES], axis=1)
    level = floor_level(soles[..., 2].min(axis=(1, 2)), rate)
    places[..., 2] -= level[:, None]
    soles[..., 2] -= level[:, None, None]
    fixes = np.stack([correction(soles[:, foot], rate) for foot in (0, 1)], axis=1)
    ankles = [places[:, figure.bone(f"{side}_foot")] + fixes[:, foot] for foot, side in enumerate(SIDES)]
    places[..., 2] += gaussian_filter1d(fixes[..., 2].mean(axis=1), BODY * rate, mode="nearest")[:, None]
    places[..., 2] -= _out_of_reach(figure, places, ankles, rate)[:, None]
    for side, target in zip(SIDES, ankles, strict=True):
        reach(figure, worlds, places, side, target)


def floor_level(lowest: np.ndarray, rate: float) -> np.ndarray:
    """(T,) metres: the floor's height under the body, from that of the lower sole (T,)."""
    usual = np.percentile(lowest, FLOOR)
    near = minimum_filter1d(lowest, 2 * round(0.5 * STRETCH * rate) + 1, mode="nearest")
    return usual + gaussian_filter1d(np.clip(near - usual, -UNEVEN, UNEVEN), 0.3 * STRETCH * rate, mode="nearest")


def correction(soles: np.ndarray, rate: float) -> np.ndarray:
    """(T, 3) metres: what is to be added to a foot, given the points of its sole (T, points, 3)."""
    lowest = soles[..., 2].min(axis=1)
    velocity = grip_velocity(soles, rate)
    fix = np.zeros((len(soles), 3))
    spells = bearing_spells(lowest, np.linalg.norm(velocity, axis=1), rate)
    inside = np.zeros(len(soles), dtype=bool)
    for begin, end in spells:
        slipped = np.cumsum(velocity[begin:end], axis=0) / rate
        fix[begin:end, :2] = slipped.mean(axis=0) - slipped
        fix[begin:end, 2] = -lowest[begin:end]
        inside[begin:end] = True
    _bridge(fix, inside)
    fix[:, 2] = np.maximum(fix[:, 2], -lowest)
    return gaussian_filter1d(fix, FEET * rate, axis=0, mode="nearest")


def grip_velocity(soles: np.ndarray, rate: float) -> np.ndarray:
    """(T, 2) metres per second: how fast the lowest part of a sole (T, points, 3) moves over the floor."""
    grip = np.exp(-(soles[..., 2] - soles[..., 2].min(axis=1, keepdims=True)) / 0.01)
    share = grip[1:] + grip[:-1]
    share /= share.sum(axis=1, keepdims=True)
    moved = (share[..., None] * np.diff(soles[..., :2], axis=0)).sum(axis=1) * rate
    return np.concatenate([moved[:1], moved]) if len(moved) else np.zeros((len(soles), 2))


def bearing_spells(lowest: np.ndarray, speed: np.ndarray, rate: float) -> list[tuple[int, int]]:
    """Begin and end (not included) of the times when a foot bears, from its height (T,) and speed (T,)."""
    low = 1.0 - smooth_step((lowest - LOW[0]) / (LOW[1] - LOW[0]))
    slow = 1.0 - smooth_step((speed - SLOW[0]) / (SLOW[1] - SLOW[0]))
    bears = np.concatenate([[False], low * slow > 0.5, [False]]).astype(int)
    begins, ends = np.flatnonzero(np.diff(bears) == 1), np.flatnonzero(np.diff(bears) == -1)
    return [(int(b), int(e)) for b, e in zip(begins, ends, strict=True) if e - b >= SHORTEST * rate]


def _bridge(fix: np.ndarray, inside: np.ndarray) -> None:
    """Fill corrections (T, 3) outside the spells, evenly and without corners; nothing where there is no spell."""
    known = np.flatnonzero(inside)
    if not len(known):
        return
    for t in np.flatnonzero(~inside):
        after = int(np.searchsorted(known, t))
        first, last = known[max(after - 1, 0)], known[min(after, len(known) - 1)]
        share = smooth_step(np.array((t - first) / (last - first))) if last > first else 0.0
        fix[t] = fix[first] + share * (fix[last] - fix[first])


def _out_of_reach(figure: Figure, places: np.ndarray, ankles: list[np.ndarray], rate: float) -> np.ndarray:
    """(T,) metres, without jumps: how far the body must come down for both ankles to be within reach."""
    length = STRETCHED * leg_length(figure)
    down = np.zeros(len(places))
    for side, target in zip(SIDES, ankles, strict=True):
        hip = places[:, figure.bone(f"{side}_thigh")]
        flat = np.linalg.norm((target - hip)[:, :2], axis=1)
        allowed = target[:, 2] + np.sqrt(np.maximum(length**2 - flat**2, 0.0))
        down = np.maximum(down, hip[:, 2] - allowed)
    width = 0.5 * BODY * rate
    return gaussian_filter1d(maximum_filter1d(down, 2 * round(width) + 1, mode="nearest"), width, mode="nearest")
