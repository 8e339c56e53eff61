"""What happens once before the first frame: the first pose, the body fitted to the person, the cameras checked.

A short look ahead: the clip's first seconds are tracked with the body as given; a dozen frames of them then say how
long and how wide the person's parts are, and whether the cameras agree with each other.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from muybridge.body import Body
from muybridge.cameras.model import Rig
from muybridge.errors import InputError
from muybridge.filters import guided
from muybridge.io.job import Job
from muybridge.likelihood.observation import ImageLikelihood, Observation
from muybridge.tracking.evidence import Eyes
from muybridge.tracking.fit import Fit, FitConfig, fit_body
from muybridge.tracking.guessing import Guesser, guessed_start
from muybridge.tracking.pose_input import first_pose
from muybridge.tracking.start import Start, StartConfig, automatic_start
from muybridge.tracking.tracker import Estimate, Tracker, TrackerConfig

FIT_SECONDS, FIT_FRAMES = 2.5, 12
START_SECONDS, START_TRIES = 4.0, 9
GOOD_START = 0.25  # two-sided silhouette cost at which no better first frame is looked for
PERSON_ROWS = 230  # a person reduced to so many rows is tracked as well as at full size
#: By filter, where fewer do: see docs/benchmarks.md, "The guided Gaussian-process filter".
ROWS = {"agp-pf": 115}
#: Only for looking ahead: no particles, the mode is enough.
_LOOK = TrackerConfig("guided", replace(guided.WORKING, particles=3))


@dataclass(frozen=True, eq=False)
class Preparation:
    """What tracking starts from.

    model : body and cameras as they will be used; pose : (D,) in the first frame; fit, check : what was fitted, and the
    cameras' residual shifts; start : the automatic start, where there was one.
    """

    model: ImageLikelihood
    pose: np.ndarray
    fit: Fit | None = None
    check: Fit | None = None
    start: Start | None = None
    start_frame: int = 0
    names: tuple[str, ...] = field(default=())

    def to_dict(self) -> dict[str, Any]:
        """For run.json: body factors, camera shifts (recorded pixels) and the start's costs."""
        out: dict[str, Any] = {}
        if self.start is not None:
            out["start"] = {"frame": self.start_frame, "cost": self.start.cost, "rival_cost": self.start.rival_cost}
        if self.fit is not None:
            out["body_fit"] = {
                "lengths": self.fit.lengths,
                "widths": self.fit.widths,
                "depths": self.fit.depths,
                "residual_m": self.fit.residual,
            }
        if self.check is not None:
            out["cameras"] = {
                name: {"shift_px": shift.tolist(), "residual_px": float(np.hypot(*shift))}
                for name, shift in zip(self.names, self.check.shifts, strict=True)
            }
        return out


def prepare(
    job: Job, eyes: Eyes, body: Body, interval: float, frames: tuple[int, int], guesser: Guesser | None = None
) -> Preparation:
    """Find the first pose, fit the body where the job asks for it, check the cameras where there are several."""
    model = ImageLikelihood(body, eyes.rig, eyes.reductions)
    start, start_frame, pose = None, frames[0], first_pose(job, body, frames[0])
    if pose is None:
        start, start_frame = _find_start(model, eyes, frames, interval, guesser)
        pose = _track_between(model, eyes, interval, start.pose, start_frame, frames[0])
    fit = check = None
    if len(eyes.rig) > 1:  # one camera cannot tell a long limb from a near one
        chosen, observations, poses = _look_ahead(model, eyes, interval, pose, frames)
        if job.body.fit and chosen:
            model, fit = fit_body(model, observations, poses, FitConfig())
            poses = fit.poses
        if chosen:
            corrected, check = fit_body(
                model, observations, poses, FitConfig(lengths=False, girths=False, cameras=True)
            )
            if job.calibration.corrected:
                model, poses = corrected, check.poses
                if job.body.fit:
                    model, fit = fit_body(replace(model, body=body), observations, poses, FitConfig())
                    poses = fit.poses
        if chosen and chosen[0] == frames[0]:
            pose = poses[0]
    return Preparation(model, pose, fit, check, start, start_frame, eyes.rig.names)


def observe(model: ImageLikelihood, eyes: Eyes, index: int, expected: np.ndarray | None) -> Observation:
    """The evidence of one frame by its number."""
    return model.observe(eyes.masks(eyes.read(index), expected))


def _find_start(
    model: ImageLikelihood, eyes: Eyes, frames: tuple[int, int], interval: float, guesser: Guesser | None
) -> tuple[Start, int]:
    """The first pose, in the first frame that gives a clear one, else in the best of the first seconds."""
    span = min(frames[1] - frames[0], round(START_SECONDS / interval))
    best: tuple[Start, int] | None = None
    trouble: InputError | None = None
    for index in np.unique(np.linspace(frames[0], frames[0] + span, START_TRIES).round().astype(int)).tolist():
        try:
            found = _start_in(observe(model, eyes, index, None), guesser)
        except InputError as error:
            trouble = trouble or error
            continue
        if best is None or found.cost < best[0].cost:
            best = found, index
        if found.cost < GOOD_START:
            break
    if best is None:
        assert trouble is not None
        raise trouble
    limit = StartConfig().highest_cost
    if best[0].cost > limit:
        raise InputError(
            "automatic start",
            expected=f"a pose whose silhouettes differ by less than {limit:.2f}",
            got=f"{best[0].cost:.2f} at best (frame {best[1]})",
            remedy="give the first pose in [start], mend the masks, or begin where the person stands upright",
        )
    return best


