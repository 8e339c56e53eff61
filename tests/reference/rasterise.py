"""What `_kernels.rasterise.resolve` means, sample by sample."""

from __future__ import annotations

import numpy as np


def resolved(
    depth_buffer, face_buffer, corner_buffer, faces, normals, material, labels, uv, regions, parts, tiles, sizes, light,
    ambient,
):  # fmt: skip
    """Coverage (h, w), colours (h, w, 3), depth (h, w) and part (h, w) of s x s samples a pixel, here s = H // 5."""
    samples = face_buffer.shape[0] // 5
    height, width = face_buffer.shape[0] // samples, face_buffer.shape[1] // samples
    coverage, colours = np.zeros((height, width)), np.zeros((height, width, 3))
    depth, part = np.full((height, width), np.inf), np.full((height, width), -1)
    for y, x in np.ndindex(height, width):
        for v, u in np.ndindex(samples, samples):
            at = y * samples + v, x * samples + u
            face = face_buffer[at]
            if face < 0:
                continue
            share = np.array([1 - corner_buffer[at].sum(), *corner_buffer[at]], dtype=float)
            normal = share @ normals[faces[face]]
            normal = normal / np.linalg.norm(normal)
            bright = ambient * (0.8 + 0.2 * normal[2]) + (1 - ambient) * max(0.0, normal @ light)
            label = labels[face]
            if label < 0:
                column, row = (share @ uv[face] * regions.shape[::-1]).astype(int)
                label = regions[row, column]
            cell = np.floor(share @ material[faces[face]] * tiles.shape[1] / sizes[label]).astype(int) % tiles.shape[1]
            colours[y, x] += tiles[(label, *cell)] * bright / samples**2
            coverage[y, x] += 1 / samples**2
            depth[y, x] = min(depth[y, x], 1 / depth_buffer[at])
            if v == u == 0:
                part[y, x] = parts[face]
    return coverage, colours, depth, part
