"""A recording that a figure performs: `Recorded`, beside `Motion`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from muybridge.errors import InputError
from muybridge.io.asf_amc import beside, read_amc
from muybridge.io.bvh import read_bvh
from muybridge.io.skeleton import Recording
from muybridge.synthetic.angles import about
from muybridge.synthetic.contacts import settle
from muybridge.synthetic.retarget import retarget
from muybridge.synthetic.skinning import FORWARD, Figure

#: Degrees from the first to the second frame, and from there on: a posture set before the recording, such as a T-pose.
APART, NEAR = 20.0, 5.0
#: Seconds around the middle of the clip over which the direction faced is averaged.
FACING = 1.0


@dataclass(frozen=True)
class Recorded:
    """What the figure does, from a motion file.

    Parameters
    ----------
    file : path of an .amc or .bvh file
    start, end : seconds in the file
        Left out, the whole of it, without a first frame that stands apart (the T-pose that converters put there).
    rate : frames per second of the clip, whatever the file's are
    heading : radians, direction faced around the middle of the clip, counter-clockwise from +x
    place : (x, y) metres, world, of the pelvis at the middle of the clip
    skeleton : path of an AMC's .asf; empty: the one beside it
    scale : metres a unit of the file; left out, what the file says or its size suggests
    axes : world axis of a BVH's X, Y and Z, such as "yzx" for Y up; empty: guessed
    file_rate : frames per second of an AMC, which does not say
    """

    file: str
    start: float | None = None
    end: float | None = None
    rate: float = 30.0
    heading: float = 0.0
    place: tuple[float, float] = (0.0, 0.0)
    skeleton: str = ""
    scale: float | None = None
    axes: str = ""
    file_rate: float = 120.0

    def __post_init__(self) -> None:
        if Path(self.file).suffix.lower() not in (".amc", ".bvh"):
            raise InputError("motion file", expected="a name that ends in .amc or .bvh", got=repr(self.file))
        for name in ("rate", "file_rate", "scale"):
            value = getattr(self, name)
            if value is not None and not (np.isfinite(value) and value > 0):
                raise InputError(f"recorded motion: {name}", expected="a positive number", got=str(value))
        if not np.isfinite([self.heading, *self.place]).all():
            raise InputError("recorded motion: heading and place", expected="finite numbers", got="nan or infinity")

    @property
    def span(self) -> tuple[float, float]:
        """Seconds in the file: begin and end of the clip."""
        times = load(self).times
        start = self.start if self.start is not None else float(times[_first(load(self))])
        end = self.end if self.end is not None else float(times[-1])
        if not 0 <= start < end <= times[-1] + 1e-6:
            raise InputError(
                f"start and end of {self.file}",
                expected=f"0 <= start < end <= {times[-1]:.2f} s",
                got=f"{start:g} and {end:g}",
            )
        return start, end

    @property
    def duration(self) -> float:
        """Seconds."""
        start, end = self.span
        return end - start

    @property
    def times(self) -> np.ndarray:
        """(T,) seconds."""
        return np.arange(max(1, round(self.duration * self.rate))) / self.rate


def load(recorded: Recorded) -> Recording:
    """The whole recording; the last few files are kept until they change."""
    path = Path(recorded.file)
    amc = path.suffix.lower() == ".amc"
    skeleton = str(recorded.skeleton or beside(path)) if amc else ""
    try:
        stamps = tuple(Path(name).stat().st_mtime_ns for name in (recorded.file, skeleton) if name)
    except OSError as error:
        raise InputError(f"motion file {path}", expected="a file", got=error.strerror or "an error") from error
    return _read(recorded.file, skeleton, recorded.scale, recorded.axes, recorded.file_rate, stamps)


def pose(figure: Figure, recorded: Recorded) -> tuple[np.ndarray, np.ndarray]:
    """(T, B, 3, 3) and (T, B, 3) metres, world: the figure's bones at the clip's times, its feet on the floor."""
    start, end = recorded.span
    recording = _cut(load(recorded), start, end)
    worlds, places = retarget(figure, recording, recorded.file)
    if len(recording.times) > 1:
        settle(figure, worlds, places, 1.0 / float(np.median(np.diff(recording.times))))
    worlds, places = _sampled(figure, recording.times - start, worlds, places[:, 0], recorded.times)
    return _placed(worlds, places, recorded)


@lru_cache(maxsize=8)
def _read(
    file: str, skeleton: str, scale: float | None, axes: str, file_rate: float, stamps: tuple[int, ...]
) -> Recording:
    if skeleton:
        return read_amc(file, skeleton, rate=file_rate, scale=scale)
    return read_bvh(file, scale=scale, axes=axes or None)


def _first(recording: Recording) -> int:
    """1 where the first frame is a posture apart from all that follows, or 0."""
    if len(recording.times) < 3:
        return 0
    change = np.swapaxes(recording.rotations[:2], -1, -2) @ recording.rotations[1:3]
    worst = np.degrees(Rotation.from_matrix(change.reshape(-1, 3, 3)).magnitude()).reshape(2, -1).max(axis=1)
    return int(worst[0] > APART and worst[1] < NEAR)


def _cut(recording: Recording, start: float, end: float) -> Recording:
    """The frames from start to end, seconds, with one more at each side where needed to span them."""
    first = max(int(np.searchsorted(recording.times, start + 1e-9, side="right")) - 1, 0)
    last = int(np.searchsorted(recording.times, end - 1e-9)) + 1
    part = slice(first, last)
    return Recording(recording.skeleton, recording.times[part], recording.rotations[part], recording.root_places[part])


def _sampled(
    figure: Figure, known: np.ndarray, worlds: np.ndarray, roots: np.ndarray, times: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Rotations on great circles between frames, the root along straight lines; at `times` (T,) seconds."""
    times = np.clip(times, known[0], known[-1])
    local = np.swapaxes(worlds[:, figure.parents], -1, -2) @ worlds
    local[:, 0] = worlds[:, 0]
    turned = np.empty((len(times), *local.shape[1:]))
    for bone in range(local.shape[1]):
        own = Rotation.from_matrix(local[:, bone])
        turned[:, bone] = (Slerp(known, own)(times) if len(known) > 1 else own).as_matrix()
    places = np.stack([np.interp(times, known, column) for column in roots.T], axis=1)
    frames = [figure.frames(turn, root) for turn, root in zip(turned, places, strict=True)]
    return np.array([world for world, _ in frames]), np.array([place for _, place in frames])


def _placed(worlds: np.ndarray, places: np.ndarray, recorded: Recorded) -> tuple[np.ndarray, np.ndarray]:
    """Turned about the vertical and moved over the floor to where the clip is wanted."""
    middle, reach = len(worlds) // 2, round(0.5 * FACING * recorded.rate)
    front = (worlds[max(middle - reach, 0) : middle + reach + 1, 0] @ FORWARD).mean(axis=0)
    turn = about(2, np.array(recorded.heading - np.arctan2(front[1], front[0])))
    places = (places - places[middle, 0] * (1, 1, 0)) @ turn.T
    return turn @ worlds, places + (*recorded.place, 0.0)
