"""One person, frame by frame: masks in, joints with their standard deviations out.

`Tracker` holds what is fixed (body, cameras, settings); a `TrackState` is what the next frame needs. The loop over
frames is the user's own if wanted:

    state = tracker.init(rng, first_pose)
    for masks in frames:
        state, estimate = tracker.step(rng, state, masks)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np

from muybridge.errors import InputError
from muybridge.filters import (
    METHODS,
    CommonConfig,
    ConstantVelocity,
    Guess,
    Info,
    State,
    Weights,
    agp_pf,
    annealed,
    demc,
    guided,
)
from muybridge.likelihood.colour import ColourReference
from muybridge.likelihood.observation import ImageLikelihood, Observation
from muybridge.tracking.guessing import Guesser, placed, turned_towards
from muybridge.tracking.motion import Motion, motion_of
from muybridge.tracking.spread import SpreadConfig, carried, joint_deviations, laplace

TRACKED, DOUBTFUL, UNSEEN, LOST = "tracked", "doubtful", "unseen", "lost"


@dataclass(frozen=True)
class TrackerConfig:
    """How a person may move, and when a frame is doubted."""

    method: str = "guided"  # a row of filters.METHODS
    filter: CommonConfig | None = None  # None: the method's working settings
    motion: Motion | None = None  # None: what suits the method
    doubtful_cost: float = 0.40  # two-sided silhouette cost from which a frame is doubted
    doubtful_ratio: float = 1.6  # or this many times the run's usual cost
    patience: int = 8  # doubted or unseen frames in a row after which the person counts as lost
    spread: SpreadConfig = SpreadConfig()
    guess: Literal["always", "troubled"] | None = None  # when a pose is guessed; None: always for agp-pf alone
    trust: float = 0.05  # added to a camera's usual cost before weights are taken as its inverse


@dataclass(frozen=True, eq=False)
class TrackState:
    """What the next frame needs.

    usual_costs : (C,) running mean of each camera's cost; troubled : bad frames in a row; seen : good frames
    covariance : (D, D) of the pose, whatever the filter
    reference : what the segments look like, where colour counts and a frame was seen
    """

    filter: State
    usual_costs: np.ndarray
    covariance: np.ndarray
    troubled: int = 0
    seen: int = 0
    reference: ColourReference | None = None

    @property
    def sought(self) -> bool:
        """Where the person is, is not known: nobody was seen well in the last frame."""
        return self.troubled > 0 or self.seen == 0

    def to_arrays(self) -> dict[str, np.ndarray]:
        """Named arrays, for a checkpoint."""
        arrays = {f"filter_{name}": np.asarray(value) for name, value in vars(self.filter).items()}
        if self.reference is not None:
            arrays |= {"colour_histograms": self.reference.histograms, "colour_known": self.reference.known}
        return arrays | {
            "usual_costs": self.usual_costs,
            "covariance": self.covariance,
            "troubled": np.array(self.troubled),
            "seen": np.array(self.seen),
        }


@dataclass(frozen=True, eq=False)
class Estimate:
    """What is known after a frame.

    pose : (D,) metres and radians; joints : (J, 3) metres, world; joint_sd : (J,) metres, standard deviation per axis
    costs : (C,) two-sided silhouette cost in each camera; status : tracked, doubtful, unseen or lost
    """

    pose: np.ndarray
    joints: np.ndarray
    joint_sd: np.ndarray
    costs: np.ndarray
    status: str
    info: Info | None = field(default=None)

    @property
    def ess(self) -> float:
        """Effective number of particles, (3.18); NaN in a frame that showed nobody."""
        return self.info.ess if self.info is not None else float("nan")

    @property
    def evaluations(self) -> int:
        """Likelihood evaluations that the frame took."""
        return self.info.evaluations if self.info is not None else 0


@dataclass(frozen=True)
class Tracker:
    """Tracks one person through frames that are `interval` seconds apart."""

    model: ImageLikelihood
    interval: float  # seconds
    config: TrackerConfig = TrackerConfig()
    guesser: Guesser | None = None  # finds who is lost, and the first pose

    @cached_property
    def dynamics(self) -> ConstantVelocity:
        """Constant velocity with noise in proportion to the time between frames."""
        return self.motion.dynamics(self.model.body, self.interval)

    @property
    def motion(self) -> Motion:
        """How the person is expected to move."""
        return self.config.motion or motion_of(self.config.method, len(self.model.rig))

    @cached_property
    def filter_config(self) -> Any:
        """The method's settings, with the body's limbs where it draws limb by limb.

        With one camera none is redrawn by the guided filter: its silhouette is met by too many wrong ones.
        """
        config = self.config.filter or METHODS[self.config.method].WORKING
        if isinstance(config, guided.Config) and not config.blocks and len(self.model.rig) > 1:
            config = replace(config, blocks=self._limbs()[1:])
        if isinstance(config, annealed.Config | demc.Config) and config.by_limb and config.blocks is None:
            config = replace(config, blocks=self._limbs())
        return config

    def _limbs(self) -> tuple[tuple[int, ...], ...]:
        """Components of the root, then of each limb."""
        blocks = self.model.body.blocks
        return tuple(tuple(blocks[name].tolist()) for name in sorted(blocks, key=lambda name: name != "root"))

    def init(
        self, rng: np.random.Generator, pose: np.ndarray | None = None, observation: Observation | None = None
    ) -> TrackState:
        """A state that believes in one pose (D,), or in what is guessed from the first frame's evidence."""
        sd = self.dynamics.noise_sd
        common = sd, self.filter_config, self.dynamics.lower, self.dynamics.upper
        if pose is None:
            if observation is None:
                raise InputError("first pose", expected="a pose, or a frame of which one can be guessed", got="neither")
            guess, rest = self._first_guess(observation)
            if isinstance(self.filter_config, agp_pf.Config):
                return self._started(agp_pf.begin(rng, guess, rest, *common))
            poses = np.clip(guess.poses(rest), self.dynamics.lower, self.dynamics.upper)
            pose = poses[int(np.argmin(observation.costs(poses).mean(axis=1)))]
        return self._started(METHODS[self.config.method].init(rng, pose, *common))

    def _started(self, state: State) -> TrackState:
        return TrackState(state, np.full(len(self.model.rig), np.nan), np.diag(np.square(self.dynamics.noise_sd)))

    def _first_guess(self, observation: Observation) -> tuple[Guess, np.ndarray]:
        """A guess with the place in it, and a pose (D,) for what it does not speak of."""
        guess = self._made(observation)
        if guess is None:
            raise InputError("first pose", expected="a pose, or a frame of which one can be guessed", got="neither")
        rest = np.clip(np.zeros(len(self.model.body.dof_names)), self.dynamics.lower, self.dynamics.upper)
        return placed(guess, observation, rest), rest

    def restore(self, arrays: dict[str, np.ndarray]) -> TrackState:
        """The state that `TrackState.to_arrays` saved."""
        kind = METHODS[self.config.method].State
        own = {name.removeprefix("filter_"): value for name, value in arrays.items() if name.startswith("filter_")}
        seen = "colour_histograms" in arrays
        reference = ColourReference(arrays["colour_histograms"], arrays["colour_known"]) if seen else None
        counts = int(arrays["troubled"]), int(arrays["seen"])
        return TrackState(kind(**own), arrays["usual_costs"], arrays["covariance"], *counts, reference)

    def predict(self, state: TrackState) -> np.ndarray:
        """(J, 3) metres: where the joints are expected in the next frame."""
        return self.model.body.joints(self._predicted(state))

    def expected(self, state: TrackState) -> np.ndarray | None:
        """(J, 3) metres as `predict`; None, anywhere, for a person who is lost and can be found by a guess."""
        anywhere = self.guesser is not None and state.troubled > self.config.patience
        return None if anywhere else self.predict(state)

    def step(
        self,
        rng: np.random.Generator,
        state: TrackState,
        masks: Sequence[np.ndarray],
        pictures: Sequence[np.ndarray] | None = None,
    ) -> tuple[TrackState, Estimate]:
        """One frame from its masks, C times (H, W) bool, and its pictures, where the likelihood looks at them."""
        return self.step_observed(rng, state, self.model.observe(masks, pictures))

    def step_observed(
        self, rng: np.random.Generator, state: TrackState, observation: Observation
    ) -> tuple[TrackState, Estimate]:
        """One frame from its evidence."""
        seeing = observation.areas >= MINIMUM_AREA
        if not seeing.any():
            return self._unseen(state)
        reference = self._reference(state, observation)
        guess = self._guess(state, observation)
        observation = replace(observation, model=self.weighted(state, seeing), reference=reference, guess=guess)
        method = METHODS[self.config.method]
        following, info = method.step(rng, state.filter, observation, self.dynamics, self.filter_config)
        if info.collapsed:
            return self._unseen(state, info)
        if guess is not None and state.sought and not isinstance(following, guided.State):
            following = replace(following, velocity=np.zeros_like(following.velocity))  # a jump tells no velocity
        costs = observation.costs(following.estimate)[0]
        doubted = self._doubted(state, costs[seeing], seeing)
        troubled = state.troubled + 1 if doubted else 0
        status = TRACKED if not doubted else LOST if troubled > self.config.patience else DOUBTFUL
        usual = state.usual_costs if doubted else _running_mean(state.usual_costs, costs, state.seen)
        if reference is not None and not doubted:
            reference = observation.updated_reference(following.estimate)
        body = self.model.body
        covariance, left = self._posterior(following, state.covariance, observation)
        sd = joint_deviations(following.estimate, covariance, left, body, self.config.spread)
        estimate = Estimate(following.estimate, body.joints(following.estimate), sd, costs, status, info)
        return TrackState(following, usual, covariance, troubled, state.seen + (not doubted), reference), estimate

    def _posterior(self, state: State, before: np.ndarray, observation: Observation) -> tuple[np.ndarray, np.ndarray]:
        """Covariance (D, D) and the step to the mode; the guided filter knows them, for the others they are worked out.

        before : (D, D) covariance after the frame before.
        """
        if isinstance(state, guided.State):
            return state.covariance, np.zeros_like(state.estimate)
        known = carried(before, self.dynamics, self.model.body)
        return laplace(observation, state.estimate, known, self.dynamics, self.config.spread)

    def _guess(self, state: TrackState, observation: Observation) -> Guess | None:
        """What the filter may ask for; with the place from the masks where the person's is not known."""
        when = self.config.guess or ("always" if self.config.method == "agp-pf" else "troubled")
        guess = self._made(observation) if state.sought or when == "always" else None
        if guess is None:
            return None
        guess = turned_towards(guess, state.filter.estimate, self.model.body)
        return placed(guess, observation, state.filter.estimate) if state.sought else guess

    def _made(self, observation: Observation) -> Guess | None:
        """The guess that the evidence carries, else one made of its masks."""
        if observation.guess is not None or self.guesser is None:
            return observation.guess
        return self.guesser.guess(observation.masks)

    def _reference(self, state: TrackState, observation: Observation) -> ColourReference | None:
        """What the segments look like: as known, else as at the first pose; None where colour does not count."""
        if self.model.cues.colour == 0 or state.reference is not None:
            return state.reference
        return observation.first_reference(state.filter.estimate)

    def weighted(self, state: TrackState, seeing: np.ndarray) -> ImageLikelihood:
        """The model with cameras weighted by how well they usually agree, and blind ones left out."""
        usual = np.where(np.isfinite(state.usual_costs), state.usual_costs, 0.15)
        weights = np.where(seeing, 1.0 / (usual + self.config.trust), 0.0)
        return replace(self.model, weights=tuple(weights))

    def _predicted(self, state: TrackState) -> np.ndarray:
        ahead = state.filter.estimate + self.motion.velocity_gain * state.filter.velocity
        return np.clip(ahead, self.dynamics.lower, self.dynamics.upper)

    def _doubted(self, state: TrackState, costs: np.ndarray, seeing: np.ndarray) -> bool:
        usual = state.usual_costs[seeing]
        ceiling = self.config.doubtful_cost
        if state.seen >= 5 and np.isfinite(usual).all():
            ceiling = min(ceiling, max(0.2, self.config.doubtful_ratio * float(usual.mean())))
        return float(costs.mean()) > ceiling

    def _unseen(self, state: TrackState, info: Info | None = None) -> tuple[TrackState, Estimate]:
        """No evidence: move on for a while as last seen, and be less sure with every frame."""
        troubled = state.troubled + 1
        coasting = self._coasted(state.filter)
        pose, body = coasting.estimate, self.model.body
        joints = body.joints(pose)
        known = _particles_sd(body.joints(coasting.particles), Weights(coasting.log_weights))
        drift = UNSEEN_SPEED * self.interval * np.sqrt(troubled) * 2.0
        status = LOST if troubled > self.config.patience else UNSEEN
        costs = np.full(len(self.model.rig), np.nan)
        estimate = Estimate(pose, joints, np.hypot(known, drift), costs, status, info)
        covariance = carried(state.covariance, self.dynamics, body)
        return replace(state, filter=coasting, covariance=covariance, troubled=troubled), estimate

    def _coasted(self, state: State) -> State:
        """A frame later without a picture: velocities fade, soon of limbs, which swing back, later of the place."""
        fading = np.full_like(state.velocity, LIMBS_COAST)
        fading[:ROOT_COMPONENTS] = ROOT_COAST
        velocity = state.velocity * np.exp(-self.interval / fading)
        if isinstance(state, guided.State):
            ahead = self.dynamics.carry(replace(state.belief, velocity=velocity))
            step = ahead.mean - state.estimate
            state = replace(state, covariance=ahead.covariance, cross=ahead.cross,
                            velocity_covariance=ahead.velocity_covariance)  # fmt: skip
        else:
            step = np.clip(state.estimate + velocity, self.dynamics.lower, self.dynamics.upper) - state.estimate
        particles = np.clip(state.particles + step, self.dynamics.lower, self.dynamics.upper)
        return replace(state, particles=particles, estimate=state.estimate + step, velocity=step)


UNSEEN_SPEED = 1.25  # metres a second that a person who is not seen may have moved, one standard deviation
ROOT_COAST, LIMBS_COAST = 1.0, 0.2  # seconds after which a velocity that is not seen has fallen to 1 / e
ROOT_COMPONENTS = 3  # of the pose: the root's place
MINIMUM_AREA = 20  # reduced pixels; a mask with fewer shows nobody


def _running_mean(usual: np.ndarray, costs: np.ndarray, count: int) -> np.ndarray:
    """Mean of the first twenty frames, then a slow average."""
    rate = 1.0 / min(count + 1, 20)
    return np.where(np.isfinite(usual), usual + rate * (costs - usual), costs)


def _particles_sd(joints: np.ndarray, weights: Weights) -> np.ndarray:
    """(J,) metres: root mean square over the axes of the particles' (N, J, 3) standard deviation."""
    share = np.exp(weights.log)
    mean = np.einsum("n,nja->ja", share, joints)
    variance = np.einsum("n,nja->ja", share, (joints - mean) ** 2)
    return np.sqrt(variance.mean(axis=1))
