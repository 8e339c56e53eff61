"""A calibrated camera, and a set of them: pinhole with five distortion coefficients, checked when made.

World: metres, right-handed, z up. Camera: x right, y down, z forward, X_cam = R X_world + t. Pixel centres lie at
integers, so the picture covers [-0.5, width - 0.5] x [-0.5, height - 0.5].
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from muybridge.cameras.distortion import distort, fold_radius_squared, undistort
from muybridge.errors import InputError

ORTHONORMAL_TOLERANCE = 1e-6  # of R R^T - 1; files with fewer digits are made orthonormal by their reader


@dataclass(frozen=True, eq=False)
class Camera:
    """One calibrated camera; immutable, and valid by construction.

    Parameters
    ----------
    name : str
    size : (width, height), pixels
    matrix : (3, 3) float64, pixels: focal lengths, skew and principal point
    distortion : (5,) float64: k1 k2 p1 p2 k3; four (k3 = 0) are accepted
    rotation : (3, 3) float64: world to camera
    translation : (3,) float64, metres: the world's origin in camera coordinates
    """

    name: str
    size: tuple[int, int]
    matrix: np.ndarray
    distortion: np.ndarray
    rotation: np.ndarray
    translation: np.ndarray

    def __post_init__(self) -> None:
        what = f"camera {self.name!r}"
        if not isinstance(self.name, str) or not self.name:
            raise InputError("camera name", expected="a word", got=repr(self.name))
        object.__setattr__(self, "size", checked_size(what, self.size))
        coefficients = np.atleast_1d(np.asarray(self.distortion))
        if coefficients.shape == (4,):
            coefficients = np.append(coefficients, 0.0)
        for field, value, shape in (
            ("matrix", self.matrix, (3, 3)),
            ("distortion", coefficients, (5,)),
            ("rotation", self.rotation, (3, 3)),
            ("translation", self.translation, (3,)),
        ):
            object.__setattr__(self, field, _checked_array(f"{what}: {field}", value, shape))
        _check_matrix(what, self.matrix)
        _check_rotation(what, self.rotation)

    @property
    def position(self) -> np.ndarray:
        """(3,) float64, metres, world: the centre of projection, -R^T t."""
        return -self.rotation.T @ self.translation

    # ---- world to picture -------------------------------------------------------------------------------------

    def world_to_camera(self, points: np.ndarray) -> np.ndarray:
        """(..., 3) metres, world -> (..., 3) metres, camera."""
        return np.asarray(points, dtype=np.float64) @ self.rotation.T + self.translation

    def camera_to_pixel(self, points: np.ndarray) -> np.ndarray:
        """(..., 3) metres, camera -> (..., 2) pixels; NaN where no light of the point can reach the picture.

        That is behind the camera (z <= 0), or so far off the axis that the distortion polynomial has turned back
        (`distortion.fold_radius_squared`). Points outside the picture's border do have pixels.
        """
        points = np.asarray(points, dtype=np.float64)
        depth = points[..., 2:]
        with np.errstate(all="ignore"):
            flat = points[..., :2] / np.where(depth > 0, depth, np.nan)
            if np.any(self.distortion):
                folded = np.sum(flat * flat, axis=-1, keepdims=True) >= fold_radius_squared(self.distortion)
                flat = distort(np.where(folded, np.nan, flat), self.distortion)
            return flat @ self.matrix[:2, :2].T + self.matrix[:2, 2]

    def world_to_pixel(self, points: np.ndarray) -> np.ndarray:
        """(..., 3) metres, world -> (..., 2) pixels; NaN as in `camera_to_pixel`."""
        return self.camera_to_pixel(self.world_to_camera(points))

    # ---- picture to world -------------------------------------------------------------------------------------

    def camera_to_world(self, points: np.ndarray) -> np.ndarray:
        """(..., 3) metres, camera -> (..., 3) metres, world."""
        return (np.asarray(points, dtype=np.float64) - self.translation) @ self.rotation

    def pixel_to_camera(self, pixels: np.ndarray, depth: np.ndarray | float = 1.0) -> np.ndarray:
        """Points seen at pixels, at a depth along the optical axis.

        Parameters
        ----------
        pixels : (..., 2) float64, pixels
        depth : (...) float64 or number, metres: camera z, not distance

        Returns
        -------
        (..., 3) float64, metres, camera; NaN where the lens maps no direction to the pixel
        """
        pixels = np.asarray(pixels, dtype=np.float64)
        flat = (pixels - self.matrix[:2, 2]) @ np.linalg.inv(self.matrix[:2, :2]).T
        flat = undistort(flat, self.distortion)
        depth = np.broadcast_to(np.asarray(depth, dtype=np.float64), flat.shape[:-1])[..., None]
        return np.concatenate([flat * depth, depth], axis=-1)

    def pixel_to_ray(self, pixels: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(..., 2) pixels -> origins (..., 3) metres and unit directions (..., 3), both world."""
        directions = self.pixel_to_camera(pixels) @ self.rotation
        directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
        return np.broadcast_to(self.position, directions.shape).copy(), directions

    # ---- the same camera, another picture ---------------------------------------------------------------------

    def scaled(self, factor: float) -> Camera:
        """The camera of the picture reduced or enlarged: u' = (u + 0.5) factor - 0.5, size rounded."""
        if not (np.isfinite(factor) and factor > 0):
            raise InputError(f"camera {self.name!r}: scale", expected="a positive number", got=str(factor))
        width, height = (max(1, round(side * factor)) for side in self.size)
        shift = 0.5 * factor - 0.5
        return self.mapped(factor, (shift, shift), size=(width, height))

    def shifted(self, dx: float, dy: float) -> Camera:
        """The camera whose picture lies (dx, dy) pixels further right and down: the principal point moves."""
        return self.mapped(1.0, (dx, dy))

    def mapped(self, scale: float, offset: tuple[float, float], size: tuple[int, int] | None = None) -> Camera:
        """The camera of a picture made from this one by u' = scale u + offset_x, v' = scale v + offset_y.

        For recordings stored scaled, cropped or with black bars: the map is absorbed into the matrix, and the
        distortion, which acts before it, stays as it is. The size stays unless one is given.
        """
        change = np.array([[scale, 0.0, offset[0]], [0.0, scale, offset[1]], [0.0, 0.0, 1.0]])
        return replace(self, matrix=change @ self.matrix, size=self.size if size is None else size)

    def with_size(self, width: int, height: int) -> Camera:
        """The camera with its picture cropped or padded at the right and bottom; nothing is scaled."""
        return replace(self, size=(width, height))

    def in_world(self, rotation: np.ndarray, translation: np.ndarray | None = None) -> Camera:
        """The same camera described in another world, X_new = Q X + s with Q (3, 3) a rotation and s (3,) metres."""
        new_rotation = self.rotation @ np.asarray(rotation, dtype=np.float64).T
        shift = np.zeros(3) if translation is None else np.asarray(translation, dtype=np.float64)
        return replace(self, rotation=new_rotation, translation=self.translation - new_rotation @ shift)

    def renamed(self, name: str) -> Camera:
        """The same camera under another name."""
        return replace(self, name=name)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Camera) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def _key(self) -> tuple:
        arrays = (self.matrix, self.distortion, self.rotation, self.translation)
        return (self.name, self.size, *(tuple(array.ravel()) for array in arrays))


