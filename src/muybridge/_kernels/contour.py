"""Where the model's outline should move so that it meets the mask's border: residuals and their derivatives.

For every camera and segment, points are taken along both side lines and round the two ends. At each, the border of the
mask is searched along the outward normal; the signed distance d (pixels, positive outwards) is the residual, and its
derivative by the pose is the speed of the outline along that normal,

    d(n . u) / d(theta) = n^T J (a x (P - o)),

with J the projection's derivative at the surface point P that makes the outline, and a, o the axis and anchor of the
joint.

The other way round, every border point of the mask that no segment covers is matched to the segment whose outline is
nearest, with limbs preferred to the trunk: an arm that comes out from before the trunk is seen by nothing else.
"""

from __future__ import annotations

import math

import numpy as np

from muybridge._kernels._jit import kernel
from muybridge._kernels.chain import dof_screws
from muybridge._kernels.outline import END, KIND, OUTLINE_COLUMNS, SIDE, outlines_of, project, row_span, support

#: Columns of a row's facts: camera, segment, distance d, metres per pixel at the point, normal x, y, pixel x, y, place
#: along the segment (0 base, 1 tip), pixels per log width, pixels per log depth, alignment of border and normal.
CAMERA, SEGMENT, DISTANCE, METRES, NORMAL, PIXEL, ALONG, WIDTH, DEPTH, ALIGNMENT = 0, 1, 2, 3, 4, 6, 8, 9, 10, 11
ROW_COLUMNS = 12
NEIGHBOUR = 1.5  # pixels outwards; a point whose neighbour there lies in another segment is no border
STEP = 0.5  # pixels between looks at the mask
UNCOVERED = 1.5  # pixels outside every segment from which a border point of the mask counts as unexplained
CAP_ANGLES = (-1.05, -0.52, 0.0, 0.52, 1.05)  # radians round the axis direction


@kernel
def look(mask, x, y):
    """Bilinear value of a mask in [0, 1] at a pixel; 0 outside the picture."""
    height, width = mask.shape
    x0, y0 = math.floor(x), math.floor(y)
    fx, fy = x - x0, y - y0
    i, j = int(y0), int(x0)
    value = 0.0
    for a in range(2):
        for b in range(2):
            if 0 <= i + a < height and 0 <= j + b < width:
                value += mask[i + a, j + b] * (fy if a else 1.0 - fy) * (fx if b else 1.0 - fx)
    return value


@kernel
def border_distance(mask, x, y, nx, ny, reach):
    """Signed distance along (nx, ny) to where the mask next falls through one half; `inf` if that is out of reach."""
    here = look(mask, x, y)
    sense = 1.0 if here >= 0.5 else -1.0
    before, travelled = here, 0.0
    while travelled < reach:
        travelled += STEP
        value = look(mask, x + sense * travelled * nx, y + sense * travelled * ny)
        if (value < 0.5) == (sense > 0.0):
            part = (before - 0.5) / (before - value)
            return sense * (travelled - STEP + part * STEP)
        before = value
    return np.inf


@kernel
def border_alignment(mask, x, y, nx, ny):
    """Cosine between the outward normal and the direction in which the mask falls at (x, y), not below 0."""
    gx = look(mask, x - 1.0, y) - look(mask, x + 1.0, y)
    gy = look(mask, x, y - 1.0) - look(mask, x, y + 1.0)
    length = math.sqrt(gx * gx + gy * gy)
    return max(0.0, (gx * nx + gy * ny) / length) if length > 1e-6 else 0.0


@kernel
def inside_another(outlines, own, x, y):
    """Whether a pixel lies within the outline of any segment but `own`."""
    for k in range(outlines.shape[0]):
        if k != own and outlines[k, KIND] > 0.0:
            left, right = row_span(outlines[k], y)
            if left <= x <= right:
                return True
    return False


