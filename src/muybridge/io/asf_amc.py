"""Motion in Acclaim files: the skeleton in ASF, its motion in AMC, as the CMU graphics lab publishes them.

A bone of an ASF has a direction, a length, and axes of its own (C) in the rest posture. AMC gives angles about those
axes, so that with the angles' rotation M the bone's turn from rest is C M C^-1. Angles turn in the order in which they
stand, the first one innermost: "XYZ" is Rz Ry Rx. Y is up.

A length is `value / length` inches, with `length` from the ASF's `:units`. AMC states no frame rate: CMU's is 120 Hz.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from muybridge.errors import InputError
from muybridge.io.skeleton import Recording, Skeleton, numbers, read_lines, to_world, turns

INCH = 0.0254
DOFS = ("tx", "ty", "tz", "rx", "ry", "rz")


@dataclass
class _Bone:
    """A bone as it is read; `dofs` are indices into DOFS, angles as the file has them."""

    name: str
    direction: list[float] = field(default_factory=lambda: [0.0] * 3)
    length: float = 0.0
    axis: list[float] = field(default_factory=lambda: [0.0] * 3)
    order: str = "XYZ"
    dofs: list[int] = field(default_factory=list)


@dataclass
class _Asf:
    """What an ASF says: bones by name, the root first; parents by name; metres a unit; radians an angle."""

    bones: dict[str, _Bone] = field(default_factory=lambda: {"root": _Bone("root", dofs=list(range(6)))})
    parents: dict[str, str] = field(default_factory=dict)
    metres: float = INCH
    radians: float = np.pi / 180.0


def read_amc(
    path: str | Path, skeleton: str | Path | None = None, *, rate: float = 120.0, scale: float | None = None
) -> Recording:
    """Read an AMC file and its ASF into the world: metres, z up.

    Parameters
    ----------
    path : str or Path, the AMC
    skeleton : str or Path, optional
        The ASF; left out, the one beside it whose name begins the AMC's (02.asf for 02_01.amc), or the only one.
    rate : float
        Frames per second.
    scale : float, optional
        Metres a unit; left out, what the ASF's `:units` say.

    Raises
    ------
    InputError
        With file and line, for anything that does not fit.
    """
    source = Path(skeleton) if skeleton is not None else beside(path)
    asf = _read_asf(source)
    frames, radians = _read_frames(path, asf, source)
    if not (np.isfinite(rate) and rate > 0):
        raise InputError("frame rate of an AMC", expected="a positive number", got=f"{rate:g}")
    raw = _recording(asf, frames, radians)
    raw = Recording(raw.skeleton, np.arange(len(frames)) / rate, raw.rotations, raw.root_places)
    return to_world(raw, "yzx", scale if scale is not None else asf.metres)


def beside(path: str | Path) -> Path:
    """The ASF that belongs to an AMC, by its name or by being alone in the folder."""
    path = Path(path)
    found = sorted(entry for entry in path.parent.glob("*") if entry.suffix.lower() == ".asf")
    named = [entry for entry in found if path.stem.startswith(entry.stem)]
    if len(named or found) != 1:
        raise InputError(
            f"skeleton of {path}",
            expected=f"one .asf beside it, such as {path.stem.partition('_')[0]}.asf",
            got=", ".join(entry.name for entry in found) or "none",
            remedy="name the .asf file",
        )
    return (named or found)[0]


# ---- the skeleton ----------------------------------------------------------------------------------------------------


def _read_asf(path: Path) -> _Asf:
    """Sections begin with a colon; each is read line by line."""
    asf, section, bone = _Asf(), "", None
    readers = {"units": _units, "root": _root, "hierarchy": _hierarchy}
    for index, line in enumerate(read_lines(path), start=1):
        words, where = line.partition("#")[0].split(), f"{path}, line {index}"
        if not words:
            continue
        if words[0].startswith(":"):
            section = words[0][1:].lower()
        elif section == "bonedata":
            bone = _bone(asf, bone, words, where)
        elif section in readers:
            readers[section](asf, words, where)
    if not asf.parents:
        raise InputError(f"ASF file {path}", expected="sections :root, :bonedata, :hierarchy", got="no hierarchy")
    lost = [name for name in asf.bones if name != "root" and name not in asf.parents]
    if lost:
        raise InputError(f"ASF file {path}", expected="every bone in :hierarchy", got=f"none for {', '.join(lost)}")
    return asf


def _units(asf: _Asf, words: list[str], where: str) -> None:
    if words[0] == "length":
        (length,) = numbers(words[1:], f"{where}: length", 1)
        if not length > 0:
            raise InputError(f"{where}: length", expected="a number above 0", got=f"{length:g}")
        asf.metres = INCH / length
    elif words[0] == "angle":
        asf.radians = _radians(words[-1], where)


def _radians(word: str, where: str) -> float:
    """Radians in a file's unit of angle."""
    for names, radians in ((("deg", "degree", "degrees"), np.pi / 180.0), (("rad", "radian", "radians"), 1.0)):
        if word.lower() in names:
            return radians
    raise InputError(f"{where}: angle", expected="deg or rad", got=repr(word))


