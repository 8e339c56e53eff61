"""Joint names: the 15 that are reported, and what other people's files call them."""

from __future__ import annotations

from collections.abc import Iterable

SIDED = ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")
JOINTS: tuple[str, ...] = (
    "pelvis",
    "thorax",
    "head_top",
    *(f"{side}_{joint}" for side in ("left", "right") for joint in SIDED),
)
"""The reported joints (the 15 of HumanEva)."""

OFFICE_NAMES: dict[str, str] = {"pelvis": "pelvis", "neck": "thorax", "headtop": "head_top"} | {
    f"{side[0]}{joint}": f"{side}_{joint}" for side in ("left", "right") for joint in SIDED
}
"""Names in the `truth_joints.csv` of rendered office scenes."""

MARKER_NAMES: dict[str, str] = (
    {
        "neck": "thorax",
        "head": "head_top",
        "headtop": "head_top",
        "hip": "pelvis",
        "midhip": "pelvis",
        "chip": "pelvis",
        "pelvis": "pelvis",
        "thorax": "thorax",
    }
    | {f"{side[0]}{joint}": f"{side}_{joint}" for side in ("left", "right") for joint in SIDED}
    | {f"{side}{joint}": f"{side}_{joint}" for side in ("left", "right") for joint in SIDED}
)
"""Names in marker files (BODY_25B, HALPE_26, COCO), in lower case without separators."""


def joint_of_marker(marker: str) -> str | None:
    """The reported joint a marker stands for, or None: `RHip`, `right_hip` and `Right Hip` are all `right_hip`.

    Examples
    --------
    >>> joint_of_marker("LElbow"), joint_of_marker("Neck"), joint_of_marker("RBigToe")
    ('left_elbow', 'thorax', None)
    """
    plain = marker.strip().lower()
    if plain in JOINTS:
        return plain
    return MARKER_NAMES.get("".join(letter for letter in plain if letter.isalnum()))


def mirrored(name: str) -> str:
    """The same joint of the other side; a joint without sides is its own mirror.

    Examples
    --------
    >>> mirrored("left_knee"), mirrored("pelvis")
    ('right_knee', 'pelvis')
    """
    for side, other in (("left_", "right_"), ("right_", "left_")):
        if name.startswith(side):
            return other + name[len(side) :]
    return name


def root_joints(names: Iterable[str]) -> tuple[int, ...]:
    """Where the root is among `names`: the pelvis, else both hips, else nothing."""
    listed = list(names)
    if "pelvis" in listed:
        return (listed.index("pelvis"),)
    hips = [name for name in ("left_hip", "right_hip") if name in listed]
    return tuple(listed.index(name) for name in hips) if len(hips) == 2 else ()
