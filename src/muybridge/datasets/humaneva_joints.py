"""HumanEva's 15 joints from what its motion capture files hold.

The files carry 39 markers on the skin and the points that Vicon's Plug-in Gait computed from them. For each segment
those are four: origin O, and one along each axis, P proximal (z), A anterior (x), L lateral (y), so PELO, PELP, PELA,
PELL for the pelvis. The joints are made of the computed points alone; a frame counts only where all markers were seen.

With R the segment's axes, L(a, b) the distance of two points, r half the mean distance of the shoulder markers in the
static trial less half a marker (7 mm), s the shoulder offset of the .mp file, Y(t) = [[cos t, 0, -sin t], [0, 1, 0],
[sin t, 0, cos t]], all in millimetres:

    pelvis      p = PELO + R_pel (-50, 0, 0)
    thorax      mean of TRXO and p + R_pel Y(atan2(r / 2, l)) (0, 0, l), l = L(TRXO, PELO)
    head_top    TRXO + R_hed (0, 0, 316.103)
    hip, ankle  FEP; FEO - R_tib (0, 0, L(FEO, TIO))
    knee        mean of FEO and FEP - R_fem (0, 0, L(FEP, FEO))
    shoulder    CLO
    elbow       mean of u = CLO + R_hum Y(-t) (0, 0, -l) and u + d, where l = L(CLO, HUO), t = atan2(s / 2, l),
                d = HUO - CLO - R_hum (0, 0, -l)
    wrist       u + d + R_rad Y(t) (0, 0, -L(HUO, RAO))

Between two rows of the motion capture, points are interpolated along the line and axes along the shortest turn.

Checked against the release code 1.1 (github.com/emredog/humaneva: @mocap_stream/cur_frame.m, TOOLBOX_common/
MarkerCoord2Xform.m, define_markers.m, ComputeLimbParameters.m, yRotation.m); that two points of one joint are
averaged, against VideoPose3D's ConvertHumanEva.m; the names of the points, against Vicon's list of Plug-in Gait bones.
Not checked on the data itself.

Differences from the release code: axes are found by the points' names, not by their order in the file; a frame in
which a computed point is missing or a segment's axes are not at right angles is invalid too, where the release warns
and goes on, or stops; means over the static trial leave out what was not seen. jackd/human_pose_util, a port of it,
turns the other way about y.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from muybridge.errors import InputError
from muybridge.evaluation.names import JOINTS
from muybridge.io.trc import MarkerTrack

HALF_MARKER = 0.007
PELVIS_SHIFT = (-0.050, 0.0, 0.0)
HEAD_LENGTH = 0.316103
"""Metres."""
SKIN_MARKERS = (
    "RASI", "LASI", "LPSI", "RELB", "STRN", "LTHI", "LWRA", "LELB", "T10", "RWRA", "RUPA", "RKNE", "RBAK", "LKNE",
    "CLAV", "RSHO", "LSHO", "C7", "RTIB", "LTIB", "LBHD", "RBHD", "RFHD", "LFHD", "LANK", "LHEE", "RANK", "LTOE",
    "RTOE", "RHEE", "LFIN", ("RFRM", "RFRA"), ("LFRM", "LFRA"), "RWRB", "RFIN", "LWRB", "RTHI", "LUPA", "RPSI",
)  # fmt: skip
"""The 39 that must be seen; the forearm's has two names."""
ORTHOGONAL = 0.02  # cosine between two axes that only wrong points reach
SEGMENTS = ("PEL", "HED", *(f"{side}{bone}" for side in "LR" for bone in ("FE", "TI", "HU", "RA")))


@dataclass(frozen=True)
class Person:
    """What the joints need to know of a person, metres: r, and s on the left and on the right."""

    torso_radius: float
    shoulder_offsets: tuple[float, float]


def torso_radius(static: MarkerTrack) -> float:
    """Half the mean distance of the shoulder markers in the static trial, less half a marker; metres."""
    left, right = (static.positions[:, index_of(static, name)] for name in ("LSHO", "RSHO"))
    distances = np.linalg.norm(left - right, axis=1)
    known = distances[np.isfinite(distances)]
    if not len(known):
        raise InputError("static trial", expected="both shoulder markers, LSHO and RSHO, in one frame", got="none")
    return float(known.mean()) / 2 - HALF_MARKER


def humaneva_joints(track: MarkerTrack, rows: NDArray, person: Person) -> NDArray:
    """The joints of `evaluation.names.JOINTS` at given moments.

    Parameters
    ----------
    track : MarkerTrack
        Points of one trial.
    rows : (F,) float64
        Rows of the track, from 0; may lie between two.
    person : Person

    Returns
    -------
    (F, 15, 3) float64, metres, world
        NaN throughout an invalid frame: outside the track, or with a marker that was not seen in one of its two rows.
    """
    points = _Points(track, np.asarray(rows, np.float64))
    usable = points.inside & points.seen() & points.square()
    found = {"pelvis": points.at("PELO") + points.axes("PEL").apply(PELVIS_SHIFT)}
    length = points.length("TRXO", "PELO")
    lean = _turned(np.arctan2(person.torso_radius / 2, length), length)
    found["thorax"] = (points.at("TRXO") + found["pelvis"] + points.axes("PEL").apply(lean)) / 2
    found["head_top"] = points.at("TRXO") + points.axes("HED").apply((0.0, 0.0, HEAD_LENGTH))
    for side, offset in zip(("left", "right"), person.shoulder_offsets, strict=True):
        found |= {f"{side}_{name}": joint for name, joint in _leg(points, side[0].upper()).items()}
        found |= {f"{side}_{name}": joint for name, joint in _arm(points, side[0].upper(), offset).items()}
    joints = np.stack([found[name] for name in JOINTS], axis=1)
    joints[~(usable & np.isfinite(joints).all(axis=(1, 2)))] = np.nan
    return joints


