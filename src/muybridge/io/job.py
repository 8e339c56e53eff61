"""The job: one TOML file that says what is tracked, in which pictures, with which body, by which filter.

A job is read once, at the rim; every path in it is taken relative to the file's own folder and comes out absolute.
An unknown key is an error that names the nearest known one. docs/job.md lists every key.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta, field

from muybridge.errors import InputError
from muybridge.io import _tables, _toml
from muybridge.io._tables import Table

Positive = Annotated[float, Meta(gt=0)]
Weight = Annotated[float, Meta(ge=0)]
FrameRange = tuple[Annotated[int, Meta(ge=0)], Annotated[int, Meta(ge=0)]]
"""First and last frame, counted from 0, both included."""
Unit = Literal["m", "cm", "mm"]


class CalibrationInput(Table, frozen=True):
    """`[calibration]`: one file for all cameras (or a folder of files), or a list of files."""

    file: Path | None = None
    files: tuple[Path, ...] = ()
    unit: Unit | None = None
    """Of the lengths; the format's own where absent."""
    up: Literal["z", "y", "x", "-z", "-y", "-x"] = "z"
    """The axis of the file's world that points up."""
    corrected: bool = False
    """Correct the cameras by the residual shift that tracking finds, instead of only reporting it."""

    def __post_init__(self) -> None:
        if (self.file is None) == (not self.files):
            raise ValueError("expected either file or files")


class BackgroundInput(Table, frozen=True):
    """`[camera.background]`: how the person is told from what stands still.

    Every other key is a setting of that model, such as `threshold`.
    """

    kind: str
    """A key of `muybridge.segmentation.BACKGROUND_MODELS`: plate, gaussian, hue_key."""
    file: Path | None = None
    """A picture, a video or a pattern of the empty scene."""
    empty: FrameRange | None = None
    """Or the frames of the camera's own pictures in which nobody is there."""
    shadows: bool | None = None
    """Remove shadows; where absent: in colour pictures only."""
    settings: dict[str, Any] = {}

    def __post_init__(self) -> None:
        _check_range(self.empty, "empty")


class CameraInput(Table, frozen=True):
    """`[[camera]]`: one camera's pictures, a video or a pattern (`img_%04d.png`, `*.png`), and its masks."""

    name: str
    pictures: Path
    masks: Path | None = None
    """A video or a pattern; white is the person."""
    background: BackgroundInput | None = None
    frame_rate: Positive | None = None
    """Frames a second, for picture patterns; a video has its own timestamps."""
    frames: FrameRange | None = None
    """The part of pictures and masks that is used; frame 0 of the job is the first of them. All where absent."""

    def __post_init__(self) -> None:
        _check_range(self.frames, "frames")


class BodyInput(Table, frozen=True):
    """`[body]`: a model of the catalogue or a file, and how it is made to fit the person."""

    name: str | None = None
    file: Path | None = None
    height_m: Positive | None = None
    measures: dict[str, Positive] | str | None = None
    """Measured lengths in metres by segment, here or in a TOML file of the same keys."""
    fit: bool = True
    """Fit radii and lengths to the person over the first frames."""

    def __post_init__(self) -> None:
        if self.name is not None and self.file is not None:
            raise ValueError("expected name or file, got both")


class StartInput(Table, frozen=True):
    """`[start]`: where the first pose comes from."""

    pose: str = "auto"
    """`auto`, `reference`, or a file with a pose."""
    frame: Annotated[int, Meta(ge=0)] | None = None
    """The frame which that pose is for; the first one where absent."""

    @property
    def file(self) -> Path | None:
        """The file with the first pose, if it comes from one."""
        return None if self.pose in START_WORDS else Path(self.pose)


START_WORDS = ("auto", "reference")


class GuessInput(Table, frozen=True):
    """`[guess]`: a regressor that guesses the pose from the masks, where it is not known."""

    model: str = "shipped"
    """A file that `train` wrote; `shipped`: the program's own, for bodies that turn as its person does; or `none`."""
    when: Literal["always", "troubled"] | None = None
    """In every frame, or where the last one is doubted; as the filter needs it where absent."""

    @property
    def file(self) -> Path | None:
        """The model's file, where the job names one."""
        return None if self.model in GUESS_WORDS else Path(self.model)


GUESS_WORDS = ("shipped", "none")


AUTO = "auto"


