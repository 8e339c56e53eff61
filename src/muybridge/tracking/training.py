"""Training a silhouette regressor: examples of rendered scenes and of tracked recordings, learnt and checked.

An example is a silhouette's descriptor and the body's turns, the heading relative to the ray that the person is seen
along. Whole people are held out where there are several, else whole clips: they tell how far guesses about somebody new
deserve trust.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Protocol

import numpy as np

from muybridge.body import named_body, read_body
from muybridge.cameras.model import Camera
from muybridge.cameras.readers import read_rig
from muybridge.errors import InputError
from muybridge.evaluation.names import JOINTS
from muybridge.io import job as jobs
from muybridge.io._tables import replaced
from muybridge.io.run_folder import read_pose
from muybridge.io.training_file import RecordingSource, SceneSource, Training
from muybridge.regression import (
    WORKING,
    Calibration,
    Config,
    PoseOutputs,
    SilhouetteRegressor,
    bearing,
    calibrate_lambda,
    describe,
    fit_regressor,
)
from muybridge.synthetic.measure import tracker_body
from muybridge.synthetic.presets import PRESETS, preset_scene
from muybridge.synthetic.scene import Scene, silhouettes, truth
from muybridge.tracking.evidence import open_eyes
from muybridge.tracking.pose_input import poses_from_joints
from muybridge.tracking.prepare import reductions_of
from muybridge.tracking.run import BODY_FILE, CAMERAS_FILE
from muybridge.tracking.silhouette_guesser import FEWEST_PIXELS


@dataclass(frozen=True, eq=False)
class Examples:
    """What is learnt from.

    Attributes
    ----------
    descriptors : (N, F) float64
    outputs : (N, D) float64, radians
        As `regression.PoseOutputs` has them, the heading relative to the camera.
    clips, people : (N,) int
        Which clip and whom each shows. Frames of a clip are alike, and so are those of a person.
    """

    descriptors: np.ndarray
    outputs: np.ndarray
    clips: np.ndarray
    people: np.ndarray

    def __len__(self) -> int:
        return len(self.descriptors)

    def where(self, own: np.ndarray) -> Examples:
        """Those of a choice (N,) bool."""
        return Examples(self.descriptors[own], self.outputs[own], self.clips[own], self.people[own])


@dataclass(frozen=True, eq=False)
class Trained:
    """A regressor, what held-out clips say of it, and how much it was made of."""

    regressor: SilhouetteRegressor
    calibration: Calibration
    examples: int
    clips: int


class Progress(Protocol):
    """Told after every clip how many of how many are done."""

    def __call__(self, done: int, total: int) -> None: ...


def train(training: Training, *, workers: int = 1, progress: Progress | None = None) -> Trained:
    """Make examples, hold some clips out, learn, and set lambda by the clips held out."""
    config = config_of(training)
    outputs = PoseOutputs(named_body(training.body))
    examples = gather(training, outputs, config, progress)
    rng = np.random.default_rng(training.seed)
    learnt, held = split(examples, training.held_out, rng)
    regressor = fit_regressor(
        rng, learnt.descriptors, learnt.outputs, outputs.components, config, body=training.body, workers=workers
    )
    calibration = calibrate_lambda(regressor, held.descriptors, held.outputs)
    regressor = regressor.with_trusted_variance(calibration.trusted_variance)
    return Trained(regressor, calibration, len(learnt), len(np.unique(examples.clips)))


def config_of(training: Training) -> Config:
    """The working settings with the file's in place of them."""
    return replaced(WORKING, training.regressor, "regressor")


def split(examples: Examples, share: float, rng: np.random.Generator) -> tuple[Examples, Examples]:
    """(learnt from, held out): whole people where there are several, else whole clips; at least one on either side."""
    groups = examples.people if len(np.unique(examples.people)) > 1 else examples.clips
    names = np.unique(groups)
    if len(names) < 2:
        raise InputError("training: clips", expected="at least 2, so that one can be held out", got=str(len(names)))
    count = int(np.clip(round(share * len(names)), 1, len(names) - 1))
    held = np.isin(groups, rng.permutation(names)[:count])
    return examples.where(~held), examples.where(held)


def gather(training: Training, outputs: PoseOutputs, config: Config, progress: Progress | None = None) -> Examples:
    """The examples of every clip that the file names, in its order."""
    scenes = [(source, *key) for source in training.scenes
              for key in product(source.figures, source.motions, source.seeds)]  # fmt: skip
    total, parts = len(scenes) + len(training.recordings), []
    people: list[str] = []
    for source, figure, motion, seed in scenes:
        parts.append(of_scene(source, figure, motion, seed, outputs, config))
        people.append(figure)
        if progress:
            progress(len(parts), total)
    for recording in training.recordings:
        parts.append(of_recording(recording, outputs, config))
        people.append(str(recording.run))
        if progress:
            progress(len(parts), total)
    return joined(parts, people)


