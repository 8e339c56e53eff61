"""One trial: its evidence tracked frame by frame from the true first pose, and held against the truth."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from muybridge.body import Body
from muybridge.evaluation import JointErrors, joint_errors
from muybridge.evaluation.angles import joint_angles
from muybridge.experiments.bodies import body_of_trial, fitted, start_pose, wrong_pose
from muybridge.experiments.clips import Evidence, evidence_of
from muybridge.experiments.spoiling import shifted_rig, spoilt_mask
from muybridge.experiments.trial import EVIDENCE, Clip, Faults, Trial
from muybridge.io.disk import make_folder
from muybridge.io.run_folder import JointSeries, write_joints
from muybridge.likelihood.observation import ImageLikelihood, Observation
from muybridge.regression import SilhouetteRegressor, load_regressor
from muybridge.tracking.silhouette_guesser import SilhouetteGuesser
from muybridge.tracking.spread import MEASURED, SpreadConfig
from muybridge.tracking.tracker import Tracker, TrackerConfig

SCENES, MODELS = "scenes", "models"  # folders of an experiment
PLACE = ("pelvis",)
LEGS = ("left_knee", "right_knee", "left_ankle", "right_ankle")
ARMS = ("left_elbow", "right_elbow", "left_wrist", "right_wrist")


@dataclass(frozen=True)
class Result:
    """What came of a trial.

    Attributes
    ----------
    mean_mm, root_mm : float
        Mean joint error, alignment none and root.
    angle_deg : float
        Mean absolute error of the eight joint angles.
    lost_share : float
        Share of frames with a mean error above 200 mm.
    lost_wrists : float
        Share of frames and wrists above 200 mm.
    place_mm, legs_mm, arms_mm : float
        Mean error of the pelvis, of knees and ankles, of elbows and wrists, alignment none.
    swapped_share : float
        Share of frames in which the legs fit better exchanged.
    inside : (3,) float
        Share of true joints inside the stated 50, 80 and 95 % regions; NaN where no deviation was stated.
    scale : float
        What would make the stated deviations right on average, sqrt(mean(error^2 / (3 sd^2))).
    sd_mm : float
        The median stated deviation.
    evaluations, ms : float
        Of the likelihood, and processor time, a frame.
    cost : float
        Two-sided silhouette cost of the estimates, all cameras alike; NaN through a job.
    moves : float
        Accepted moves a chain and frame; NaN for filters without, and through a job.
    status : str
        Of the last frame.
    frame_mm : (T,) float
        Mean error of each frame, alignment none.
    """

    mean_mm: float
    root_mm: float
    angle_deg: float
    lost_share: float
    lost_wrists: float
    place_mm: float
    legs_mm: float
    arms_mm: float
    swapped_share: float
    inside: tuple[float, float, float]
    scale: float
    sd_mm: float
    evaluations: float
    ms: float
    cost: float
    moves: float
    status: str
    frame_mm: tuple[float, ...]

    @staticmethod
    def from_dict(values: Mapping[str, Any]) -> Result:
        """The inverse of `asdict`, by way of JSON."""
        filled: dict[str, Any] = {name: _known(value) for name, value in values.items()}
        for name in ("inside", "frame_mm"):
            filled[name] = tuple(_known(value) for value in filled[name])
        return Result(**filled)


def _known(value: Any) -> Any:
    """NaN for what JSON has as null."""
    return float("nan") if value is None else value


@dataclass(frozen=True, eq=False)
class Tracked:
    """A track and what it cost: joints with deviations, what was counted in each frame, and the end.

    costs, moves : (T,) see `Result`; empty through a job
    """

    series: JointSeries
    evaluations: np.ndarray
    milliseconds: np.ndarray
    status: str
    costs: np.ndarray = field(default_factory=lambda: np.zeros(0))
    moves: np.ndarray = field(default_factory=lambda: np.zeros(0))


def run_trial(trial: Trial, folder: Path) -> Result:
    """Track the trial's clip; evidence is kept under `folder`, and the track too where the trial asks for it."""
    evidence = _evidence(trial.clip, folder, trial.cues.need_pictures)
    if trial.masks == "job":
        from muybridge.experiments.through_job import tracked_by_job

        tracked = tracked_by_job(trial, evidence, folder / SCENES)
    else:
        tracked = tracked_in_process(trial, evidence, guesser_of(trial, folder))
    if trial.keep_track:
        path = trial.track_file(folder)
        make_folder(path.parent)
        write_joints(path, tracked.series)
    return judged(tracked, evidence)


@lru_cache(maxsize=2)
def _evidence(clip: Clip, folder: Path, pictures: bool) -> Evidence:
    return evidence_of(clip, folder / EVIDENCE, pictures=pictures)


def tracked_in_process(trial: Trial, evidence: Evidence, regressor: SilhouetteRegressor | None = None) -> Tracked:
    """The product's tracker over the evidence of each frame."""
    model, pose = _prepared(trial, evidence)
    spread = MEASURED if trial.body == "right" else SpreadConfig()
    config = TrackerConfig(trial.method, trial.filter_config, trial.motion, spread=spread)
    guesser = None if regressor is None else SilhouetteGuesser.of(regressor, model)
    tracker = Tracker(model, evidence.interval, config, guesser)
    first = {"truth": pose, "wrong": wrong_pose(model.body, pose), "guess": None}[trial.begin]
    state = tracker.init(np.random.default_rng([trial.seed, 0, 1]), first, observed(trial, evidence, model, 0))
    estimates, milliseconds, costs = [], [], []
    for frame in range(trial.clip.frames):
        began = time.process_time()
        observation = observed(trial, evidence, model, frame)
        state, estimate = tracker.step_observed(np.random.default_rng([trial.seed, frame, 0]), state, observation)
        milliseconds.append(1e3 * (time.process_time() - began))
        estimates.append(estimate)
        costs.append(float(estimate.costs.mean()))
    frames = np.arange(len(estimates))
    series = JointSeries(
        model.body.joint_names,
        frames,
        frames * evidence.interval,
        np.array([estimate.joints for estimate in estimates]),
        np.array([estimate.joint_sd for estimate in estimates]),
    )
    evaluations = np.array([estimate.evaluations for estimate in estimates], float)
    moves = np.array([float(e.info.acceptance.sum()) if e.info is not None else np.nan for e in estimates])
    return Tracked(series, evaluations, np.array(milliseconds), estimates[-1].status, np.array(costs), moves)


