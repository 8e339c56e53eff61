"""What `_kernels.chain` means: a product of 4 x 4 matrices down the tree."""

from __future__ import annotations

import numpy as np

from muybridge.body.model import BodyArrays


def turn(code: int, angle: float) -> np.ndarray:
    """(4, 4): right-handed turn about x, y, z for the codes 1, 2, 3; the other sense for negative codes."""
    axis, angle = abs(code) - 1, np.sign(code) * angle
    i, j = (axis + 1) % 3, (axis + 2) % 3
    out = np.eye(4)
    out[i, i] = out[j, j] = np.cos(angle)
    out[i, j], out[j, i] = -np.sin(angle), np.sin(angle)
    return out


def frames(pose: np.ndarray, arrays: BodyArrays) -> np.ndarray:
    """Segment frames (S, 3, 4) of one pose (D,)."""
    out: list[np.ndarray] = []
    for s, parent in enumerate(arrays.parent):
        local = np.vstack([arrays.fixed[s], [0.0, 0.0, 0.0, 1.0]])
        if parent < 0:
            local[:3, 3] += pose[:3]
        for code, dof in zip(arrays.axis[s], arrays.dof[s], strict=True):
            if code:
                local = local @ turn(int(code), pose[dof])
        out.append(local if parent < 0 else out[parent] @ local)
    return np.array(out)[:, :3]
