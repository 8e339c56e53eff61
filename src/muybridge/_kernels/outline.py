"""The outline of a cone in a picture: two ellipses and their outer tangents, and from these one span per picture row.

A cone's ends are ellipsoids (flat ends: discs, one half axis is zero). An end with half axes a_j is seen, to first order
around its centre, as the ellipse {c + sum_j w_j J a_j, |w| <= 1} with J the derivative of the projection: an ellipse with
matrix M = sum_j (J a_j)(J a_j)^T and support function h(n) = sqrt(n^T M n). The cone is the convex hull of both. On its
tangents both ends reach equally far, c_1 n + h_1(n) = c_2 n + h_2(n), which is solved for the normal n by Newton steps from
the circles' closed form.

A camera is a row of numbers: fx, fy, cx, cy, skew, k1, k2, p1, p2, k3, largest radius squared, R (9), t (3), width, height.
An outline is a row of numbers: see the column names below.
"""

from __future__ import annotations

import math

import numpy as np

from muybridge._kernels._jit import kernel

CAMERA_COLUMNS = 25
#: Columns of an outline: kind (0 unseen, 1 ellipses only, 2 with tangents), then twice the end (c_x, c_y, M_xx, M_xy, M_yy,
#: depth), then for each of the two sides the normal and the tangent points on both ends, then first and last y.
KIND, END, SIDE, TOP, BOTTOM, OUTLINE_COLUMNS = 0, 1, 13, 25, 26, 27
NEAREST = 0.05  # metres; what is nearer than this, or behind, is not drawn
SMALLEST = 0.01  # square pixels; keeps ellipses seen edge on from vanishing
NEWTON_STEPS = 3


@kernel
def project(camera, x, y, z):
    """Pixel and its derivative by the camera-frame point: u, v, du/dx, du/dy, du/dz, dv/dx, dv/dy, dv/dz (z > 0)."""
    a, b = x / z, y / z
    r2 = a * a + b * b
    k1, k2, p1, p2, k3 = camera[5], camera[6], camera[7], camera[8], camera[9]
    if r2 > camera[10]:  # past the fold of the distortion polynomial: go on with the factor at its edge
        edge = camera[10]
        factor, slope = 1.0 + edge * (k1 + edge * (k2 + edge * k3)), 0.0
        p1 = p2 = 0.0
    else:
        factor = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
        slope = k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3)
    ad = a * factor + 2.0 * p1 * a * b + p2 * (r2 + 2.0 * a * a)
    bd = b * factor + p1 * (r2 + 2.0 * b * b) + 2.0 * p2 * a * b
    aa = factor + 2.0 * slope * a * a + 2.0 * p1 * b + 6.0 * p2 * a
    ab = 2.0 * slope * a * b + 2.0 * p1 * a + 2.0 * p2 * b
    bb = factor + 2.0 * slope * b * b + 6.0 * p1 * b + 2.0 * p2 * a
    fx, fy, skew = camera[0], camera[1], camera[4]
    ua, ub = fx * aa + skew * ab, fx * ab + skew * bb
    va, vb = fy * ab, fy * bb
    w = 1.0 / z
    return (fx * ad + skew * bd + camera[2], fy * bd + camera[3],
            ua * w, ub * w, -(ua * a + ub * b) * w, va * w, vb * w, -(va * a + vb * b) * w)


@kernel
def outline_of(camera, frame, ends, half_axes, out):
    """Fill one outline row for a segment with `frame` (3, 4), `ends` (2, 3) and `half_axes` (2, 3, 3) in its own frame."""
    out[KIND] = 0.0
    top, bottom = np.inf, -np.inf
    for e in range(2):
        wx = frame[0, 0] * ends[e, 0] + frame[0, 1] * ends[e, 1] + frame[0, 2] * ends[e, 2] + frame[0, 3]
        wy = frame[1, 0] * ends[e, 0] + frame[1, 1] * ends[e, 1] + frame[1, 2] * ends[e, 2] + frame[1, 3]
        wz = frame[2, 0] * ends[e, 0] + frame[2, 1] * ends[e, 1] + frame[2, 2] * ends[e, 2] + frame[2, 3]
        x = camera[11] * wx + camera[12] * wy + camera[13] * wz + camera[20]
        y = camera[14] * wx + camera[15] * wy + camera[16] * wz + camera[21]
        z = camera[17] * wx + camera[18] * wy + camera[19] * wz + camera[22]
        if not z > NEAREST:
            return
        u, v, ux, uy, uz, vx, vy, vz = project(camera, x, y, z)
        # derivative by the world point, then by the segment's own coordinates
        u0 = ux * camera[11] + uy * camera[14] + uz * camera[17]
        u1 = ux * camera[12] + uy * camera[15] + uz * camera[18]
        u2 = ux * camera[13] + uy * camera[16] + uz * camera[19]
        v0 = vx * camera[11] + vy * camera[14] + vz * camera[17]
        v1 = vx * camera[12] + vy * camera[15] + vz * camera[18]
        v2 = vx * camera[13] + vy * camera[16] + vz * camera[19]
        a0 = u0 * frame[0, 0] + u1 * frame[1, 0] + u2 * frame[2, 0]
        a1 = u0 * frame[0, 1] + u1 * frame[1, 1] + u2 * frame[2, 1]
        a2 = u0 * frame[0, 2] + u1 * frame[1, 2] + u2 * frame[2, 2]
        b0 = v0 * frame[0, 0] + v1 * frame[1, 0] + v2 * frame[2, 0]
        b1 = v0 * frame[0, 1] + v1 * frame[1, 1] + v2 * frame[2, 1]
        b2 = v0 * frame[0, 2] + v1 * frame[1, 2] + v2 * frame[2, 2]
        mxx, mxy, myy = SMALLEST, 0.0, SMALLEST
        for j in range(3):
            p = a0 * half_axes[e, j, 0] + a1 * half_axes[e, j, 1] + a2 * half_axes[e, j, 2]
            q = b0 * half_axes[e, j, 0] + b1 * half_axes[e, j, 1] + b2 * half_axes[e, j, 2]
            mxx += p * p
            mxy += p * q
            myy += q * q
        base = END + 6 * e
        out[base], out[base + 1], out[base + 2], out[base + 3], out[base + 4], out[base + 5] = u, v, mxx, mxy, myy, z
        reach = math.sqrt(myy)
        top, bottom = min(top, v - reach), max(bottom, v + reach)
    out[TOP], out[BOTTOM] = top, bottom
    out[KIND] = 1.0
    tangents(out)


