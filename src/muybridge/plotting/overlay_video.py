"""A run drawn over its own footage: `overlay_<camera>.mp4`, one picture a tracked frame."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from muybridge.errors import InputError
from muybridge.io.run_folder import JointSeries, PoseSeries, read_joints, read_pose
from muybridge.plotting.outlines import segment_outlines
from muybridge.plotting.overlay import draw_joints, draw_label, draw_limbs

if TYPE_CHECKING:
    from muybridge.body import Body
    from muybridge.cameras import Camera
    from muybridge.io.video import PictureSource

LARGEST_SIDE = 960
"""Pixels; footage beyond is drawn smaller, which is quicker to make and to look at."""


def write_overlay(
    folder: str | Path,
    camera: Camera,
    pictures: PictureSource,
    body: Body | None = None,
    *,
    progress: Callable[[int], None] | None = None,
) -> Path:
    """Draw a run over one camera's pictures.

    Parameters
    ----------
    folder : str or Path
        A run folder with joints.csv, and with pose.csv where a body is given.
    camera : Camera
        As tracking used it; the video is named after it.
    pictures : PictureSource
        The camera's own pictures; frames are those of the run.
    body : Body, optional
        As it was fitted; without one only joints are drawn.
    progress : callable, optional
        Told the number of frames done.

    Returns
    -------
    Path
        The video in the run folder.
    """
    from muybridge.io.video_writer import VideoWriter

    folder = Path(folder)
    joints = read_joints(folder)
    poses = read_pose(folder) if body is not None else None
    if poses is not None and body is not None and poses.names != body.dof_names:
        raise InputError(
            f"poses in {folder}", expected=f"those of body {body.name!r}", got=f"{len(poses.names)} others"
        )
    scale = min(1.0, LARGEST_SIDE / max(camera.size))
    drawn_camera = camera if scale == 1.0 else camera.scaled(scale)
    target = folder / f"overlay_{camera.name}.mp4"
    row_of = {int(frame): row for row, frame in enumerate(joints.frames)}
    if not row_of:
        raise InputError(f"run {folder}", expected="at least one tracked frame", got="none")
    with VideoWriter(target, pictures.frame_rate) as video:
        for frame, _, picture in pictures.frames(min(row_of)):
            if frame > max(row_of):
                break
            if frame in row_of:
                picture = _resized(picture, drawn_camera.size)
                video.write(draw_frame(picture, drawn_camera, joints, row_of[frame], body, poses))
                if progress is not None:
                    progress(video.frame_count)
    return target


def draw_frame(
    picture: np.ndarray,
    camera: Camera,
    joints: JointSeries,
    row: int,
    body: Body | None = None,
    poses: PoseSeries | None = None,
) -> np.ndarray:
    """One picture (H, W, 3) uint8 BGR with limbs, joints, their uncertainty and the frame's number; a new picture."""
    result = picture
    if body is not None and poses is not None:
        where = np.flatnonzero(poses.frames == joints.frames[row])
        if len(where) and np.isfinite(poses.poses[where[0]]).all():
            result = draw_limbs(result, *segment_outlines(body, poses.poses[where[0]], camera))
    points, sd = joints.positions[row], joints.sd[row]
    depth = camera.world_to_camera(points)[:, 2]
    seen = np.isfinite(depth) & (depth > 0)
    pixels = np.full((len(points), 2), np.nan)
    pixels[seen] = camera.world_to_pixel(points[seen])
    spread = np.where(seen, sd * camera.matrix[0, 0] / np.where(seen, depth, 1.0), np.nan)
    return draw_label(draw_joints(result, pixels, joints.names, spread), f"frame {joints.frames[row]}")


def _resized(picture: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """The picture in colour and of that (width, height)."""
    import cv2

    if picture.ndim == 2:
        picture = cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR)
    return picture if picture.shape[1::-1] == size else cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
