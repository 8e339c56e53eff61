"""A figure's own motion written as a BVH file: a recording whose truth is known."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import Rotation

from muybridge.synthetic.clip import Track
from muybridge.synthetic.skinning import Figure

MIXAMO = {
    "pelvis": "Hips",
    "abdomen": "Spine",
    "thorax": "Spine1",
    "neck": "Neck",
    "head": "Head",
    "clavicle": "Shoulder",
    "upper_arm": "Arm",
    "forearm": "ForeArm",
    "hand": "Hand",
    "thigh": "UpLeg",
    "shank": "Leg",
    "foot": "Foot",
    "toes": "ToeBase",
}
BY_JOINTS = MIXAMO | {
    "clavicle": "Collar",
    "upper_arm": "Shoulder",
    "forearm": "Elbow",
    "hand": "Wrist",
    "thigh": "Hip",
    "shank": "Knee",
    "foot": "Ankle",
    "toes": "Toe",
}
CMU = {
    "pelvis": "root",
    "abdomen": "lowerback",
    "clavicle": "clavicle",
    "upper_arm": "humerus",
    "forearm": "radius",
    "hand": "hand",
    "thigh": "femur",
    "shank": "tibia",
    "foot": "foot",
    "toes": "toes",
}


def named(table: dict[str, str], prefix: str = "", *, short: bool = False) -> Callable[[str], str]:
    """Bone of a figure -> name in a file."""

    def name(bone: str) -> str:
        side, _, part = bone.partition("_") if bone.startswith(("left_", "right_")) else ("", "", bone)
        return prefix + (side[:1] if short else side.capitalize()) + table.get(part, part)

    return name


def rest_turns(figure: Figure, spread: float) -> np.ndarray:
    """(B, 3, 3): from the neutral posture to one with the arms `spread` degrees from the sides; 90: a T-pose."""
    turns = np.tile(np.eye(3), (len(figure.bone_names), 1, 1))
    for side, sign in (("left", 1), ("right", -1)):
        for part in ("upper_arm", "forearm", "hand"):
            turns[figure.bone(f"{side}_{part}")] = Rotation.from_euler("x", sign * spread, degrees=True).as_matrix()
    return turns


def bvh_text(
    figure: Figure,
    track: Track,
    name: Callable[[str], str],
    *,
    order: str = "ZXY",
    unit: float = 0.01,
    spread: float = 90.0,
) -> str:
    """The track as BVH, Y up, with a rest posture of its own; `unit` in metres."""
    rest, parents = rest_turns(figure, spread), figure.parents
    to_file = np.eye(3)[[1, 2, 0]]  # the file's X, Y, Z are the world's y, z, x
    offsets = np.einsum("bij,bj->bi", rest[parents], figure.neutral_offsets) @ to_file.T / unit
    worlds = to_file @ track.rotations @ np.swapaxes(rest, -1, -2) @ to_file.T
    local = np.swapaxes(worlds[:, parents], -1, -2) @ worlds
    local[:, 0] = worlds[:, 0]
    columns, lines = [track.places[:, 0] @ to_file.T / unit], ["HIERARCHY"]

    def write(bone: int, depth: int) -> None:
        pad = "\t" * depth
        channels = " ".join(f"{axis}rotation" for axis in order)
        kind, lead = ("ROOT", "6 Xposition Yposition Zposition") if bone == 0 else ("JOINT", "3")
        lines.append(f"{pad}{kind} {name(figure.bone_names[bone])}")
        lines.extend([f"{pad}{{", f"{pad}OFFSET {' '.join(f'{v:.6f}' for v in offsets[bone])}"])
        lines.append(f"{pad}CHANNELS {lead} {channels}")
        columns.append(Rotation.from_matrix(local[:, bone]).as_euler(order, degrees=True))
        children = np.flatnonzero(parents == bone)
        for child in children:
            write(int(child), depth + 1)
        if not len(children):
            tip = rest[bone] @ (0, 0, -0.1) if "hand" in figure.bone_names[bone] else np.array([0, 0, 0.15])
            end = " ".join(f"{v:.6f}" for v in to_file @ tip / unit)
            lines.extend([f"{pad}\tEnd Site", f"{pad}\t{{", f"{pad}\tOFFSET {end}", f"{pad}\t}}"])
        lines.append(f"{pad}}}")

    write(0, 0)
    rows = [" ".join(f"{v:.6f}" for v in row) for row in np.concatenate(columns, axis=1)]
    interval = track.times[1] - track.times[0]
    return "\n".join([*lines, "MOTION", f"Frames: {len(rows)}", f"Frame Time: {interval:.7f}", *rows, ""])
