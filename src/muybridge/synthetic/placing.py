"""Where people and cameras go so that the one sees the other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from muybridge.cameras.model import Camera, Rig
from muybridge.errors import InputError
from muybridge.synthetic.occluders import Occluder
from muybridge.synthetic.rigs import looking_at

MARGIN = 24.0  # pixels kept around the joints: hands, hair and shoes reach beyond them


def whole(rig: Rig, joints: np.ndarray, margin: float = MARGIN) -> bool:
    """Whether all joints (T, J, 3) stay `margin` pixels inside every picture."""
    for camera in rig:
        pixels = camera.world_to_pixel(joints)
        if not ((pixels > margin) & (pixels < np.array(camera.size) - margin)).all():
            return False
    return True


def check_seen(rig: Rig, joints: np.ndarray) -> None:
    """Raise where a camera has no joint (T, J, 3) in its picture, in any frame."""
    for camera in rig:
        pixels = camera.world_to_pixel(joints)
        if not ((pixels >= 0) & (pixels <= np.array(camera.size) - 1)).all(axis=-1).any():
            remedy = "turn it towards the person (look_at), or move the motion (place)"
            raise InputError(f"camera {camera.name}", expected="to see the person", got="nobody in any of its pictures",
                             remedy=remedy)  # fmt: skip


def side_camera(
    joints: np.ndarray,
    heading: float,
    *,
    side: float,
    distance: float,
    height: float,
    size: tuple[int, int] = (640, 480),
    distortion: np.ndarray | None = None,
) -> Camera:
    """A camera that looks at right angles on the way walked, as near as the whole clip allows.

    Parameters
    ----------
    joints : (T, J, 3) float64, metres, world
    heading : radians, the direction walked
    side : 1 to stand on the left of the way, -1 on the right
    distance, height : metres, from the middle of the way, and above the floor
    """
    low, high = joints.min(axis=(0, 1)), joints.max(axis=(0, 1))
    middle = 0.5 * (low + high)
    outward = side * np.array([-np.sin(heading), np.cos(heading)])
    place = np.array([*(middle[:2] + distance * outward), height])
    # Without the lens, pixels from the middle grow with the focal length; a barrel lens only brings them nearer.
    probe = looking_at("cam1", place, middle, focal=1.0, size=size)
    points = probe.world_to_camera(joints)
    if not (points[..., 2] > 0.5).all():
        raise InputError("side view", expected="a clip short enough to stay in view", got=f"a way to {distance:g} m")
    reach = np.abs(points[..., :2] / points[..., 2:]).max(axis=(0, 1))
    room = (np.array(size) - 1) / 2 - MARGIN - 2.0
    focal = float((room / reach).min())
    return looking_at("cam1", place, middle, focal=focal, size=size, distortion=distortion)


def clear_of(things: Sequence[Occluder], joints: np.ndarray, gap: float) -> bool:
    """Whether all joints (T, J, 3) stay `gap` metres away from every thing, along the floor."""
    return all(bool((thing.distance(joints[..., :2]) > gap).all()) for thing in things)


def apart(first: np.ndarray, second: np.ndarray, gap: float) -> bool:
    """Whether two people, joints (T, J, 3) each, keep `gap` metres between their pelvises, along the floor."""
    return bool((np.linalg.norm(first[:, 0, :2] - second[:, 0, :2], axis=-1) > gap).all())


def in_room(rig: Rig, joints: np.ndarray, half_width: float, gap: float = 0.3) -> bool:
    """Whether cameras and joints (T, J, 3) are inside the walls."""
    inside = all((np.abs(camera.position[:2]) < half_width - 0.05).all() for camera in rig)
    return inside and bool((np.abs(joints[..., :2]) < half_width - gap).all())
