"""A job from end to end: open, start, fit, track, and leave a run folder that can be resumed and read.

The loop itself is in `_track`; everything else is what happens once.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Protocol

import msgspec
import numpy as np
from threadpoolctl import threadpool_limits

from muybridge.body import Body, read_body, write_body
from muybridge.cameras import read_rig, write_rig
from muybridge.cameras.model import Rig
from muybridge.errors import InputError
from muybridge.filters import METHODS
from muybridge.io.disk import make_folder
from muybridge.io.job import Job, filter_config
from muybridge.io.run_facts import peak_memory_mb, speed, versions
from muybridge.io.run_folder import RunWriter, read_preparation, write_preparation, write_summary
from muybridge.io.run_log import create_log, job_digest, read_records
from muybridge.io.synchronise import check_synchronised, synchronised
from muybridge.likelihood.cues import CueWeights
from muybridge.likelihood.observation import ImageLikelihood
from muybridge.tracking.checkpoint import Checkpoint, read_checkpoint, write_checkpoint
from muybridge.tracking.diagnostics import DiagnosticsWriter
from muybridge.tracking.evidence import Eyes, open_eyes
from muybridge.tracking.motion import Motion, motion_of
from muybridge.tracking.prepare import Preparation, body_of_job, prepare, reductions_of, rig_of_job
from muybridge.tracking.silhouette_guesser import guesser_of_job
from muybridge.tracking.spread import MEASURED, SpreadConfig
from muybridge.tracking.tracker import LOST, TRACKED, Estimate, Tracker, TrackerConfig, TrackState

CHECKPOINT_EVERY = 25  # frames
READ_AHEAD = 2  # frames that are decoded beside the tracking
LOG_FILE, BODY_FILE, CAMERAS_FILE = "track.log", "body.toml", "cameras.json"
STATUSES = (TRACKED, "doubtful", "unseen", LOST)


class Progress(Protocol):
    """Told after every frame how many of how many are done."""

    def __call__(self, done: int, total: int) -> None: ...


@dataclass(frozen=True)
class RunSummary:
    """What came of a run; the same as in run.json."""

    status: str
    frames: int
    seed: int
    evaluations_per_frame: float
    ms_per_frame: dict[str, float]
    peak_memory_mb: float


def run(job: Job, out: Path, progress: Progress | None = None, *, resume: bool = False) -> RunSummary:
    """Track the person a job describes and write the run folder.

    Parameters
    ----------
    job : Job
    out : Path
        The run folder; made where absent, its tables replaced unless `resume`.
    progress : callable, optional
    resume : bool
        Go on from where an interrupted run of the same job stopped.
    """
    out = make_folder(out)
    with threadpool_limits(limits=1, user_api="blas"):  # sums of two threads round differently
        return _Run(job, out, progress).go(resume)


class _Run:
    """One run's bookkeeping."""

    def __init__(self, job: Job, out: Path, progress: Progress | None) -> None:
        self.job, self.out, self.progress = job, out, progress
        self.cues = cue_weights(job)
        self.digest = job_digest(msgspec.to_builtins(job, enc_hook=str))
        self.milliseconds: list[float] = []
        self.evaluations = self.frames = self.lost = 0
        self.last_status = TRACKED
        self.preparation: Preparation | None = None
        self.first, self.last = job.frames or (0, 0)

    def go(self, resume: bool) -> RunSummary:
        """Everything in order: open, prepare or take up the checkpoint, track, summarise."""
        rig, body = rig_of_job(self.job), body_of_job(self.job)
        with open_eyes(self.job, rig, reductions_of(self.job, rig, body), self.cues.need_pictures) as eyes:
            count = check_synchronised(eyes.sources)
            self.first, self.last = self.job.frames or (0, count - 1)
            if self.last >= count:
                raise InputError("frames", expected=f"a last frame of at most {count - 1}", got=str(self.last))
            checkpoint = read_checkpoint(self.out, self.digest) if resume else None
            if checkpoint is None:
                prepared = self.preparation = self._prepare(eyes, body)
                write_body(self.out / BODY_FILE, prepared.model.body)
                write_rig(self.out / CAMERAS_FILE, prepared.model.rig)
                write_preparation(self.out, prepared.to_dict())
            tracker = self._tracker(eyes)
            try:
                self._track(eyes, tracker, checkpoint)
            except KeyboardInterrupt:
                if self.frames:
                    self._summarise(tracker, interrupted=True)
                raise
            return self._summarise(tracker)

    def _prepare(self, eyes: Eyes, body: Body) -> Preparation:
        guesser = guesser_of_job(self.job, ImageLikelihood(body, eyes.rig, eyes.reductions))
        return prepare(self.job, eyes, body, self._interval(eyes), (self.first, self.last), guesser)

    def _interval(self, eyes: Eyes) -> float:
        return 1.0 / float(eyes.sources[0].frame_rate)

    def _tracker(self, eyes: Eyes) -> Tracker:
        """The tracker with body and cameras as the run folder has them: the same for a fresh and a resumed run."""
        body, rig = read_body(self.out / BODY_FILE), read_rig(self.out / CAMERAS_FILE)
        eyes.eyes = [replace(eye, camera=rig[eye.camera.name]) for eye in eyes.eyes]
        rig = Rig(tuple(rig[eye.camera.name] for eye in eyes.eyes))
        spread = SpreadConfig() if self.job.body.fit else MEASURED
        method, when = self.job.chosen_filter.name, self.job.guess.when
        config = TrackerConfig(method, filter_config(self.job), self._motion(), spread=spread, guess=when)
        model = ImageLikelihood(body, rig, eyes.reductions, cues=self.cues)
        return Tracker(model, self._interval(eyes), config, guesser_of_job(self.job, model))

    def _motion(self) -> Motion:
        """The method's own, with the job's settings in place of it."""
        given = {name: value for name, value in msgspec.to_builtins(self.job.motion).items() if value is not None}
        return replace(motion_of(self.job.chosen_filter.name, len(self.job.cameras)), **given)

    def _track(self, eyes: Eyes, tracker: Tracker, checkpoint: Checkpoint | None) -> None:
        """The loop over frames."""
        body = tracker.model.body
        fields = _log_fields(len(body.joint_names), len(body.dof_names), len(eyes.rig))
        with (
            RunWriter(self.out, body.joint_names, body.dof_names) as writer,
            DiagnosticsWriter(self.out, [camera.name for camera in eyes.rig]) as diagnostics,
        ):
            kept = self._replay(writer, diagnostics, checkpoint)
            start = self.first + len(kept)
            if checkpoint is not None:
                state = tracker.restore(checkpoint.arrays)
            else:
                assert self.preparation is not None
                state = tracker.init(self._rng(start, 1), self.preparation.pose)
            with create_log(self.out / LOG_FILE, fields, self.digest) as log:
                for record in kept:
                    log.append(**{name: record[name] for name in record.dtype.names})
                for index, seconds, images, began in self._frames(eyes, start):
                    masks = eyes.masks(images, tracker.expected(state))
                    state, estimate = tracker.step(self._rng(index, 0), state, masks, eyes.pictures(images))
                    elapsed = (time.perf_counter() - began) * 1e3
                    record = _record(index, seconds, estimate, elapsed)
                    log.append(**record)
                    self._write(writer, diagnostics, record)
                    done = index - self.first + 1
                    if done % CHECKPOINT_EVERY == 0 or index == self.last:
                        write_checkpoint(self.out, Checkpoint(done, state.to_arrays()), self.digest)
                    if self.progress:
                        self.progress(done, self.last - self.first + 1)

    def _frames(self, eyes: Eyes, start: int) -> Iterator[tuple[int, float, list[np.ndarray], float]]:
        """Frames with the moment at which reading them began."""
        began = time.perf_counter()
        for index, seconds, images in synchronised(eyes.sources, start, self.last + 1, ahead=READ_AHEAD):
            yield index, seconds, images, began
            began = time.perf_counter()

    def _replay(self, writer: RunWriter, diagnostics: DiagnosticsWriter, checkpoint: Checkpoint | None) -> list[Any]:
        """Write the tables of the frames up to the checkpoint again; returns their records."""
        kept: list[Any] = []
        if checkpoint is not None:
            for record in read_records(self.out / LOG_FILE):
                if len(kept) == checkpoint.frames:
                    break
                kept.append(record)
                self._write(writer, diagnostics, record)
            if len(kept) < checkpoint.frames:
                raise InputError(
                    str(self.out / LOG_FILE),
                    expected=f"the {checkpoint.frames} frames of the checkpoint",
                    got=str(len(kept)),
                    remedy="run without --resume",
                )
        return kept

    def _write(self, writer: RunWriter, diagnostics: DiagnosticsWriter, record: Any) -> None:
        index, seconds = int(record["frame"]), float(record["time_s"])
        status = STATUSES[int(record["status"])]
        self.frames += 1  # before the tables: whoever sees a row there, and interrupts, has a summary
        self.evaluations += int(record["evaluations"])
        self.lost += status == LOST
        self.last_status = status
        self.milliseconds.append(float(record["ms"]))
        writer.write(index, seconds, record["joints"], record["sd"], record["pose"])
        diagnostics.write(index, seconds, status, float(record["ess"]), float(record["acceptance"]), record["costs"])

    def _rng(self, frame: int, purpose: int) -> np.random.Generator:
        """A generator of its own for every frame: results depend on neither interruptions nor threads."""
        return np.random.default_rng([self.job.seed, frame, purpose])

    def _summarise(self, tracker: Tracker, *, interrupted: bool = False) -> RunSummary:
        status = "lost" if self.last_status == LOST or self.lost > 0.5 * self.frames else "done"
        status = "interrupted" if interrupted else status
        times, memory = speed(self.milliseconds), peak_memory_mb()
        evaluations = self.evaluations / max(1, self.frames)
        summary = RunSummary(status, self.frames, self.job.seed, evaluations, times, memory)
        settings = {
            "filter": {"name": self.job.chosen_filter.name, **asdict(filter_config(self.job))},
            "motion": asdict(tracker.motion),
            "likelihood": asdict(self.cues),
            "reductions": list(tracker.model.reductions),
        }
        facts = {"settings": settings, "versions": versions(), "lost_frames": self.lost}
        write_summary(self.out, {**asdict(summary), **facts, **read_preparation(self.out)})
        return summary


