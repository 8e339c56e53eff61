"""Calibrations in OpenCV's YAML (cv2.FileStorage): one file a camera, or several cameras told apart by name.

- One file a camera, named after the file: a matrix, distortion, rotation, translation and a size.
- Several cameras: a list `names`, and each key followed by `_NAME`. EasyMocap spreads these over two files
  (`intri.yml`, `extri.yml`), which are read together.

Each key has the spellings in use (`SPELLINGS`). Rotations may be matrices or Rodrigues vectors.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from muybridge.cameras._reading import five_coefficients, names_of, numbers, picture_size, read_text, require, to_metres
from muybridge.cameras.model import Camera
from muybridge.cameras.rotations import nearest_rotation, rotation_from_vector
from muybridge.errors import InputError

SPELLINGS = {
    "matrix": ("camera_matrix", "K", "intrinsic", "intrinsics", "M"),
    "distortion": ("distortion_coefficients", "dist", "distCoeffs", "dist_coeffs", "distortion", "D"),
    "rotation": ("Rot", "R", "rotation", "rvec"),  # Rot first: where both are there (EasyMocap), R is its vector
    "translation": ("T", "t", "tvec", "translation"),
    "width": ("image_width", "width", "W"),
    "height": ("image_height", "height", "H"),
    "size": ("image_size", "imageSize", "size"),
}


def read_opencv_yaml(
    paths: Sequence[Path], unit: str | None = None, size: tuple[int, int] | None = None
) -> list[Camera]:
    """Cameras of OpenCV YAML files, in metres.

    Parameters
    ----------
    paths : files
    unit : "m", "cm" or "mm"; None judges by the size of the rig and refuses what could be either
    size : width and height in pixels, for files that name none
    """
    documents = [_document(path) for path in paths]
    what = f"calibration {paths[0]}"
    cameras: list[Camera] = []
    if any("names" in document for document in documents):
        merged = {key: value for document in documents for key, value in document.items()}
        names = merged["names"] if isinstance(merged["names"], list) else [merged["names"]]
        cameras = [_camera(what, str(name), merged, f"_{name}", size) for name in names]
    else:
        for path, name, document in zip(paths, names_of(paths), documents, strict=True):
            cameras.append(_camera(f"calibration {path}", name, document, "", size))
    if not cameras:
        raise InputError(what, expected="at least one camera", got="an empty list of names")
    return to_metres(what, cameras, unit)


def _camera(what: str, name: str, document: dict[str, Any], suffix: str, size: tuple[int, int] | None) -> Camera:
    def find(field: str, *counts: int) -> np.ndarray:
        keys = [spelling + suffix for spelling in SPELLINGS[field]]
        return numbers(f"{what}: {field} of {name}", require(f"{what}, camera {name}", document, *keys), *counts)

    rotation = find("rotation", 3, 9)
    return Camera(
        name=name,
        size=size or _size(what, name, document, suffix),
        matrix=find("matrix", 9).reshape(3, 3),
        distortion=five_coefficients(f"{what}: distortion of {name}", find("distortion")),
        rotation=(
            rotation_from_vector(rotation)
            if rotation.size == 3
            else nearest_rotation(f"{what}: rotation of {name}", rotation.reshape(3, 3))
        ),
        translation=find("translation", 3),
    )


def _size(what: str, name: str, document: dict[str, Any], suffix: str) -> tuple[int, int]:
    """Width and height, per camera or for all, as two keys or as one."""
    for ending in (suffix, ""):
        both = [_first(document, field, ending) for field in ("width", "height")]
        pair = both if None not in both else _first(document, "size", ending)
        if pair is not None:
            return picture_size(f"{what}, camera {name}", pair)
    raise InputError(
        f"{what}, camera {name}",
        expected="keys 'image_width' and 'image_height'",
        got="neither",
        remedy="add them, or give size = (width, height)",
    )


def _first(document: dict[str, Any], field: str, suffix: str) -> Any:
    return next((document[key + suffix] for key in SPELLINGS[field] if key + suffix in document), None)


def _document(path: Path) -> dict[str, Any]:
    """The file's top level: matrices as arrays, sequences as lists, numbers and words; deeper maps are left out."""
    import cv2

    what = f"calibration {path}"
    text = read_text(path)
    if not text.lstrip().startswith("%YAML"):
        text = "%YAML:1.0\n---\n" + text
    mode = cv2.FILE_STORAGE_READ | cv2.FILE_STORAGE_MEMORY | cv2.FILE_STORAGE_FORMAT_YAML
    try:
        storage = cv2.FileStorage(text, mode)
        root = storage.root()
        document = {key: _value(root.getNode(key)) for key in root.keys()}
    except (cv2.error, SystemError) as error:
        reason = str(getattr(error, "err", "")) or "a syntax error"
        raise InputError(what, expected="YAML as OpenCV writes it", got=reason) from None
    if not document:
        raise InputError(what, expected="YAML as OpenCV writes it", got="no keys")
    return document


def _value(node: Any) -> Any:
    if node.isInt() or node.isReal():
        return node.real()
    if node.isString():
        return node.string()
    if node.isSeq():
        return [_value(node.at(index)) for index in range(node.size())]
    return node.mat() if node.isMap() and "data" in node.keys() else None