def _root(asf: _Asf, words: list[str], where: str) -> None:
    root = asf.bones["root"]
    if words[0] == "order":
        root.dofs = _dofs(words[1:], where, DOFS)
    elif words[0] == "axis":
        root.order = _order(words[-1], where)
    elif words[0] == "orientation":
        root.axis = numbers(words[1:], f"{where}: orientation", 3)


def _bone(asf: _Asf, bone: _Bone | None, words: list[str], where: str) -> _Bone | None:
    """One line of :bonedata; the bone that it leaves open."""
    key = words[0].lower()
    if key == "begin":
        return _Bone("")
    if bone is None:
        raise InputError(where, expected="begin", got=repr(words[0]))
    if key == "end":
        if not bone.name or bone.name in asf.bones:
            raise InputError(where, expected="a name of its own for each bone", got=repr(bone.name))
        asf.bones[bone.name] = bone
        return None
    if key == "name":
        bone.name = " ".join(words[1:])
    elif key == "direction":
        bone.direction = numbers(words[1:], f"{where}: direction of {bone.name}", 3)
    elif key == "length":
        (bone.length,) = numbers(words[1:], f"{where}: length of {bone.name}", 1)
    elif key == "axis":
        bone.axis, bone.order = numbers(words[1:-1], f"{where}: axis of {bone.name}", 3), _order(words[-1], where)
    elif key == "dof":
        bone.dofs = _dofs(words[1:], where, DOFS[3:])
    return bone


def _order(word: str, where: str) -> str:
    if sorted(word.upper()) != ["X", "Y", "Z"]:
        raise InputError(f"{where}: order of axes", expected="X, Y and Z in some order", got=repr(word))
    return word.upper()


def _dofs(words: list[str], where: str, known: tuple[str, ...]) -> list[int]:
    """Degrees of freedom; only the root may move, other bones keep their lengths."""
    unknown = [word for word in words if word.lower() not in known]
    if unknown:
        raise InputError(f"{where}: degrees of freedom", expected=", ".join(known), got=" ".join(unknown))
    return [DOFS.index(word.lower()) for word in words]


def _hierarchy(asf: _Asf, words: list[str], where: str) -> None:
    if words[0] in ("begin", "end"):
        return
    unknown = [name for name in words if name not in asf.bones]
    if unknown:
        raise InputError(f"{where}: hierarchy", expected="bones of :bonedata", got=", ".join(unknown))
    if words[0] != "root" and words[0] not in asf.parents:
        raise InputError(f"{where}: hierarchy", expected="parents before children", got=repr(words[0]))
    for name in words[1:]:
        if name == "root" or name in asf.parents:
            raise InputError(f"{where}: hierarchy", expected="one parent a bone, none for the root", got=repr(name))
        asf.parents[name] = words[0]


