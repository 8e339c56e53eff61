"""Forward kinematics: poses -> segment frames.

Every rotation is about an axis of the local frame, so that appending it mixes two columns of the frame's matrix and
nothing else.
"""

from __future__ import annotations

import math

import numpy as np

from muybridge._kernels._jit import exact_kernel, kernel

LARGEST = 1e7  # metres and radians; beyond it, or not a number, a pose is none
LANES = 16  # poses that are posed and projected together: two vectors of eight
#: pi / 2 in three parts, the first two with 26 zero bits at their ends, so that multiples up to 2^26 are exact.
_HALF_PI_1, _HALF_PI_2, _HALF_PI_3 = 1.57079625129699707031, 7.54978941586159635335e-08, 5.39030285815811905290e-15


@exact_kernel
def cosines_and_sines(angles, cosines, sines):
    """Fill cosines and sines of angles (M,), radians, |angle| < 1e7: polynomials (Cephes) that the compiler can
    vectorise.
    """
    for i in range(angles.shape[0]):
        turns = math.floor(angles[i] * (2.0 / math.pi) + 0.5)
        r = ((angles[i] - turns * _HALF_PI_1) - turns * _HALF_PI_2) - turns * _HALF_PI_3
        z = r * r
        p = (
            (
                ((1.58962301576546568060e-10 * z - 2.50507477628578072866e-8) * z + 2.75573136213857245213e-6) * z
                - 1.98412698295895385996e-4
            )
            * z
            + 8.33333333332211858878e-3
        ) * z - 1.66666666666666307295e-1
        q = (
            (
                ((-1.13585365213876817300e-11 * z + 2.08757008419747316778e-9) * z - 2.75573141792967388112e-7) * z
                + 2.48015872888517045348e-5
            )
            * z
            - 1.38888888888730564116e-3
        ) * z + 4.16666666666665929218e-2
        sine, cosine = r + r * z * p, 1.0 - 0.5 * z + z * z * q
        quadrant = np.int64(turns) & 3
        s = cosine if quadrant & 1 else sine
        c = sine if quadrant & 1 else cosine
        sines[i] = -s if quadrant & 2 else s
        cosines[i] = -c if (quadrant + 1) & 2 else c


@kernel
def _row(flat, i):
    return flat[i * LANES : (i + 1) * LANES]


@kernel
def lane_space(dofs, segments):
    """Room for LANES poses: angles, their cosines and sines (D, LANES), and frames (S, 12 * LANES)."""
    shape = (dofs, LANES)
    return np.empty(shape), np.empty(shape), np.empty(shape), np.empty((segments, 12 * LANES))


@kernel
def load_lanes(poses, start, lanes, cosines, sines):
    """Copy poses[start : start + LANES] into lanes (D, LANES), the last pose repeated where there are fewer, and
    turn them.
    """
    for lane in range(LANES):
        n = min(start + lane, poses.shape[0] - 1)
        for d in range(poses.shape[1]):
            lanes[d, lane] = poses[n, d] if abs(poses[n, d]) < LARGEST else 0.0
    size = lanes.shape[0] * LANES
    cosines_and_sines(lanes.reshape(size), cosines.reshape(size), sines.reshape(size))
    for lane in range(LANES):
        n = min(start + lane, poses.shape[0] - 1)
        for d in range(poses.shape[1]):
            if not abs(poses[n, d]) < LARGEST:
                lanes[0, lane] = np.nan  # no place: nothing of it is seen


