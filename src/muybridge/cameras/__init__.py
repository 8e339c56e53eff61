"""Cameras: the model, the files it is read from, and calibration from pictures of a board.

| name | what |
|---|---|
| `Camera`, `Rig` | one calibrated camera; several that share a world |
"""

from muybridge.cameras.model import Camera, Rig

__all__ = ["Camera", "Rig"]
