"""HumanEva's 15 joints against a literal, frame-by-frame reading of their definition, and against numbers by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from made_humaneva import LABELS, SKIN, made_track
from muybridge.datasets.humaneva_joints import Person, humaneva_joints, torso_radius
from muybridge.errors import InputError
from muybridge.evaluation.names import JOINTS
from muybridge.io.trc import MarkerTrack

PERSON = Person(0.17, (0.044, 0.050))


def shift(x: float, y: float, z: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def about_y(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, -s, 0], [0, 1, 0, 0], [s, 0, c, 0], [0, 0, 0, 1]])


def literal_joints(track: MarkerTrack, row: float, person: Person) -> dict[str, np.ndarray]:
    """One frame, with 4 x 4 transforms from a segment to the world: 20 ends of 10 limbs, two of them a joint."""
    low, high = int(np.floor(row)), int(np.ceil(row))
    share = row - low

    def raw(name: str, at: int) -> np.ndarray:
        return track.positions[at, LABELS.index(name)]

    def point(name: str) -> np.ndarray:
        return (1 - share) * raw(name, low) + share * raw(name, high)

    def axes(segment: str, at: int) -> np.ndarray:
        rows = [raw(f"{segment}{letter}", at) - raw(f"{segment}O", at) for letter in "ALP"]
        return np.array([line / np.linalg.norm(line) for line in rows]).T

    def transform(segment: str, origin: str) -> np.ndarray:
        ends = Rotation.from_matrix([axes(segment, low), axes(segment, high)])
        matrix = np.eye(4)
        matrix[:3, :3] = Slerp([0, 1], ends)(share).as_matrix()
        matrix[:3, 3] = point(origin)
        return matrix

    def length(one: str, other: str) -> float:
        return float(np.mean([np.linalg.norm(raw(one, at) - raw(other, at)) for at in (low, high)]))

    torso = length("TRXO", "PELO")
    pelvis = transform("PEL", "PELO") @ shift(-0.05, 0, 0) @ about_y(np.arctan2(person.torso_radius / 2, torso))
    ends = {
        "torso_proximal": (pelvis @ [0, 0, torso, 1])[:3],
        "torso_distal": pelvis[:3, 3],
        "head_proximal": point("TRXO"),
        "head_distal": (transform("HED", "TRXO") @ [0, 0, 0.316103, 1])[:3],
    }
    for side, letter, offset in zip(("left", "right"), "LR", person.shoulder_offsets, strict=True):
        thigh = transform(f"{letter}FE", f"{letter}FEP") @ about_y(np.pi)
        shank = transform(f"{letter}TI", f"{letter}FEO") @ about_y(np.pi)
        ends[f"{side}_hip"] = thigh[:3, 3]
        ends[f"{side}_knee_1"] = (thigh @ [0, 0, length(f"{letter}FEP", f"{letter}FEO"), 1])[:3]
        ends[f"{side}_knee_2"] = shank[:3, 3]
        ends[f"{side}_ankle"] = (shank @ [0, 0, length(f"{letter}FEO", f"{letter}TIO"), 1])[:3]
        upper, lower = length(f"{letter}CLO", f"{letter}HUO"), length(f"{letter}HUO", f"{letter}RAO")
        arm = transform(f"{letter}HU", f"{letter}CLO")
        forearm = transform(f"{letter}RA", f"{letter}HUO")
        gap = forearm[:3, 3] - (arm @ [0, 0, -upper, 1])[:3]
        arm = arm @ about_y(-np.arctan2(offset / 2, upper))
        forearm[:3, 3] = (arm @ [0, 0, -upper, 1])[:3] + gap
        forearm = forearm @ about_y(np.arctan2(offset / 2, upper))
        ends[f"{side}_shoulder"] = arm[:3, 3]
        ends[f"{side}_elbow_1"] = (arm @ [0, 0, -upper, 1])[:3]
        ends[f"{side}_elbow_2"] = forearm[:3, 3]
        ends[f"{side}_wrist"] = (forearm @ [0, 0, -lower, 1])[:3]
    ends["pelvis"], ends["head_top"] = ends["torso_distal"], ends["head_distal"]
    ends["thorax"] = (ends["torso_proximal"] + ends["head_proximal"]) / 2
    for joint in ("left_knee", "right_knee", "left_elbow", "right_elbow"):
        ends[joint] = (ends[f"{joint}_1"] + ends[f"{joint}_2"]) / 2
    return {name: ends[name] for name in JOINTS}


@pytest.mark.parametrize("seed", [1, 2])
def test_the_literal_definition(seed):
    """On random segments, at whole and at broken rows."""
    track = made_track(rows=12, seed=seed)
    rows = np.array([0, 0.25, 3, 7.5, 10.9, 11])
    joints = humaneva_joints(track, rows, PERSON)
    for row, found in zip(rows, joints, strict=True):
        np.testing.assert_allclose(found, list(literal_joints(track, row, PERSON).values()), atol=1e-12)


def standing() -> MarkerTrack:
    """Upright, every segment's axes those of the world: x forward, y to the left, z up."""
    origins = {
        "PEL": (0, 0, 1.0), "HED": (0, 0, 1.6), "LFE": (0, 0.1, 0.5), "RFE": (0, -0.1, 0.5), "LTI": (0, 0.1, 0.1),
        "RTI": (0, -0.1, 0.1), "LHU": (0, 0.2, 1.2), "RHU": (0, -0.2, 1.2), "LRA": (0, 0.2, 0.95),
        "RRA": (0, -0.2, 0.95),
    }  # fmt: skip
    lengths = {"LFE": 0.4, "RFE": 0.4}  # the thigh's tip is the hip
    places = {"TRXO": (0, 0, 1.5), "LCLO": (0, 0.2, 1.5), "RCLO": (0, -0.2, 1.5)} | {name: (1, 1, 1) for name in SKIN}
    for segment, origin in origins.items():
        places[f"{segment}O"] = origin
        for letter, axis in zip("ALP", np.eye(3), strict=True):
            places[f"{segment}{letter}"] = tuple(np.array(origin) + lengths.get(segment, 0.2) * axis)
    positions = np.tile(np.array([places[name] for name in LABELS], float), (2, 1, 1))
    return MarkerTrack(LABELS, np.arange(2), np.arange(2) / 120, positions, "xyz")


