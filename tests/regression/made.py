"""Made examples: a person of three angles whose silhouette hides, as silhouettes do, whether they come or go."""

from __future__ import annotations

import numpy as np

from muybridge.regression.components import PoseComponents

COMPONENTS = PoseComponents(("yaw", "left_hip", "right_hip"), (0,), 0)
NOISE = 0.02


def examples(rng, count):
    """Descriptors (N, 6) and poses (N, 3): projections onto the picture that depth hardly enters."""
    heading, phase = rng.uniform(-np.pi, np.pi, count), rng.uniform(0, 2 * np.pi, count)
    swing = rng.uniform(0.3, 0.5, count)
    hips = np.column_stack([np.cos(phase), -np.cos(phase)]) * swing[:, None]
    across, along = np.sin(heading), np.cos(heading)
    descriptors = np.column_stack([
        np.abs(along), across * hips[:, 0], across * hips[:, 1], across, swing, 0.15 * along,
    ])  # fmt: skip
    poses = COMPONENTS.wrapped(np.column_stack([heading, hips]))
    return descriptors + NOISE * rng.normal(size=descriptors.shape), poses
