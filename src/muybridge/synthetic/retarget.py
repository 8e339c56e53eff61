"""A recording's motion on a figure's bones.

Every bone of the figure takes the orientation of its counterpart, corrected by one fixed turn a bone: the turn that
brings the figure's neutral posture to the recording's rest posture. For trunk and head that is the rest posture's own
front, left and up; a limb's bone is laid along its counterpart, and rolled so that the axes of knees and elbows agree.
Where the rest posture's knees and elbows bend to is seen from the recording itself. So directions of limbs are exactly
the recording's, while lengths are the figure's; the path of the hips scales with the length of the legs.

A spine has any number of bones in a file. Here the thorax follows the bone that bears the shoulders, the abdomen turns
half way between pelvis and thorax, and the neck half way between thorax and head.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from muybridge.io.skeleton import Recording, Skeleton
from muybridge.synthetic.bone_names import matched
from muybridge.synthetic.limbs import SIDES, leg_length
from muybridge.synthetic.skinning import DOWN, FORWARD, Figure, turn_between

LEFT, UP = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])
#: Degrees: a rest posture nearer than this to the axes of its file is taken to stand along them.
SNAP = 20.0
#: Weight of where knees and elbows usually bend to, against a bend of 90 degrees throughout the recording.
USUAL = 0.05


def retarget(figure: Figure, recording: Recording, where: str) -> tuple[np.ndarray, np.ndarray]:
    """Pose a figure as the recording is; feet are left where lengths of legs take them (`contacts` mends that).

    Parameters
    ----------
    where : the recording's file, for errors

    Returns
    -------
    (T, B, 3, 3) and (T, B, 3) metres: world rotations and places of the figure's bones
    """
    bones = matched(recording.skeleton.names, where)
    turned, places = recording.posed()
    worlds = np.empty((len(turned), len(figure.bone_names), 3, 3))
    for bone, fixed in corrections(recording.skeleton, bones, turned).items():
        worlds[:, figure.bone(bone)] = turned[:, bones.get(bone, _bearer(recording.skeleton, bones))] @ fixed
    _fill(figure, worlds, bones)
    scale = leg_length(figure) / _leg(recording.skeleton, bones)
    hips = scale * 0.5 * (places[:, bones["left_thigh"]] + places[:, bones["right_thigh"]])
    return worlds, carried(figure, worlds, hips)


def corrections(skeleton: Skeleton, bones: dict[str, int], turned: np.ndarray) -> dict[str, np.ndarray]:
    """Bone -> (3, 3): from the figure's neutral posture to the recording's rest; turned: (T, B, 3, 3), world."""
    axes = rest_axes(skeleton, bones)
    fixed = dict.fromkeys(("pelvis", "thorax", "head", "left_clavicle", "right_clavicle"), axes)
    for side in SIDES:
        for parts, bend in ((("upper_arm", "forearm", "hand"), -LEFT), (("thigh", "shank", "foot"), LEFT)):
            upper, lower, end = (bones[f"{side}_{part}"] for part in parts)
            rest = skeleton.rest_places
            along = [_unit(rest[lower] - rest[upper]), _unit(rest[end] - rest[lower])]
            hinge = np.einsum("tij,j->ti", turned[:, upper], along[0])
            hinge = np.cross(hinge, np.einsum("tij,j->ti", turned[:, lower], along[1]))
            usual = np.cross(along[0], axes @ (-FORWARD if bend[1] > 0 else FORWARD))
            for bone, part, direction in ((upper, parts[0], along[0]), (lower, parts[1], along[1])):
                own = np.einsum("tji,tj->i", turned[:, bone], hinge) / len(turned) + USUAL * usual
                fixed[f"{side}_{part}"] = turn_between((DOWN, bend), (direction, own))
        fixed[f"{side}_hand"] = _hand(skeleton, bones, side, axes)
        fixed[f"{side}_foot"] = fixed[f"{side}_toes"] = _foot(skeleton, bones, side, axes, turned)
    return {bone: turn for bone, turn in fixed.items() if bone in bones or bone in ("thorax",)}


def rest_axes(skeleton: Skeleton, bones: dict[str, int]) -> np.ndarray:
    """(3, 3): columns: front, left and up of the recording's rest posture, along the world's axes if nearly so."""
    rest = skeleton.rest_places
    across = rest[bones["left_thigh"]] - rest[bones["right_thigh"]]
    up = rest[bones["head"]] - 0.5 * (rest[bones["left_thigh"]] + rest[bones["right_thigh"]])
    up = _snapped(_unit(up))
    left = _snapped(_unit(across - up * (up @ across)))
    left = _unit(left - up * (up @ left))
    return np.stack([np.cross(left, up), left, up], axis=1)


def carried(figure: Figure, worlds: np.ndarray, hips: np.ndarray) -> np.ndarray:
    """(T, B, 3) metres: where bones with these world rotations are, the middle of the hips at (T, 3)."""
    places = np.zeros((len(worlds), len(figure.bone_names), 3))
    for bone in range(1, len(figure.bone_names)):
        parent = figure.parents[bone]
        places[:, bone] = places[:, parent] + worlds[:, parent] @ figure.neutral_offsets[bone]
    middle = 0.5 * (places[:, figure.bone("left_thigh")] + places[:, figure.bone("right_thigh")])
    return places + (hips - middle)[:, None]


def halfway(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """(T, 3, 3): the turn half way from one to the other."""
    between = Rotation.from_matrix(np.swapaxes(first, -1, -2) @ second)
    return first @ Rotation.from_rotvec(0.5 * between.as_rotvec()).as_matrix()


def _bearer(skeleton: Skeleton, bones: dict[str, int]) -> int:
    """The bone that bears the shoulders: the nearest that is above both upper arms."""
    above = {bone: _ancestors(skeleton, bones[bone]) for bone in ("left_upper_arm", "right_upper_arm")}
    return next(bone for bone in above["left_upper_arm"] if bone in above["right_upper_arm"])


def _ancestors(skeleton: Skeleton, bone: int) -> list[int]:
    """Parents, the nearest first."""
    found = []
    while skeleton.parents[bone] >= 0:
        bone = int(skeleton.parents[bone])
        found.append(bone)
    return found


def _fill(figure: Figure, worlds: np.ndarray, bones: dict[str, int]) -> None:
    """Bones that have no counterpart: between their neighbours, or with their parent."""
    pelvis, abdomen, thorax, neck, head = (figure.bone(b) for b in ("pelvis", "abdomen", "thorax", "neck", "head"))
    worlds[:, abdomen] = halfway(worlds[:, pelvis], worlds[:, thorax])
    worlds[:, neck] = halfway(worlds[:, thorax], worlds[:, head])
    for side in SIDES:
        for bone, parent in ((f"{side}_clavicle", "thorax"), (f"{side}_toes", f"{side}_foot")):
            if bone not in bones:
                worlds[:, figure.bone(bone)] = worlds[:, figure.bone(parent)]


def _leg(skeleton: Skeleton, bones: dict[str, int]) -> float:
    """Metres, from hip to knee to ankle, the mean of both sides."""
    rest = skeleton.rest_places
    lengths = [
        np.linalg.norm(rest[bones[f"{side}_{a}"]] - rest[bones[f"{side}_{b}"]])
        for side in SIDES
        for a, b in (("shank", "thigh"), ("foot", "shank"))
    ]
    return 0.5 * float(np.sum(lengths))


def _hand(skeleton: Skeleton, bones: dict[str, int], side: str, axes: np.ndarray) -> np.ndarray:
    """Palms face what they face with the arm at the side, carried to the rest posture with the front kept in front."""
    rest, hand, forearm = skeleton.rest_places, bones[f"{side}_hand"], bones[f"{side}_forearm"]
    along = skeleton.tips[hand] if np.any(skeleton.tips[hand]) else rest[hand] - rest[forearm]
    return turn_between((DOWN, FORWARD), (along, axes @ FORWARD))


def _foot(skeleton: Skeleton, bones: dict[str, int], side: str, axes: np.ndarray, turned: np.ndarray) -> np.ndarray:
    """Soles lie flat at rest, or are square to a leg held outward: whichever is flatter while feet are still."""
    rest, foot = skeleton.rest_places, bones[f"{side}_foot"]
    leg = rest[foot] - rest[bones[f"{side}_thigh"]]
    still = np.linalg.norm(np.diff(turned[:, foot], axis=0, prepend=turned[:1, foot]), axis=(1, 2))
    still = np.argsort(still, kind="stable")[: max(1, len(still) // 4)]
    choices = [axes, turn_between((FORWARD, DOWN), (axes @ FORWARD, leg))]
    return max(choices, key=lambda fixed: float((turned[still, foot] @ fixed @ UP)[:, 2].mean()))


def _snapped(direction: np.ndarray) -> np.ndarray:
    """The coordinate axis a unit vector is near to, or itself."""
    axis = np.zeros(3)
    axis[np.argmax(np.abs(direction))] = np.sign(direction[np.argmax(np.abs(direction))])
    return axis if direction @ axis > np.cos(np.radians(SNAP)) else direction


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.linalg.norm(vector)
