"""The printed Sigma: the largest change between two frames of every component of a pose, in training (V-C1).

    python benchmarks/largest_changes.py [FIGURE [SEED]]

Sedai et al. (2013) take it for the standard deviation of the motion model. `tracking.motion.GUESSING_PRINTED` has the
place's, the heading's and the knees' of what this prints for a jog: 2.2 m, 2.7 rad and 12 rad a second.
"""

from __future__ import annotations

import sys

import numpy as np

from muybridge.evaluation.names import JOINTS
from muybridge.io.training_file import SceneSource
from muybridge.synthetic.measure import tracker_body
from muybridge.synthetic.scene import truth
from muybridge.tracking.pose_input import poses_from_joints
from muybridge.tracking.training import scene_of

FRAMES = 60


def main(figure: str = "man", seed: int = 300) -> None:
    """Print metres and radians a second, walking and jogging."""
    for motion in ("walk", "jog"):
        source = SceneSource(preset="humaneva", figures=(figure,), motions=(motion,), seeds=(seed,), frames=FRAMES)
        scene = scene_of(source, figure, motion, seed)
        person = scene.person
        body = tracker_body(person.figure, person.cut, person.hair)
        poses = poses_from_joints(body, JOINTS, truth(scene).joints)
        largest = np.abs(np.diff(poses, axis=0)).max(axis=0) * person.motion.rate
        for name, value in zip(body.dof_names, largest, strict=True):
            print(f"{motion:5s} {name:28s} {value:5.1f}")


if __name__ == "__main__":
    main(*sys.argv[1:2], *map(int, sys.argv[2:3]))
