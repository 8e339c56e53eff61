"""What one trial of an experiment is: a clip, what is seen of it, and who tracks it; frozen, with a digest.

Two experiments that ask for the same trial share its result, and a run that was interrupted knows by the digest what
it has. The digest covers the filter's settings as they are resolved: a default changed later makes a new trial.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from muybridge.errors import InputError
from muybridge.filters import method
from muybridge.filters.state import CommonConfig
from muybridge.io.run_log import job_digest
from muybridge.likelihood.cues import CueWeights
from muybridge.tracking.motion import GUESSING_PRINTED, SEARCHING, Motion, motion_of

if TYPE_CHECKING:
    from muybridge.experiments.running import Result

EVIDENCE, TRACKS = "evidence", "tracks"  # folders of an experiment
VERSION = 4  # raise it when a trial of the same description gives another result
MASKS, MASK_FAULTS = ("own", "true", "job"), ("", "eroded", "dilated", "holes")
BODIES, TORSOS = ("right", "height"), ("elliptical", "round")
BEGINNINGS = ("truth", "guess", "wrong")
Settings = tuple[tuple[str, Any], ...]


@dataclass(frozen=True)
class Clip:
    """A scene to be tracked in; see `clips.scene_of`.

    view : "ring" (cameras around the person) or "side" (one camera across the direction walked)
    frames, rate : how many, and how many a second
    reduction : of pictures and masks before anything is measured; None is what the tracker would choose
    """

    figure: str = "man"
    motion: str = "walk"
    view: str = "ring"
    cameras: int = 3
    seed: int = 0
    frames: int = 60
    rate: float = 30.0
    preset: str = "studio"
    reduction: int | None = None

    def __post_init__(self) -> None:
        _one_of("clip: view", self.view, ("ring", "side"))
        _at_least_one("clip: cameras", self.cameras)
        if self.frames < 2:
            raise InputError("clip: frames", expected="at least 2", got=str(self.frames))

    @property
    def digest(self) -> str:
        """The name of its evidence on disk."""
        return job_digest({"version": VERSION, **asdict(self)})[:16]

    @property
    def scene(self) -> str:
        """Who does what, and seen from where."""
        return f"{self.figure} {self.motion} {self.view}"

    def prepare(self, folder: Path, trials: Sequence[Trial]) -> None:
        """Make the evidence where it is not there yet; pictures for trials whose cues look at them."""
        from muybridge.experiments.clips import evidence_of

        evidence_of(self, folder / EVIDENCE, pictures=any(trial.cues.need_pictures for trial in trials))

    def drop(self, folder: Path) -> None:
        """Delete the pictures, which are large."""
        from muybridge.experiments.clips import drop_pictures

        drop_pictures(self, folder / EVIDENCE)


@dataclass(frozen=True)
class Faults:
    """What is made worse on purpose.

    masks : "", "eroded", "dilated" (by one pixel of the reduced mask) or "holes"
    calibration_px : pixels as recorded, by which every camera's picture is off, each in its own direction
    body : share by which every length and girth is off, with random signs
    """

    masks: str = ""
    calibration_px: float = 0.0
    body: float = 0.0

    def __post_init__(self) -> None:
        _one_of("faults: masks", self.masks, MASK_FAULTS)


@dataclass(frozen=True)
class Trial:
    """One clip tracked once.

    Parameters
    ----------
    clip : Clip
    method : a row of `filters.METHODS`
    printed : the paper's settings, else those measured to work
    settings : of the filter, and `moving` : of the motion model, that replace the preset's
    cues : CueWeights
    masks : "own" (background subtraction), "true", or "job" (the whole product, from videos to a run folder)
    body : "right" (joint centres and girths of the figure) or "height" (fitted to the clip from the height alone)
    torso : "elliptical", or "round": as wide as deep
    begin : "truth" (the true first pose), "guess" (none is given), or "wrong" (see `bodies.wrong_pose`)
    guesser : name of a silhouette regressor in the experiment's folder; none where empty
    gap : the first and the last frame in which nobody is seen; empty: everybody always is
    seed : of the tracker
    keep_track : leave the estimated joints on disk, for curves
    """

    clip: Clip = field(default_factory=Clip)
    method: str = "guided"
    printed: bool = False
    settings: Settings = ()
    moving: Settings = ()
    cues: CueWeights = CueWeights()
    masks: str = "own"
    body: str = "right"
    torso: str = "elliptical"
    faults: Faults = field(default_factory=Faults)
    begin: str = "truth"
    guesser: str = ""
    gap: tuple[int, ...] = ()
    seed: int = 0
    keep_track: bool = False

    def __post_init__(self) -> None:
        for what, got, known in (
            ("begin", self.begin, BEGINNINGS),
            ("masks", self.masks, MASKS),
            ("body", self.body, BODIES),
            ("torso", self.torso, TORSOS),
        ):
            _one_of(f"trial: {what}", got, known)
        if self.begin == "guess" and not self.guesser:
            raise InputError("trial that begins with a guess", expected="a guesser", got="none")
        if self.gap and not (len(self.gap) == 2 and 0 < self.gap[0] <= self.gap[1]):
            raise InputError("trial: gap", expected="first and last frame, not from the beginning", got=str(self.gap))
        if self.masks == "job" and (self.faults != Faults() or self.body != "height" or self.torso != "elliptical"):
            raise InputError("trial through a job", expected="no faults and a body by height", got=str(self.faults))

    @property
    def filter_config(self) -> CommonConfig:
        """The filter's settings, all of them."""
        row = method(self.method)
        return replace(row.PRINTED if self.printed else row.WORKING, **dict(self.settings))

    @property
    def motion(self) -> Motion:
        """How the person may move: the method's own, or as its paper has it."""
        base = motion_of(self.method, self.clip.cameras)
        if self.printed:
            searching = replace(SEARCHING, velocity_gain=1.0, usual_weight=0.0)
            base = GUESSING_PRINTED if self.method == "agp-pf" else searching
        return replace(base, **dict(self.moving))

    @property
    def description(self) -> dict[str, Any]:
        """Everything that decides the result, as JSON values."""
        resolved = {"filter": asdict(self.filter_config), "motion": asdict(self.motion)}
        own = {name: value for name, value in asdict(self).items() if name not in SELDOM or value != SELDOM[name]}
        return {"version": VERSION, **_plain(own), **_plain(resolved)}

    @property
    def digest(self) -> str:
        """The key under which its result is kept."""
        return job_digest(self.description)[:16]

    @property
    def kernels(self) -> Hashable:
        """The filter, its cues and the body; nothing is rehearsed for a job, which is another process's."""
        return None if self.masks == "job" else (self.method, self.cues, self.body)

    def track_file(self, folder: Path) -> Path:
        """Where the estimated joints are left, if they are."""
        return folder / TRACKS / f"{self.digest}.csv"

    def leaves(self, folder: Path) -> tuple[Path, ...]:
        """See `RunnableTrial`."""
        return (self.track_file(folder),) if self.keep_track else ()

    def rehearse(self, folder: Path) -> None:
        """Two small frames, from the truth: silhouettes may be too small for a guess of the first pose."""
        short = replace(self.clip, frames=2, reduction=8)
        replace(self, clip=short, begin="truth", keep_track=False, gap=()).run(folder)

    def run(self, folder: Path) -> Result:
        """Track the clip."""
        from muybridge.experiments.running import run_trial

        return run_trial(self, folder)

    def result(self, values: Mapping[str, Any]) -> Result:
        """From `asdict` by way of JSON."""
        from muybridge.experiments.running import Result

        return Result.from_dict(values)

    def with_settings(self, **settings: Any) -> Trial:
        """The same with filter settings replaced."""
        return replace(self, settings=tuple(sorted({**dict(self.settings), **settings}.items())))

    def with_motion(self, **settings: float) -> Trial:
        """The same with settings of the motion model replaced."""
        return replace(self, moving=tuple(sorted({**dict(self.moving), **settings}.items())))


#: What most trials do not have is not part of their description either.
SELDOM = {"begin": "truth", "guesser": "", "gap": ()}


def _plain(value: Any) -> Any:
    """Tuples as lists, for JSON."""
    if isinstance(value, Mapping):
        return {name: _plain(item) for name, item in value.items()}
    return [_plain(item) for item in value] if isinstance(value, tuple | list) else value


def _one_of(what: str, got: str, known: tuple[str, ...]) -> None:
    if got not in known:
        raise InputError(what, expected=" | ".join(map(repr, known)), got=repr(got))


def _at_least_one(what: str, got: int) -> None:
    if got < 1:
        raise InputError(what, expected="at least 1", got=str(got))