@kernel
def chain_lanes(poses, cosines, sines, parent, fixed, axis, dof, frames):
    """Frames (S, 12 * LANES) of LANES poses (D, LANES) at once, with the cosines and sines (D, LANES) of their angles.

    A frame's twelve rows are its (3, 4) matrix, rotation and origin; the poses are the lanes of the processor's
    vectors.
    """
    for s in range(parent.shape[0]):
        p = parent[s]
        for i in range(3):
            for j in range(4):
                target = _row(frames[s], 4 * i + j)
                if p < 0:
                    for lane in range(LANES):
                        target[lane] = fixed[s, i, j]
                else:
                    f0, f1, f2, f3 = fixed[s, 0, j], fixed[s, 1, j], fixed[s, 2, j], 1.0 if j == 3 else 0.0
                    a, b, c, o = (
                        _row(frames[p], 4 * i),
                        _row(frames[p], 4 * i + 1),
                        _row(frames[p], 4 * i + 2),
                        _row(frames[p], 4 * i + 3),
                    )
                    for lane in range(LANES):
                        target[lane] = a[lane] * f0 + b[lane] * f1 + c[lane] * f2 + o[lane] * f3
            if p < 0:
                target, place = _row(frames[s], 4 * i + 3), poses[i]
                for lane in range(LANES):
                    target[lane] += place[lane]
        for k in range(3):
            if axis[s, k] != 0:
                _turn_lanes(frames[s], axis[s, k], cosines[dof[s, k]], sines[dof[s, k]])


@kernel
def _turn_lanes(frame, code, cosines, sines):
    """As `turn_columns`, for a frame (12 * LANES,)."""
    sign = 1.0 if code > 0 else -1.0
    i, j = abs(code) % 3, (abs(code) + 1) % 3
    for row in range(3):
        u, v = _row(frame, 4 * row + i), _row(frame, 4 * row + j)
        for lane in range(LANES):
            a, b, cosine, sine = u[lane], v[lane], cosines[lane], sign * sines[lane]
            u[lane] = cosine * a + sine * b
            v[lane] = cosine * b - sine * a


@kernel
def turn_columns(frame, code, angle):
    """Multiply the frame's rotation from the right by a turn about the axis `code` (1, 2, 3 = x, y, z; sign =
    sense).
    """
    if code < 0:
        code, angle = -code, -angle
    cosine, sine = math.cos(angle), math.sin(angle)
    i, j = code % 3, (code + 1) % 3
    for row in range(3):
        u, v = frame[row, i], frame[row, j]
        frame[row, i] = cosine * u + sine * v
        frame[row, j] = cosine * v - sine * u


@kernel
def segment_frames(poses, parent, fixed, axis, dof):
    """Frames (N, S, 3, 4) of poses (N, D)."""
    segments, shape = parent.shape[0], (poses.shape[1], LANES)
    out = np.empty((poses.shape[0], segments, 3, 4))
    lanes, cosines, sines, frames = np.empty(shape), np.empty(shape), np.empty(shape), np.empty((segments, 12 * LANES))
    for start in range(0, poses.shape[0], LANES):
        load_lanes(poses, start, lanes, cosines, sines)
        chain_lanes(lanes, cosines, sines, parent, fixed, axis, dof, frames)
        for n in range(start, min(start + LANES, poses.shape[0])):
            for s in range(segments):
                for i in range(12):
                    out[n, s, i // 4, i % 4] = frames[s, i * LANES + n - start]
    return out


@kernel
def dof_screws(pose, parent, fixed, axis, dof, frames, axes, anchors):
    """World axis (D, 3) and anchor (D, 3) of every rotation, needed for derivatives; `frames` (S, 3, 4) is filled as
    well.

    A turn by d about axis a through anchor o moves a point P that hangs below it by d * a x (P - o).
    """
    work = np.empty((3, 4))
    for s in range(parent.shape[0]):
        p = parent[s]
        for i in range(3):
            for j in range(4):
                if p < 0:
                    work[i, j] = fixed[s, i, j]
                else:
                    work[i, j] = (
                        frames[p, i, 0] * fixed[s, 0, j]
                        + frames[p, i, 1] * fixed[s, 1, j]
                        + frames[p, i, 2] * fixed[s, 2, j]
                    )
            work[i, 3] += pose[i] if p < 0 else frames[p, i, 3]
        for k in range(3):
            code = axis[s, k]
            if code != 0:
                column, sign = abs(code) - 1, 1.0 if code > 0 else -1.0
                for i in range(3):
                    axes[dof[s, k], i] = sign * work[i, column]
                    anchors[dof[s, k], i] = work[i, 3]
                turn_columns(work, code, pose[dof[s, k]])
        frames[s] = work
