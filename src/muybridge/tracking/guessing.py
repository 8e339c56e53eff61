"""Guesses of the pose from the masks alone: who makes them, and what a tracker adds before a filter asks for them.

A regressor knows angles, up to whole turns, and not where the person stands. So a guess's turns are brought near to
those of the last estimate, and where that is not to be trusted, each mode is stood where the masks are.

Difference from Sedai et al. (2013), section IV-C: there the place of every sample is drawn from the motion model. That
is right while the person is tracked; who was lost is somewhere else.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from muybridge.body.model import Body
from muybridge.cameras.model import Camera
from muybridge.errors import InputError
from muybridge.filters import Guess, guided
from muybridge.filters.dynamics import GaussianWalk
from muybridge.likelihood.observation import Observation
from muybridge.tracking.start import Start, StartConfig, chosen, climbed, place_of_masks

PLACE = np.arange(3)  # components of a pose
PLACE_SD, PLACE_SD_ONE = 0.05, 0.1  # metres: of a mode's place among two or more cameras, and before one
SEARCHED = 0.3  # metres, one standard deviation: how far from where it is first set up a mode's place is looked for
SPREADS = (0.25, 0.15, 0.1, 0.07)  # metres; coarse, for the mode's limbs are not right either
JOINTS_SHARE = 0.95  # of the silhouette's height, from head top to ankles
EXTENT = (1.0, 99.0)  # percentiles of the mask's rows: a stray pixel is no head


class Guesser(Protocol):
    """Whatever guesses poses from silhouettes."""

    def guess(self, masks: Sequence[np.ndarray]) -> Guess | None:
        """A guess from one frame's masks, C times (H, W) bool, reduced; None where they show too little.

        Its components are indices of the tracked body's degrees of freedom.
        """
        ...


def turned_towards(guess: Guess, pose: np.ndarray, body: Body) -> Guess:
    """The guess with every turn that has no limits within half a turn of the pose (D,)."""
    free = (guess.components >= len(PLACE)) & np.isinf(body.upper)[guess.components]
    turns = np.round((pose[guess.components] - guess.means) / (2.0 * np.pi))
    return replace(guess, means=guess.means + np.where(free, 2.0 * np.pi * turns, 0.0))


def placed(guess: Guess, observation: Observation, pose: np.ndarray) -> Guess:
    """The guess with every mode stood where the masks are; itself where it speaks of the place already.

    pose : (D,) whatever the guess does not speak of
    """
    if np.isin(PLACE, guess.components).any():
        return guess
    places = np.array([_stood(mode, observation)[PLACE] for mode in guess.poses(pose)])
    sd = PLACE_SD if np.count_nonzero(observation.areas) > 1 else PLACE_SD_ONE
    return replace(
        guess,
        means=np.concatenate([places, guess.means], axis=1),
        variances=np.concatenate([np.full_like(places, sd**2), guess.variances], axis=1),
        components=np.concatenate([PLACE, guess.components]),
    )


def _stood(pose: np.ndarray, observation: Observation) -> np.ndarray:
    """The pose (D,) moved, not turned or bent, to where its outline meets the masks."""
    body = observation.body
    pose = pose.copy()
    if np.count_nonzero(observation.areas) > 1:
        pose[PLACE] += place_of_masks(observation.model.rig, observation) - body.joints(pose).mean(axis=0)
    else:
        pose[PLACE] += _way_of_one(pose, observation)
    dynamics = GaussianWalk(np.zeros(pose.size), body.lower, body.upper)
    precision = np.eye(pose.size) / SEARCHED**2
    return guided.climb(pose, precision, observation, dynamics, SPREADS, PLACE)[0]


def _way_of_one(pose: np.ndarray, observation: Observation) -> np.ndarray:
    """(3,) metres: how far to move a pose so that a single camera sees it in the mask's middle and as tall."""
    seeing = int(np.argmax(observation.areas))
    if not observation.areas[seeing]:
        raise InputError("place of the person", expected="a camera that sees the person", got="none")
    camera, factor = observation.model.rig[seeing], observation.model.reductions[seeing]
    rows, columns = np.nonzero(observation.masks[seeing])
    middle = (np.array([np.median(columns), np.median(rows)]) + 0.5) * factor - 0.5
    tall = factor * float(np.ptp(np.percentile(rows, EXTENT))) * JOINTS_SHARE
    origin, direction = camera.pixel_to_ray(middle)
    joints = observation.body.joints(pose)
    away = camera.matrix[1, 1] * observation.body.height / max(tall, 1.0)
    for _ in range(3):  # a nearer body is taller in inverse proportion, and seen a little from above
        way = origin + away * direction - joints.mean(axis=0)
        away *= _tall(camera, joints + way) / max(tall, 1.0)
    return origin + away * direction - joints.mean(axis=0)


def _tall(camera: Camera, joints: np.ndarray) -> float:
    """Rows that the joints (J, 3) span, pixels as recorded."""
    return float(np.ptp(camera.world_to_pixel(joints)[:, 1]))


def guessed_start(
    observation: Observation,
    guess: Guess,
    config: StartConfig = StartConfig(),  # noqa: B008 - frozen
) -> Start:
    """The best first pose among those that a guess leads to; it needs one camera only.

    Each mode is stood where the masks are and climbs, as the candidates of `start.automatic_start` do.
    """
    body = observation.body
    rest = np.clip(np.zeros(len(body.dof_names)), body.lower, body.upper)
    poses = np.clip(placed(guess, observation, rest).poses(rest), body.lower, body.upper)
    climbs = np.array([climbed(observation, pose, config, config.narrow) for pose in poses])
    return chosen(climbs, observation.costs(climbs).mean(axis=1), body, len(climbs))