# ---- the motion ------------------------------------------------------------------------------------------------------


def _read_frames(path: str | Path, asf: _Asf, source: Path) -> tuple[list[dict[str, list[float]]], float]:
    """A frame is bone -> numbers; and the radians in the angles' unit."""
    frames: list[dict[str, list[float]]] = []
    radians, first = asf.radians, 0
    for index, line in enumerate(read_lines(path), start=1):
        words, where = line.partition("#")[0].split(), f"{path}, line {index}"
        if not words:
            continue
        if words[0].startswith(":"):
            if words[0].lower() in (":degrees", ":radians"):
                radians = _radians(words[0][1:], where)
        elif len(words) == 1 and words[0].isdigit():
            _check_complete(frames, asf, where, first)
            first = first if frames else int(words[0])
            _check_number(int(words[0]), first + len(frames), where)
            frames.append({})
        else:
            _add_bone(frames, asf, words, where, source)
    if not frames:
        raise InputError(f"AMC file {path}", expected="frames", got="none")
    _check_complete(frames, asf, f"{path}, end of the file", first)
    return frames, radians


def _add_bone(frames: list[dict[str, list[float]]], asf: _Asf, words: list[str], where: str, source: Path) -> None:
    name = words[0]
    if not frames:
        raise InputError(where, expected="a frame's number", got=repr(" ".join(words)[:30]))
    if name not in asf.bones:
        raise InputError(
            f"{where}: bone",
            expected=f"a bone of {source.name}",
            got=repr(name),
            remedy="use the .asf that the motion was recorded with",
        )
    if name in frames[-1]:
        raise InputError(where, expected="each bone once a frame", got=f"{name} again")
    frames[-1][name] = numbers(words[1:], f"{where}: {name}", len(asf.bones[name].dofs))


def _check_number(number: int, due: int, where: str) -> None:
    if number != due:
        raise InputError(
            where, expected=f"frame {due}", got=f"frame {number}", remedy="frames are missing: fill the gap first"
        )


def _check_complete(frames: list[dict[str, list[float]]], asf: _Asf, where: str, first: int) -> None:
    """Every bone that can move has its numbers in the frame that ends here."""
    if not frames:
        return
    missing = [name for name, bone in asf.bones.items() if bone.dofs and name not in frames[-1]]
    if missing:
        raise InputError(
            where,
            expected=f"numbers for every bone of frame {first + len(frames) - 1}",
            got=f"none for {', '.join(missing[:4])}" + f" and {len(missing) - 4} more" * (len(missing) > 4),
            remedy="the file may be cut off",
        )


def _recording(asf: _Asf, frames: list[dict[str, list[float]]], radians: float) -> Recording:
    """The files' numbers as rotations, in their own axes and unit; times are left at 0."""
    names = ("root", *asf.parents)
    rotations = np.tile(np.eye(3), (len(frames), len(names), 1, 1))
    root_places = np.zeros((len(frames), 3))
    for index, name in enumerate(names):
        bone = asf.bones[name]
        if not bone.dofs:
            continue
        values, dofs = np.array([frame[name] for frame in frames]), np.array(bone.dofs)
        own = turns(["XYZ".index(axis) for axis in bone.order[::-1]], asf.radians * np.array(bone.axis[::-1]))
        angles = dofs >= 3
        moved = turns([int(dof) - 3 for dof in dofs[angles][::-1]], radians * values[:, angles][:, ::-1])
        rotations[:, index] = own @ moved @ own.T
        if index == 0:
            root_places[:, dofs[~angles]] = values[:, ~angles]
    parents = np.array([-1, *(names.index(asf.parents[name]) for name in names[1:])], dtype=np.int64)
    tips = np.array([asf.bones[name].length * np.array(asf.bones[name].direction) for name in names])
    offsets = tips[parents]
    offsets[0] = 0.0
    return Recording(Skeleton(names, parents, offsets, tips), np.zeros(len(frames)), rotations, root_places)