def test_by_hand():
    """Standing upright with r = 2 * 0.5 tan(10 degrees) and s = 2 * 0.3 tan(5 degrees), so that the turns are whole."""
    ten, five = np.radians([10, 5])
    person = Person(2 * 0.5 * np.tan(ten), (2 * 0.3 * np.tan(five),) * 2)
    joints = dict(zip(JOINTS, humaneva_joints(standing(), np.array([0.5]), person)[0], strict=True))
    expected = {
        "pelvis": (-0.05, 0, 1.0),
        # The torso leans back by 10 degrees: its upper end, and TRXO.
        "thorax": ((-0.05 - 0.5 * np.sin(ten)) / 2, 0, (1 + 0.5 * np.cos(ten) + 1.5) / 2),
        "head_top": (0, 0, 1.5 + 0.316103),
        "left_hip": (0, 0.1, 0.9),
        "left_knee": (0, 0.1, 0.5),
        "right_ankle": (0, -0.1, 0.1),
        "left_shoulder": (0, 0.2, 1.5),
        # The upper arm hangs 5 degrees backwards, the forearm 5 degrees forwards again.
        "right_elbow": (-0.3 * np.sin(five), -0.2, 1.5 - 0.3 * np.cos(five)),
        "right_wrist": (-0.3 * np.sin(five) + 0.25 * np.sin(five), -0.2, 1.5 - 0.55 * np.cos(five)),
    }
    for name, place in expected.items():
        np.testing.assert_allclose(joints[name], place, atol=1e-12, err_msg=name)


def without(track: MarkerTrack, row: int, name: str) -> MarkerTrack:
    positions = track.positions.copy()
    positions[row, track.names.index(name)] = np.nan
    return replace(track, positions=positions)


@pytest.mark.parametrize("name", ["LTOE", "C7", "LFRM", "LHUA", "TRXO"])
def test_a_point_that_was_not_seen_spoils_the_frames_that_need_its_row(name):
    """Row 5 of frames at 0, 1.5, 3, ...: needed by 4.5 alone. At whole rows, by that row alone."""
    track = without(made_track(rows=20), 5, name)
    rows = np.array([0, 1.5, 3, 4.5, 6, 7.5])
    invalid = np.isnan(humaneva_joints(track, rows, PERSON)).any(axis=(1, 2))
    assert invalid.tolist() == [False, False, False, True, False, False]
    invalid = np.isnan(humaneva_joints(track, np.arange(4.0, 7), PERSON)).all(axis=(1, 2))
    assert invalid.tolist() == [False, True, False]


def test_moments_outside_the_track_are_invalid():
    joints = humaneva_joints(made_track(rows=10), np.array([-0.5, 0, 9, 9.01]), PERSON)
    assert np.isnan(joints).all(axis=(1, 2)).tolist() == [True, False, False, True]


def test_axes_that_are_not_at_right_angles_are_invalid():
    track = made_track(rows=10)
    positions = track.positions.copy()
    positions[4, LABELS.index("RTIA")] += 0.1
    joints = humaneva_joints(replace(track, positions=positions), np.arange(10.0), PERSON)
    assert np.flatnonzero(np.isnan(joints).any(axis=(1, 2))).tolist() == [4]
    swapped = [{"PELA": "PELL", "PELL": "PELA"}.get(name, name) for name in LABELS]  # left-handed in every frame
    with pytest.raises(InputError, match="PELO, PELA"):
        humaneva_joints(replace(track, names=tuple(swapped)), np.arange(10.0), PERSON)


def test_labels_may_carry_the_subject_and_the_other_forearm():
    track = made_track(rows=3)
    names = tuple("Leon:" + {"LFRM": "LFRA"}.get(name, name) for name in LABELS)
    again = humaneva_joints(replace(track, names=names), np.arange(3.0), PERSON)
    np.testing.assert_array_equal(again, humaneva_joints(track, np.arange(3.0), PERSON))
    with pytest.raises(InputError, match="RFRM or RFRA"):
        humaneva_joints(replace(track, names=tuple(n.replace("RFRM", "X") for n in LABELS)), np.arange(3.0), PERSON)


def test_the_torso_is_measured_where_both_shoulders_were_seen():
    track = made_track(rows=3)
    left, right = LABELS.index("LSHO"), LABELS.index("RSHO")
    positions = track.positions.copy()
    positions[:, left], positions[:, right] = (0, 0.2, 1.4), (0, -0.19, 1.4)
    positions[1, left] = np.nan
    assert torso_radius(replace(track, positions=positions)) == pytest.approx(0.39 / 2 - 0.007)
    positions[:, left] = np.nan
    with pytest.raises(InputError, match="LSHO and RSHO"):
        torso_radius(replace(track, positions=positions))