def observed(trial: Trial, evidence: Evidence, model: ImageLikelihood, frame: int) -> Observation:
    """The evidence of one frame as the trial has it, faults and all."""
    rng = np.random.default_rng([trial.seed, frame, 2])
    given = evidence.true if trial.masks == "true" else evidence.own
    masks = [spoilt_mask(view[frame], trial.faults.masks, rng) for view in given]
    if trial.gap and trial.gap[0] <= frame <= trial.gap[1]:
        masks = [np.zeros_like(mask) for mask in masks]
    pictures = [view[frame] for view in evidence.pictures] if model.cues.need_pictures else None
    return model.observe(masks, pictures)


def guesser_of(trial: Trial, folder: Path) -> SilhouetteRegressor | None:
    """The trial's regressor, which the experiment has put into the folder; None where it has none."""
    return _regressor(folder / MODELS / f"{trial.guesser}.npz") if trial.guesser else None


@lru_cache(maxsize=4)
def _regressor(path: Path) -> SilhouetteRegressor:
    return load_regressor(path)


def judged(tracked: Tracked, evidence: Evidence) -> Result:
    """The track held against the truth."""
    free = joint_errors(tracked.series, evidence.truth, "none")
    rooted = joint_errors(tracked.series, evidence.truth, "root")
    calibration = free.calibration
    nan = float("nan")
    inside = calibration.coverage if calibration else (nan, nan, nan)
    return Result(
        mean_mm=free.mean_mm,
        root_mm=rooted.mean_mm,
        angle_deg=angle_error(tracked.series, evidence.truth),
        lost_share=free.lost_share,
        lost_wrists=float(np.mean(list(free.lost_wrists.values()))) if free.lost_wrists else nan,
        place_mm=_mean_of(free, PLACE),
        legs_mm=_mean_of(free, LEGS),
        arms_mm=_mean_of(free, ARMS),
        swapped_share=len(free.swapped_frames) / len(free.frames),
        inside=(inside[0], inside[1], inside[2]),
        scale=calibration.scale if calibration else nan,
        sd_mm=1000.0 * float(np.median(tracked.series.sd)),
        evaluations=float(tracked.evaluations.mean()),
        ms=float(np.median(tracked.milliseconds)),
        cost=_mean(tracked.costs),
        moves=_mean(tracked.moves),
        status=tracked.status,
        frame_mm=tuple(round(float(value), 2) for value in free.frame_means_mm),
    )


def _mean(values: np.ndarray) -> float:
    """Mean of what is known; NaN where nothing is."""
    known = values[np.isfinite(values)]
    return float(known.mean()) if known.size else float("nan")


def _mean_of(errors: JointErrors, names: tuple[str, ...]) -> float:
    """Mean error of some joints over all frames, mm; NaN where the body has none of them."""
    columns = [j for j, joint in enumerate(errors.joints) if joint.joint in names]
    return float(np.nanmean(errors.errors_mm[:, columns])) if columns else float("nan")


def angle_error(estimate: JointSeries, truth: JointSeries) -> float:
    """Mean absolute error of the eight joint angles, degrees; the way round that is shorter."""
    found, true = (joint_angles(series.positions, series.names) for series in (estimate, truth))
    difference = np.mod(found - true + np.pi, 2 * np.pi) - np.pi
    return float(np.degrees(np.nanmean(np.abs(difference))))


def _prepared(trial: Trial, evidence: Evidence) -> tuple[ImageLikelihood, np.ndarray]:
    """The likelihood with its body, and the first pose."""
    body, pose = _body_and_pose(_without_tracker(trial), evidence)
    rig = shifted_rig(evidence.rig, trial.faults.calibration_px, trial.seed)
    return ImageLikelihood(body, rig, evidence.reductions, cues=trial.cues), pose


def _without_tracker(trial: Trial) -> Trial:
    """Only what decides body and first pose; the seed does where something is wrong on purpose."""
    seed = trial.seed if trial.faults != Faults() else 0
    return Trial(trial.clip, masks=trial.masks, body=trial.body, torso=trial.torso, faults=trial.faults, seed=seed)


@lru_cache(maxsize=16)
def _body_and_pose(trial: Trial, evidence: Evidence) -> tuple[Body, np.ndarray]:
    """The trial's body and first pose, worked out once for trials that agree in both."""
    body = body_of_trial(trial, evidence)
    pose = start_pose(body, evidence)
    if trial.body == "height":
        rig = shifted_rig(evidence.rig, trial.faults.calibration_px, trial.seed)
        model = ImageLikelihood(body, rig, evidence.reductions)
        body = fitted(model, lambda seen, frame: observed(trial, evidence, seen, frame), pose, evidence).body
        pose = start_pose(body, evidence)
    return body, pose
