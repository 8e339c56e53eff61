"""How far off the joints may be: what is reported as their standard deviation, for every filter alike.

Three things add up, as variances:

1. the posterior's own width: the curvature of the contour's log likelihood at the estimate, added to what was known
   from earlier frames and what is usual (a Laplace approximation, carried from frame to frame as a Kalman filter
   does). Particles would tell it too, but those of a filter that optimises have been gathered around the best one and
   say next to nothing;
2. how far the search stopped from the nearest mode: the Newton step that it did not take;
3. what no filter can see: the tracked body's joint centres are not quite the person's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from muybridge.body.model import Body
from muybridge.filters.dynamics import WIDEST, Dynamics
from muybridge.likelihood.observation import Observation

STEP = 1e-4  # metres and radians, of the numerical derivative of joints by the pose
LARGEST_STEP = 0.3  # radians and metres; beyond that a Newton step means nothing


@dataclass(frozen=True)
class SpreadConfig:
    """What the reported standard deviations are made of; how true they are: table coverage of papers/du-2005."""

    contour_m: float = 0.025  # spread of the contour's robust weights
    dependence: float = 5.0  # so many neighbouring residuals err together
    widening: float = 1.0  # factor on the posterior's own width: errors last for many frames
    body_sd: float = 0.012  # metres, along each axis: joint centres of a body that was fitted, not measured
    falling_short: float = 2.0  # of the step to the mode: 30 mm away, residuals count so little that it goes half way


#: A body whose measures were given, and are taken as they are.
MEASURED = SpreadConfig(body_sd=0.004)


def joint_deviations(
    pose: np.ndarray, covariance: np.ndarray, left: np.ndarray, body: Body, config: SpreadConfig
) -> np.ndarray:
    """Standard deviation of each joint along each axis.

    Parameters
    ----------
    pose : (D,) float64
    covariance : (D, D) float64
        Of the pose, metres and radians.
    left : (D,) float64
        The step to the mode that was not taken.

    Returns
    -------
    (J,) float64, metres
    """
    slopes = joint_slopes(body, pose)
    own = np.einsum("jad,de,jae->j", slopes, covariance, slopes) / 3.0
    missed = np.square(config.falling_short * slopes @ left).sum(axis=1) / 3.0
    return np.sqrt(config.widening**2 * own + missed + config.body_sd**2)


def joint_slopes(body: Body, pose: np.ndarray) -> np.ndarray:
    """(J, 3, D) float64: metres that joints move per metre and radian of each component of the pose (D,)."""
    moved = body.joints(pose + STEP * np.eye(len(pose)))
    slopes: np.ndarray = np.moveaxis((moved - body.joints(pose)) / STEP, 0, -1)
    return slopes


def laplace(
    observation: Observation, pose: np.ndarray, known: np.ndarray, dynamics: Dynamics, config: SpreadConfig
) -> tuple[np.ndarray, np.ndarray]:
    """The posterior around an estimate: covariance (D, D), and the Newton step (D,) from the estimate to the mode.

    The step is that of the filter's own target, in which what is usual counts in every frame. Poses of neighbouring
    frames are no independent evidence of it, so that in the covariance it only bounds what is known, see `carried`.

    Parameters
    ----------
    known : (D, D) float64
        Covariance of the pose before this picture; the estimate is taken for its mean.
    """
    seen = observation.normal_equations(pose, config.contour_m)
    precision = seen.curvature / config.dependence + np.linalg.inv(known)
    usual = dynamics.usual_precision(pose)
    pull = seen.gradient / config.dependence + usual * (dynamics.usual - pose)
    step = np.linalg.solve(precision + np.diag(usual), pull)
    return np.linalg.inv(precision), np.clip(step, -LARGEST_STEP, LARGEST_STEP)


def carried(covariance: np.ndarray, dynamics: Dynamics, body: Body) -> np.ndarray:
    """(D, D) a frame later: wider by the dynamics' noise, no wider than people mostly are, or than `WIDEST`."""
    widest = np.minimum(body.usual[1], WIDEST)
    narrowed = np.minimum(1.0, widest / np.sqrt(np.maximum(np.diag(covariance), 1e-12)))
    grown: np.ndarray = narrowed[:, None] * covariance * narrowed + np.diag(np.maximum(dynamics.noise_sd, 1e-6) ** 2)
    return grown
