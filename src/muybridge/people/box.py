"""A box that moves: its state, how it moves from frame to frame, and how many particles it needs (Zhao 2009, 4.1, 4.4).

The boxes run through the filters that everything else runs through: `filters.condensation` with `BoxMotion`.

====================  =====================================
symbol                name
====================  =====================================
S = [X Y W H X' Y']   a state (6,): centre, size, velocity
A                     BoxMotion.transition
W                     noise of BoxMotion.noise_sd
Delta t               BoxMotion.frames
N_t, C                adapted_count, CountConfig.growth
====================  =====================================

Differences from the paper: sizes and centres stay within limits (the filters fold what goes beyond them back inside).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from muybridge.errors import InputError
from muybridge.filters.dynamics import Belief, GaussianWalk, reflect
from muybridge.filters.particles import FloatArray, Weights

X, Y, WIDTH, HEIGHT, SPEED_X, SPEED_Y = range(6)
DIMENSIONS = 6
PRINTED_VARIANCES = (10.0, 10.0, 2.0, 2.0, 2.0, 2.0)  # 4.1.1: px^2, and px^2 per frame^2 of the velocities
SMALLEST_SIDE = 2.0  # px; a box of one pixel has no histogram to speak of


def states_from_boxes(boxes: FloatArray) -> FloatArray:
    """(N, 4) left, top, width, height, with pixel i from i to i + 1 -> states (N, 6) at rest, pixel i's centre at i."""
    boxes = np.atleast_2d(np.asarray(boxes, dtype=np.float64))
    centres = boxes[:, :2] + boxes[:, 2:] / 2 - 0.5
    return np.column_stack([centres, boxes[:, 2:], np.zeros((len(boxes), 2))])


def boxes_from_states(states: FloatArray) -> FloatArray:
    """States (N, >= 4) -> (N, 4) left, top, width, height, with pixel i from i to i + 1."""
    states = np.atleast_2d(np.asarray(states, dtype=np.float64))
    return np.column_stack([states[:, :2] - states[:, 2:4] / 2 + 0.5, states[:, 2:4]])


@dataclass(frozen=True, eq=False)
class BoxMotion(GaussianWalk):
    """S_t = A S_{t-1} + W, (4.1) to (4.3): the centre goes on at the state's own velocity.

    Parameters
    ----------
    noise_sd : (6,) float64
        Pixels, and pixels per frame of the velocities; each step.
    frames : float
        Frames from one step to the next, Delta t.
    """

    frames: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.noise_sd.size != DIMENSIONS:
            raise InputError("box motion: noise_sd", expected=f"{DIMENSIONS} numbers", got=str(self.noise_sd.size))
        if not (np.isfinite(self.frames) and self.frames > 0):
            raise InputError("box motion: frames", expected="above 0", got=str(self.frames))

    @classmethod
    def within(
        cls,
        picture: tuple[int, int],
        variances: tuple[float, ...] = PRINTED_VARIANCES,
        largest: tuple[float, float] | None = None,
    ) -> BoxMotion:
        """Centres inside a picture (width, height), sides from `SMALLEST_SIDE` to `largest` (None: the picture's)."""
        (width, height), most = picture, largest or picture
        lower = np.array([-0.5, -0.5, SMALLEST_SIDE, SMALLEST_SIDE, -np.inf, -np.inf])
        upper = np.array([width - 0.5, height - 0.5, *most, np.inf, np.inf])
        return cls(np.sqrt(np.asarray(variances, dtype=np.float64)), lower, upper)

    @property
    def transition(self) -> FloatArray:
        """A of (4.2), (6, 6)."""
        matrix = np.eye(DIMENSIONS)
        matrix[X, SPEED_X] = matrix[Y, SPEED_Y] = self.frames
        return matrix

    def sample(
        self,
        rng: np.random.Generator,
        particles: FloatArray,
        velocity: FloatArray | None = None,
        scale: float | FloatArray = 1.0,
    ) -> FloatArray:
        """See `Dynamics.sample`; the velocity is the particles' own, `velocity` is not used."""
        moved = particles + rng.standard_normal(particles.shape) * (self.noise_sd * scale)
        moved[:, :2] += self.frames * particles[:, SPEED_X:]
        return reflect(moved, self.lower, self.upper)

    def log_usual(self, particles: FloatArray) -> FloatArray:
        """See `Dynamics.log_usual`; nothing to work out where nothing is said to be usual."""
        if np.isinf(self.usual_sd).all():
            return np.zeros(len(particles))
        return super().log_usual(particles)

    def carry(self, belief: Belief) -> Belief:
        """Mean A m, covariance A P A' + Q: the prediction of a Kalman filter."""
        a = self.transition
        covariance = a @ belief.covariance @ a.T + self._noise
        mean = reflect((a @ belief.mean)[None], self.lower, self.upper)[0]
        return replace(super().carry(belief), mean=mean, covariance=covariance)


@dataclass(frozen=True, kw_only=True)
class CountConfig:
    """Settings of (4.18)."""

    growth: float = 1.2  # C; section 4.4
    fewest: int = 200  # section 4.4
    most: int = 1000

    def __post_init__(self) -> None:
        if not (np.isfinite(self.growth) and self.growth > 0 and 3 <= self.fewest <= self.most):
            raise InputError("particle count", expected="growth above 0 and 3 <= fewest <= most",
                             got=f"{self.growth}, {self.fewest}, {self.most}")  # fmt: skip


def adapted_count(log_weights: FloatArray, config: CountConfig | None = None) -> int:
    """N_t = C N_{t-1} H / log N_{t-1}, (4.18), within limits: many where the weights (N,) say little, few where much.

    Examples
    --------
    >>> adapted_count(np.zeros(500)), adapted_count(np.log(np.eye(500)[0] + 1e-300))
    (600, 200)
    """
    config = config or CountConfig()
    weights = Weights(log_weights)
    count, some = len(weights), weights.values > 0
    entropy = -float((weights.values[some] * weights.log[some]).sum())
    share = entropy / np.log(count) if count > 1 else 1.0
    return int(np.clip(round(config.growth * count * share), config.fewest, config.most))
