"""Motion in BVH files (Biovision hierarchy).

A file is a tree of joints, each with an OFFSET from its parent and CHANNELS in any order, then one line of numbers a
frame. Angles are in degrees and turn in the order in which they stand, the first one outermost. The format states
neither unit nor axes:

- the unit is given (`scale`), or guessed from the size of the rest posture (`skeleton.guess_metres`);
- the vertical axis is given (`axes`), or guessed from heads being above feet in most frames (`trc.guess_axes`).

The root's position channels stand for its OFFSET. Position channels of other joints are read and left unused: bones
keep their lengths. CMU recordings that were turned into BVH begin with one frame of a T-pose that nobody took.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from muybridge.errors import InputError
from muybridge.io.skeleton import Recording, Skeleton, guess_metres, numbers, read_lines, to_world, turns
from muybridge.io.trc import guess_axes

CHANNELS = tuple(f"{axis}{kind}" for kind in ("position", "rotation") for axis in "XYZ")

#: Stands for an end site among indices of joints.
END = -1


@dataclass
class _Joint:
    """A joint as it is read; `channels` are indices into CHANNELS."""

    name: str
    parent: int
    offset: list[float] = field(default_factory=lambda: [0.0] * 3)
    tip: list[float] = field(default_factory=lambda: [0.0] * 3)
    channels: list[int] = field(default_factory=list)


def read_bvh(path: str | Path, *, scale: float | None = None, axes: str | None = None) -> Recording:
    """Read a BVH file into the world: metres, z up.

    Parameters
    ----------
    path : str or Path
    scale : float, optional
        Metres a unit; guessed where it is left out.
    axes : str, optional
        World axis of the file's X, Y and Z, e.g. "yzx" for Y up, "xyz" for Z up; guessed where it is left out.

    Raises
    ------
    InputError
        With the line's number, for anything that is no BVH.
    """
    lines = read_lines(path)
    begin = next((i for i, line in enumerate(lines) if line.strip() == "MOTION"), None)
    if not lines or lines[0].strip() != "HIERARCHY" or begin is None:
        got = "an empty file" if not lines else "neither" if begin is None else f"a first line {lines[0][:30]!r}"
        raise InputError(f"BVH file {path}", expected="a line HIERARCHY, then one MOTION", got=got)
    joints = _hierarchy(lines[:begin], path)
    frames, interval = _motion(lines, begin, sum(len(joint.channels) for joint in joints), path)
    raw = _recording(joints, frames, interval)
    metres = scale if scale is not None else guess_metres(raw.skeleton, path)
    return to_world(raw, axes or guess_axes(raw.skeleton.names, raw.posed()[1]), metres)


def _hierarchy(lines: list[str], path: str | Path) -> list[_Joint]:
    """The joints in the order of their channels."""
    joints: list[_Joint] = []
    open_joints: list[int] = []  # END: an end site
    opening: int | None = None
    for index, line in enumerate(lines[1:], start=2):
        where = f"{path}, line {index}"
        for words in _statements(line):
            if words[0] in ("ROOT", "JOINT", "End"):
                opening = _opened(joints, open_joints, words, where)
            elif words[0] == "{":
                if opening is None:
                    raise InputError(where, expected="ROOT, JOINT or End Site before a brace", got="a brace")
                open_joints.append(opening)
                opening = None
            elif words[0] == "}":
                if not open_joints:
                    raise InputError(where, expected="as many braces opened as closed", got="one closed too many")
                open_joints.pop()
            else:
                _described(joints, open_joints, words, where)
    if open_joints or not joints:
        raise InputError(
            f"{path}: hierarchy", expected="a ROOT whose braces are closed", got=f"{len(open_joints)} open"
        )
    return joints


def _statements(line: str) -> list[list[str]]:
    """A line's words, braces apart."""
    parts = line.replace("{", "\n{\n").replace("}", "\n}\n").split("\n")
    return [part.split() for part in parts if part.strip()]


