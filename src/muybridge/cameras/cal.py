"""Calibrations as in HumanEva and bodytrack: one `.cal` file a camera, 22 or 25 numbers, millimetres.

In order: fx fy, cx cy, skew, k1 k2 p1 p2 k3, R by rows, T, and in bodytrack a Rodrigues vector. X_cam = R X + T. The
vector says again what R says and is used to notice a file in another order. The skew is that of the MATLAB calibration
toolbox, which wrote these files: K[0, 1] = skew fx.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from muybridge.cameras._reading import names_of, numbers, read_text, to_metres
from muybridge.cameras.model import Camera
from muybridge.cameras.rotations import nearest_rotation, rotation_from_vector
from muybridge.errors import InputError

USUAL_SIZE = (640, 480)  # of both collections; the file itself names none
AGREEMENT = 1e-3  # between R and the Rodrigues vector
COUNTS = (22, 25)  # of numbers in a file: HumanEva, bodytrack


def read_cal(paths: Sequence[Path], unit: str | None = None, size: tuple[int, int] | None = None) -> list[Camera]:
    """A camera per file, named after it, in metres; `size` is the picture's, which the format leaves out."""
    cameras = [_camera(path, name, size) for path, name in zip(paths, names_of(paths), strict=True)]
    return to_metres(f"calibration {paths[0]}", cameras, unit or "mm")


def _camera(path: Path, name: str, size: tuple[int, int] | None) -> Camera:
    what = f"calibration {path}"
    values = numbers(what, read_text(path).split(), *COUNTS)
    (fx, fy, cx, cy, skew), distortion = values[:5], values[5:10]
    rotation = nearest_rotation(f"{what}: R", values[10:19].reshape(3, 3))
    off = float(np.abs(rotation - rotation_from_vector(values[22:])).max()) if len(values) > 22 else 0.0
    if not off <= AGREEMENT:
        raise InputError(
            what,
            expected="a Rodrigues vector (numbers 23-25) that says what R (numbers 11-19) says",
            got=f"{off:.2g} off",
        )
    width, height = size or USUAL_SIZE
    if size is None and not (0 < cx < width and 0 < cy < height):
        raise InputError(
            what,
            expected=f"a principal point inside {width} x {height}",
            got=f"({cx:.0f}, {cy:.0f})",
            remedy="say how large the pictures are with size = (width, height)",
        )
    matrix = np.array([[fx, skew * fx, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    return Camera(name, (width, height), matrix, distortion, rotation, values[19:22])
