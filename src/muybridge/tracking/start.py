"""The first pose, found without help: place from the masks, several headings and postures, each climbed by its contour.

Works where two or more cameras see the person. The person's place is where the rays through the masks' middles meet; at
that place each posture of a short list is set up in each of `headings` directions and climbs from there. The pose of
lowest silhouette cost wins; how far the next different one is behind says how sure that is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from muybridge.body.model import Body
from muybridge.cameras.model import Rig
from muybridge.errors import InputError
from muybridge.filters import guided
from muybridge.filters.dynamics import GaussianWalk
from muybridge.likelihood.observation import Observation

#: Postures to begin from, degrees by degree of freedom; names that a body does not have are left out.
POSTURES: tuple[Mapping[str, float], ...] = (
    {},
    {"left_shoulder_abduction": 70, "right_shoulder_abduction": 70},
    {
        "left_shoulder_abduction": 30,
        "right_shoulder_abduction": 30,
        "left_elbow_flexion": 40,
        "right_elbow_flexion": 40,
    },
    {
        "left_hip_flexion": 30,
        "right_hip_flexion": -20,
        "right_knee_flexion": 20,
        "right_shoulder_flexion": 25,
        "left_shoulder_flexion": -25,
    },
    {
        "right_hip_flexion": 30,
        "left_hip_flexion": -20,
        "left_knee_flexion": 20,
        "left_shoulder_flexion": 25,
        "right_shoulder_flexion": -25,
    },
    {"left_shoulder_flexion": 80, "right_shoulder_flexion": 80},
)
DRAWN_POSTURES = 3  # of a body that is no person: its limits are all that is known


@dataclass(frozen=True)
class StartConfig:
    """Settings of the search for the first pose."""

    headings: int = 16
    refined: int = 8  # candidates that are climbed once more with narrow spreads
    place_sd: float = 0.3  # metres
    turn_sd: float = 0.6  # radians
    wide: tuple[float, ...] = tuple(0.03 + 0.3 * 0.8**i for i in range(10))  # metres, spreads of the first climb
    narrow: tuple[float, ...] = (0.12, 0.08, 0.06, 0.045, 0.035, 0.03)
    highest_cost: float = 0.38  # of the two-sided silhouette; upright right answers lie near .2, wrong ones above .3


@dataclass(frozen=True, eq=False)
class Start:
    """A first pose (D,), its cost in [0, 1], and the cost of the best that heads at least 90 degrees elsewhere."""

    pose: np.ndarray
    cost: float
    rival_cost: float


def automatic_start(observation: Observation, config: StartConfig = StartConfig()) -> Start:
    """The best first pose in one frame.

    Raises
    ------
    InputError
        Fewer than two cameras see anything.
    """
    model = observation.model
    place = place_of_masks(model.rig, observation)
    starts = _candidates(model.body, place, config.headings)
    poses = np.array([climbed(observation, pose, config, config.wide) for pose in starts])
    order = np.argsort(observation.costs(poses).mean(axis=1))[: config.refined]
    refined = np.array([climbed(observation, pose, config, config.narrow) for pose in poses[order]])
    poses = np.concatenate([refined, poses])  # among the others may be the only ones that head elsewhere
    costs = observation.costs(poses).mean(axis=1)
    return chosen(poses, costs, model.body, len(refined))


def chosen(poses: np.ndarray, costs: np.ndarray, body: Body, good: int) -> Start:
    """The cheapest of the first `good` poses (N, D), and what the cheapest that heads elsewhere costs."""
    best = int(np.argmin(costs[:good]))
    yaw = body.dof_names.index("root_yaw")
    apart = np.cos(poses[:, yaw] - poses[best, yaw]) < 0.0
    rival = float(costs[apart].min()) if apart.any() else 1.0
    return Start(poses[best], float(costs[best]), rival)


def place_of_masks(rig: Rig, observation: Observation) -> np.ndarray:
    """(3,) metres, world: nearest point to the rays through the middles of the masks.

    Middles are medians: a shadow or a stray blob moves them little.
    """
    seeing = np.flatnonzero(observation.areas > 0)
    if len(seeing) < 2:
        raise InputError(
            "automatic start",
            expected="two or more cameras that see the person",
            got=str(len(seeing)),
            remedy="give the first pose in [start], or a later first frame",
        )
    matrix, vector = np.zeros((3, 3)), np.zeros(3)
    for c in seeing:
        factor = observation.model.reductions[int(c)]
        rows, columns = np.nonzero(observation.masks[int(c)])
        middle = (np.array([np.median(columns), np.median(rows)]) + 0.5) * factor - 0.5
        origin, direction = rig[int(c)].pixel_to_ray(middle)
        across = np.eye(3) - np.outer(direction, direction)
        matrix, vector = matrix + across, vector + across @ origin
    return np.linalg.solve(matrix, vector)


def _candidates(body: Body, place: np.ndarray, headings: int) -> list[np.ndarray]:
    poses = []
    for number, posture in enumerate(_postures(body, headings)):
        pose = posture.copy()
        pose[body.dof_names.index("root_yaw")] += 2 * np.pi * (number % headings) / headings
        centre = body.joints(pose).mean(axis=0)
        pose[:3] += place - centre
        poses.append(pose)
    return poses


def _postures(body: Body, headings: int) -> list[np.ndarray]:
    """Poses (D,), one a candidate: a person's by name; another body's at rest, then anywhere within its limits."""
    upright = _upright(body)
    if "left_hip_flexion" not in body.dof_names:
        limited = np.isfinite(body.lower) & np.isfinite(body.upper)
        low, high = np.where(limited, body.lower, upright), np.where(limited, body.upper, upright)
        drawn = np.random.default_rng(0).uniform(
            low, high, (DRAWN_POSTURES * headings, len(upright))
        )  # always the same
        return [upright] * headings + list(drawn)
    postures = []
    for posture in POSTURES:
        pose = upright.copy()
        for name, degrees in posture.items():
            if name in body.dof_names:
                pose[body.dof_names.index(name)] = np.radians(degrees)
        postures += [pose] * headings
    return postures


def _upright(body: Body) -> np.ndarray:
    return np.clip(np.zeros(len(body.dof_names)), body.lower, body.upper)


def climbed(observation: Observation, pose: np.ndarray, config: StartConfig, spreads: tuple[float, ...]) -> np.ndarray:
    """The pose (D,) that the contour leads to from a pose (D,) that is hardly known."""
    body = observation.model.body
    sd = np.full(len(pose), config.turn_sd)
    sd[:3] = config.place_sd
    dynamics = GaussianWalk(sd, body.lower, body.upper)
    return guided.climb(pose, np.diag(sd**-2.0), observation, dynamics, spreads)[0]