def cue_weights(job: Job) -> CueWeights:
    """The job's `[likelihood]`."""
    given = job.likelihood
    return CueWeights(given.silhouette, given.colour, given.boundary, given.edges, given.silhouette_kind)


def _log_fields(joints: int, dofs: int, cameras: int) -> dict[str, tuple[str, tuple[int, ...]]]:
    scalars = {name: ("<f8", ()) for name in ("time_s", "ess", "acceptance", "ms")}
    return {
        "frame": ("<i8", ()),
        "status": ("<i8", ()),
        "evaluations": ("<i8", ()),
        **scalars,
        "pose": ("<f8", (dofs,)),
        "joints": ("<f8", (joints, 3)),
        "sd": ("<f8", (joints,)),
        "costs": ("<f8", (cameras,)),
    }


def _record(index: int, seconds: float, estimate: Estimate, milliseconds: float) -> dict[str, Any]:
    info = estimate.info
    acceptance = (
        float(np.nanmean(info.acceptance)) if info is not None and np.isfinite(info.acceptance).any() else np.nan
    )
    return {
        "frame": index,
        "time_s": seconds,
        "status": STATUSES.index(estimate.status),
        "evaluations": estimate.evaluations,
        "ess": estimate.ess,
        "acceptance": acceptance,
        "ms": milliseconds,
        "pose": estimate.pose,
        "joints": estimate.joints,
        "sd": estimate.joint_sd,
        "costs": estimate.costs,
    }


__all__ = ["METHODS", "RunSummary", "TrackState", "run"]