def _leg(points: _Points, side: str) -> dict[str, NDArray]:
    hip, knee, ankle = f"{side}FEP", f"{side}FEO", f"{side}TIO"
    thigh, shank = points.length(hip, knee), points.length(knee, ankle)
    distal = points.at(hip) + points.axes(f"{side}FE").apply(_along_z(-thigh))
    return {
        "hip": points.at(hip),
        "knee": (distal + points.at(knee)) / 2,
        "ankle": points.at(knee) + points.axes(f"{side}TI").apply(_along_z(-shank)),
    }


def _arm(points: _Points, side: str, offset: float) -> dict[str, NDArray]:
    shoulder, elbow, wrist = f"{side}CLO", f"{side}HUO", f"{side}RAO"
    upper, lower = points.length(shoulder, elbow), points.length(elbow, wrist)
    humerus, radius = points.axes(f"{side}HU"), points.axes(f"{side}RA")
    turn = np.arctan2(offset / 2, upper)
    gap = points.at(elbow) - points.at(shoulder) - humerus.apply(_along_z(-upper))
    distal = points.at(shoulder) + humerus.apply(_turned(-turn, -upper))
    return {
        "shoulder": points.at(shoulder),
        "elbow": distal + gap / 2,
        "wrist": distal + gap + radius.apply(_turned(turn, -lower)),
    }


def _along_z(lengths: NDArray) -> NDArray:
    return np.stack([np.zeros_like(lengths), np.zeros_like(lengths), lengths], axis=-1)


def _turned(angles: NDArray, lengths: NDArray) -> NDArray:
    """Y(t) (0, 0, l), (F, 3)."""
    return np.stack([-np.sin(angles) * lengths, np.zeros_like(lengths), np.cos(angles) * lengths], axis=-1)


class _Points:
    """Points and axes of a track at moments between its rows."""

    def __init__(self, track: MarkerTrack, rows: NDArray) -> None:
        self.track = track
        self.inside = (rows >= 0) & (rows <= len(track.positions) - 1)
        rows = np.where(self.inside, rows, 0.0)
        self.before, self.after = np.floor(rows).astype(int), np.ceil(rows).astype(int)
        self.share = rows - self.before

    def at(self, name: str) -> NDArray:
        """(F, 3) metres; NaN where the point was not seen."""
        before, after = self._ends(name)
        return before + self.share[:, None] * (after - before)

    def axes(self, segment: str) -> Rotation:
        """F rotations whose columns are the segment's x, y, z; the identity where a point is missing or wrong."""
        first, second = (Rotation.from_matrix(matrices) for matrices, _ in self._axes_of(segment))
        return first * Rotation.from_rotvec(self.share[:, None] * (first.inv() * second).as_rotvec())

    def length(self, one: str, other: str) -> NDArray:
        """(F,) metres: the mean of the distances in the two rows."""
        apart = [np.linalg.norm(a - b, axis=1) for a, b in zip(self._ends(one), self._ends(other), strict=True)]
        return (apart[0] + apart[1]) / 2

    def seen(self) -> NDArray:
        """(F,) bool: all markers on the skin were seen in both rows."""
        indices = [index_of(self.track, *([names] if isinstance(names, str) else names)) for names in SKIN_MARKERS]
        known = np.isfinite(self.track.positions[:, indices]).all(axis=(1, 2))
        return known[self.before] & known[self.after]

    def square(self) -> NDArray:
        """(F,) bool: the axes of every segment are at right angles and right-handed in both rows."""
        fine = np.ones(len(self.before), bool)
        for segment in SEGMENTS:
            (_, first), (_, second) = self._axes_of(segment)
            if self.inside.any() and not (first | second).any():
                names = ", ".join(f"{segment}{letter}" for letter in "OALP")
                raise InputError(
                    f"points {names}", expected="origin and axes of a segment, at right angles", got="none"
                )
            fine &= first & second
        return fine

    def _ends(self, name: str) -> tuple[NDArray, NDArray]:
        positions = self.track.positions[:, index_of(self.track, name)]
        return positions[self.before], positions[self.after]

    def _axes_of(self, segment: str) -> list[tuple[NDArray, NDArray]]:
        """In each of the two rows: (F, 3, 3) axes as columns, and whether they are ones (F,); else the identity."""
        origin = self._ends(f"{segment}O")
        tips = [self._ends(f"{segment}{letter}") for letter in "ALP"]
        out = []
        for end in (0, 1):
            with np.errstate(invalid="ignore", divide="ignore"):
                columns = np.stack([tip[end] - origin[end] for tip in tips], axis=-1)
                columns /= np.linalg.norm(columns, axis=1, keepdims=True)
                off = np.abs(np.swapaxes(columns, 1, 2) @ columns - np.eye(3)).max(axis=(1, 2))
            fine = off <= ORTHOGONAL
            columns[~fine] = np.eye(3)
            fine = fine & (np.linalg.det(columns) > 0)
            columns[~fine] = np.eye(3)
            out.append((columns, fine))
        return out


def index_of(track: MarkerTrack, *names: str) -> int:
    """The first point whose label is, or ends with, one of the names: laboratories put the subject's name before it."""
    for name in names:
        found = next((index for index, label in enumerate(track.names) if label.upper().endswith(name)), None)
        if found is not None:
            return found
    raise InputError("motion capture", expected=f"a point {' or '.join(names)}", got=_some(track.names))


def _some(names: Sequence[str]) -> str:
    return ", ".join(names[:8]) + ("..." if len(names) > 8 else "") or "none"
