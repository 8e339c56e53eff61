"""What the readers of calibration files share: text in, checked numbers out, lengths to metres."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from muybridge.cameras.model import Camera, checked_size
from muybridge.errors import InputError

LARGEST_FILE = 20_000_000  # bytes; a rig of a hundred cameras takes some 100 kB
METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001}
LARGEST_IN_METRES = 60.0  # a hall; cameras further apart than that are not in metres
SMALLEST_IN_MILLIMETRES = 300.0  # a desk; cameras nearer together than that are not in millimetres


def read_text(path: Path) -> str:
    """The file's text, or one clear line why not."""
    what = f"calibration {path}"
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise InputError(what, expected="a calibration file", got=f"{path.stat().st_size} bytes")
        return path.read_bytes().decode("utf-8-sig")
    except FileNotFoundError:
        raise InputError(what, expected="a file", got="nothing at this path") from None
    except UnicodeDecodeError:
        raise InputError(what, expected="text in UTF-8", got="bytes that are not") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(what, expected="a readable file", got=reason) from None


def numbers(what: str, value: Any, *counts: int) -> np.ndarray:
    """Flat float64 array of a value as parsed from a file; its length must be one of `counts`, where given."""
    try:
        array = np.asarray(value, dtype=np.float64).ravel()
    except (TypeError, ValueError, OverflowError):
        raise InputError(what, expected="numbers", got=_short(value)) from None
    if counts and array.size not in counts:
        wanted = " or ".join(str(count) for count in counts)
        raise InputError(what, expected=f"{wanted} numbers", got=str(array.size))
    return array


def picture_size(what: str, value: Any) -> tuple[int, int]:
    """Width and height from two numbers, which some writers spell as reals (1088.0)."""
    return checked_size(what, tuple(numbers(what, value, 2)))


def require(what: str, table: dict[str, Any], *keys: str) -> Any:
    """The value of the first key present."""
    for key in keys:
        if key in table:
            return table[key]
    raise InputError(what, expected=f"a key {' or '.join(repr(key) for key in keys)}", got=_short(sorted(table)))


def five_coefficients(what: str, value: Any) -> np.ndarray:
    """k1 k2 p1 p2 k3 from a list that may end early or carry zeros of a longer model."""
    coefficients = numbers(what, value)
    if np.any(coefficients[5:]):
        raise InputError(
            what,
            expected="at most 5 distortion coefficients",
            got=str(coefficients.size),
            remedy="calibrate without the rational, prism and tilted models",
        )
    return np.append(coefficients[:5], np.zeros(max(0, 5 - coefficients.size)))


def to_metres(what: str, cameras: Sequence[Camera], unit: str | None) -> list[Camera]:
    """Cameras whose translations are in `unit`, in metres; without one, judged by how large the rig is.

    Files that name no unit are in metres (Pose2Sim, caliscope) or in the unit of the board's squares, mostly
    millimetres (Anipose, MATLAB). A rig that could be either is refused rather than guessed.
    """
    positions = np.array([camera.position for camera in cameras])
    extent = max(float(np.abs(positions).max()), float(np.abs(positions - positions[0]).max()))
    if unit is None:
        if LARGEST_IN_METRES < extent < SMALLEST_IN_MILLIMETRES:
            raise InputError(
                f"{what}: unit of length",
                expected="metres or millimetres",
                got=f"cameras {extent:.0f} from the origin",
                remedy="say which with unit = 'm', 'cm' or 'mm'",
            )
        unit = "m" if extent <= LARGEST_IN_METRES else "mm"
    if unit not in METRES:
        raise InputError("unit of length", expected="'m', 'cm' or 'mm'", got=repr(unit))
    return [replace(camera, translation=camera.translation * METRES[unit]) for camera in cameras]


def names_of(paths: Sequence[Path]) -> list[str]:
    """A name per file: its stem; its folder's name where all stems are the same (cam1/calib.yml, cam2/calib.yml)."""
    stems = [path.name.split(".")[0] for path in paths]
    return [path.resolve().parent.name for path in paths] if len(stems) > 1 and len(set(stems)) == 1 else stems


def _short(value: Any) -> str:
    text = ", ".join(map(str, value)) if isinstance(value, list) else repr(value)
    text = " ".join(text.split())
    return text if len(text) <= 80 else text[:77] + "..."
