"""Where the model's outline should move so that it meets the mask's border: residuals and their derivatives.

For every camera and segment, points are taken along both side lines and round the two ends. At each, the border of the
mask is searched along the outward normal; the signed distance d (pixels, positive outwards) is the residual, and its
derivative by the pose is the speed of the outline along that normal,

    d(n . u) / d(theta) = n^T J (a x (P - o)),

with J the projection's derivative at the surface point P that makes the outline, and a, o the axis and anchor of the
joint.

The other way round, every border point of the mask that no segment covers is matched to the segment whose outline is
nearest, with limbs preferred to the trunk: an arm that comes out from before the trunk is seen by nothing else.

Every residual is a row of numbers, filled in three steps: a place on the outline, what the mask says there, and how
fast it moves.
"""

from __future__ import annotations

import math

import numpy as np

from muybridge._kernels._jit import kernel
from muybridge._kernels.border import border_alignment, border_distance
from muybridge._kernels.chain import dof_screws
from muybridge._kernels.outline import END, KIND, OUTLINE_COLUMNS, SIDE, outlines_of, project, row_span, support

#: Columns of a row: camera, segment, distance d, metres per pixel at the point, normal x, y, pixel x, y, place along
#: the segment (0 base, 1 tip), pixels per log width, pixels per log depth, alignment of border and normal, and the
#: point P, world, metres.
CAMERA, SEGMENT, DISTANCE, METRES, NORMAL, PIXEL = 0, 1, 2, 3, 4, 6
ALONG, WIDTH, DEPTH, ALIGNMENT, POINT, ROW_COLUMNS = 8, 9, 10, 11, 12, 15
NEIGHBOUR = 1.5  # pixels outwards; a point whose neighbour there lies in another segment is no border
UNCOVERED = 1.5  # pixels outside every segment from which a border point of the mask counts as unexplained
CAP_ANGLES = (-1.05, -0.52, 0.0, 0.52, 1.05)  # radians round the axis direction
TURNS = 12  # points round a segment that is seen as one ellipse


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
    wanted,
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

    wanted (S,) bool: the segments whose outline is looked at; masks (C, H, W) uint8, 0 to FULL; borders (C, B, 2)
    pixels, of which border_counts (C,) are used; stiffness (S,), by which a segment's distance to a border point is
    multiplied before the nearest is chosen; reaches (C,) pixels; affects (S, D) bool: whether a joint moves a segment.
    Fills rows (R, ROW_COLUMNS) and slopes (R, D), pixels per metre and per radian; returns how many.
    """
    count = 0
    frames = np.empty((parent.shape[0], 3, 4))
    axes, anchors = np.zeros((pose.shape[0], 3)), np.zeros((pose.shape[0], 3))
    dof_screws(pose, parent, fixed, axis, dof, frames, axes, anchors)
    outlines, boxes = np.empty((shaped.shape[0], OUTLINE_COLUMNS)), np.empty((shaped.shape[0], 4))
    for c in range(cameras.shape[0]):
        outlines_of(cameras[c], frames, shaped, ends, half_axes, outlines)
        boxes_of(outlines, boxes)
        for k in range(shaped.shape[0]):
            s = shaped[k]
            if not wanted[s] or outlines[k, KIND] == 0.0:
                continue
            for i in range(points_of(outlines[k], side_points)):
                row = rows[count]
                row[CAMERA], row[SEGMENT] = c, s
                if (
                    place_point(outlines[k], i, side_points, row)
                    and seen_as_border(outlines, boxes, k, cameras[c], row)
                    and meet_border(masks[c], reaches[c], row)
                ):
                    surface_point(cameras[c], frames[s], ends[s], half_axes[s], row)
                    count += 1
        for b in range(border_counts[c]):
            row = rows[count]
            k = nearest_uncovering(outlines, shaped, stiffness, borders[c, b, 0], borders[c, b, 1], row)
            if k >= 0 and wanted[shaped[k]] and UNCOVERED <= row[DISTANCE] <= reaches[c]:
                s = shaped[k]
                row[CAMERA], row[SEGMENT], row[ALIGNMENT] = c, s, 1.0
                surface_point(cameras[c], frames[s], ends[s], half_axes[s], row)
                count += 1
    return differentiate(rows, slopes, count, cameras, affects, axes, anchors)


@kernel
def points_of(out, side_points):
    """How many points of an outline are looked at: along two sides and round two caps, or round one ellipse."""
    return 2 * (side_points + len(CAP_ANGLES)) if out[KIND] == 2.0 else TURNS


@kernel
def place_point(out, i, side_points, row):
    """Fill a row's place with the i-th point of an outline; False where there is none."""
    if out[KIND] == 2.0 and i < 2 * side_points:
        base = SIDE + 6 * (i // side_points)
        t = (i % side_points + 0.5) / side_points
        row[NORMAL], row[NORMAL + 1], row[ALONG] = out[base], out[base + 1], t
        row[PIXEL] = out[base + 2] + t * (out[base + 4] - out[base + 2])
        row[PIXEL + 1] = out[base + 3] + t * (out[base + 5] - out[base + 3])
    else:
        e = larger_end(out)
        angle = 2.0 * math.pi * i / TURNS
        nx, ny = math.cos(angle), math.sin(angle)
        if out[KIND] == 2.0:
            i -= 2 * side_points
            e = i // len(CAP_ANGLES)
            dx, dy = out[END + 6] - out[END], out[END + 7] - out[END + 1]
            length = math.sqrt(dx * dx + dy * dy)
            if length < 1e-9:
                return False
            sign = (2.0 * e - 1.0) / length  # away from the segment's middle
            cosine, sine = math.cos(CAP_ANGLES[i % len(CAP_ANGLES)]), math.sin(CAP_ANGLES[i % len(CAP_ANGLES)])
            nx, ny = sign * (dx * cosine - dy * sine), sign * (dx * sine + dy * cosine)
        base = END + 6 * e
        h = support(out, base, nx, ny)
        row[NORMAL], row[NORMAL + 1], row[ALONG] = nx, ny, e
        row[PIXEL] = out[base] + (out[base + 2] * nx + out[base + 3] * ny) / h
        row[PIXEL + 1] = out[base + 1] + (out[base + 3] * nx + out[base + 4] * ny) / h
    return True


@kernel
def larger_end(out):
    """0 or 1: which end's ellipse is the larger, and covers the other where an outline has no sides."""
    return 1 if out[END + 8] + out[END + 10] > out[END + 2] + out[END + 4] else 0


@kernel
def surface_point(camera, frame, ends, half_axes, row):
    """Fill a row's P, world: the surface point whose image is farthest along the normal, `ALONG` from base to tip.

    And its widths: how far, in pixels, the outline moves there per log width and per log depth.
    """
    row[WIDTH] = row[DEPTH] = row[POINT] = row[POINT + 1] = row[POINT + 2] = 0.0
    for e in range(2):
        part = row[ALONG] if e == 1 else 1.0 - row[ALONG]
        if part > 0.0:
            _add_end(camera, frame, ends[e], half_axes[e], part, row)


@kernel
def _add_end(camera, frame, end, half_axes, part, row):
    """Add `part` of the extreme point of one end to a row's P and widths."""
    cx, cy, cz = turned(frame, end)
    cx, cy, cz = cx + frame[0, 3], cy + frame[1, 3], cz + frame[2, 3]
    gx, gy, gz, _ = pixel_gradient(camera, cx, cy, cz, row[NORMAL], row[NORMAL + 1])
    total, wide, deep, along = 1e-12, 0.0, 0.0, 0.0
    px, py, pz = 0.0, 0.0, 0.0
    for j in range(3):
        ax, ay, az = turned(frame, half_axes[j])
        reach = gx * ax + gy * ay + gz * az
        px, py, pz = px + reach * ax, py + reach * ay, pz + reach * az
        total += reach * reach
        if j == 0:
            wide = reach * reach
        elif j == 1:
            deep = reach * reach
        else:
            along = 0.5 * reach * reach
    length = math.sqrt(total)
    row[POINT] += part * (cx + px / length)
    row[POINT + 1] += part * (cy + py / length)
    row[POINT + 2] += part * (cz + pz / length)
    row[WIDTH] += part * (wide + along) / length
    row[DEPTH] += part * (deep + along) / length


@kernel
def turned(frame, v):
    """A segment's vector (3,) in the world: x, y, z."""
    return (
        frame[0, 0] * v[0] + frame[0, 1] * v[1] + frame[0, 2] * v[2],
        frame[1, 0] * v[0] + frame[1, 1] * v[1] + frame[1, 2] * v[2],
        frame[2, 0] * v[0] + frame[2, 1] * v[1] + frame[2, 2] * v[2],
    )


@kernel
def pixel_gradient(camera, x, y, z, nx, ny):
    """Pixels along (nx, ny) per metre that a world point moves in x, y, z; and its depth."""
    a = camera[11] * x + camera[12] * y + camera[13] * z + camera[20]
    b = camera[14] * x + camera[15] * y + camera[16] * z + camera[21]
    depth = camera[17] * x + camera[18] * y + camera[19] * z + camera[22]
    _, _, ux, uy, uz, vx, vy, vz = project(camera, a, b, depth)
    ga, gb, gc = nx * ux + ny * vx, nx * uy + ny * vy, nx * uz + ny * vz
    return (
        ga * camera[11] + gb * camera[14] + gc * camera[17],
        ga * camera[12] + gb * camera[15] + gc * camera[18],
        ga * camera[13] + gb * camera[16] + gc * camera[19],
        depth,
    )


@kernel
def boxes_of(outlines, boxes):
    """Fill boxes (K, 4) with left, top, right, bottom of outlines (K, OUTLINE_COLUMNS), pixels; empty where unseen."""
    for k in range(outlines.shape[0]):
        out, box = outlines[k], boxes[k]
        box[0] = box[1] = np.inf
        box[2] = box[3] = -np.inf
        for e in range(2 if out[KIND] > 0.0 else 0):
            base = END + 6 * e
            wide, high = math.sqrt(out[base + 2]), math.sqrt(out[base + 4])
            box[0], box[1] = min(box[0], out[base] - wide), min(box[1], out[base + 1] - high)
            box[2], box[3] = max(box[2], out[base] + wide), max(box[3], out[base + 1] + high)


@kernel
def seen_as_border(outlines, boxes, own, camera, row):
    """Whether a point of outline `own` lies in the picture and just outside it lies no other segment."""
    x, y = row[PIXEL], row[PIXEL + 1]
    if not (0.0 <= x <= camera[23] - 1.0 and 0.0 <= y <= camera[24] - 1.0):
        return False
    x, y = x + NEIGHBOUR * row[NORMAL], y + NEIGHBOUR * row[NORMAL + 1]
    for k in range(outlines.shape[0]):
        if k != own and boxes[k, 0] <= x <= boxes[k, 2] and boxes[k, 1] <= y <= boxes[k, 3]:
            left, right = row_span(outlines[k], y)
            if left <= x <= right:
                return False
    return True


@kernel
def meet_border(mask, reach, row):
    """Fill a row's distance to the mask's border and how well the two are aligned; False where it is out of reach."""
    x, y, nx, ny = row[PIXEL], row[PIXEL + 1], row[NORMAL], row[NORMAL + 1]
    distance = border_distance(mask, x, y, nx, ny, reach)
    if not math.isfinite(distance):
        return False
    row[DISTANCE] = distance
    row[ALIGNMENT] = border_alignment(mask, x + distance * nx, y + distance * ny, nx, ny)
    return True


@kernel
def nearest_uncovering(outlines, shaped, stiffness, x, y, row):
    """The outline that a border point of the mask should be reached by, and the row's place on it.

    -1 where a segment covers the point already.
    """
    best, nearest = np.inf, -1
    for k in range(shaped.shape[0]):
        out, stiff = outlines[k], stiffness[shaped[k]]
        if out[KIND] == 0.0:
            continue
        dx, dy = out[END + 6] - out[END], out[END + 7] - out[END + 1]
        square = dx * dx + dy * dy
        t = float(larger_end(out))
        if out[KIND] == 2.0 and square > 1e-9:
            t = min(1.0, max(0.0, ((x - out[END]) * dx + (y - out[END + 1]) * dy) / square))
        vx, vy = x - out[END] - t * dx, y - out[END + 1] - t * dy
        length = math.sqrt(vx * vx + vy * vy)
        farthest = math.sqrt(max(out[END + 2] + out[END + 4], out[END + 8] + out[END + 10]))  # of the ends' borders
        if (length - farthest) * stiff > best or length < 1e-9:
            continue
        vx, vy = vx / length, vy / length
        away = length - (1.0 - t) * support(out, END, vx, vy) - t * support(out, END + 6, vx, vy)
        if away <= 0.0:
            return -1
        if away * stiff < best:
            best, nearest = away * stiff, k
            row[DISTANCE], row[ALONG], row[NORMAL], row[NORMAL + 1] = away, t, vx, vy
            row[PIXEL], row[PIXEL + 1] = x - away * vx, y - away * vy
    return nearest


@kernel
def differentiate(rows, slopes, count, cameras, affects, axes, anchors):
    """Fill the derivatives of `count` rows by every degree of freedom; returns how many lie before their camera."""
    kept = 0
    for i in range(count):
        row = rows[i]
        x, y, z = row[POINT], row[POINT + 1], row[POINT + 2]
        gx, gy, gz, depth = pixel_gradient(cameras[int(row[CAMERA])], x, y, z, row[NORMAL], row[NORMAL + 1])
        if not depth > 0.0:
            continue
        row[METRES] = 1.0 / max(1e-9, math.sqrt(gx * gx + gy * gy + gz * gz))
        if kept < i:
            rows[kept] = row
        slope, s = slopes[kept], int(row[SEGMENT])
        slope[0], slope[1], slope[2] = gx, gy, gz
        for d in range(3, axes.shape[0]):
            slope[d] = 0.0
            if affects[s, d]:
                rx, ry, rz = x - anchors[d, 0], y - anchors[d, 1], z - anchors[d, 2]
                slope[d] = (
                    gx * (axes[d, 1] * rz - axes[d, 2] * ry)
                    + gy * (axes[d, 2] * rx - axes[d, 0] * rz)
                    + gz * (axes[d, 0] * ry - axes[d, 1] * rx)
                )
        kept += 1
    return kept
