"""Between a body's poses and what is regressed: no place, and a heading that is relative to the camera.

A silhouette does not tell where the person stands (its place in the picture does, together with the calibration), and
it tells the turn about the vertical only relative to the direction in which it is seen. So of a body's D components the
first three, the root's place, are not regressed, and the heading is

    facing = azimuth of the person's front - azimuth from the person to the camera (`bearing`),

0 where the person faces the camera, pi/2 where they face the picture's right. Azimuths are counter-clockwise from +x,
seen from above.

Differences from the paper
    The paper turns by the angle between training and test camera. A person beside the optical axis is seen from another
    side than its direction says (by up to 29 degrees at the border of a picture of ordinary width), so the bearing is
    best taken along the ray through the silhouette's middle; `bearing(camera)` without a pixel is the axis.
    Where a body does not turn about the vertical first, its root's turns are brought to that order (yaw, roll, pitch)
    and back.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial.transform import Rotation as Turn

from muybridge.body import Body
from muybridge.cameras import Camera
from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.regression.components import PoseComponents

LEVEL = 0.05  # smallest horizontal part of a unit ray that has a bearing: the camera is not straight above
PLACE = 3  # numbers of a pose that are the root's place
_CANONICAL = "ZYX"  # intrinsic: about the vertical, then the others


def bearing(camera: Camera, pixel: FloatArray | None = None) -> float:
    """Azimuth, radians in the world, from what is seen to the camera.

    Parameters
    ----------
    camera : Camera
    pixel : (2,) float64, optional
        Where the person is seen, in pixels of this camera's picture; the optical axis where absent.

    Raises
    ------
    InputError
        The camera looks straight down or up there, or its lens maps no direction to the pixel.
    """
    direction = camera.rotation[2] if pixel is None else camera.pixel_to_ray(np.asarray(pixel, dtype=np.float64))[1]
    if not np.hypot(direction[0], direction[1]) > LEVEL:
        got = "one straight up or down" if np.isfinite(direction).all() else "none at this pixel"
        raise InputError(f"view of camera {camera.name!r}", expected="a direction across the floor", got=got)
    return float(np.arctan2(-direction[1], -direction[0]))


@dataclass(frozen=True)
class PoseOutputs:
    """How a body's poses (N, D) become outputs (N, D - 3) of a regressor, and back.

    Raises
    ------
    InputError
        A body whose root does not turn about the vertical, or about other axes than x, y and z once each.
    """

    body: Body

    def __post_init__(self) -> None:
        axes = self._root_axes
        if "z" not in axes or (axes[0] != "z" and sorted(axis[-1] for axis in axes) != ["x", "y", "z"]):
            expected = "turns of the root about z, and about x and y too where z is not the first"
            raise InputError(f"body {self.body.name!r}", expected=expected, got=", ".join(axes) or "none")

    @cached_property
    def components(self) -> PoseComponents:
        """Names are the body's; the root's turns and joints without limits, or with limits a turn apart, wrap."""
        span = (self.body.upper - self.body.lower)[PLACE:]
        circular = np.flatnonzero(~(span < 2 * np.pi))
        return PoseComponents(self.body.dof_names[PLACE:], tuple(circular.tolist()), self._heading)

    def from_poses(self, poses: FloatArray, bearings: FloatArray | float = 0.0) -> FloatArray:
        """(N, D - 3): poses (N, D) as they look from bearings (N,) or one for all, radians."""
        poses = np.atleast_2d(np.asarray(poses, dtype=np.float64))
        if poses.shape[1] != len(self.body.dof_names):
            expected = f"{len(self.body.dof_names)} numbers"
            raise InputError(f"pose of body {self.body.name!r}", expected=expected, got=str(poses.shape[1]))
        outputs = poses[:, PLACE:].copy()
        if not self._upright_first:
            outputs[:, : len(self._root_axes)] = self._canonical(outputs[:, : len(self._root_axes)])
        outputs[:, self._heading] += self._front - np.asarray(bearings, dtype=np.float64)
        return self.components.wrapped(outputs)

    def to_poses(
        self, outputs: FloatArray, places: FloatArray, bearings: FloatArray | float = 0.0, near: float | None = None
    ) -> FloatArray:
        """(N, D) poses within the body's limits.

        Parameters
        ----------
        outputs : (N, D - 3) float64, radians
        places : (N, 3) or (3,) float64, metres: the root's
        bearings : (N,) float64 or one for all, radians
            0 where the mixture that they are drawn from was `turned` already.
        near : float, radians, optional
            A value of root_yaw, such as the last frame's: of equal headings the one that is nearest to it.
        """
        outputs = self.components.checked("outputs", np.atleast_2d(outputs)).copy()
        outputs[:, self._heading] += np.asarray(bearings, dtype=np.float64) - self._front
        if not self._upright_first:
            outputs[:, : len(self._root_axes)] = self._own(outputs[:, : len(self._root_axes)])
        outputs = self.components.wrapped(outputs)
        if near is not None:
            yaw = outputs[:, self._heading]
            outputs[:, self._heading] = near + np.mod(yaw - near + np.pi, 2 * np.pi) - np.pi
        places = np.broadcast_to(np.asarray(places, dtype=np.float64), (len(outputs), PLACE))
        return np.clip(np.concatenate([places, outputs], axis=1), self.body.lower, self.body.upper)

    @cached_property
    def _root_axes(self) -> tuple[str, ...]:
        return tuple(rotation.axis for rotation in self.body.segments[0].rotations)

    @property
    def _upright_first(self) -> bool:
        return self._root_axes[0] == "z"

    @cached_property
    def _heading(self) -> int:
        return self._root_axes.index("z")

    @cached_property
    def _front(self) -> float:
        """Azimuth of the person's front at a yaw of 0: a quarter turn left of their right, if they have hips."""
        if not {"left_hip", "right_hip"} <= set(self.body.joint_names):
            return 0.5 * np.pi
        joints = self.body.joints(np.zeros(len(self.body.dof_names)))
        across = joints[self.body.joint_names.index("right_hip")] - joints[self.body.joint_names.index("left_hip")]
        return float(np.arctan2(across[1], across[0]) + 0.5 * np.pi)

    @cached_property
    def _signs(self) -> FloatArray:
        return np.array([-1.0 if axis.startswith("-") else 1.0 for axis in self._root_axes])

    @property
    def _order(self) -> str:
        """The root's own order of turns, as scipy writes intrinsic ones."""
        return "".join(axis[-1].upper() for axis in self._root_axes)

    def _canonical(self, angles: FloatArray) -> FloatArray:
        """(N, 3) root angles in the order yaw, roll, pitch, each in the place of its axis."""
        turns = Turn.from_euler(self._order, angles * self._signs).as_euler(_CANONICAL)
        return np.stack([turns[:, _CANONICAL.index(axis)] for axis in self._order], axis=1)

    def _own(self, canonical: FloatArray) -> FloatArray:
        """The inverse of `_canonical`."""
        ordered = np.stack([canonical[:, self._order.index(axis)] for axis in _CANONICAL], axis=1)
        own: FloatArray = Turn.from_euler(_CANONICAL, ordered).as_euler(self._order) * self._signs
        return own