@kernel
def surface_point(camera, frame, end, half_axes, nx, ny, point):
    """Fill `point` (3,), world: the point of an end whose image is farthest along (nx, ny).

    Returns how far, in pixels, the outline moves there per log width and per log depth of the end.
    """
    c = np.empty(3)
    for i in range(3):
        c[i] = frame[i, 0] * end[0] + frame[i, 1] * end[1] + frame[i, 2] * end[2] + frame[i, 3]
        point[i] = c[i]
    x = camera[11] * c[0] + camera[12] * c[1] + camera[13] * c[2] + camera[20]
    y = camera[14] * c[0] + camera[15] * c[1] + camera[16] * c[2] + camera[21]
    z = camera[17] * c[0] + camera[18] * c[1] + camera[19] * c[2] + camera[22]
    _, _, ux, uy, uz, vx, vy, vz = project(camera, x, y, z)
    g = np.empty(3)
    for i in range(3):
        g[i] = (
            (nx * ux + ny * vx) * camera[11 + i]
            + (nx * uy + ny * vy) * camera[14 + i]
            + (nx * uz + ny * vz) * camera[17 + i]
        )
    total = 1e-12
    share = np.zeros(3)
    for j in range(3):
        for i in range(3):
            share[j] += g[i] * (
                frame[i, 0] * half_axes[j, 0] + frame[i, 1] * half_axes[j, 1] + frame[i, 2] * half_axes[j, 2]
            )
        total += share[j] * share[j]
    length = math.sqrt(total)
    for j in range(3):
        for i in range(3):
            axis_i = frame[i, 0] * half_axes[j, 0] + frame[i, 1] * half_axes[j, 1] + frame[i, 2] * half_axes[j, 2]
            point[i] += share[j] / length * axis_i
    along = 0.5 * share[2] * share[2]
    return (share[0] * share[0] + along) / length, (share[1] * share[1] + along) / length


@kernel
def add_row(
    camera,
    c,
    k,
    s,
    affects,
    axes,
    anchors,
    point,
    nx,
    ny,
    x,
    y,
    along,
    width,
    depth,
    outlines,
    mask,
    reach,
    rows,
    slopes,
    count,
):
    """Append the residual at one outline point unless another segment hides it or no border is near; the new count."""
    if count >= rows.shape[0] or inside_another(outlines, k, x + NEIGHBOUR * nx, y + NEIGHBOUR * ny):
        return count
    if not (0.0 <= x <= camera[23] - 1.0 and 0.0 <= y <= camera[24] - 1.0):
        return count
    distance = border_distance(mask, x, y, nx, ny, reach)
    if not math.isfinite(distance):
        return count
    alignment = border_alignment(mask, x + distance * nx, y + distance * ny, nx, ny)
    return write_row(
        camera,
        c,
        s,
        affects,
        axes,
        anchors,
        point,
        nx,
        ny,
        x,
        y,
        along,
        width,
        depth,
        distance,
        alignment,
        rows,
        slopes,
        count,
    )


@kernel
def write_row(
    camera,
    c,
    s,
    affects,
    axes,
    anchors,
    point,
    nx,
    ny,
    x,
    y,
    along,
    width,
    depth,
    distance,
    alignment,
    rows,
    slopes,
    count,
):
    """Write a residual and its derivative by every degree of freedom; the new count."""
    px = camera[11] * point[0] + camera[12] * point[1] + camera[13] * point[2] + camera[20]
    py = camera[14] * point[0] + camera[15] * point[1] + camera[16] * point[2] + camera[21]
    pz = camera[17] * point[0] + camera[18] * point[1] + camera[19] * point[2] + camera[22]
    if not pz > 0.0:
        return count
    _, _, ux, uy, uz, vx, vy, vz = project(camera, px, py, pz)
    gx = nx * ux + ny * vx
    gy = nx * uy + ny * vy
    gz = nx * uz + ny * vz
    g0 = gx * camera[11] + gy * camera[14] + gz * camera[17]
    g1 = gx * camera[12] + gy * camera[15] + gz * camera[18]
    g2 = gx * camera[13] + gy * camera[16] + gz * camera[19]
    slopes[count, 0], slopes[count, 1], slopes[count, 2] = g0, g1, g2
    for d in range(3, axes.shape[0]):
        slopes[count, d] = 0.0
        if affects[s, d]:
            r0, r1, r2 = point[0] - anchors[d, 0], point[1] - anchors[d, 1], point[2] - anchors[d, 2]
            slopes[count, d] = (
                g0 * (axes[d, 1] * r2 - axes[d, 2] * r1)
                + g1 * (axes[d, 2] * r0 - axes[d, 0] * r2)
                + g2 * (axes[d, 0] * r1 - axes[d, 1] * r0)
            )
    rows[count, CAMERA], rows[count, SEGMENT], rows[count, DISTANCE] = c, s, distance
    rows[count, METRES] = 1.0 / max(1e-9, math.sqrt(g0 * g0 + g1 * g1 + g2 * g2))
    rows[count, NORMAL], rows[count, NORMAL + 1], rows[count, PIXEL], rows[count, PIXEL + 1] = nx, ny, x, y
    rows[count, ALONG], rows[count, WIDTH], rows[count, DEPTH] = along, width, depth
    rows[count, ALIGNMENT] = alignment
    return count + 1


