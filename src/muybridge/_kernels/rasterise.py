"""Z-buffer triangles: which face each pixel sees, and where on it.

Pixel centres lie at integers. A pixel belongs to a face whose three edge functions are >= 0 there; the depth is
interpolated as 1/z, which is what a plane does in a pinhole picture.
"""

from __future__ import annotations

import math

import numpy as np

from muybridge._kernels._jit import kernel, vector_kernel


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
def resolve(
    depth_buffer,
    face_buffer,
    corner_buffer,
    faces,
    normals,
    material,
    face_labels,
    corner_uv,
    regions,
    face_parts,
    tiles,
    tile_size,
    light,
    ambient,
    coverage,
    colours,
    depth,
    part,
):
    """From buffers with s x s samples a pixel to a picture (h, w): coverage, premultiplied colours, depth and part.

    Colour is a solid texture times Lambert's cosine. normals and material (V, 3) float64: unit normals (world) and
    places in the texture (metres); face_labels (F,) int32, where -1 looks it up in `regions` (R, C) uint8 at the
    face's corner_uv (F, 3, 2) float32; tiles (L, T, T, T, 3) float32 repeats every `tile_size` (L,) metres; light (3,)
    unit, towards the lamp; ambient: share of the light from everywhere, a little more from above. depth is that of the
    nearest sample, infinity where there is none; part is that of the first sample, -1 where there is none.
    """
    height, width = coverage.shape
    if height == 0 or width == 0:
        return
    samples = face_buffer.shape[0] // height
    share = np.float32(1.0 / (samples * samples))
    cells = tiles.shape[1]
    for y in range(height):
        for x in range(width):
            count, nearest = 0, np.float32(0.0)
            blue, green, red = np.float32(0.0), np.float32(0.0), np.float32(0.0)
            for v in range(y * samples, (y + 1) * samples):
                for u in range(x * samples, (x + 1) * samples):
                    face = face_buffer[v, u]
                    if face < 0:
                        continue
                    count += 1
                    nearest = max(nearest, depth_buffer[v, u])
                    wb, wc = corner_buffer[v, u, 0], corner_buffer[v, u, 1]
                    bright = np.float32(_brightness(normals, faces[face], wb, wc, light, ambient))
                    label = face_labels[face]
                    if label < 0:
                        label = _region(regions, corner_uv[face], wb, wc)
                    i, j, k = _cell(material, faces[face], wb, wc, cells / tile_size[label], cells)
                    blue += tiles[label, i, j, k, 0] * bright
                    green += tiles[label, i, j, k, 1] * bright
                    red += tiles[label, i, j, k, 2] * bright
            coverage[y, x] = count * share
            colours[y, x, 0], colours[y, x, 1], colours[y, x, 2] = blue * share, green * share, red * share
            depth[y, x] = np.float32(1.0) / nearest if count > 0 else np.float32(np.inf)
            first = face_buffer[y * samples, x * samples]
            part[y, x] = face_parts[first] if first >= 0 else -1


@vector_kernel
def _brightness(normals, face, wb, wc, light, ambient):
    """Share of the lamp's light that a place on a face sends on."""
    a, b, c = face[0], face[1], face[2]
    wa = 1.0 - wb - wc
    nx = wa * normals[a, 0] + wb * normals[b, 0] + wc * normals[c, 0]
    ny = wa * normals[a, 1] + wb * normals[b, 1] + wc * normals[c, 1]
    nz = wa * normals[a, 2] + wb * normals[b, 2] + wc * normals[c, 2]
    scale = 1.0 / (math.sqrt(nx * nx + ny * ny + nz * nz) + 1e-9)
    cosine = max(0.0, (nx * light[0] + ny * light[1] + nz * light[2]) * scale)
    return ambient * (0.8 + 0.2 * nz * scale) + (1.0 - ambient) * cosine


@vector_kernel
def _region(regions, uv, wb, wc):
    """Label of the texel that holds a place on a face with corners uv (3, 2)."""
    wa = 1.0 - wb - wc
    column = int((wa * uv[0, 0] + wb * uv[1, 0] + wc * uv[2, 0]) * regions.shape[1])
    row = int((wa * uv[0, 1] + wb * uv[1, 1] + wc * uv[2, 1]) * regions.shape[0])
    return int(regions[max(0, min(regions.shape[0] - 1, row)), max(0, min(regions.shape[1] - 1, column))])


@vector_kernel
def _cell(material, face, wb, wc, per_metre, cells):
    """Cell (i, j, k) of a solid texture at a place on a face."""
    a, b, c = face[0], face[1], face[2]
    wa = 1.0 - wb - wc
    i = int(math.floor((wa * material[a, 0] + wb * material[b, 0] + wc * material[c, 0]) * per_metre)) % cells
    j = int(math.floor((wa * material[a, 1] + wb * material[b, 1] + wc * material[c, 1]) * per_metre)) % cells
    k = int(math.floor((wa * material[a, 2] + wb * material[b, 2] + wc * material[c, 2]) * per_metre)) % cells
    return i, j, k


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
