"""Forward kinematics: poses -> segment frames.

Every rotation is about an axis of the local frame, so that appending it mixes two columns of the frame's matrix and
nothing else.
"""

from __future__ import annotations

import math

import numpy as np

from muybridge._kernels._jit import kernel


@kernel
def one_chain(pose, parent, fixed, axis, dof, frames):
    """Fill `frames` (S, 3, 4) with every segment's rotation and origin in the world, for one pose (D,)."""
    for s in range(parent.shape[0]):
        p = parent[s]
        if p < 0:
            for i in range(3):
                for j in range(4):
                    frames[s, i, j] = fixed[s, i, j]
                frames[s, i, 3] += pose[i]
        else:
            for i in range(3):
                a, b, c = frames[p, i, 0], frames[p, i, 1], frames[p, i, 2]
                for j in range(4):
                    frames[s, i, j] = a * fixed[s, 0, j] + b * fixed[s, 1, j] + c * fixed[s, 2, j]
                frames[s, i, 3] += frames[p, i, 3]
        for k in range(3):
            code = axis[s, k]
            if code != 0:
                turn_columns(frames[s], code, pose[dof[s, k]])


@kernel
def turn_columns(frame, code, angle):
    """Multiply the frame's rotation from the right by a turn about the axis `code` (1, 2, 3 = x, y, z; sign = sense)."""
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
    out = np.empty((poses.shape[0], parent.shape[0], 3, 4))
    for n in range(poses.shape[0]):
        one_chain(poses[n], parent, fixed, axis, dof, out[n])
    return out


@kernel
def dof_screws(pose, parent, fixed, axis, dof, frames, axes, anchors):
    """World axis (D, 3) and anchor (D, 3) of every rotation, needed for derivatives; `frames` (S, 3, 4) is filled as well.

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
                    work[i, j] = (frames[p, i, 0] * fixed[s, 0, j] + frames[p, i, 1] * fixed[s, 1, j]
                                  + frames[p, i, 2] * fixed[s, 2, j])
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