@kernel
def contour_rows(
    pose,
    parent,
    fixed,
    axis,
    dof,
    shaped,
    ends,
    half_axes,
    affects,
    cameras,
    masks,
    borders,
    border_counts,
    stiffness,
    reaches,
    side_points,
    rows,
    slopes,
):
    """Residuals of one pose (D,) in all cameras.

    masks (C, H, W) float32 in [0, 1]; borders (C, B, 2) pixels, of which border_counts (C,) are used; stiffness (S,),
    by which a segment's distance to a border point is multiplied before the nearest is chosen; reaches (C,) pixels;
    affects (S, D) bool: whether a joint moves a segment. Fills rows (R, ROW_COLUMNS) and slopes (R, D), pixels per
    metre and per radian; returns how many.
    """
    count = 0
    frames = np.empty((parent.shape[0], 3, 4))
    axes, anchors = np.zeros((pose.shape[0], 3)), np.zeros((pose.shape[0], 3))
    dof_screws(pose, parent, fixed, axis, dof, frames, axes, anchors)
    outlines = np.empty((shaped.shape[0], OUTLINE_COLUMNS))
    first, second, point = np.empty(3), np.empty(3), np.empty(3)
    for c in range(cameras.shape[0]):
        outlines_of(cameras[c], frames, shaped, ends, half_axes, outlines)
        for k in range(shaped.shape[0]):
            out, s = outlines[k], shaped[k]
            if out[KIND] == 0.0:
                continue
            if out[KIND] == 2.0:
                for side in range(2):
                    base = SIDE + 6 * side
                    nx, ny = out[base], out[base + 1]
                    w1, d1 = surface_point(cameras[c], frames[s], ends[s, 0], half_axes[s, 0], nx, ny, first)
                    w2, d2 = surface_point(cameras[c], frames[s], ends[s, 1], half_axes[s, 1], nx, ny, second)
                    for i in range(side_points):
                        t = (i + 0.5) / side_points
                        x = out[base + 2] + t * (out[base + 4] - out[base + 2])
                        y = out[base + 3] + t * (out[base + 5] - out[base + 3])
                        for j in range(3):
                            point[j] = first[j] + t * (second[j] - first[j])
                        count = add_row(
                            cameras[c],
                            c,
                            k,
                            s,
                            affects,
                            axes,
                            anchors,
                            point,
                            nx,
                            ny,
                            x,
                            y,
                            t,
                            w1 + t * (w2 - w1),
                            d1 + t * (d2 - d1),
                            outlines,
                            masks[c],
                            reaches[c],
                            rows,
                            slopes,
                            count,
                        )
            count = _caps(
                cameras[c],
                c,
                k,
                s,
                frames[s],
                ends[s],
                half_axes[s],
                affects,
                axes,
                anchors,
                outlines,
                masks[c],
                reaches[c],
                point,
                rows,
                slopes,
                count,
            )
        for b in range(border_counts[c]):
            count = _uncovered(
                cameras[c],
                c,
                borders[c, b, 0],
                borders[c, b, 1],
                frames,
                shaped,
                ends,
                half_axes,
                affects,
                axes,
                anchors,
                outlines,
                stiffness,
                reaches[c],
                first,
                second,
                point,
                rows,
                slopes,
                count,
            )
    return count


