"""Copy a folder in the bodytrack layout with wrong body lengths and cameras that look past the truth.

    python benchmarks/spoil_bodytrack.py SCENE OUT [--length 0.05] [--pixels 2] [--seed 1] [--same-sign]

Every length of the body file is made `length` too long or too short (at random, or all too long), and every principal
point is moved by `pixels` in a random direction. Pictures are linked, truth is copied.
"""

from __future__ import annotations

import argparse
import shutil
from pathlib import Path

import numpy as np


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--length", type=float, default=0.05)
    parser.add_argument("--pixels", type=float, default=2.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--same-sign", action="store_true")
    args = parser.parse_args()
    rng = np.random.default_rng(args.seed)
    args.out.mkdir(parents=True)
    for entry in args.scene.iterdir():
        if entry.is_dir() and entry.name != "CALIB":
            (args.out / entry.name).symlink_to(entry.resolve())
        elif entry.is_file() and entry.suffix in (".txt", ".csv"):
            shutil.copy(entry, args.out)
    numbers = np.array((args.scene / "BodyShapeParameters.txt").read_text().split(), float)
    signs = np.ones(18) if args.same_sign else rng.choice([-1.0, 1.0], 18)
    numbers[40:] *= 1.0 + args.length * signs
    (args.out / "BodyShapeParameters.txt").write_text("\n".join(f"{v:.9f}" for v in numbers) + "\n")
    (args.out / "CALIB").mkdir()
    for path in sorted((args.scene / "CALIB").glob("*.cal")):
        values = np.array(path.read_text().split(), float)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        values[2:4] += args.pixels * np.array([np.cos(angle), np.sin(angle)])
        (args.out / "CALIB" / path.name).write_text("\n".join(f"{v:.10f}" for v in values) + "\n")


if __name__ == "__main__":
    main()