@kernel
def support(out, base, nx, ny):
    """Support function h(n) of the end whose columns begin at `base`."""
    return math.sqrt(out[base + 2] * nx * nx + 2.0 * out[base + 3] * nx * ny + out[base + 4] * ny * ny)


@kernel
def tangents(out):
    """Find both outer tangents of an outline's ends; leaves kind 1 where one end covers the other."""
    first, second = END, END + 6
    dx, dy = out[second] - out[first], out[second + 1] - out[first + 1]
    distance = math.sqrt(dx * dx + dy * dy)
    if distance < 1e-9:
        return
    ux, uy = dx / distance, dy / distance
    for side in range(2):
        sign = 1.0 - 2.0 * side
        nx, ny = -uy * sign, ux * sign
        sine = (support(out, first, nx, ny) - support(out, second, nx, ny)) / distance
        if abs(sine) >= 1.0:
            return
        cosine = math.sqrt(1.0 - sine * sine)
        nx, ny = ux * sine + nx * cosine, uy * sine + ny * cosine
        for _ in range(NEWTON_STEPS):
            h1, h2 = support(out, first, nx, ny), support(out, second, nx, ny)
            px, py = -ny, nx
            g = dx * nx + dy * ny + h2 - h1
            slope = dx * px + dy * py
            slope += (out[second + 2] * nx * px + out[second + 3] * (nx * py + ny * px) + out[second + 4] * ny * py) / h2
            slope -= (out[first + 2] * nx * px + out[first + 3] * (nx * py + ny * px) + out[first + 4] * ny * py) / h1
            if abs(slope) < 1e-9:
                return
            step = max(-0.5, min(0.5, -g / slope))
            nx, ny = nx + step * px, ny + step * py
            length = math.sqrt(nx * nx + ny * ny)
            nx, ny = nx / length, ny / length
        if abs(dx * nx + dy * ny + support(out, second, nx, ny) - support(out, first, nx, ny)) > 0.1:
            return
        base = SIDE + 6 * side
        out[base], out[base + 1] = nx, ny
        for e in range(2):
            end = END + 6 * e
            h = support(out, end, nx, ny)
            out[base + 2 + 2 * e] = out[end] + (out[end + 2] * nx + out[end + 3] * ny) / h
            out[base + 3 + 2 * e] = out[end + 1] + (out[end + 3] * nx + out[end + 4] * ny) / h
    out[KIND] = 2.0


@kernel
def row_span(out, y):
    """First and last x (float) of the outline on the row `y`; an empty span has first > last."""
    left, right = np.inf, -np.inf
    for e in range(2):
        base = END + 6 * e
        myy = out[base + 4]
        dy = y - out[base + 1]
        rest = 1.0 - dy * dy / myy
        if rest >= 0.0:
            middle = out[base] + out[base + 3] / myy * dy
            half = math.sqrt((out[base + 2] - out[base + 3] * out[base + 3] / myy) * rest)
            left, right = min(left, middle - half), max(right, middle + half)
    if out[KIND] == 2.0:
        for side in range(2):
            base = SIDE + 6 * side
            ya, yb = out[base + 3], out[base + 5]
            if (ya <= y) != (yb <= y):
                x = out[base + 2] + (y - ya) / (yb - ya) * (out[base + 4] - out[base + 2])
                left, right = min(left, x), max(right, x)
    return left, right


@kernel
def outlines_of(camera, frames, shaped, ends, half_axes, out):
    """Outlines (K, OUTLINE_COLUMNS) of all segments that have a shape, for one camera."""
    for k in range(shaped.shape[0]):
        s = shaped[k]
        outline_of(camera, frames[s], ends[s], half_axes[s], out[k])
