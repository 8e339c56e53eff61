"""The outline of a cone in a picture: two ellipses and their outer tangents, and from these one span per picture row.

A cone's ends are ellipsoids (flat ends: discs, one half axis is zero). An end with half axes a_j is seen, to first
order around its centre, as the ellipse {c + sum_j w_j J a_j, |w| <= 1} with J the derivative of the projection: an
ellipse with matrix M = sum_j (J a_j)(J a_j)^T and support function h(n) = sqrt(n^T M n). The cone is the convex hull
of both. On its tangents both ends reach equally far, c_1 n + h_1(n) = c_2 n + h_2(n), which is solved for the normal
n by Newton steps from the closed form for circles.

A camera is a row of numbers: fx, fy, cx, cy, skew, k1, k2, p1, p2, k3, largest radius squared, R (9), t (3), width,
height. An outline is a row of numbers: see the column names below.
"""

from __future__ import annotations

import math

import numpy as np

from muybridge._kernels._jit import kernel, vector_kernel
from muybridge._kernels.chain import LANES

CAMERA_COLUMNS = 25
#: Columns of an outline: kind (0 unseen, 1 ellipses only, 2 with tangents), then twice the end (c_x, c_y, M_xx, M_xy,
#: M_yy,
#: depth), then for each of the two sides the normal and the tangent points on both ends, then first and last y.
KIND, END, SIDE, TOP, BOTTOM, OUTLINE_COLUMNS = 0, 1, 13, 25, 26, 27
NEAREST = 0.05  # metres; what is nearer than this, or behind, is not drawn
FARTHEST = 1e9  # pixels
SMALLEST = 0.01  # square pixels; keeps ellipses seen edge on from vanishing
UNSOLVED = 3.0  # kind of an outline between two steps of the solution
CLOSE = 1e-3  # radians; Newton's step squares the error: the next would move a 50 pixel end by 1e-4 pixels at most
BISECTIONS = 40


@kernel
def project(camera, x, y, z):
    """Pixel and its derivative by the camera-frame point: u, v, du/dx, du/dy, du/dz, dv/dx, dv/dy, dv/dz (z > 0)."""
    return _project(
        camera[0],
        camera[1],
        camera[2],
        camera[3],
        camera[4],
        camera[5],
        camera[6],
        camera[7],
        camera[8],
        camera[9],
        camera[10],
        x,
        y,
        z,
    )


@vector_kernel
def _project(fx, fy, cx, cy, skew, k1, k2, p1, p2, k3, edge, x, y, z):
    """As `project`, for a camera's first eleven columns."""
    w = 1.0 / z
    a, b = x * w, y * w
    r2 = a * a + b * b
    inside = r2 <= edge  # past the fold of the distortion polynomial: go on with the factor at its edge
    rr = min(r2, edge)
    factor = 1.0 + rr * (k1 + rr * (k2 + rr * k3))
    slope = k1 + rr * (2.0 * k2 + 3.0 * rr * k3) if inside else 0.0
    p1, p2 = p1 if inside else 0.0, p2 if inside else 0.0
    ad = a * factor + 2.0 * p1 * a * b + p2 * (r2 + 2.0 * a * a)
    bd = b * factor + p1 * (r2 + 2.0 * b * b) + 2.0 * p2 * a * b
    aa = factor + 2.0 * slope * a * a + 2.0 * p1 * b + 6.0 * p2 * a
    ab = 2.0 * slope * a * b + 2.0 * p1 * a + 2.0 * p2 * b
    bb = factor + 2.0 * slope * b * b + 6.0 * p1 * b + 2.0 * p2 * a
    ua, ub = fx * aa + skew * ab, fx * ab + skew * bb
    va, vb = fy * ab, fy * bb
    return (
        fx * ad + skew * bd + cx,
        fy * bd + cy,
        ua * w,
        ub * w,
        -(ua * a + ub * b) * w,
        va * w,
        vb * w,
        -(va * a + vb * b) * w,
    )


@kernel
def outline_lanes(camera, frame, ends, half_axes, kinds, ellipses, sides):
    """Outlines of one segment in LANES poses at once; a row of LANES numbers follows another in each of the flat
    arrays.

    frame holds the 12 numbers of the segment's frames. An outline's columns are spread over kinds (1 row), ellipses
    (12) and sides (14): arrays of their own with a stride that the compiler knows, which is what lets it make vector
    code.
    """
    for e in range(2):
        _end_lanes(camera, frame, ends[e], half_axes[e], ellipses[6 * LANES * e : 6 * LANES * (e + 1)])
    _tangent_lanes(ellipses, kinds, sides)
    for lane in range(LANES):
        if kinds[lane] == UNSOLVED:
            _bisect_tangents(ellipses, sides, lane)
            kinds[lane] = 2.0
        before = ellipses[5 * LANES + lane] > NEAREST and ellipses[11 * LANES + lane] > NEAREST
        # rows are numbers: a pose that is not finite is not drawn
        if not (before and sides[12 * LANES + lane] > -FARTHEST and sides[13 * LANES + lane] < FARTHEST):
            kinds[lane] = 0.0


