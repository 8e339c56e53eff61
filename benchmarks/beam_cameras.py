"""The man on the beam with every choice of cameras: mean error of 13 joints against the reference, alignment none.

    python benchmarks/beam_cameras.py JOB.toml [--cameras 4 3 2 1] [--seeds 3] [--set KEY=VALUE ...]

JOB.toml is what `muybridge.datasets.samples.write_beam_job` wrote, with a [reference]. A single camera starts from the
reference's first pose; more find their own.
"""

from __future__ import annotations

import argparse
import itertools
import tempfile
from pathlib import Path

import msgspec
import numpy as np

from muybridge.errors import InputError
from muybridge.evaluation import evaluate
from muybridge.io.job import Job, StartInput, read
from muybridge.tracking import run

LIMBS = [
    f"{side}_{joint}" for side in ("left", "right") for joint in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")
]
JOINTS = ["thorax", *LIMBS]


def measure(job: Job, seed: int) -> str:
    """One run: mean over 13 joints and frames, worst frame, frames with a lost wrist, frames with swapped legs."""
    assert job.reference is not None
    with tempfile.TemporaryDirectory() as folder:
        try:
            summary = run(msgspec.structs.replace(job, seed=seed), Path(folder))
        except InputError as error:
            return f"| no start: {error} | | | | |"
        errors = evaluate(folder, job.reference.file, "none")
    order = [joint.joint for joint in errors.joints]
    millimetres = errors.errors_mm[:, [order.index(name) for name in JOINTS]]
    wrists = errors.errors_mm[:, [order.index(f"{side}_wrist") for side in ("left", "right")]]
    lost = int((wrists > 200).any(axis=1).sum())
    frames = np.nanmean(millimetres, axis=1)
    swapped = len(errors.swapped_frames)
    speed = summary.ms_per_frame["median"]
    return f"| {np.nanmean(millimetres):.1f} | {frames.max():.0f} | {lost} | {swapped} | {speed:.0f} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("job", type=Path)
    parser.add_argument("--cameras", type=int, nargs="+", default=[4, 3, 2, 1])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--set", nargs="*", default=[])
    args = parser.parse_args()
    job = read(args.job, args.set)
    print(
        "| cameras | seed | mean mm | worst frame mm | lost wrists | swapped legs | ms a frame |\n"
        "|---|---|---|---|---|---|---|"
    )
    for count in args.cameras:
        for chosen in itertools.combinations(job.cameras, count):
            fewer = msgspec.structs.replace(job, cameras=tuple(chosen))
            if count == 1:
                fewer = msgspec.structs.replace(fewer, start=StartInput(pose="reference"))
            for seed in range(1, args.seeds + 1):
                names = "+".join(camera.name for camera in chosen)
                print(f"| {names} | {seed} {measure(fewer, seed)}", flush=True)


if __name__ == "__main__":
    main()