class FilterInput(Table, frozen=True):
    """`[filter]`: a method of `muybridge.filters.METHODS`; every other key is a setting of that method."""

    name: str = AUTO
    """`auto`: as `Job.chosen_filter` has it."""
    preset: Literal["working", "printed"] = "working"
    """What the settings not given here are: those measured to work, or those of the paper."""
    settings: dict[str, Any] = {}


class MotionInput(Table, frozen=True):
    """`[motion]`: what a prediction does not know, one standard deviation a second, and what is usual.

    Where absent: what suits the method and the number of cameras, `tracking.motion.motion_of`.
    """

    root_speed: Weight | None = None
    """Metres a second."""
    root_turn_speed: Weight | None = None
    """Radians a second."""
    turn_speed: Weight | None = None
    """Radians a second, of every other joint."""
    velocity_gain: Annotated[float, Meta(ge=0, le=1)] | None = None
    """Share of the velocity that the prediction repeats."""
    velocity_follow: Annotated[float, Meta(ge=0, le=1)] | None = None
    """Share of what a step surprises by that the velocity takes up, where accelerations are given; not of guided."""
    root_acceleration: Weight | None = None
    """Metres a second squared; where all three are 0, velocities are differences of places, not estimated."""
    root_turn_acceleration: Weight | None = None
    """Radians a second squared."""
    turn_acceleration: Weight | None = None
    """Radians a second squared, of every other joint."""
    usual_weight: Weight | None = None
    """How strongly the body's usual angles are preferred; 0: not at all, 1: as the body states them."""


class LikelihoodInput(Table, frozen=True):
    """`[likelihood]`: the weight of each cue against the others; 0 switches it off."""

    silhouette: Weight = 1.0
    colour: Weight = 0.0
    boundary: Weight = 0.0
    edges: Weight = 0.0
    silhouette_kind: Literal["two-sided", "one-sided", "iou"] = "two-sided"
    reduction: Annotated[int, Meta(ge=1, le=16)] | None = None
    """Pictures are reduced by this factor; chosen by the person's size where absent."""

    def __post_init__(self) -> None:
        if not any((self.silhouette, self.colour, self.boundary, self.edges)):
            raise ValueError("expected at least one weight above 0")


class ReferenceInput(Table, frozen=True):
    """`[reference]`: another measurement of the same motion, to start from or to compare with."""

    file: Path
    axes: str | None = None
    """The world axis of a .trc file's X, Y and Z, such as "yzx"; found from heads and feet where absent."""


class Job(Table, frozen=True):
    """A whole job; `cameras` is the file's `[[camera]]`."""

    calibration: CalibrationInput
    cameras: Annotated[tuple[CameraInput, ...], Meta(min_length=1)] = field(name="camera")
    name: str = "track"
    seed: Annotated[int, Meta(ge=0)] = 1
    frames: FrameRange | None = None
    body: BodyInput = BodyInput()
    start: StartInput = StartInput()
    guess: GuessInput = GuessInput()
    filter: FilterInput = FilterInput()
    motion: MotionInput = MotionInput()
    likelihood: LikelihoodInput = LikelihoodInput()
    reference: ReferenceInput | None = None

    def __post_init__(self) -> None:
        names = [camera.name for camera in self.cameras]
        if len(set(names)) < len(names):
            raise ValueError(f"expected different camera names, got {', '.join(names)}")
        if self.start.pose == "reference" and self.reference is None:
            raise ValueError('start.pose = "reference" needs a [reference]')
        _check_range(self.frames, "frames")

    @property
    def chosen_filter(self) -> FilterInput:
        """The filter with `auto` decided: guided with several cameras, annealed, all of the body at once, with one.

        papers/du-2005, tables E1-ring and E1-side: a contour seen from one side has too many peaks to climb.
        """
        if self.filter.name != AUTO:
            return self.filter
        if len(self.cameras) > 1:
            return msgspec.structs.replace(self.filter, name="guided")
        own = {"particles": 500, "layers": 10, "by_limb": False} if self.filter.preset == "working" else {}
        return msgspec.structs.replace(self.filter, name="annealed", settings={**own, **self.filter.settings})


# The file reads in the order in which a person thinks of it, whatever order the fields need.
ORDER = (
    "name",
    "seed",
    "frames",
    "calibration",
    "camera",
    "body",
    "start",
    "guess",
    "filter",
    "motion",
    "likelihood",
    "reference",
)


