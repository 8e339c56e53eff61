"""Pictures of a mesh: coverage, depth and colour in one camera.

The renderer is a z-buffer over triangles (`_kernels.rasterise`). Lens distortion is applied to the vertices, so a
triangle's edges stay straight: with triangles of a few pixels that is far below a tenth of a pixel.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from muybridge._kernels.rasterise import empty_buffers, fill_triangles, resolve
from muybridge.cameras.model import Camera

LIGHT = np.array([0.35, -0.45, 0.82])


@dataclass(frozen=True, eq=False)
class Cloth:
    """What the labels of a mesh look like: one solid texture each.

    Parameters
    ----------
    tiles : (L, T, T, T, 3) float32, BGR in 0-255, repeated in space
    tile_size : (L,) float64, metres
    """

    tiles: np.ndarray
    tile_size: np.ndarray


@dataclass(frozen=True, eq=False)
class Mesh:
    """A figure in one posture, ready to be drawn.

    Parameters
    ----------
    vertices, normals : (V, 3) float64, metres and unit vectors, world
    faces : (F, 3) int32
    material : (V, 3) float64, metres: places in the cloth
    face_labels : (F,) int32: which cloth each face wears; -1 where the region map decides, texel by texel
    face_parts : (F,) int32: which part of the body each face belongs to
    corner_uv : (F, 3, 2) float32 in 0-1: where in the region map each corner of a face lies; may be empty if no label
        is -1
    regions : (rows, columns) uint8: labels of an atlas; u runs along its columns, v along its rows
    """

    vertices: np.ndarray
    normals: np.ndarray
    faces: np.ndarray
    material: np.ndarray
    face_labels: np.ndarray
    face_parts: np.ndarray
    corner_uv: np.ndarray = field(default_factory=lambda: np.zeros((0, 3, 2), dtype=np.float32))
    regions: np.ndarray = field(default_factory=lambda: np.zeros((1, 1), dtype=np.uint8))


@dataclass(frozen=True, eq=False)
class Layer:
    """A mesh drawn alone, in a window of the picture.

    Parameters
    ----------
    window : (left, top, right, bottom), pixels, half open; empty where the camera sees nothing
    coverage : (h, w) float32 in 0-1: share of each pixel that the mesh covers
    colours : (h, w, 3) float32, BGR, premultiplied with coverage
    depth : (h, w) float32, metres: camera z of the nearest sample; infinity where there is none
    part : (h, w) int16: which part of the body the pixel's first sample sees; -1 where there is none
    """

    window: tuple[int, int, int, int]
    coverage: np.ndarray
    colours: np.ndarray
    depth: np.ndarray
    part: np.ndarray


def draw(
    camera: Camera,
    mesh: Mesh,
    cloth: Cloth,
    *,
    light: np.ndarray = LIGHT,
    ambient: float = 0.55,
    samples: int = 2,
) -> Layer:
    """Draw a mesh with `samples` x `samples` samples a pixel.

    Parameters
    ----------
    light : (3,) towards the lamp, world; ambient : share of light that has no direction
    """
    window, fine, inverse_depth = _projected(camera, mesh.vertices, samples)
    width, height = window[2] - window[0], window[3] - window[1]
    buffers = empty_buffers(width * samples, height * samples)
    fill_triangles(fine, inverse_depth, mesh.faces, *buffers)
    layer = Layer(
        window,
        np.empty((height, width), dtype=np.float32),
        np.empty((height, width, 3), dtype=np.float32),
        np.empty((height, width), dtype=np.float32),
        np.empty((height, width), dtype=np.int16),
    )
    light = np.asarray(light, dtype=np.float64) / np.linalg.norm(light)
    resolve(
        *buffers,
        mesh.faces,
        mesh.normals,
        mesh.material,
        mesh.face_labels,
        mesh.corner_uv,
        mesh.regions,
        mesh.face_parts,
        cloth.tiles,
        cloth.tile_size,
        light,
        ambient,
        layer.coverage,
        layer.colours,
        layer.depth,
        layer.part,
    )
    return layer


def _projected(
    camera: Camera, vertices: np.ndarray, samples: int
) -> tuple[tuple[int, int, int, int], np.ndarray, np.ndarray]:
    """The picture's window, vertices (V, 2) in its samples, and 1/z (V,), -1 where a vertex has no pixel."""
    place = camera.world_to_camera(vertices)
    pixels = camera.camera_to_pixel(place)
    window = _window(pixels, camera.size)
    fine = (pixels - window[:2] + 0.5) * samples - 0.5
    inverse = np.where(np.isfinite(pixels[:, 0]), 1.0 / np.where(place[:, 2] > 0, place[:, 2], -1.0), -1.0)
    return window, fine, inverse


def coverage_of(points: np.ndarray, faces: np.ndarray, width: int, height: int) -> np.ndarray:
    """(height, width) bool: cells of a grid that a flat mesh covers, such as a shadow; points (V, 2) float64, cells."""
    buffers = empty_buffers(width, height)
    fill_triangles(points, np.ones(len(points)), faces, *buffers)
    return buffers[1] >= 0


def extent(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The least and the largest of each column of points (N, D), of which there is one at least."""
    columns = points.T  # a column at a time: numpy reduces long narrow arrays slowly
    return np.array([column.min() for column in columns]), np.array([column.max() for column in columns])


def _window(pixels: np.ndarray, size: tuple[int, int]) -> tuple[int, int, int, int]:
    """The part of the picture that can hold the points."""
    seen = pixels[np.isfinite(pixels[:, 0])]
    if not len(seen):
        return 0, 0, 0, 0
    low, high = extent(seen)
    low = np.clip(np.floor(low), 0, size).astype(int)
    high = np.clip(np.ceil(high) + 1, 0, size).astype(int)
    return int(low[0]), int(low[1]), int(max(high[0], low[0])), int(max(high[1], low[1]))
