"""Pictures of a mesh: coverage, depth and colour in one camera.

The renderer is a z-buffer over triangles (`_kernels.rasterise`). Lens distortion is applied to the vertices, so a
triangle's edges stay straight: with triangles of a few pixels that is far below a tenth of a pixel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from muybridge._kernels.rasterise import empty_buffers, fill_triangles, shade_faces
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
    face_labels : (F,) int32: which cloth each face wears
    face_parts : (F,) int32: which part of the body each face belongs to
    """

    vertices: np.ndarray
    normals: np.ndarray
    faces: np.ndarray
    material: np.ndarray
    face_labels: np.ndarray
    face_parts: np.ndarray


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
    place = camera.world_to_camera(mesh.vertices)
    pixels = camera.camera_to_pixel(place)
    window = _window(pixels, camera.size)
    left, top, right, bottom = window
    width, height = right - left, bottom - top
    fine = (pixels - (left, top) + 0.5) * samples - 0.5
    buffers = empty_buffers(width * samples, height * samples)
    inverse_depth = np.where(np.isfinite(pixels[:, 0]), 1.0 / np.where(place[:, 2] > 0, place[:, 2], -1.0), -1.0)
    fill_triangles(fine, inverse_depth, mesh.faces, *buffers)
    colours = np.zeros((height * samples, width * samples, 3), dtype=np.float32)
    light = np.asarray(light, dtype=np.float64) / np.linalg.norm(light)
    shade_faces(
        mesh.faces,
        buffers[1],
        buffers[2],
        mesh.normals,
        mesh.material,
        mesh.face_labels,
        cloth.tiles,
        cloth.tile_size,
        light,
        ambient,
        colours,
    )
    nearest = _blocks(buffers[0], samples).max(axis=(1, 3))
    with np.errstate(divide="ignore"):
        depth = np.float32(1.0) / nearest
    return Layer(
        window,
        _blocks((buffers[1] >= 0).astype(np.float32), samples).mean(axis=(1, 3)),
        _blocks(colours, samples).mean(axis=(1, 3)),
        depth,
        _parts(buffers[1][::samples, ::samples], mesh.face_parts),
    )


def _parts(faces: np.ndarray, face_parts: np.ndarray) -> np.ndarray:
    """(h, w) int16: the part that each pixel's face (h, w) belongs to."""
    return np.where(faces >= 0, face_parts[faces], -1).astype(np.int16)


def coverage_of(points: np.ndarray, faces: np.ndarray, width: int, height: int) -> np.ndarray:
    """(height, width) bool: cells of a grid that a flat mesh covers, such as a shadow; points (V, 2) float64, cells."""
    buffers = empty_buffers(width, height)
    fill_triangles(points, np.ones(len(points)), faces, *buffers)
    return buffers[1] >= 0


def _blocks(image: np.ndarray, samples: int) -> np.ndarray:
    """(h s, w s, ...) -> (h, s, w, s, ...) view."""
    height, width = image.shape[0] // samples, image.shape[1] // samples
    return image.reshape(height, samples, width, samples, *image.shape[2:])


def _window(pixels: np.ndarray, size: tuple[int, int]) -> tuple[int, int, int, int]:
    """The part of the picture that can hold the points."""
    seen = pixels[np.isfinite(pixels[:, 0])]
    if not len(seen):
        return 0, 0, 0, 0
    low = np.clip(np.floor(seen.min(axis=0)), 0, size).astype(int)
    high = np.clip(np.ceil(seen.max(axis=0)) + 1, 0, size).astype(int)
    return int(low[0]), int(low[1]), int(max(high[0], low[0])), int(max(high[1], low[1]))