def _start_in(observation: Observation, guesser: Guesser | None) -> Start:
    """The first pose in one frame: guessed, and where that is not good, or nothing is guessed, searched for too."""
    guess = guesser.guess(observation.masks) if guesser is not None else None
    guessed = guessed_start(observation, guess) if guess is not None else None
    if guessed is not None and (guessed.cost < GOOD_START or np.count_nonzero(observation.areas) < 2):
        return guessed
    searched = automatic_start(observation)
    return searched if guessed is None or searched.cost < guessed.cost else guessed


def _track_between(
    model: ImageLikelihood, eyes: Eyes, interval: float, pose: np.ndarray, begin: int, end: int
) -> np.ndarray:
    """The pose followed from frame `begin` back to frame `end`."""
    tracker = Tracker(model, interval, _LOOK)
    rng = np.random.default_rng(0)  # the mode does not depend on it
    state = tracker.init(rng, pose)
    for index in range(begin - 1, end - 1, -1):
        state, estimate = tracker.step_observed(rng, state, observe(model, eyes, index, tracker.predict(state)))
        pose = estimate.pose
    return pose


def _look_ahead(
    model: ImageLikelihood, eyes: Eyes, interval: float, pose: np.ndarray, frames: tuple[int, int]
) -> tuple[list[int], list[Observation], np.ndarray]:
    """Track the first seconds and keep some frames: their numbers, evidence and poses (F, D)."""
    span = min(frames[1] - frames[0] + 1, max(FIT_FRAMES, round(FIT_SECONDS / interval)))
    stride = max(1, span // FIT_FRAMES)
    tracker = Tracker(model, interval, _LOOK)
    rng = np.random.default_rng(0)
    state = tracker.init(rng, pose)
    chosen: list[int] = []
    observations: list[Observation] = []
    poses: list[np.ndarray] = []
    for index in range(frames[0], frames[0] + span):
        observation = observe(model, eyes, index, tracker.predict(state))
        state, estimate = tracker.step_observed(rng, state, observation)
        if (index - frames[0]) % stride == 0 and _good(estimate):
            chosen.append(index)
            observations.append(observation)
            poses.append(estimate.pose)
    return chosen, observations, np.array(poses)


def _good(estimate: Estimate) -> bool:
    return estimate.status == "tracked"


def reductions_of(job: Job, rig: Rig, body: Body) -> tuple[int, ...]:
    """How much each camera's pictures are reduced: as the job says, or to as many rows as its filter needs."""
    if job.likelihood.reduction is not None:
        return (job.likelihood.reduction,) * len(rig)
    return reductions_for(rig, body, ROWS.get(job.filter.name, PERSON_ROWS))


def reductions_for(rig: Rig, body: Body, wanted: int = PERSON_ROWS) -> tuple[int, ...]:
    """How much each camera's pictures are reduced so that the person has about as many rows as are wanted."""
    focus = _focus(rig)
    out = []
    for camera in rig:
        distance = float(camera.world_to_camera(focus)[2]) if focus is not None else 0.0
        rows = camera.matrix[1, 1] * body.height / distance if distance > 0.3 else 0.5 * max(camera.size)
        out.append(int(np.clip(round(rows / wanted), 1, 16)))
    return tuple(out)


def _focus(rig: Rig) -> np.ndarray | None:
    """(3,) metres: where the optical axes nearly meet; None for a single camera or parallel ones."""
    matrix, vector = np.zeros((3, 3)), np.zeros(3)
    for camera in rig:
        across = np.eye(3) - np.outer(camera.rotation[2], camera.rotation[2])
        matrix, vector = matrix + across, vector + across @ camera.position
    return np.linalg.solve(matrix, vector) if len(rig) > 1 and np.linalg.cond(matrix) < 1e6 else None


def rig_of_job(job: Job) -> Rig:
    """The job's cameras, in the job's order."""
    from muybridge.cameras.readers import read_rig
    from muybridge.io.video import open_pictures

    calibration = job.calibration
    paths = [calibration.file] if calibration.file else list(calibration.files)
    size = None
    if any(path is not None and path.suffix == ".cal" for path in paths):
        with open_pictures(job.cameras[0].pictures, job.cameras[0].frame_rate) as first:
            size = (int(first.size[0]), int(first.size[1]))
    rig = read_rig(paths[0] if len(paths) == 1 else paths, calibration.unit, size=size, up=calibration.up)
    if len(paths) == len(job.cameras) > 1 and not set(rig.names) >= {c.name for c in job.cameras}:
        rig = Rig(tuple(camera.renamed(entry.name) for camera, entry in zip(rig, job.cameras, strict=True)))
    missing = [entry.name for entry in job.cameras if entry.name not in rig.names]
    if missing:
        raise InputError(
            f"camera {missing[0]!r}",
            expected=f"one of the calibrated cameras: {', '.join(rig.names)}",
            got="no calibration of that name",
            remedy="name the camera as the calibration does",
        )
    return rig.subset([entry.name for entry in job.cameras])


def body_of_job(job: Job) -> Body:
    """The job's body: of the catalogue or a file, at its height, with its measures."""
    from muybridge.tracking.body_input import body_from

    return body_from(job.body)
