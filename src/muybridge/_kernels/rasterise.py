"""Z-buffer triangles: which face each pixel sees, and where on it.

Pixel centres lie at integers. A pixel belongs to a face whose three edge functions are >= 0 there; the depth is
interpolated as 1/z, which is what a plane does in a pinhole picture.
"""

from __future__ import annotations

import math

import numpy as np

from muybridge._kernels._jit import kernel


@kernel
def fill_triangles(pixels, inverse_depth, faces, depth_buffer, face_buffer, corner_buffer):
    """Draw `faces` into the buffers; a face with a corner that has no pixel (NaN) or lies behind is left out.

    pixels (V, 2) and inverse_depth (V,) float64; faces (F, 3) int32. depth_buffer (H, W) float32 holds the largest 1/z
    so far (0: nothing); face_buffer (H, W) int32 the face; corner_buffer (H, W, 2) float32 the perspective-correct
    weights of its second and third corner.
    """
    height, width = depth_buffer.shape
    for face in range(faces.shape[0]):
        a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
        za, zb, zc = inverse_depth[a], inverse_depth[b], inverse_depth[c]
        if not (za > 0.0 and zb > 0.0 and zc > 0.0):
            continue
        ax, ay = pixels[a, 0], pixels[a, 1]
        bx, by = pixels[b, 0], pixels[b, 1]
        cx, cy = pixels[c, 0], pixels[c, 1]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if not abs(area) > 1e-12:  # also where a corner is NaN
            continue
        left = max(0, int(math.ceil(max(-1.0, min(ax, bx, cx)))))
        right = min(width - 1, int(math.floor(min(float(width), max(ax, bx, cx)))))
        top = max(0, int(math.ceil(max(-1.0, min(ay, by, cy)))))
        bottom = min(height - 1, int(math.floor(min(float(height), max(ay, by, cy)))))
        scale = 1.0 / area
        for y in range(top, bottom + 1):
            for x in range(left, right + 1):
                wb = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) * scale
                wc = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) * scale
                wa = 1.0 - wb - wc
                if wa < 0.0 or wb < 0.0 or wc < 0.0:
                    continue
                inverse = wa * za + wb * zb + wc * zc
                if inverse > depth_buffer[y, x]:
                    depth_buffer[y, x] = inverse
                    face_buffer[y, x] = face
                    corner_buffer[y, x, 0] = wb * zb / inverse
                    corner_buffer[y, x, 1] = wc * zc / inverse


@kernel
def shade_faces(
    faces, face_buffer, corner_buffer, normals, material, face_label, tiles, tile_size, light, ambient, colours
):
    """Colour every covered pixel: solid texture times Lambert's cosine.

    normals and material (V, 3) float64: unit normals (world) and places in the texture (metres); face_label (F,) int32;
    tiles (L, T, T, T, 3) float32 repeats every `tile_size` (L,) metres; light (3,) unit, towards the lamp; ambient:
    share of the light from everywhere, a little more from above. colours (H, W, 3) float32 is filled where a face is.
    """
    height, width = face_buffer.shape
    cells = tiles.shape[1]
    for y in range(height):
        for x in range(width):
            face = face_buffer[y, x]
            if face < 0:
                continue
            a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
            wb, wc = corner_buffer[y, x, 0], corner_buffer[y, x, 1]
            wa = 1.0 - wb - wc
            nx = wa * normals[a, 0] + wb * normals[b, 0] + wc * normals[c, 0]
            ny = wa * normals[a, 1] + wb * normals[b, 1] + wc * normals[c, 1]
            nz = wa * normals[a, 2] + wb * normals[b, 2] + wc * normals[c, 2]
            length = math.sqrt(nx * nx + ny * ny + nz * nz) + 1e-9
            cosine = max(0.0, (nx * light[0] + ny * light[1] + nz * light[2]) / length)
            bright = ambient * (0.8 + 0.2 * nz / length) + (1.0 - ambient) * cosine
            label = face_label[face]
            per_metre = cells / tile_size[label]
            i = int(math.floor((wa * material[a, 0] + wb * material[b, 0] + wc * material[c, 0]) * per_metre)) % cells
            j = int(math.floor((wa * material[a, 1] + wb * material[b, 1] + wc * material[c, 1]) * per_metre)) % cells
            k = int(math.floor((wa * material[a, 2] + wb * material[b, 2] + wc * material[c, 2]) * per_metre)) % cells
            for channel in range(3):
                colours[y, x, channel] = tiles[label, i, j, k, channel] * bright


@kernel
def vertex_normals(vertices, faces, normals):
    """Area-weighted unit normals (V, 3) of a mesh, outward for faces that run counter-clockwise seen from outside."""
    normals[:] = 0.0
    for face in range(faces.shape[0]):
        a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
        ux, uy, uz = vertices[b, 0] - vertices[a, 0], vertices[b, 1] - vertices[a, 1], vertices[b, 2] - vertices[a, 2]
        vx, vy, vz = vertices[c, 0] - vertices[a, 0], vertices[c, 1] - vertices[a, 1], vertices[c, 2] - vertices[a, 2]
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        for corner in range(3):
            vertex = faces[face, corner]
            normals[vertex, 0] += nx
            normals[vertex, 1] += ny
            normals[vertex, 2] += nz
    for vertex in range(normals.shape[0]):
        length = math.sqrt(normals[vertex, 0] ** 2 + normals[vertex, 1] ** 2 + normals[vertex, 2] ** 2) + 1e-30
        for axis in range(3):
            normals[vertex, axis] /= length


@kernel
def blend_skin(rest, weights, indices, rotations, offsets, out):
    """Linear blend skinning: out[v] = sum_k w[v, k] (R[b] rest[v] + t[b]), b = indices[v, k]."""
    for vertex in range(rest.shape[0]):
        x, y, z = rest[vertex, 0], rest[vertex, 1], rest[vertex, 2]
        for axis in range(3):
            total = 0.0
            for k in range(weights.shape[1]):
                weight = weights[vertex, k]
                if weight > 0.0:
                    bone = indices[vertex, k]
                    moved = rotations[bone, axis, 0] * x + rotations[bone, axis, 1] * y + rotations[bone, axis, 2] * z
                    total += weight * (moved + offsets[bone, axis])
            out[vertex, axis] = total


def empty_buffers(width: int, height: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Depth (H, W) float32 of zeros, face (H, W) int32 of -1 and corner (H, W, 2) float32 buffers."""
    return (
        np.zeros((height, width), dtype=np.float32),
        np.full((height, width), -1, dtype=np.int32),
        np.zeros((height, width, 2), dtype=np.float32),
    )