def joined(parts: Sequence[tuple[np.ndarray, np.ndarray]], people: Sequence[str]) -> Examples:
    """(descriptors, outputs) of each clip, and whom it shows, as one."""
    counts = [len(part[0]) for part in parts]
    if not sum(counts):
        raise InputError("training: examples", expected="silhouettes of somebody", got="none in any clip")
    whom = np.unique(people, return_inverse=True)[1]
    return Examples(
        np.concatenate([part[0] for part in parts]),
        np.concatenate([part[1] for part in parts]),
        np.repeat(np.arange(len(parts)), counts),
        np.repeat(whom, counts),
    )


def of_scene(
    source: SceneSource, figure: str, motion: str, seed: int, outputs: PoseOutputs, config: Config
) -> tuple[np.ndarray, np.ndarray]:
    """Descriptors (N, F) and outputs (N, D) of a rendered clip, camera by camera within each frame."""
    scene = scene_of(source, figure, motion, seed)
    chosen = np.arange(0, scene.frame_count, source.every)
    person = scene.person
    own = tracker_body(person.figure, person.cut, person.hair)
    poses = _same_turns(outputs, own.dof_names, poses_from_joints(own, JOINTS, truth(scene).joints[chosen]))
    views = ((list(scene.rig), silhouettes(scene, int(frame))) for frame in chosen)
    return examples_of(views, poses, outputs, config)


def scene_of(source: SceneSource, figure: str, motion: str, seed: int) -> Scene:
    """One of the source's scenes."""
    known = PRESETS.get(source.preset)
    duration = None if source.frames is None or known is None else source.frames / known.rate
    return preset_scene(
        source.preset, seed=seed, figure=figure, motion=motion, cameras=source.cameras, duration=duration
    )


def of_recording(source: RecordingSource, outputs: PoseOutputs, config: Config) -> tuple[np.ndarray, np.ndarray]:
    """Descriptors (N, F) and outputs (N, D) of a run's frames, with the masks that its job makes of the pictures."""
    job = jobs.read(source.job)
    body, rig = read_body(source.run / BODY_FILE), read_rig(source.run / CAMERAS_FILE)
    series = read_pose(source.run)
    chosen = np.arange(0, len(series.frames), source.every)
    poses = _same_turns(outputs, body.dof_names, series.poses[chosen])
    rig = rig.subset([entry.name for entry in job.cameras])
    with open_eyes(job, rig, reductions_of(job, rig, body)) as eyes:
        cameras = [eye.camera.scaled(1.0 / eye.reduction) for eye in eyes.eyes]
        views = (
            (cameras, eyes.masks(eyes.read(int(series.frames[row])), body.joints(series.poses[row]))) for row in chosen
        )
        return examples_of(views, poses, outputs, config)


def examples_of(
    views: Iterator[tuple[list[Camera], Sequence[np.ndarray]]], poses: np.ndarray, outputs: PoseOutputs, config: Config
) -> tuple[np.ndarray, np.ndarray]:
    """What each camera's mask says of each frame's pose (T, D); masks that show little or are cut off are left out."""
    size = config.descriptor.size
    descriptors, learnt = [], []
    for pose, (cameras, masks) in zip(poses, views, strict=True):
        for camera, mask in zip(cameras, masks, strict=True):
            if np.count_nonzero(mask) < FEWEST_PIXELS:
                continue
            seen = describe(mask, config.descriptor)
            if seen.touches_border:
                continue
            descriptors.append(seen.values)
            learnt.append(outputs.from_poses(pose[None], bearing(camera, seen.centre))[0])
    return (
        np.array(descriptors).reshape(-1, size),
        np.array(learnt).reshape(-1, len(outputs.components)),
    )


def _same_turns(outputs: PoseOutputs, names: Sequence[str], poses: np.ndarray) -> np.ndarray:
    """Poses of a body with the same turns as the one that is learnt, in its order; InputError where it has others."""
    wanted = outputs.body.dof_names
    missing = [name for name in wanted if name not in names]
    if missing:
        raise InputError("poses to learn from", expected=f"the turns of body {outputs.body.name!r}",
                         got=f"a body without {missing[0]}")  # fmt: skip
    columns = [list(names).index(name) for name in wanted]
    return poses[:, columns]