@vector_kernel
def _four(rows, first, lane):
    """One lane's numbers of four rows from `first` on."""
    return (
        rows[first * LANES + lane],
        rows[(first + 1) * LANES + lane],
        rows[(first + 2) * LANES + lane],
        rows[(first + 3) * LANES + lane],
    )


@kernel
def _end_lanes(camera, frame, end, half_axes, out):
    """Ellipses of one end: out (6 * LANES,) takes c_x, c_y, M_xx, M_xy, M_yy and the depth."""
    fx, fy, cx, cy, skew = camera[0], camera[1], camera[2], camera[3], camera[4]
    k1, k2, p1, p2, k3, edge = camera[5], camera[6], camera[7], camera[8], camera[9], camera[10]
    r0, r1, r2, r3, r4 = camera[11], camera[12], camera[13], camera[14], camera[15]
    r5, r6, r7, r8, t0, t1, t2 = camera[16], camera[17], camera[18], camera[19], camera[20], camera[21], camera[22]
    e0, e1, e2 = end[0], end[1], end[2]
    a0, a1, a2 = half_axes[0, 0], half_axes[0, 1], half_axes[0, 2]
    b0, b1, b2 = half_axes[1, 0], half_axes[1, 1], half_axes[1, 2]
    c0, c1, c2 = half_axes[2, 0], half_axes[2, 1], half_axes[2, 2]
    for lane in range(LANES):
        f0, f1, f2, f3 = _four(frame, 0, lane)
        g0, g1, g2, g3 = _four(frame, 4, lane)
        h0, h1, h2, h3 = _four(frame, 8, lane)
        wx, wy = f0 * e0 + f1 * e1 + f2 * e2 + f3, g0 * e0 + g1 * e1 + g2 * e2 + g3
        wz = h0 * e0 + h1 * e1 + h2 * e2 + h3
        x, y = r0 * wx + r1 * wy + r2 * wz + t0, r3 * wx + r4 * wy + r5 * wz + t1
        z = r6 * wx + r7 * wy + r8 * wz + t2
        u, v, ux, uy, uz, vx, vy, vz = _project(fx, fy, cx, cy, skew, k1, k2, p1, p2, k3, edge, x, y, max(z, NEAREST))
        # derivative by the world point, then by the segment's own coordinates, then along the half axes
        wu0, wu1, wu2 = ux * r0 + uy * r3 + uz * r6, ux * r1 + uy * r4 + uz * r7, ux * r2 + uy * r5 + uz * r8
        wv0, wv1, wv2 = vx * r0 + vy * r3 + vz * r6, vx * r1 + vy * r4 + vz * r7, vx * r2 + vy * r5 + vz * r8
        u0, u1, u2 = wu0 * f0 + wu1 * g0 + wu2 * h0, wu0 * f1 + wu1 * g1 + wu2 * h1, wu0 * f2 + wu1 * g2 + wu2 * h2
        v0, v1, v2 = wv0 * f0 + wv1 * g0 + wv2 * h0, wv0 * f1 + wv1 * g1 + wv2 * h1, wv0 * f2 + wv1 * g2 + wv2 * h2
        pa, qa = u0 * a0 + u1 * a1 + u2 * a2, v0 * a0 + v1 * a1 + v2 * a2
        pb, qb = u0 * b0 + u1 * b1 + u2 * b2, v0 * b0 + v1 * b1 + v2 * b2
        pc, qc = u0 * c0 + u1 * c1 + u2 * c2, v0 * c0 + v1 * c1 + v2 * c2
        out[lane], out[1 * LANES + lane], out[5 * LANES + lane] = u, v, z
        out[2 * LANES + lane] = pa * pa + pb * pb + pc * pc + SMALLEST
        out[3 * LANES + lane] = pa * qa + pb * qb + pc * qc
        out[4 * LANES + lane] = qa * qa + qb * qb + qc * qc + SMALLEST


@kernel
def support(out, base, nx, ny):
    """Support function h(n) of the end whose columns begin at `base`."""
    return math.sqrt(out[base + 2] * nx * nx + 2.0 * out[base + 3] * nx * ny + out[base + 4] * ny * ny)