def read(path: Path | str, overrides: Sequence[str] = ()) -> Job:
    """Read a job file.

    Parameters
    ----------
    path : Path
        The TOML file; relative paths in it start from its folder.
    overrides : sequence of str
        Settings that win over the file's, `"filter.particles=1000"`; a camera is `camera.NAME.` or `camera.0.`.
        Relative paths in them start from the file's folder too.
    """
    path = Path(path)
    table = _toml.load(path, "a job")
    return from_table(table, path.parent, overrides=overrides, source=path.name)


def from_table(table: Mapping[str, Any], folder: Path, *, overrides: Sequence[str] = (), source: str = "job") -> Job:
    """A job from the nested tables that its file would hold, with relative paths starting from `folder`."""
    folder = Path(folder).absolute()
    tables: dict[str, Any] = _tables.copied(table)
    for text in overrides:
        _tables.override(tables, text)
    _resolve_text_paths(tables, folder)
    return _tables.convert(tables, Job, folder, source)


def check_settings(job: Job) -> None:
    """Raise where a filter or background model is unknown, or does not have one of the job's settings for it."""
    filter_config(job)
    for camera in job.cameras:
        background_config(camera)


def filter_config(job: Job) -> Any:
    """The Config of the job's filter method: its preset, with the job's settings in place of the preset's."""
    from muybridge.filters import METHODS

    chosen = job.chosen_filter
    if chosen.name not in METHODS:
        raise _tables.unknown("filter.name", chosen.name, [AUTO, *METHODS])
    method = METHODS[chosen.name]
    preset = method.PRINTED if chosen.preset == "printed" else method.WORKING
    return _tables.replaced(preset, chosen.settings, f"filter {chosen.name}")


def background_config(camera: CameraInput) -> Any:
    """The config of the camera's background model; None where it has none."""
    from muybridge.segmentation import BACKGROUND_MODELS

    background = camera.background
    if background is None:
        return None
    if background.kind not in BACKGROUND_MODELS:
        raise _tables.unknown(f"camera {camera.name}: background.kind", background.kind, list(BACKGROUND_MODELS))
    model = BACKGROUND_MODELS[background.kind]
    if model.needs_pictures and background.file is None and background.empty is None:
        raise InputError(f"camera {camera.name}: {background.kind} background", expected="the empty scene", got="none",
                         remedy="give file, or empty = [first, last]")  # fmt: skip
    return _tables.replaced(model.config(), background.settings, f"camera {camera.name}: {background.kind}")


def dumps(job: Job, folder: Path | None = None) -> str:
    """The job as TOML, defaults left out; paths inside `folder` are written relative to it."""
    table = msgspec.to_builtins(job, enc_hook=lambda path: _relative(str(path), folder))
    if job.start.file is not None:
        table["start"]["pose"] = _relative(job.start.pose, folder)
    if job.guess.file is not None:
        table["guess"]["model"] = _relative(job.guess.model, folder)
    if isinstance(job.body.measures, str):
        table["body"]["measures"] = _relative(job.body.measures, folder)
    for open_table in (table.get("filter", {}), *(row.get("background", {}) for row in table["camera"])):
        open_table |= open_table.pop("settings", {})
    return _toml.dumps({key: table[key] for key in ORDER if key in table})


def write(path: Path | str, job: Job) -> None:
    """Write the job file; paths in its own folder become relative, so that the folder can be moved as a whole."""
    path = Path(path)
    path.write_text(dumps(job, path.parent.absolute()), encoding="utf-8")


def _check_range(frames: tuple[int, int] | None, name: str) -> None:
    if frames is not None and frames[0] > frames[1]:
        raise ValueError(f"expected {name} = [first, last] with first <= last, got {list(frames)}")


def _resolve_text_paths(table: dict[str, Any], folder: Path) -> None:
    """The keys that are a path only when they are not something else."""
    start, body, guess = table.get("start"), table.get("body"), table.get("guess")
    if isinstance(guess, dict) and isinstance(guess.get("model"), str) and guess["model"] not in GUESS_WORDS:
        guess["model"] = str(folder / guess["model"])
    if isinstance(start, dict) and isinstance(start.get("pose"), str) and start["pose"] not in START_WORDS:
        start["pose"] = str(folder / start["pose"])
    if isinstance(body, dict) and isinstance(body.get("measures"), str):
        body["measures"] = str(folder / body["measures"])


def _relative(path: str, folder: Path | None) -> str:
    return Path(path).relative_to(folder).as_posix() if folder and Path(path).is_relative_to(folder) else path
