"""A trial through the product itself: a scene's folder with its videos, a job, a run folder, its joints.csv."""

from __future__ import annotations

import json
import shutil
from dataclasses import asdict
from pathlib import Path

import msgspec
import numpy as np

from muybridge.evaluation import read_truth
from muybridge.experiments.clips import Evidence
from muybridge.experiments.running import Tracked
from muybridge.experiments.scenes import scene_of
from muybridge.experiments.trial import Trial
from muybridge.io.job import FilterInput, Job, LikelihoodInput, MotionInput, StartInput
from muybridge.io.job import read as read_job
from muybridge.synthetic.write import write_scene
from muybridge.tracking import run


def tracked_by_job(trial: Trial, evidence: Evidence, folder: Path) -> Tracked:
    """Write the scene, track it as a user would (started at the truth), read the run folder, and tidy up."""
    place = folder / trial.digest
    try:
        job = job_of_trial(read_job(write_scene(scene_of(trial.clip), place / "scene")), trial)
        run(job, place / "run")
        series = read_truth(place / "run" / "joints.csv")
        summary = json.loads((place / "run" / "run.json").read_text(encoding="utf-8"))
    finally:
        shutil.rmtree(place, ignore_errors=True)
    status = "lost" if summary["status"] == "lost" else "tracked"
    evaluations = np.array([float(summary["evaluations_per_frame"])])
    return Tracked(series, evaluations, np.array([float(summary["ms_per_frame"]["median"])]), status)


def job_of_trial(job: Job, trial: Trial) -> Job:
    """The scene's own job with the trial's filter, cues, motion and seed, started from the true first pose."""
    cues = trial.cues
    moving = {name: value for name, value in asdict(trial.motion).items() if name in MotionInput.__struct_fields__}
    return msgspec.structs.replace(
        job,
        start=StartInput(pose="reference"),
        filter=FilterInput(
            name=trial.method, preset="printed" if trial.printed else "working", settings=dict(trial.settings)
        ),
        likelihood=LikelihoodInput(
            silhouette=cues.silhouette,
            colour=cues.colour,
            boundary=cues.boundary,
            edges=cues.edges,
            silhouette_kind=cues.silhouette_kind,  # type: ignore[arg-type]  # checked by CueWeights
        ),
        motion=MotionInput(**moving),
        seed=trial.seed,
    )
