"""The body that a trial's tracker believes in: right, fitted from the height, or wrong on purpose."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from muybridge.body import Body, named_body
from muybridge.experiments.clips import Evidence
from muybridge.experiments.scenes import right_body
from muybridge.experiments.trial import Trial
from muybridge.filters import guided
from muybridge.likelihood.observation import ImageLikelihood, Observation
from muybridge.tracking.fit import FitConfig, fit_body
from muybridge.tracking.pose_input import pose_from_joints
from muybridge.tracking.prepare import FIT_FRAMES, FIT_SECONDS
from muybridge.tracking.tracker import Tracker, TrackerConfig

WRONG_METRES = 0.5
TRUNK = ("torso", "pelvis")
WRONG_SEED = 20053  # of the signs by which measures are wrong: the same for every filter
Observe = Callable[[ImageLikelihood, int], Observation]


def body_of_trial(trial: Trial, evidence: Evidence) -> Body:
    """The body before any fit to the pictures: right for the figure, or by height alone; then made wrong."""
    if trial.body == "right":
        body = right_body(trial.clip)
    else:
        body = named_body("person").with_height(round(evidence.stature, 2))
    if trial.torso == "round":
        body = rounded(body)
    return wrong_body(body, trial.faults.body, trial.seed) if trial.faults.body else body


def wrong_body(body: Body, share: float, seed: int) -> Body:
    """Every length and girth too long or too short by a share of itself; which, the seed says."""
    rng = np.random.default_rng([seed, WRONG_SEED])

    def factors(groups: Sequence[str]) -> dict[str, float]:
        return {name: 1.0 + share * float(rng.choice([-1.0, 1.0])) for name in groups}

    lengths, girths = factors(body.length_groups), factors(body.radius_groups)
    return body.scaled(lengths=lengths, widths=girths, depths=girths)


def rounded(body: Body, names: Sequence[str] = TRUNK) -> Body:
    """Some segments with round sections (Du's cones) in place of elliptical ones of the same area."""
    segments = []
    for segment in body.segments:
        shape = segment.shape
        if segment.name in names and shape is not None:
            mean = float(np.sqrt(shape.scale[0] * shape.scale[1]))
            segment = replace(segment, shape=replace(shape, scale=(mean, mean)))
        segments.append(segment)
    return replace(body, segments=tuple(segments))


def start_pose(body: Body, evidence: Evidence) -> np.ndarray:
    """(D,) the body's pose nearest to the true joints of the first frame."""
    truth = evidence.truth
    known = {name: evidence.joints[0, j] for j, name in enumerate(truth.names) if name in body.joint_names}
    return pose_from_joints(body, known)


def fitted(model: ImageLikelihood, observe: Observe, pose: np.ndarray, evidence: Evidence) -> ImageLikelihood:
    """The model with its body fitted to the clip's first seconds, as a job does; unchanged for a single camera."""
    if len(model.rig) < 2:
        return model
    span = min(len(evidence.joints), max(FIT_FRAMES, round(FIT_SECONDS / evidence.interval)))
    stride = max(1, span // FIT_FRAMES)
    tracker = Tracker(model, evidence.interval, TrackerConfig("guided", replace(guided.WORKING, particles=3)))
    rng = np.random.default_rng(0)
    state = tracker.init(rng, pose)
    observations, poses = [], []
    for frame in range(span):
        observation = observe(model, frame)
        state, estimate = tracker.step_observed(rng, state, observation)
        if frame % stride == 0 and estimate.status == "tracked":
            observations.append(observation)
            poses.append(estimate.pose)
    return fit_body(model, observations, np.array(poses), FitConfig())[0] if poses else model


def wrong_pose(body: Body, true: np.ndarray) -> np.ndarray:
    """(D,) wrong in every way: standing straight, turned round, half a metre beside the true pose (D,)."""
    pose = np.clip(np.zeros_like(true), body.lower, body.upper)
    yaw = body.dof_names.index("root_yaw")
    pose[:3], pose[yaw] = true[:3], true[yaw] + np.pi
    pose[0] += WRONG_METRES
    return pose
