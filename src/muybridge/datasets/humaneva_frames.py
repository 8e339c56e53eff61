"""HumanEva's time: which picture of each camera and which row of the motion capture belong to one frame.

Cameras were started one after another, and the motion capture runs at about twice their rate. For each camera a file
`Sync_Data/MOTION_(CAMERA).ofs` holds three numbers: a picture, the motion capture frame of the same moment, and motion
capture frames a picture. Both count from 1:

    mocap frame = o_mocap + (picture - o_picture) s

One numbering for all cameras comes of it, in which frame 1 is the first that every camera has. It depends on every
camera with such a file, also on those that are not used: the published parts (train, validate, test) are stated in it.
Frames of this module count from 0, so 0 is the publication's 1.

Checked against the data set's release code 1.1 (github.com/emredog/humaneva: TOOLBOX_common/ReadStreamOffset.m,
@sync_stream/sync_stream.m, @he_dataset/he_dataset.m), and the parts against facebookresearch/VideoPose3D,
data/prepare_data_humaneva.py, which also tells that the first pictures so found suit decoding by FFmpeg. Not checked on
the data itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from muybridge.datasets.bodytrack import read_numbers
from muybridge.errors import InputError

RATE_HZ = 60.0
"""Pictures a second."""
REPEATED = 5
"""Frames at the beginning of a video that may show one picture: a fault of the codec that wrote them."""

# Last frame, counted from 1, of trial 1's validation part, trial 1's training part and trial 2's test part. Trial 3 was
# recorded without cameras.
HUMANEVA_I: dict[str, dict[str, tuple[int | None, int | None, int]]] = {
    "S1": {"Walking": (590, 1203, 1004), "Jog": (367, 740, 874), "ThrowCatch": (473, 945, 951),
           "Gestures": (395, 801, 1070), "Box": (385, 789, 606), "Combo": (None, None, 2602)},
    "S2": {"Walking": (438, 876, 1093), "Jog": (398, 795, 727), "ThrowCatch": (550, 1128, 1399),
           "Gestures": (500, 901, 1062), "Box": (382, 734, 989), "Combo": (None, None, 2054)},
    "S3": {"Walking": (448, 939, 805), "Jog": (401, 842, 864), "ThrowCatch": (493, 1027, 1000),
           "Gestures": (533, 1102, 553), "Box": (512, 1021, 753), "Combo": (None, None, 1798)},
    "S4": {"Walking": (None, None, 667), "Jog": (None, None, 590), "ThrowCatch": (None, None, 773),
           "Gestures": (None, None, 459), "Box": (None, None, 574), "Combo": (None, None, 1102)},
}  # fmt: skip
HUMANEVA_II: dict[tuple[str, str], tuple[int, int]] = {("S2", "Combo_1"): (1, 1202), ("S4", "Combo_4"): (2, 1258)}
"""First and last frame of the test parts, counted from 1."""


@dataclass(frozen=True)
class StreamOffset:
    """One .ofs file: `picture` and `mocap` are the same moment, both from 1; `step` is mocap frames a picture."""

    picture: float
    mocap: float
    step: float


@dataclass(frozen=True)
class Synchrony:
    """One numbering for all streams, from 0.

    Attributes
    ----------
    first : dict
        The picture of each camera, from 0, that is frame 0.
    mocap_first, mocap_step : float
        Frame k is row mocap_first + k mocap_step of the motion capture, from 0; between two rows where not whole.
    """

    first: dict[str, int]
    mocap_first: float
    mocap_step: float

    def mocap_rows(self, frames: NDArray) -> NDArray:
        """(F,) frames -> (F,) float64 rows of the motion capture."""
        return self.mocap_first + np.asarray(frames, np.float64) * self.mocap_step

    def mocap_frames(self, rows: int) -> int:
        """How many frames the motion capture covers if it has so many rows."""
        return max(0, int(np.floor((rows - 1 - self.mocap_first) / self.mocap_step + 1e-9)) + 1)


def read_offset(path: Path | str) -> StreamOffset:
    """Read an .ofs file."""
    picture, mocap, step = read_numbers(path, 3)
    if not step > 0:
        raise InputError(str(path), expected="motion capture frames a picture above 0", got=f"{step:g}")
    return StreamOffset(float(picture), float(mocap), float(step))


def synchronise(offsets: Mapping[str, StreamOffset]) -> Synchrony:
    """One numbering for all cameras.

    Parameters
    ----------
    offsets : mapping of camera name to StreamOffset
        All cameras of the motion, in the publication's order: its numbering takes the first one's motion capture frame
        and the mean of all steps.
    """
    values = np.array([(offset.picture, offset.mocap, offset.step) for offset in offsets.values()])
    mocap, step = float(values[0, 1]), float(values[:, 2].mean())
    starts = values[:, 0] + (mocap - values[:, 1]) / values[:, 2]
    mocap -= step * float(starts.min() - 1)
    starts = starts - starts.min() + 1
    if mocap < 1:  # the cameras were there before the motion capture
        starts = starts - (mocap - 1) / step
        mocap = 1.0
    whole = np.floor(starts + 0.5).astype(int) - 1
    return Synchrony(dict(zip(offsets, whole.tolist(), strict=True)), mocap - 1, step)


def part_frames(subject: str, motion: str, part: str) -> tuple[int, int]:
    """First and last frame, from 0, of the train, validate or test part of a motion."""
    parts = _parts_of(subject, motion)
    if part not in parts:
        raise InputError(
            f"part of {subject} {motion}", expected=" or ".join(parts) or "none, it has no parts", got=repr(part)
        )
    first, last = parts[part]
    return first - 1, last - 1


def _parts_of(subject: str, motion: str) -> dict[str, tuple[int, int]]:
    """Parts by name, counted from 1."""
    if (subject, motion) in HUMANEVA_II:
        return {"test": HUMANEVA_II[subject, motion]}
    action, _, trial = motion.rpartition("_")
    validate, train, test = HUMANEVA_I.get(subject, {}).get(action, (None, None, None))
    if trial == "1" and validate and train:
        return {"train": (validate + 1, train), "validate": (REPEATED + 1, validate)}
    return {"test": (REPEATED + 1, test)} if trial == "2" and test else {}
