"""Who is trained on and who is tracked, and the filters that Sedai et al. (2013) compare, printed and working."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from muybridge.experiments.experiment import DEFAULT_SEEDS, QUICK_SEEDS, Case, Scale
from muybridge.experiments.running import MODELS
from muybridge.experiments.trial import Clip, Trial
from muybridge.filters import agp_pf
from muybridge.io.disk import make_folder
from muybridge.io.run_log import job_digest
from muybridge.io.training_file import SceneSource, Training
from muybridge.likelihood.cues import CueWeights
from muybridge.regression import SilhouetteRegressor, load_regressor, save_regressor
from muybridge.synthetic.skinning import figure_names
from muybridge.tracking.training import train

#: Tracked and never learnt from.
UNSEEN = ("heavy_man", "slight_woman")
MOTIONS = ("walk", "jog")
FIRST_TRAINING_SEED = 300  # takes and camera directions that no tracked clip has: those have seeds from 0
#: (14): silhouettes, two-sided, and edges.
SEDAI = CueWeights(silhouette=1.0, edges=1.0)
SUM = 2.0  # sharpness: (14) adds the costs; cues' weights are made to sum to 1
RATE = 60.0
NAMES = ("AGP-PF", "AGP", "APF", "GP-PF", "PF")


def scale_of(quick: bool, seeds: int | None = None) -> Scale:
    """Two people who were not learnt from, walking and jogging in `humaneva` rooms, a second and a half at 60 Hz."""
    if quick:
        return Scale(True, seeds or QUICK_SEEDS, UNSEEN[:1], MOTIONS[:1], 20, "humaneva", RATE)
    return Scale(False, seeds or DEFAULT_SEEDS, UNSEEN, MOTIONS, 90, "humaneva", RATE)


def training(scale: Scale) -> Training:
    """Everybody else, walking and jogging: about 3000 silhouettes, or a few hundred for a quick look."""
    figures = tuple(name for name in figure_names() if name not in UNSEEN)
    seeds = range(FIRST_TRAINING_SEED, FIRST_TRAINING_SEED + (1 if scale.quick else 4))
    figures = figures[:3] if scale.quick else figures
    source = SceneSource(preset="humaneva", figures=figures, motions=MOTIONS, seeds=tuple(seeds), frames=120,
                         every=4 if scale.quick else 6)  # fmt: skip
    return Training(scenes=(source,), seed=1)


def model_name(scale: Scale) -> str:
    """The regressor's name in the experiment's folder: of what it was trained on."""
    import msgspec

    return "silhouettes-" + job_digest(msgspec.to_builtins(training(scale), enc_hook=str))[:8]


def prepare(scale: Scale, folder: Path, workers: int) -> None:
    """Train the regressor, unless the folder has it."""
    path = make_folder(folder / MODELS) / f"{model_name(scale)}.npz"
    if not path.is_file():
        save_regressor(path, train(training(scale), workers=workers).regressor)


def model_of(scale: Scale, folder: Path) -> SilhouetteRegressor:
    """The regressor that `prepare` made."""
    return load_regressor(folder / MODELS / f"{model_name(scale)}.npz")


def printed(name: str, scale: Scale, clip: Clip, **settings: Any) -> Trial:
    """One of the paper's filters with its settings and its measurement, no first pose."""
    trial = Trial(clip, "agp-pf", printed=True, cues=SEDAI, begin="guess", guesser=model_name(scale), seed=clip.seed)
    return trial.with_settings(**{"sharpness": SUM, **case_of(name), **settings})


def working(name: str, scale: Scale, clip: Clip, **settings: Any) -> Trial:
    """The same with the settings that were measured to work."""
    trial = Trial(clip, "agp-pf", begin="guess", guesser=model_name(scale), seed=clip.seed)
    return trial.with_settings(**{**case_of(name), **settings})


def guided(scale: Scale, clip: Clip) -> Trial:
    """The default filter, which asks for guesses where it is in doubt."""
    return Trial(clip, "guided", begin="guess", guesser=model_name(scale), seed=clip.seed)


def case_of(name: str) -> dict[str, Any]:
    """What makes a filter of the paper's comparison of the agp-pf: settings that differ from its own."""
    base, case = vars(agp_pf.PRESETS["agp-pf"]), vars(agp_pf.PRESETS[name.lower()])
    return {key: value for key, value in case.items() if value != base[key]}


def one_camera(clips: Iterable[Clip]) -> tuple[Clip, ...]:
    """The same people and motions before a single camera."""
    return tuple(replace(clip, cameras=1) for clip in clips)


def over(clips: Iterable[Clip], label: str, trial: Trial, x: float = float("nan")) -> Iterator[Case]:
    """One condition on every clip, the tracker's seed being the scene's."""
    for clip in clips:
        yield Case(label, replace(trial, clip=clip, seed=clip.seed), x)
