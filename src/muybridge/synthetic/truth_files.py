"""What is true of a scene, as tables: joints, angles, and how much of each segment each camera sees.

truth_joints.csv       frame, time_s, joint, x_m, y_m, z_m, sd_m: the columns of a run's joints.csv; sd_m = 0
truth_angles.csv       frame, time_s, then the eight angles of `evaluation.angles`, degrees
truth_visibility.csv   frame, camera, segment, visible: 0-1, of the pixels that it would cover in the picture alone
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from types import TracebackType

import numpy as np

from muybridge.evaluation.angles import ANGLES, joint_angles
from muybridge.evaluation.names import JOINTS
from muybridge.io.disk import disk_errors
from muybridge.io.run_folder import JointSeries, write_joints
from muybridge.synthetic.motion import Track
from muybridge.synthetic.skinning import SEGMENTS

JOINTS_FILE, ANGLES_FILE, VISIBILITY_FILE = "truth_joints.csv", "truth_angles.csv", "truth_visibility.csv"
VISIBILITY_HEADER = ("frame", "camera", "segment", "visible")


def write_truth(path: Path, track: Track) -> None:
    """The true joints, in the columns of a run's joints.csv; the standard deviation of the truth is 0."""
    count = len(track.times)
    write_joints(path, JointSeries(JOINTS, np.arange(count), track.times, track.joints, np.zeros((count, len(JOINTS)))))


def write_angles(path: Path, track: Track) -> None:
    """The true joint angles, degrees."""
    degrees = np.degrees(joint_angles(track.joints, JOINTS))
    lines = [",".join(("frame", "time_s", *(f"{name}_deg" for name in ANGLES)))]
    for frame, (time, row) in enumerate(zip(track.times, degrees, strict=True)):
        lines.append(",".join([str(frame), f"{time:.6f}", *(f"{value:.4f}" for value in row)]))
    with disk_errors(path):
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")


class VisibilityTable:
    """Writes truth_visibility.csv, frame by frame."""

    def __init__(self, path: Path, cameras: tuple[str, ...]) -> None:
        self.path, self.cameras = path, cameras
        with disk_errors(path):
            self._file = path.open("w", encoding="utf-8")
        self._write([",".join(VISIBILITY_HEADER)])

    def write(self, frame: int, shares: Iterable[np.ndarray]) -> None:
        """The visible shares (S,) of each camera in turn."""
        for camera, row in zip(self.cameras, shares, strict=True):
            self._write([f"{frame},{camera},{name},{share:.4f}" for name, share in zip(SEGMENTS, row, strict=True)])

    def _write(self, lines: list[str]) -> None:
        with disk_errors(self.path):
            self._file.write("\n".join(lines) + "\n")

    def __enter__(self) -> VisibilityTable:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        with disk_errors(self.path):
            self._file.close()
