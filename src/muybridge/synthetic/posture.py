"""A track between its frames: what a person looks like while the shutter is open."""

from __future__ import annotations

import numpy as np

from muybridge.synthetic.motion import Track
from muybridge.synthetic.rasterise import Mesh
from muybridge.synthetic.skinning import Figure

LAG = 0.1  # seconds by which loose cloth comes late


def posture_at(track: Track, frame: float) -> tuple[np.ndarray, np.ndarray]:
    """World rotations (B, 3, 3) and places (B, 3), metres, at a frame number that need not be whole.

    Between two frames both are interpolated linearly, and the rotations made orthonormal again; just before the first
    and after the last frame the motion goes on as it was.
    """
    last = len(track.times) - 1
    whole = int(np.clip(np.floor(frame), 0, max(last - 1, 0)))
    part = frame - whole
    if part == 0 or last == 0:
        return track.rotations[whole], track.places[whole]
    if part == 1:
        return track.rotations[whole + 1], track.places[whole + 1]
    places = (1 - part) * track.places[whole] + part * track.places[whole + 1]
    blend = (1 - part) * track.rotations[whole] + part * track.rotations[whole + 1]
    left, _, right = np.linalg.svd(blend)
    return left @ right, places


def mesh_at(figure: Figure, track: Track, frame: float, looseness: float) -> Mesh:
    """The figure at that moment, ready to be drawn; `looseness` in metres is how far its clothes stand off."""
    earlier = posture_at(track, max(frame - LAG / track.interval, 0.0)) if looseness else None
    return figure.mesh(*posture_at(track, frame), earlier=earlier, looseness=looseness)
