"""Cameras: the model, the files it is read from, and calibration from pictures of a board.

| name | what |
|---|---|
| `Camera`, `Rig` | one calibrated camera; several that share a world |
| `read_rig` | from files of Pose2Sim, Anipose, OpenCV, EasyMocap, Qualisys, HumanEva, bodytrack, or our own |
| `write_rig` | our own JSON, without loss |
| `calibrate` (module) | intrinsics and place of a camera from pictures of a chequered board |
"""

from muybridge.cameras.json_format import write_rig
from muybridge.cameras.model import Camera, Rig
from muybridge.cameras.readers import read_rig

__all__ = ["Camera", "Rig", "read_rig", "write_rig"]
