"""Meshes whose pictures are known: a sphere, and a body segment's cone."""

from __future__ import annotations

import numpy as np

from muybridge._kernels.rasterise import vertex_normals
from muybridge.synthetic.rasterise import Mesh


def sphere(radius: float, centre: np.ndarray, around: int = 192) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V, 3) and faces (F, 3) int32, outward."""
    directions, faces = sphere_grid(around)
    return directions * radius + centre, faces


def cone_mesh(ends: np.ndarray, half_axes: np.ndarray, frame: np.ndarray, around: int = 128) -> Mesh:
    """The convex hull of a cone's two ends: in each direction of a sphere's grid its farthest point.

    Parameters
    ----------
    ends : (2, 3) float64, metres: centres of base and tip, in the segment's frame
    half_axes : (2, 3, 3) float64, metres: rows are each end's half axes; a flat end's third is zero
    frame : (3, 4) float64: segment to world
    """
    directions, faces = sphere_grid(around)
    reached, points = [], []
    for end, axes in zip(ends, half_axes, strict=True):
        along = directions @ axes.T
        length = np.linalg.norm(along, axis=1, keepdims=True)
        points.append(end + np.where(length > 1e-12, along / np.maximum(length, 1e-12), 0.0) @ axes)
        reached.append(directions @ end + length[:, 0])
    local = np.where((reached[0] > reached[1])[:, None], points[0], points[1])
    vertices = local @ frame[:, :3].T + frame[:, 3]
    normals = np.empty_like(vertices)
    vertex_normals(vertices, faces, normals)
    labels = np.zeros(len(faces), dtype=np.int32)
    return Mesh(vertices, normals, faces, vertices, labels, labels)


def sphere_grid(around: int) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors (V, 3) along longitudes and latitudes, poles on z, and faces (F, 3) int32, outward."""
    rows = around // 2
    polar, azimuth = np.meshgrid(
        np.linspace(0, np.pi, rows + 1), np.linspace(0, 2 * np.pi, around, False), indexing="ij"
    )
    unit = np.stack([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], axis=-1)
    i, j = np.meshgrid(np.arange(rows), np.arange(around), indexing="ij")
    a, b = i * around + j, i * around + (j + 1) % around
    faces = np.concatenate([np.stack([a, a + around, b], -1), np.stack([b, a + around, b + around], -1)])
    return unit.reshape(-1, 3), faces.reshape(-1, 3).astype(np.int32)