@kernel
def _uncovered(
    camera,
    c,
    x,
    y,
    frames,
    shaped,
    ends,
    half_axes,
    affects,
    axes,
    anchors,
    outlines,
    stiffness,
    reach,
    first,
    second,
    point,
    rows,
    slopes,
    count,
):
    """Residual of one border point of the mask that lies outside every segment; the new count."""
    best, nearest, gap, place, nx, ny = np.inf, -1, 0.0, 0.0, 0.0, 0.0
    for k in range(shaped.shape[0]):
        out = outlines[k]
        if out[KIND] == 0.0:
            continue
        dx, dy = out[END + 6] - out[END], out[END + 7] - out[END + 1]
        square = dx * dx + dy * dy
        t = 0.0
        if out[KIND] == 2.0 and square > 1e-9:
            t = min(1.0, max(0.0, ((x - out[END]) * dx + (y - out[END + 1]) * dy) / square))
        elif out[END + 8] + out[END + 10] > out[END + 2] + out[END + 4]:
            t = 1.0
        vx, vy = x - out[END] - t * dx, y - out[END + 1] - t * dy
        length = math.sqrt(vx * vx + vy * vy)
        if length * stiffness[shaped[k]] > best + 60.0 * stiffness[shaped[k]] or length < 1e-9:
            continue
        vx, vy = vx / length, vy / length
        away = length - (1.0 - t) * support(out, END, vx, vy) - t * support(out, END + 6, vx, vy)
        if away <= 0.0:
            return count  # covered
        if away * stiffness[shaped[k]] < best:
            best, nearest, gap, place, nx, ny = away * stiffness[shaped[k]], k, away, t, vx, vy
    if nearest < 0 or gap < UNCOVERED or gap > reach or count >= rows.shape[0]:
        return count
    s = shaped[nearest]
    w1, d1 = surface_point(camera, frames[s], ends[s, 0], half_axes[s, 0], nx, ny, first)
    w2, d2 = surface_point(camera, frames[s], ends[s, 1], half_axes[s, 1], nx, ny, second)
    for j in range(3):
        point[j] = first[j] + place * (second[j] - first[j])
    return write_row(
        camera,
        c,
        s,
        affects,
        axes,
        anchors,
        point,
        nx,
        ny,
        x - gap * nx,
        y - gap * ny,
        place,
        w1 + place * (w2 - w1),
        d1 + place * (d2 - d1),
        gap,
        1.0,
        rows,
        slopes,
        count,
    )


@kernel
def _caps(
    camera, c, k, s, frame, ends, half_axes, affects, axes, anchors, outlines, mask, reach, point, rows, slopes, count
):
    """Residuals round both ends of one segment, in the directions that lead away from its middle."""
    out = outlines[k]
    dx, dy = out[END + 6] - out[END], out[END + 7] - out[END + 1]
    length = math.sqrt(dx * dx + dy * dy)
    full_circle = out[KIND] == 1.0
    for e in range(2):
        if (
            full_circle
            and out[END + 6 * e + 2] + out[END + 6 * e + 4]
            < out[END + 6 * (1 - e) + 2] + out[END + 6 * (1 - e) + 4] + e
        ):
            continue  # the smaller of two ends, one of which covers the other
        turns = 12 if full_circle else len(CAP_ANGLES)
        for i in range(turns):
            if full_circle or length < 1e-9:
                angle = i * math.pi / 6.0
                nx, ny = math.cos(angle), math.sin(angle)
            else:
                sign = 1.0 if e == 1 else -1.0
                cosine, sine = math.cos(CAP_ANGLES[i]), math.sin(CAP_ANGLES[i])
                nx = sign * (dx * cosine - dy * sine) / length
                ny = sign * (dx * sine + dy * cosine) / length
            base = END + 6 * e
            h = support(out, base, nx, ny)
            x = out[base] + (out[base + 2] * nx + out[base + 3] * ny) / h
            y = out[base + 1] + (out[base + 3] * nx + out[base + 4] * ny) / h
            width, depth = surface_point(camera, frame, ends[e], half_axes[e], nx, ny, point)
            count = add_row(
                camera,
                c,
                k,
                s,
                affects,
                axes,
                anchors,
                point,
                nx,
                ny,
                x,
                y,
                float(e),
                width,
                depth,
                outlines,
                mask,
                reach,
                rows,
                slopes,
                count,
            )
    return count
