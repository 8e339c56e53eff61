"""Several drawn things in one picture: who hides whom, and how much of each part is left to see."""

from __future__ import annotations

import math

import numpy as np

from muybridge._kernels._jit import kernel


@kernel
def composite(background, coverage, colours, depth, visible):
    """Lay L layers over a picture, at each pixel the nearest in front.

    background (h, w, 3) float32 is changed; coverage and depth (L, h, w) and colours (L, h, w, 3) float32, colours
    premultiplied; visible (L, h, w) float32, of zeros, takes what is left of each coverage behind the nearer layers.
    """
    count, height, width = coverage.shape
    order = np.empty(count, dtype=np.int64)
    for y in range(height):
        for x in range(width):
            most = np.float32(0.0)
            for index in range(count):
                most = max(most, coverage[index, y, x])
            if most == np.float32(0.0):
                continue
            for index in range(count):
                slot = index
                while slot > 0 and depth[order[slot - 1], y, x] > depth[index, y, x]:
                    order[slot] = order[slot - 1]
                    slot -= 1
                order[slot] = index
            left = np.float32(1.0)
            blue, green, red = np.float32(0.0), np.float32(0.0), np.float32(0.0)
            for slot in range(count):
                index = order[slot]
                share = coverage[index, y, x]
                visible[index, y, x] = left * share
                blue += left * colours[index, y, x, 0]
                green += left * colours[index, y, x, 1]
                red += left * colours[index, y, x, 2]
                left *= np.float32(1.0) - share
            background[y, x, 0] = background[y, x, 0] * left + blue
            background[y, x, 1] = background[y, x, 1] * left + green
            background[y, x, 2] = background[y, x, 2] * left + red


@kernel
def mark_parts(pixels, inverse_depth, faces, face_parts, marks):
    """Set bit `face_parts[f]` of every pixel whose centre face f covers, whatever lies before it.

    pixels (V, 2) and inverse_depth (V,) float64, faces (F, 3) int32, face_parts (F,) int32, marks (H, W) uint32. A
    face with a corner that has no pixel (NaN) or lies behind is left out, as `rasterise.fill_triangles` does.
    """
    height, width = marks.shape
    for face in range(faces.shape[0]):
        a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
        if not (inverse_depth[a] > 0.0 and inverse_depth[b] > 0.0 and inverse_depth[c] > 0.0):
            continue
        ax, ay = pixels[a, 0], pixels[a, 1]
        bx, by = pixels[b, 0], pixels[b, 1]
        cx, cy = pixels[c, 0], pixels[c, 1]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if not abs(area) > 1e-12:
            continue
        left = max(0, int(math.ceil(max(-1.0, min(ax, bx, cx)))))
        right = min(width - 1, int(math.floor(min(float(width), max(ax, bx, cx)))))
        top = max(0, int(math.ceil(max(-1.0, min(ay, by, cy)))))
        bottom = min(height - 1, int(math.floor(min(float(height), max(ay, by, cy)))))
        scale = 1.0 / area
        bit = np.uint32(1) << np.uint32(face_parts[face])
        for y in range(top, bottom + 1):
            for x in range(left, right + 1):
                wb = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) * scale
                wc = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) * scale
                if wb >= 0.0 and wc >= 0.0 and 1.0 - wb - wc >= 0.0:
                    marks[y, x] |= bit
