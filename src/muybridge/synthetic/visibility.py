"""How much of each segment of the person a camera sees.

The share is counted in pixels: those of the segment that are seen, of those that it would cover were nothing before it.
Both are taken at the same point of each pixel, so a segment that nothing hides has exactly 1.
"""

from __future__ import annotations

import numpy as np

from muybridge._kernels.layers import mark_parts
from muybridge.cameras.model import Camera
from muybridge.synthetic.rasterise import Layer, Mesh
from muybridge.synthetic.skinning import SEGMENTS


def segment_of_bone(bone_names: tuple[str, ...]) -> np.ndarray:
    """(B,) int32: the index in SEGMENTS of each bone's segment."""
    owner = {bone: index for index, bones in enumerate(SEGMENTS.values()) for bone in bones}
    return np.array([owner[bone] for bone in bone_names], dtype=np.int32)


def visible_shares(
    camera: Camera, mesh: Mesh, layer: Layer, before: np.ndarray, segments: np.ndarray, samples: int = 2
) -> np.ndarray:
    """The visible share of each segment.

    Parameters
    ----------
    mesh : Mesh
        Its parts are bones.
    layer : Layer
        The mesh, drawn by this camera with `samples` x `samples` samples a pixel.
    before : (H, W) float32, metres
        Camera z of everything else; infinity where there is nothing.
    segments : (B,) int32
        The segment of each bone.

    Returns
    -------
    (S,) float64 in 0-1; 0 for a segment outside the picture
    """
    left, top, right, bottom = layer.window
    count = len(SEGMENTS)
    marks = np.zeros((bottom - top, right - left), dtype=np.uint32)
    place = camera.world_to_camera(mesh.vertices)
    pixels = camera.camera_to_pixel(place)
    # `Layer.part` belongs to the first sample of each pixel, which lies this far from the pixel's centre.
    first = 0.5 - 0.5 / samples
    inverse_depth = np.where(np.isfinite(pixels[:, 0]), 1.0 / np.where(place[:, 2] > 0, place[:, 2], -1.0), -1.0)
    mark_parts(pixels - (left, top) + first, inverse_depth, mesh.faces, segments[mesh.face_parts], marks)
    alone = np.array([np.count_nonzero(marks & np.uint32(1 << index)) for index in range(count)])
    open_view = (layer.part >= 0) & (layer.depth <= before[top:bottom, left:right])
    seen = np.bincount(segments[layer.part[open_view]], minlength=count)
    return np.where(alone > 0, seen / np.maximum(alone, 1), 0.0)