@vector_kernel
def _whiten(axx, axy, ayy, bxx, bxy, byy, dx, dy):
    """L (l00, l10, l11) with M_1 = L L^T, its inverse (i00, i10, i11), d' = L^-1 d, and L^-1 M_2 L^-T."""
    l00 = math.sqrt(axx)
    i00 = 1.0 / l00
    l10 = axy * i00
    l11 = math.sqrt(ayy - l10 * l10)
    i11 = 1.0 / l11
    i10 = -l10 * i00 * i11
    qx, qy = i10 * bxx + i11 * bxy, i10 * bxy + i11 * byy
    return l00, l10, l11, i00, i10, i11, i00 * dx, i10 * dx + i11 * dy, i00 * i00 * bxx, i00 * qx, i10 * qx + i11 * qy


@vector_kernel
def _newton(ex, ey, nxx, nxy, nyy, mx, my):
    """One step towards the unit vector m with e m + sqrt(m^T N m) = 1; returns m and the size of the step, radians."""
    px, py = nxx * mx + nxy * my, nxy * mx + nyy * my
    h = math.sqrt(mx * px + my * py)
    slope = ey * mx - ex * my + (py * mx - px * my) / h
    step = (1.0 - h - ex * mx - ey * my) / (slope if slope != 0.0 else 1e-9)
    step = max(-1.0, min(1.0, step))
    shrink = 1.0 / (1.0 + 0.25 * step * step)  # a turn by 2 atan(step / 2) needs no root
    cosine, sine = (1.0 - 0.25 * step * step) * shrink, step * shrink
    return cosine * mx - sine * my, sine * mx + cosine * my, abs(step)


@kernel
def _tangent_lanes(ellipses, kinds, sides):
    """Find both outer tangents of ellipses, 12 rows: kind 1 where one end covers the other, else 2 or UNSOLVED; first
    and last y.

    With M_1 = L L^T and n = L^-T m the first end becomes the unit circle, and with both ends of one shape the second
    nearly a circle: the tangents' condition d' m + h_2'(m) = 1, d' = L^-1 d, is solved in closed form for a circle,
    then by Newton steps.
    """
    for lane in range(LANES):
        (ax, ay, axx, axy), ayy = _four(ellipses, 0, lane), ellipses[4 * LANES + lane]
        (bx, by, bxx, bxy), byy = _four(ellipses, 6, lane), ellipses[10 * LANES + lane]
        l00, l10, l11, i00, i10, i11, ex, ey, nxx, nxy, nyy = _whiten(axx, axy, ayy, bxx, bxy, byy, bx - ax, by - ay)
        distance = max(1e-9, math.sqrt(ex * ex + ey * ey))
        ux, uy = ex / distance if distance > 1e-9 else 1.0, ey / distance if distance > 1e-9 else 0.0
        along = math.sqrt(nxx * ux * ux + 2.0 * nxy * ux * uy + nyy * uy * uy)
        across = math.sqrt(nxx * uy * uy - 2.0 * nxy * ux * uy + nyy * ux * ux)
        sine = max(-0.999, min(0.999, (1.0 - across) / distance))
        cosine = math.sqrt(1.0 - sine * sine)
        mx, my, _ = _newton(ex, ey, nxx, nxy, nyy, ux * sine - uy * cosine, uy * sine + ux * cosine)
        mx, my, one = _newton(ex, ey, nxx, nxy, nyy, mx, my)
        kx, ky, _ = _newton(ex, ey, nxx, nxy, nyy, ux * sine + uy * cosine, uy * sine - ux * cosine)
        kx, ky, two = _newton(ex, ey, nxx, nxy, nyy, kx, ky)
        solved = 2.0 if max(one, two) < CLOSE else UNSOLVED
        kinds[lane] = solved if abs(1.0 - along) < distance else 1.0
        scale = 1.0 / (1.0 - ex * mx - ey * my)  # 1 / h_2(n), n = L^-T m
        nx, ny = i00 * mx + i10 * my, i11 * my
        length = 1.0 / math.sqrt(nx * nx + ny * ny)
        sides[lane], sides[1 * LANES + lane] = nx * length, ny * length
        sides[2 * LANES + lane], sides[3 * LANES + lane] = ax + l00 * mx, ay + l10 * mx + l11 * my
        sides[4 * LANES + lane], sides[5 * LANES + lane] = (
            bx + (bxx * nx + bxy * ny) * scale,
            by + (bxy * nx + byy * ny) * scale,
        )
        scale = 1.0 / (1.0 - ex * kx - ey * ky)
        nx, ny = i00 * kx + i10 * ky, i11 * ky
        length = 1.0 / math.sqrt(nx * nx + ny * ny)
        sides[6 * LANES + lane], sides[7 * LANES + lane] = nx * length, ny * length
        sides[8 * LANES + lane], sides[9 * LANES + lane] = ax + l00 * kx, ay + l10 * kx + l11 * ky
        sides[10 * LANES + lane], sides[11 * LANES + lane] = (
            bx + (bxx * nx + bxy * ny) * scale,
            by + (bxy * nx + byy * ny) * scale,
        )
        first, second = math.sqrt(ayy), math.sqrt(byy)
        sides[12 * LANES + lane] = min(ay - first, by - second)
        sides[13 * LANES + lane] = max(ay + first, by + second)