@dataclass(frozen=True)
class Rig:
    """Cameras that share one world frame; names are unique."""

    cameras: tuple[Camera, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "cameras", tuple(self.cameras))
        if not self.cameras:
            raise InputError("rig", expected="at least one camera", got="none")
        repeated = sorted({name for name in self.names if self.names.count(name) > 1})
        if repeated:
            raise InputError("rig", expected="a different name for every camera", got=f"{repeated[0]!r} twice")

    @property
    def names(self) -> tuple[str, ...]:
        """The C names, in the order of the cameras."""
        return tuple(camera.name for camera in self.cameras)

    def __len__(self) -> int:
        return len(self.cameras)

    def __iter__(self) -> Iterator[Camera]:
        return iter(self.cameras)

    def __getitem__(self, key: str | int) -> Camera:
        if not isinstance(key, str):
            return self.cameras[key]
        if key not in self.names:
            raise InputError("camera", expected=f"one of {', '.join(self.names)}", got=repr(key))
        return self.cameras[self.names.index(key)]

    def subset(self, names: Iterable[str | int]) -> Rig:
        """The named cameras, in the order asked for."""
        return Rig(tuple(self[name] for name in names))


def checked_size(what: str, size: Any) -> tuple[int, int]:
    """Width and height as whole numbers of pixels."""
    expected = "width and height, two whole numbers > 0"
    try:
        width, height = size
        whole = int(width) == width and int(height) == height
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{what}: size", expected=expected, got=repr(size)) from None
    if not whole or width < 1 or height < 1:
        raise InputError(f"{what}: size", expected=expected, got=f"{width} x {height}")
    return int(width), int(height)


def _checked_array(what: str, value: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """An own, read-only float64 copy of the right shape, all finite."""
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(what, expected=f"numbers in shape {shape}", got=type(value).__name__) from None
    if array.shape != shape:
        raise InputError(what, expected=f"shape {shape}", got=f"shape {array.shape}")
    if not np.isfinite(array).all():
        raise InputError(what, expected="finite numbers", got="nan or infinity")
    array.setflags(write=False)
    return array


def _check_matrix(what: str, matrix: np.ndarray) -> None:
    focal = matrix[0, 0], matrix[1, 1]
    if min(focal) <= 0:
        raise InputError(f"{what}: matrix", expected="positive focal lengths", got=f"{focal[0]:g} and {focal[1]:g}")
    if matrix[1, 0] != 0 or tuple(matrix[2]) != (0, 0, 1):
        raise InputError(
            f"{what}: matrix", expected="rows fx s cx / 0 fy cy / 0 0 1", got=" / ".join(f"{row}" for row in matrix)
        )


def _check_rotation(what: str, rotation: np.ndarray) -> None:
    off = float(np.abs(rotation @ rotation.T - np.eye(3)).max())
    if off > ORTHONORMAL_TOLERANCE:
        raise InputError(f"{what}: rotation", expected="an orthonormal matrix", got=f"R R^T off by {off:.2g}")
    if np.linalg.det(rotation) < 0:
        raise InputError(
            f"{what}: rotation",
            expected="a right-handed rotation (determinant 1)",
            got="a reflection (determinant -1)",
            remedy="one axis of the world or the picture is flipped in the calibration",
        )
