"""The outline of a cone in a picture: two ellipses and their outer tangents, and from these one span per picture row.

A cone's ends are ellipsoids (flat ends: discs, one half axis is zero). An end with half axes a_j is seen, to first order
around its centre, as the ellipse {c + sum_j w_j J a_j, |w| <= 1} with J the derivative of the projection: an ellipse with
matrix M = sum_j (J a_j)(J a_j)^T and support function h(n) = sqrt(n^T M n). The cone is the convex hull of both. On its
tangents both ends reach equally far, c_1 n + h_1(n) = c_2 n + h_2(n), which is solved for the normal n by Newton steps from
the closed form for circles.

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
NEWTON_STEPS = 5
CLOSE = 1e-3  # radians; Newton's step squares the error: the next would move a 50 pixel end by 1e-4 pixels at most
BISECTIONS = 40


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
    # the segment's frame in the camera's: rotation r_ij, origin t_i
    f00, f01, f02, f03 = frame[0, 0], frame[0, 1], frame[0, 2], frame[0, 3]
    f10, f11, f12, f13 = frame[1, 0], frame[1, 1], frame[1, 2], frame[1, 3]
    f20, f21, f22, f23 = frame[2, 0], frame[2, 1], frame[2, 2], frame[2, 3]
    c0, c1, c2 = camera[11], camera[12], camera[13]
    r00, r01, r02 = c0 * f00 + c1 * f10 + c2 * f20, c0 * f01 + c1 * f11 + c2 * f21, c0 * f02 + c1 * f12 + c2 * f22
    t0 = c0 * f03 + c1 * f13 + c2 * f23 + camera[20]
    c0, c1, c2 = camera[14], camera[15], camera[16]
    r10, r11, r12 = c0 * f00 + c1 * f10 + c2 * f20, c0 * f01 + c1 * f11 + c2 * f21, c0 * f02 + c1 * f12 + c2 * f22
    t1 = c0 * f03 + c1 * f13 + c2 * f23 + camera[21]
    c0, c1, c2 = camera[17], camera[18], camera[19]
    r20, r21, r22 = c0 * f00 + c1 * f10 + c2 * f20, c0 * f01 + c1 * f11 + c2 * f21, c0 * f02 + c1 * f12 + c2 * f22
    t2 = c0 * f03 + c1 * f13 + c2 * f23 + camera[22]
    top, bottom = np.inf, -np.inf
    for e in range(2):
        e0, e1, e2 = ends[e, 0], ends[e, 1], ends[e, 2]
        z = r20 * e0 + r21 * e1 + r22 * e2 + t2
        if not z > NEAREST:
            return
        u, v, ux, uy, uz, vx, vy, vz = project(camera, r00 * e0 + r01 * e1 + r02 * e2 + t0, r10 * e0 + r11 * e1 + r12 * e2 + t1, z)
        # derivative by the segment's own coordinates
        a0, a1, a2 = ux * r00 + uy * r10 + uz * r20, ux * r01 + uy * r11 + uz * r21, ux * r02 + uy * r12 + uz * r22
        b0, b1, b2 = vx * r00 + vy * r10 + vz * r20, vx * r01 + vy * r11 + vz * r21, vx * r02 + vy * r12 + vz * r22
        mxx, mxy, myy = SMALLEST, 0.0, SMALLEST
        for j in range(3):
            h0, h1, h2 = half_axes[e, j, 0], half_axes[e, j, 1], half_axes[e, j, 2]
            p, q = a0 * h0 + a1 * h1 + a2 * h2, b0 * h0 + b1 * h1 + b2 * h2
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
    """Find both outer tangents of an outline's ends; leaves kind 1 where one end covers the other.

    With M_1 = L L^T and n = L^-T m the first end becomes the unit circle, and with both ends of one shape the second nearly a
    circle: the tangents' condition d' m + h_2'(m) = 1, d' = L^-1 d, is solved in closed form for a circle, then by Newton steps.
    """
    first, second = END, END + 6
    dx, dy = out[second] - out[first], out[second + 1] - out[first + 1]
    mxx, mxy, myy = out[second + 2], out[second + 3], out[second + 4]
    l00 = math.sqrt(out[first + 2])
    i00 = 1.0 / l00
    l10 = out[first + 3] * i00
    l11 = math.sqrt(out[first + 4] - l10 * l10)
    i11 = 1.0 / l11
    i10 = -l10 * i00 * i11
    ex, ey = i00 * dx, i10 * dx + i11 * dy
    distance = math.sqrt(ex * ex + ey * ey)
    if distance < 1e-9:
        return
    # L^-1 M_2 L^-T
    qx, qy = i10 * mxx + i11 * mxy, i10 * mxy + i11 * myy
    nxx, nxy, nyy = i00 * i00 * mxx, i00 * qx, i10 * qx + i11 * qy
    ux, uy = ex / distance, ey / distance
    along = math.sqrt(nxx * ux * ux + 2.0 * nxy * ux * uy + nyy * uy * uy)
    if abs(1.0 - along) >= distance:
        return
    across = math.sqrt(nxx * uy * uy - 2.0 * nxy * ux * uy + nyy * ux * ux)
    sine = max(-0.999, min(0.999, (1.0 - across) / distance))
    cosine = math.sqrt(1.0 - sine * sine)
    for side in range(2):
        sign = 1.0 - 2.0 * side
        mx, my = ux * sine - sign * uy * cosine, uy * sine + sign * ux * cosine
        mx, my = tangent_normal(ex, ey, nxx, nxy, nyy, mx, my, ux, uy, sign)
        nx, ny = i00 * mx + i10 * my, i11 * my  # L^-T m
        scale = 1.0 / (1.0 - ex * mx - ey * my)  # 1 / h_2
        base = SIDE + 6 * side
        out[base + 2], out[base + 3] = out[first] + l00 * mx, out[first + 1] + l10 * mx + l11 * my
        out[base + 4], out[base + 5] = (out[second] + (mxx * nx + mxy * ny) * scale,
                                        out[second + 1] + (mxy * nx + myy * ny) * scale)
        length = 1.0 / math.sqrt(nx * nx + ny * ny)
        out[base], out[base + 1] = nx * length, ny * length
    out[KIND] = 2.0


@kernel
def tangent_normal(ex, ey, nxx, nxy, nyy, mx, my, ux, uy, sign):
    """The unit vector m with e m + sqrt(m^T N m) = 1 near the given one, on one side (`sign`) of the unit vector u."""
    for _ in range(NEWTON_STEPS):
        px, py = nxx * mx + nxy * my, nxy * mx + nyy * my
        h = math.sqrt(mx * px + my * py)
        slope = (ey * mx - ex * my) + (py * mx - px * my) / h
        if abs(slope) < 1e-9:
            break
        step = (1.0 - h - ex * mx - ey * my) / slope
        if not abs(step) < 1.0:
            break
        shrink = 1.0 / (1.0 + 0.25 * step * step)  # a turn by 2 atan(step / 2) needs no root
        cosine, sine = (1.0 - 0.25 * step * step) * shrink, step * shrink
        mx, my = cosine * mx - sine * my, sine * mx + cosine * my
        if abs(step) < CLOSE:
            return mx, my
    low, high = 0.0, math.pi  # of the angle from u: the condition's left side falls from above 1 to below it
    for _ in range(BISECTIONS):
        angle = 0.5 * (low + high)
        cosine, sine = math.cos(angle), sign * math.sin(angle)
        mx, my = ux * cosine - uy * sine, uy * cosine + ux * sine
        if ex * mx + ey * my + math.sqrt(nxx * mx * mx + 2.0 * nxy * mx * my + nyy * my * my) > 1.0:
            low = angle
        else:
            high = angle
    return mx, my


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