@kernel
def _bisect_tangents(ellipses, sides, lane):
    """The same for one lane where Newton's steps did not settle: thin discs seen edge on."""
    (ax, ay, axx, axy), ayy = _four(ellipses, 0, lane), ellipses[4 * LANES + lane]
    (bx, by, bxx, bxy), byy = _four(ellipses, 6, lane), ellipses[10 * LANES + lane]
    l00, l10, l11, i00, i10, i11, ex, ey, nxx, nxy, nyy = _whiten(axx, axy, ayy, bxx, bxy, byy, bx - ax, by - ay)
    distance = math.sqrt(ex * ex + ey * ey)
    ux, uy = ex / distance, ey / distance
    for side in range(2):
        sign = 1.0 - 2.0 * side
        low, high = 0.0, math.pi  # of the angle from u: the condition's left side falls from above 1 to below it
        mx, my = ux, uy
        for _ in range(BISECTIONS):
            angle = 0.5 * (low + high)
            cosine, sine = math.cos(angle), sign * math.sin(angle)
            mx, my = ux * cosine - uy * sine, uy * cosine + ux * sine
            if ex * mx + ey * my + math.sqrt(nxx * mx * mx + 2.0 * nxy * mx * my + nyy * my * my) > 1.0:
                low = angle
            else:
                high = angle
        nx, ny = i00 * mx + i10 * my, i11 * my
        scale = 1.0 / math.sqrt(bxx * nx * nx + 2.0 * bxy * nx * ny + byy * ny * ny)
        length = 1.0 / math.sqrt(nx * nx + ny * ny)
        base = 6 * side
        sides[(base) * LANES + lane], sides[(base + 1) * LANES + lane] = nx * length, ny * length
        sides[(base + 2) * LANES + lane], sides[(base + 3) * LANES + lane] = ax + l00 * mx, ay + l10 * mx + l11 * my
        sides[(base + 4) * LANES + lane], sides[(base + 5) * LANES + lane] = (
            bx + (bxx * nx + bxy * ny) * scale,
            by + (bxy * nx + byy * ny) * scale,
        )


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
    """Outlines (K, OUTLINE_COLUMNS) of all segments that have a shape, for one camera and frames (S, 3, 4)."""
    frame, kinds = np.empty(12 * LANES), np.empty((1, LANES))
    ellipses, sides = np.empty((1, 12 * LANES)), np.empty((1, 14 * LANES))
    for k in range(shaped.shape[0]):
        s = shaped[k]
        for i in range(12):
            frame[i * LANES : (i + 1) * LANES] = frames[s, i // 4, i % 4]
        outline_lanes(camera, frame, ends[s], half_axes[s], kinds[0], ellipses[0], sides[0])
        take_lane(kinds, ellipses, sides, 0, out[k : k + 1])


@kernel
def outline_space(shapes):
    """Room for the outlines of LANES poses, kinds, ellipses and sides as `outlines_lanes` fills them, and for one's."""
    return (
        np.empty((shapes, LANES)),
        np.empty((shapes, 12 * LANES)),
        np.empty((shapes, 14 * LANES)),
        np.empty((shapes, OUTLINE_COLUMNS)),
    )


@kernel
def outlines_lanes(camera, frames, shaped, ends, half_axes, kinds, ellipses, sides):
    """The same for LANES poses at once: frames (S, 12 * LANES), kinds (K, LANES), ellipses (K, 12 * LANES), sides
    (K, 14 * LANES).
    """
    for k in range(shaped.shape[0]):
        s = shaped[k]
        outline_lanes(camera, frames[s], ends[s], half_axes[s], kinds[k], ellipses[k], sides[k])


@kernel
def take_lane(kinds, ellipses, sides, lane, out):
    """Outlines (K, OUTLINE_COLUMNS) of one of the poses."""
    for k in range(out.shape[0]):
        row, first, second = out[k], ellipses[k], sides[k]
        row[KIND] = kinds[k, lane]
        for i in range(SIDE - END):
            row[END + i] = first[i * LANES + lane]
        for i in range(OUTLINE_COLUMNS - SIDE):
            row[SIDE + i] = second[i * LANES + lane]