def _opened(joints: list[_Joint], open_joints: list[int], words: list[str], where: str) -> int:
    """Add a joint; the index that stands for it while it is open."""
    if words[0] == "End":
        return END
    if (words[0] == "ROOT") != (not joints) or (words[0] == "JOINT" and not open_joints):
        raise InputError(where, expected="one ROOT, and JOINTs inside it", got=" ".join(words))
    name = " ".join(words[1:])
    if not name or any(joint.name == name for joint in joints):
        raise InputError(where, expected="a name of its own for each joint", got=repr(name))
    joints.append(_Joint(name, open_joints[-1] if open_joints else -1))
    return len(joints) - 1


def _described(joints: list[_Joint], open_joints: list[int], words: list[str], where: str) -> None:
    """OFFSET and CHANNELS of the innermost joint."""
    if words[0] not in ("OFFSET", "CHANNELS") or not open_joints:
        raise InputError(
            where, expected="ROOT, then JOINT, End Site, OFFSET, CHANNELS or a brace", got=repr(" ".join(words)[:40])
        )
    inside_end = open_joints[-1] == END
    joint = joints[open_joints[-2] if inside_end else open_joints[-1]]
    if words[0] == "OFFSET":
        offset = numbers(words[1:], f"{where}: OFFSET of {joint.name}", 3)
        if inside_end:
            joint.tip = offset
        else:
            joint.offset = offset
            if joint.parent >= 0 and not any(joints[joint.parent].tip):
                joints[joint.parent].tip = offset
        return
    names = words[2:]
    if not words[1:] or words[1] != str(len(names)) or any(name not in CHANNELS for name in names):
        raise InputError(
            f"{where}: CHANNELS of {joint.name}",
            expected=f"their number, then names out of {', '.join(CHANNELS)}",
            got=repr(" ".join(words[1:])),
        )
    joint.channels = [CHANNELS.index(name) for name in names]


def _motion(lines: list[str], begin: int, width: int, path: str | Path) -> tuple[np.ndarray, float]:
    """(T, width) numbers, and the seconds between two frames."""
    header = [lines[begin + k].partition(":")[::2] if begin + k < len(lines) else ("", "") for k in (1, 2)]
    if [name.strip().lower() for name, _ in header] != ["frames", "frame time"]:
        raise InputError(f"{path}, line {begin + 2}", expected="Frames: and Frame Time: after MOTION", got="others")
    count, interval = (
        numbers(text.split(), f"{path}, line {begin + 2 + k}: {name.strip()}", 1)[0]
        for k, (name, text) in enumerate(header)
    )
    if not interval > 0:
        raise InputError(f"{path}, line {begin + 3}: Frame Time", expected="seconds above 0", got=f"{interval:g}")
    rows = [(index, line) for index, line in enumerate(lines[begin + 3 :], start=begin + 4) if line.strip()]
    if count < 1 or count != len(rows):
        raise InputError(
            f"{path}: frames",
            expected=f"{count:g}, as line {begin + 2} says, and at least 1",
            got=f"{len(rows)}",
            remedy="the file is cut off" if len(rows) < count else "",
        )
    return np.array([numbers(line.split(), f"{path}, line {index}", width) for index, line in rows]), interval


def _recording(joints: list[_Joint], frames: np.ndarray, interval: float) -> Recording:
    """The file's numbers as rotations, in its own axes and unit."""
    rotations = np.empty((len(frames), len(joints), 3, 3))
    root_places = np.tile(joints[0].offset, (len(frames), 1))
    column = 0
    for index, joint in enumerate(joints):
        channels = np.array(joint.channels, dtype=int)
        own = frames[:, column : column + len(channels)]
        column += len(channels)
        rotations[:, index] = turns([int(c) - 3 for c in channels if c >= 3], np.radians(own[:, channels >= 3]))
        if index == 0:
            root_places[:, channels[channels < 3]] = own[:, channels < 3]
    offsets = np.array([joint.offset for joint in joints])
    offsets[0] = 0.0
    parents = np.array([joint.parent for joint in joints], dtype=np.int64)
    tips = np.array([joint.tip for joint in joints])
    skeleton = Skeleton(tuple(joint.name for joint in joints), parents, offsets, tips)
    return Recording(skeleton, interval * np.arange(len(frames)), rotations, root_places)
